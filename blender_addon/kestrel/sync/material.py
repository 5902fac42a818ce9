# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's shader nodes as the paper's Table 1: one Surface per material.

    Diffuse      diffuse = ambient = colour
    Glossy       reflectivity max(c) (1 - r)², tinted; the rest as a highlight and ambient;
                 below roughness 0.05 an exact mirror
    Glass        opacity 0, the index, reflectivity ((n - 1) / (n + 1))², tinted by the colour
    Transparent  opacity 0, the surroundings' index, tinted by the colour
    Emission     emission = colour * strength
    Principled   the above, weighted by Metallic and Transmission, and a dielectric highlight
    Mix, Add     property by property

The highlight of roughness r is Blinn-Phong with n = 2 / r⁴ - 2, the exponent of equal lobe width,
and F0 (n + 2) / 8, which at normal incidence is the microfacet peak F0 / (4 r⁴).
"""

from dataclasses import dataclass, field, replace

from .. import compat
from ..native import capi
from . import nodes
from .image import cached_mean, mean_color, sync_texture
from .nodes import BLACK, WHITE, Value, sum_values

MIRROR_ROUGHNESS = 0.05  # below, a reflection is taken for exact
MAX_EXPONENT = 255.0     # Table 1
SUBSTITUTES = ("TRANSLUCENT", "SUBSURFACE_SCATTERING", "BSDF_VELVET", "BSDF_SHEEN", "BSDF_TOON",
               "BSDF_HAIR", "BSDF_HAIR_PRINCIPLED", "EEVEE_SPECULAR")


@dataclass(frozen=True)
class Surface:
    emission: Value = Value()
    ambient: Value = Value()
    diffuse: Value = Value()
    specular: tuple = BLACK
    exponent: float = 1.0
    reflectivity: float = 0.0
    ior: float = 1.0
    opacity: float = 1.0
    reflection_color: tuple = WHITE
    transmission_color: tuple = WHITE
    alpha: float = 1.0
    masked: bool = False        # the diffuse texture's alpha counts: it cuts holes or blends
    transparent: bool = False   # only lets light through: a side of a mix that may become a mask
    normal: Value = field(default_factory=Value)
    normal_strength: float = 1.0


# ---- pieces ----------------------------------------------------------------------------------

def highlight(f0, roughness):
    """(specular colour, exponent) of a microfacet lobe; nothing for a mirror, whose reflections of
    point lights have no size."""
    if roughness < MIRROR_ROUGHNESS:
        return BLACK, 1.0
    exponent = min(max(2.0 / roughness ** 4 - 2.0, 1.0), MAX_EXPONENT)
    return tuple(f * (exponent + 2.0) / 8.0 for f in f0), exponent


def sharpness(roughness):
    """Share of a glossy reflection that is traced as a mirror's."""
    return 1.0 if roughness < MIRROR_ROUGHNESS else (1.0 - roughness) ** 2


def reflection(value, tint, roughness, weight=1.0):
    """A metal or Glossy BSDF of this colour. An image cannot tint reflections point by point: its
    mean colour, `tint`, does, and the image goes to the ambient part."""
    peak = max(tint)
    if peak <= 0.0 or weight <= 0.0:
        return Surface()
    share = sharpness(roughness)
    rest = value.scaled(weight * (1.0 - share))
    specular, exponent = highlight(tuple(c * weight * (1.0 - share) for c in tint), roughness)
    return Surface(ambient=rest, specular=specular, exponent=exponent,
                   reflectivity=min(peak * share * weight, 1.0),
                   reflection_color=tuple(c / peak for c in tint))


def interface(color, ior, weight=1.0):
    """Clear glass of this colour; `weight` of the surface is glass."""
    f0 = ((ior - 1.0) / (ior + 1.0)) ** 2
    return Surface(opacity=1.0 - weight, ior=ior, reflectivity=f0 * weight,
                   reflection_color=color, transmission_color=color)


def weighted(a, b, weight_a, weight_b):
    """Mean of two colours or numbers; the first where neither has any weight."""
    total = weight_a + weight_b
    if total <= 0.0:
        return a
    if isinstance(a, tuple):
        return tuple((x * weight_a + y * weight_b) / total for x, y in zip(a, b))
    return (a * weight_a + b * weight_b) / total


def add(a, b):
    """a + b, property by property; tints, indices and exponents are means by their weight."""
    clear_a, clear_b = 1.0 - a.opacity, 1.0 - b.opacity
    mapped = a if a.normal.texture else b
    return Surface(
        emission=sum_values(a.emission, b.emission),
        ambient=sum_values(a.ambient, b.ambient),
        diffuse=sum_values(a.diffuse, b.diffuse),
        specular=tuple(x + y for x, y in zip(a.specular, b.specular)),
        exponent=weighted(a.exponent, b.exponent, max(a.specular), max(b.specular)),
        reflectivity=min(a.reflectivity + b.reflectivity, 1.0),
        ior=weighted(a.ior, b.ior, clear_a, clear_b),
        opacity=max(1.0 - clear_a - clear_b, 0.0),
        reflection_color=weighted(a.reflection_color, b.reflection_color, a.reflectivity,
                                  b.reflectivity),
        transmission_color=weighted(a.transmission_color, b.transmission_color, clear_a, clear_b),
        masked=a.masked or b.masked,
        normal=mapped.normal, normal_strength=mapped.normal_strength)


def scaled(surface, factor):
    return replace(
        surface,
        emission=surface.emission.scaled(factor), ambient=surface.ambient.scaled(factor),
        diffuse=surface.diffuse.scaled(factor),
        specular=tuple(c * factor for c in surface.specular),
        reflectivity=surface.reflectivity * factor,
        opacity=1.0 - (1.0 - surface.opacity) * factor)


def mix(a, b, factor):
    """(1 - factor) a + factor b."""
    factor = min(max(factor, 0.0), 1.0)
    alpha = (1.0 - factor) * a.alpha + factor * b.alpha
    return replace(add(scaled(a, 1.0 - factor), scaled(b, factor)), alpha=alpha)


# ---- nodes -----------------------------------------------------------------------------------

class Shaders:
    """Turns shader nodes into Surfaces. `environment_ior` is the surroundings' index,
    `mean_of(texture)` the mean colour of what a texture shows."""

    def __init__(self, reader, environment_ior, mean_of):
        self.reader = reader
        self.environment_ior = environment_ior
        self.mean_of = mean_of

    def surface(self, socket, stack=(), depth=0):
        node, _, above = self.reader.source(socket, stack)
        if node is None or depth > nodes.MAX_CHAIN:
            return Surface()
        read = self.READERS.get(node.type)
        if read is not None:
            return read(self, node, above, depth)
        if node.type in SUBSTITUTES and compat.node_input(node, "Color", "Base Color"):
            self.reader.unsupported(node, "it is drawn as a Diffuse BSDF")
            value = self.reader.color(compat.node_input(node, "Color", "Base Color"), above)
            return Surface(ambient=value, diffuse=value)
        self.reader.unsupported(node, "it is drawn black")
        return Surface()

    def _number(self, node, stack, *names, default=0.0):
        socket = compat.node_input(node, *names)
        return default if socket is None else self.reader.number(socket, stack)

    def _color(self, node, stack, *names):
        socket = compat.node_input(node, *names)
        return Value() if socket is None else self.reader.color(socket, stack)

    def _tint(self, value, node):
        """One colour for rays, which cannot be tinted point by point."""
        if value.texture is None:
            return value.color
        self.reader.unsupported(
            node, f"the mean colour of '{value.texture.image.name}' tints its rays")
        return tuple(c * m for c, m in zip(value.color, self.mean_of(value.texture)))

    def _bump(self, surface, node, stack):
        """The surface with what is linked to the node's Normal."""
        socket = node.inputs.get("Normal")
        if socket is None:
            return surface
        above, _, above_stack = self.reader.source(socket, stack)
        if above is None:
            return surface
        if above.type != "NORMAL_MAP" or above.space != "TANGENT":
            self.reader.unsupported(above, "the surface keeps its own normals")
            return surface
        value = self.reader.color(above.inputs["Color"], above_stack)
        if value.texture is None:
            return surface
        return replace(surface, normal=value,
                       normal_strength=self.reader.number(above.inputs["Strength"], above_stack))

    def _diffuse(self, node, stack, _depth):
        value = self._color(node, stack, "Color")
        return self._bump(Surface(ambient=value, diffuse=value), node, stack)

    def _glossy(self, node, stack, _depth):
        value = self._color(node, stack, "Color", "Base Color")
        surface = reflection(value, self._tint(value, node), self._roughness(node, stack))
        return self._bump(surface, node, stack)

    def _roughness(self, node, stack):
        if getattr(node, "distribution", "") == "SHARP":
            return 0.0
        return self._number(node, stack, "Roughness")

    def _glass(self, node, stack, _depth):
        surface = interface(self._tint(self._color(node, stack, "Color"), node),
                            max(self._number(node, stack, "IOR", default=1.0), 0.1))
        return self._bump(surface, node, stack)

    def _refraction(self, node, stack, depth):
        return replace(self._glass(node, stack, depth), reflectivity=0.0)

    def _transparent(self, node, stack, _depth):
        return Surface(opacity=0.0, ior=self.environment_ior, transparent=True,
                       transmission_color=self._tint(self._color(node, stack, "Color"), node))

    def _emission(self, node, stack, _depth):
        strength = self._number(node, stack, "Strength", default=1.0)
        return Surface(emission=self._color(node, stack, "Color").scaled(max(strength, 0.0)))

    def _holdout(self, node, _stack, _depth):
        self.reader.unsupported(node, "it is drawn black")
        return Surface()

    def _principled(self, node, stack, _depth):
        base = self._color(node, stack, "Base Color")
        metallic = min(max(self._number(node, stack, "Metallic"), 0.0), 1.0)
        clear = self._number(node, stack, "Transmission Weight", "Transmission")
        clear = min(max(clear, 0.0), 1.0) * (1.0 - metallic)
        roughness = self._number(node, stack, "Roughness")
        ior = max(self._number(node, stack, "IOR", default=1.45), 0.1)
        level = self._number(node, stack, "Specular IOR Level", "Specular")
        f0 = compat.specular_f0(node, level, ior) * (1.0 - metallic) * (1.0 - clear)

        matte = base.scaled((1.0 - metallic) * (1.0 - clear))
        surface = Surface(ambient=matte, diffuse=matte)
        specular, exponent = highlight((f0,) * 3, roughness)
        surface = add(surface, Surface(specular=specular, exponent=exponent))
        tint = self._tint(base, node) if metallic > 0.0 or clear > 0.0 else base.color
        surface = add(surface, reflection(base, tint, roughness, metallic))
        if clear > 0.0:
            surface = add(surface, interface(tint, ior, clear))
        strength = max(self._number(node, stack, "Emission Strength", default=1.0), 0.0)
        if strength > 0.0:
            glow = self._color(node, stack, "Emission Color", "Emission").scaled(strength)
            surface = replace(surface, emission=glow)
        return self._principled_alpha(self._bump(surface, node, stack), node, stack)

    def _principled_alpha(self, surface, node, stack):
        socket = node.inputs["Alpha"]
        above, origin, above_stack = self.reader.source(socket, stack)
        if above is None or above.type == "VALUE":
            alpha = self.reader.number(socket, stack)
            return replace(surface, alpha=min(max(alpha, 0.0), 1.0))
        return self._masked(surface, above, origin, above_stack, inverted=False)

    def _masked(self, surface, node, output, stack, inverted):
        """The surface with holes where the image that this output brings is 0 (inverted: 1)."""
        found = self.reader.first_image(node, stack)
        if found is None:
            self.reader.unsupported(node, "the surface is opaque")
            return surface
        direct = node.type == "TEX_IMAGE"
        from_alpha = output.name == "Alpha" if direct else True
        if not direct:
            self.reader.unsupported(node, f"the alpha of '{found.image.name}' cuts the holes")
        mine = surface.diffuse.texture
        if mine and mine.image == found.image and from_alpha and not inverted:
            return replace(surface, masked=True)
        texture = replace(mine or replace(found, image=None),
                          mask=nodes.Mask(found.image, from_alpha, inverted))

        def with_mask(value):
            return replace(value, texture=texture) if value.texture == mine else value
        return replace(surface, masked=True, diffuse=replace(surface.diffuse, texture=texture),
                       ambient=with_mask(surface.ambient) if mine else surface.ambient)

    def _mix(self, node, stack, depth):
        first = self.surface(node.inputs[1], stack, depth + 1)
        second = self.surface(node.inputs[2], stack, depth + 1)
        above, output, above_stack = self.reader.source(node.inputs[0], stack)
        if above is None or above.type == "VALUE":
            return mix(first, second, self.reader.number(node.inputs[0], stack))
        if first.transparent != second.transparent:
            solid = second if first.transparent else first
            return self._masked(solid, above, output, above_stack, second.transparent)
        factor = self._mix_factor(above, above_stack)
        self.reader.unsupported(above, f"the shaders are mixed by {factor:.3g} everywhere")
        return mix(first, second, factor)

    def _mix_factor(self, node, stack):
        """Stand-in for a factor that varies: reflectance at normal incidence for the angle
        dependent nodes, else a half."""
        if node.type == "FRESNEL":
            ior = self._number(node, stack, "IOR", default=1.45)
            return ((ior - 1.0) / (ior + 1.0)) ** 2
        return 0.04 if node.type == "LAYER_WEIGHT" else 0.5

    def _add(self, node, stack, depth):
        return add(*(self.surface(node.inputs[i], stack, depth + 1) for i in range(2)))

    READERS = {
        "BSDF_DIFFUSE": _diffuse,
        "BSDF_GLOSSY": _glossy,
        "BSDF_ANISOTROPIC": _glossy,
        "BSDF_METALLIC": _glossy,
        "BSDF_GLASS": _glass,
        "BSDF_REFRACTION": _refraction,
        "BSDF_TRANSPARENT": _transparent,
        "BSDF_PRINCIPLED": _principled,
        "EMISSION": _emission,
        "HOLDOUT": _holdout,
        "MIX_SHADER": _mix,
        "ADD_SHADER": _add,
    }


def read_surface(material, environment_ior, warn, mean_of):
    """The Surface of a Blender material; the arguments are those of Shaders and Reader."""
    if not compat.uses_nodes(material):
        value = Value(nodes.constant(material.diffuse_color))
        return add(Surface(ambient=value, diffuse=value),
                   reflection(value, value.color, material.roughness, material.metallic))
    output = nodes.output_node(material.node_tree, "OUTPUT_MATERIAL")
    if output is None:
        return Surface()
    reader = nodes.Reader(f"Material '{material.name}'", warn)
    return Shaders(reader, environment_ior, mean_of).surface(output.inputs["Surface"])


# ---- sending ---------------------------------------------------------------------------------

def _one_mapping(surface, material, warn):
    """Tiling and offset that all textures share: those of the first one."""
    textures = [value.texture for value in (surface.diffuse, surface.emission, surface.ambient,
                                            surface.normal) if value.texture]
    mappings = {(texture.tiling, texture.offset) for texture in textures}
    if len(mappings) > 1:
        warn(f"Material '{material.name}': its images are mapped in different ways; all follow "
             "the first one.")
    return (textures[0].tiling, textures[0].offset) if textures else ((1.0, 1.0), (0.0, 0.0))


def describe(export, material, surface):
    """The capi.Material of a Surface; sends its textures."""
    item = export.session.scene.library.default_material()
    item.name = capi.encode(material.name)  # as Cryptomatte has it, without the library
    item.pass_index = material.pass_index
    item.emission[:] = surface.emission.color
    item.ambient[:] = surface.ambient.color
    item.diffuse[:] = (*surface.diffuse.color, surface.alpha)
    item.specular[:] = (*surface.specular, (surface.exponent - 1.0) / 254.0)
    item.optical[:] = (surface.reflectivity, surface.ior, surface.opacity)
    item.reflection_color[:] = surface.reflection_color
    item.transmission_color[:] = surface.transmission_color
    for name in ("emission", "ambient", "diffuse", "normal"):
        value = getattr(surface, name)
        if value.texture:
            setattr(item, f"{name}_texture", sync_texture(export, value.texture))
    item.normal_strength = surface.normal_strength
    item.tiling[:], item.offset[:] = _one_mapping(surface, material, export.warn)
    item.casts_shadow = getattr(getattr(material, "kestrel", None), "casts_shadow", True)
    if surface.masked and not compat.blends_alpha(material):
        item.alpha_mode = capi.ALPHA_MASK
        item.alpha_cutoff = compat.alpha_cutoff(material)
    elif surface.masked or surface.alpha < 1.0:
        item.alpha_mode = capi.ALPHA_BLEND
    return item


def sync_material(export, material):
    """Id of a material in the core; 0, the default grey, for None."""
    if material is None:
        return 0
    key = compat.datablock_key(material)
    if key not in export.materials:
        surface = read_surface(material, export.environment_ior, export.warn,
                               lambda texture: cached_mean(export, texture, mean_color))
        item = describe(export, material, surface)
        ident = export.new_id(capi.KIND_MATERIAL, key)
        export.put(capi.KIND_MATERIAL, ident, capi.content(item),
                   lambda: export.scene.set_material(ident, item))
        export.materials[key] = ident
    return export.materials[key]
