# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes of Blender's Shader menu, as Closures.

    Diffuse      diffuse = ambient = colour
    Glossy       reflection c s, the rest c (1 - s) as a highlight and ambient, where
                 s = (1 - r)², below roughness 0.05 an exact mirror's 1
    Glass        reflection F c, transmission (1 - F) c, by Fresnel's equations at every point
    Refraction   transmission c
    Transparent  transmission c, the surroundings' index
    Translucent  half a Diffuse
    Principled   the above, weighted by Metallic and Transmission; its dielectric layer and its coat
                 reflect F s and have a highlight of F at normal incidence
"""

from ... import compat
from .closure import Closure, added, mixed

MIRROR_ROUGHNESS = 0.05  # below, a reflection is taken for exact
COAT_IOR = 1.5  # until 4.0, when a coat reflected a quarter of what it does now
OLD_COAT = 0.25
COLORS = ("Color", "Base Color")


# ---- pieces ----------------------------------------------------------------------------------

def matte(site, color):
    return Closure(site.b, diffuse=color, ambient=color)


def sharpness(b, roughness):
    """Share of a glossy reflection that is traced as a mirror's."""
    smooth = b.invert(roughness)
    return b.mix(b.math("LESS_THAN", roughness, MIRROR_ROUGHNESS), b.multiply(smooth, smooth), 1.0)


def reflecting(site, color, roughness, mirrored=None):
    """A Glossy BSDF; `mirrored`: another colour of what is reflected as by a mirror."""
    b = site.b
    share = sharpness(b, roughness)
    rest = b.multiply(color, b.invert(share))
    return Closure(b, reflection=b.multiply(mirrored or color, share), ambient=rest, specular=rest,
                   roughness=roughness)


def at_normal(b, ior):
    """Reflectance of a boundary between dielectrics, seen head-on."""
    root = b.divide(b.subtract(ior, 1.0), b.add(ior, 1.0))
    return b.multiply(root, root)


def layer(site, f0, normal, roughness):
    """(Closure, Fresnel's reflectance) of a thin dielectric layer by its reflectance head-on."""
    b = site.b
    root = b.math("SQRT", b.clamp(f0, 0.0, 0.999))
    fresnel = b.op("fresnel", b.divide(b.add(1.0, root), b.invert(root)), normal)
    return Closure(b, specular=f0, roughness=roughness,
                   reflection=b.multiply(fresnel, sharpness(b, roughness))), fresnel


def clear(site, reflected, transmitted, ior, normal):
    """A boundary of these colours."""
    b = site.b
    fresnel = b.op("fresnel", ior, normal)
    return Closure(b, reflection=b.multiply(fresnel, reflected), ior=ior,
                   transmission=b.multiply(b.invert(fresnel), transmitted))


def with_normal(site, closure):
    closure.normal = site.normal()
    return closure


def index(site, default=1.45):
    return site.b.vector_math("MAXIMUM", site.value("IOR", default=default), 0.1)


def roughness_of(site):
    if getattr(site.node, "distribution", "") == "SHARP":
        return site.b.constant(0.0)
    return site.b.clamp(site.value("Roughness"))


# ---- nodes -----------------------------------------------------------------------------------

def diffuse(site):
    return with_normal(site, matte(site, site.value(*COLORS)))


def translucent(site):
    site.note("it is drawn as a Diffuse BSDF of half its colour")
    return with_normal(site, matte(site, site.b.multiply(site.value("Color"), 0.5)))


def glossy(site):
    return with_normal(site, reflecting(site, site.value(*COLORS), roughness_of(site)))


def metallic(site):
    """Metallic BSDF (4.3 on): its edge's tint where it is seen at a grazing angle."""
    b = site.b
    base = site.value("Base Color")
    if getattr(site.node, "fresnel_type", "F82") != "F82":
        site.note("its base colour counts and not its index of refraction")
    edge = site.value("Edge Tint", default=1.0)
    grazing = b.op("layer_weight", 0.5, site.normal(), modes=("FACING",))
    mirrored = b.mix(b.math("POWER", grazing, 5.0), base, edge)
    return with_normal(site, reflecting(site, base, roughness_of(site), mirrored))


def glass(site):
    color = site.value("Color")
    return with_normal(site, clear(site, color, color, index(site), site.normal()))


def refraction(site):
    return with_normal(site, Closure(site.b, transmission=site.value("Color"), ior=index(site)))


def transparent(site):
    return Closure(site.b, transmission=site.value("Color"),
                   ior=site.b.constant(site.c.environment_ior))


def glow(site, color):
    return Closure(site.b, emission=color)


def emission(site):
    return glow(site, site.b.multiply(site.value("Color"), site.value("Strength", default=1.0)))


def holdout(site):
    site.note("it is drawn black")
    return Closure(site.b)


def eevee_specular(site):
    b = site.b
    site.note("it is drawn as a Diffuse BSDF with a highlight")
    closure = matte(site, site.value("Base Color"))
    closure.specular, closure.roughness = site.value("Specular"), site.value("Roughness")
    closure.emission = site.value("Emissive Color")
    closure.alpha = b.invert(b.clamp(site.value("Transparency")))
    return with_normal(site, closure)


def substitute(site):
    """What stands in for a shader that is not known."""
    if site.socket(*COLORS) is None:
        site.note("it is drawn black")
        return Closure(site.b)
    site.note("it is drawn as a Diffuse BSDF")
    return diffuse(site)


def mix(site):
    first, second = (site.c.closure(site.node.inputs[i], site.stack) for i in (1, 2))
    return mixed(first, second, site.value(0))


def add(site):
    return added(*(site.c.closure(site.node.inputs[i], site.stack) for i in (0, 1)))


# ---- Principled BSDF -------------------------------------------------------------------------

def base_color(site):
    base = site.value("Base Color")
    below = site.socket("Subsurface Color")
    if below is None:
        return base
    return site.b.mix(site.b.clamp(site.value("Subsurface")), base, site.value("Subsurface Color"))


def sheen(site, normal):
    """Light along the edges, as Disney's diffuse sheen looks head-on."""
    b = site.b
    weight = site.value("Sheen Weight", "Sheen")
    if weight.is_all(0.0):
        return None
    site.note("its sheen is approximated")
    tint = site.value("Sheen Tint", default=1.0)
    if site.socket("Sheen Tint").type != "RGBA":  # until 4.0: how much of the base colour
        tint = b.mix(tint, 1.0, site.value("Base Color"))
    grazing = b.op("layer_weight", 0.5, normal, modes=("FACING",))
    return matte(site, b.multiply(b.math("POWER", grazing, 5.0), weight, tint))


def coat(site, closure):
    """The closure under its coat."""
    b = site.b
    weight = b.clamp(site.value("Coat Weight", "Clearcoat"))
    if weight.is_all(0.0):
        return closure
    modern = site.socket("Coat Weight") is not None
    normal = site.normal("Coat Normal" if modern else "Clearcoat Normal")
    roughness = b.clamp(site.value("Coat Roughness", "Clearcoat Roughness"))
    f0 = at_normal(b, site.value("Coat IOR", default=COAT_IOR))
    over, fresnel = layer(site, f0, normal, roughness)
    over.normal = normal
    under = closure
    if modern:
        through = b.multiply(weight, b.invert(fresnel))
        tint = b.mix(weight, 1.0, site.value("Coat Tint", default=1.0))
        under = closure.scaled(b.multiply(b.add(b.invert(weight), through), tint))
        return under.plus(over.scaled(weight))
    return under.plus(over.scaled(b.multiply(weight, OLD_COAT)))


def metal(site, base, weight, roughness, fresnel, f0):
    """Its base colour, white at grazing angles as a dielectric's reflection is."""
    b = site.b
    grazing = b.clamp(b.divide(b.subtract(fresnel, f0), b.invert(f0)))
    return reflecting(site, base, roughness, b.mix(grazing, base, 1.0)).scaled(weight)


def dielectric_f0(site):
    """Reflectance head-on of the dielectric part, one number."""
    b = site.b
    level = site.value("Specular IOR Level", "Specular", default=0.5)
    if not compat.specular_follows_ior(site.node):
        return b.multiply(level, 0.08)
    return b.clamp(b.multiply(at_normal(b, index(site)), level, 2.0))


def principled(site):
    b = site.b
    normal = site.normal()
    base = base_color(site)
    metallic_share = b.clamp(site.value("Metallic"))
    clear_share = b.multiply(b.clamp(site.value("Transmission Weight", "Transmission")),
                             b.invert(metallic_share))
    solid_share = b.multiply(b.invert(metallic_share), b.invert(clear_share))
    roughness = roughness_of(site)
    f0 = dielectric_f0(site)

    gloss, fresnel = layer(site, f0, normal, roughness)
    body = matte(site, base)
    if compat.specular_follows_ior(site.node):  # 4.0 on: what is reflected goes no further
        body = body.scaled(b.invert(gloss.reflection))
    closure = body.plus(gloss).scaled(solid_share)
    edges = sheen(site, normal)
    if edges:
        closure = closure.plus(edges.scaled(solid_share))
    closure = closure.plus(metal(site, base, metallic_share, roughness, fresnel, f0))
    tint = base
    if compat.specular_follows_ior(site.node):  # its colour shows twice, going in and out
        tint = b.vector_math("POWER", base, 0.5)
    closure = closure.plus(clear(site, b.constant(1.0), tint, index(site), normal).scaled(
        clear_share))
    closure.normal = normal
    closure = coat(site, closure)
    closure.emission = b.add(closure.emission, b.multiply(
        site.value("Emission Color", "Emission"), site.value("Emission Strength", default=1.0)))
    closure.alpha = b.clamp(site.value("Alpha", default=1.0))
    return closure


CLOSURES = {
    "BSDF_DIFFUSE": diffuse,
    "BSDF_TRANSLUCENT": translucent,
    "BSDF_GLOSSY": glossy,
    "BSDF_ANISOTROPIC": glossy,
    "BSDF_METALLIC": metallic,
    "BSDF_GLASS": glass,
    "BSDF_REFRACTION": refraction,
    "BSDF_TRANSPARENT": transparent,
    "BSDF_PRINCIPLED": principled,
    "EMISSION": emission,
    "HOLDOUT": holdout,
    "EEVEE_SPECULAR": eevee_specular,
    "MIX_SHADER": mix,
    "ADD_SHADER": add,
}
