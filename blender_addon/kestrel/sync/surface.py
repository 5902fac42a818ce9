# SPDX-License-Identifier: GPL-3.0-or-later
"""Plain materials as the paper's Table 1: one Surface each.

Plain is what a Surface says exactly by Table 1's means: constants, and images along one mapping of a
UV map. Every other material is a node program (shader_nodes/).

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
from . import nodes
from .nodes import BLACK, WHITE, Value
from .shader_nodes.shaders import MIRROR_ROUGHNESS

MAX_EXPONENT = 255.0  # Table 1
TEXTURED = ("emission", "ambient", "diffuse", "normal")
COLORED = ("emission", "ambient", "diffuse")


class NotPlain(Exception):
    """The material is more than a Surface can say; the argument is the nodes.Note that says where, or
    a text."""


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
    tangent_map: str = ""       # UV map along which the normal map lies; empty: the render map

    def textures(self):
        """All its nodes.Textures."""
        return [value.texture for value in map(self.__getattribute__, TEXTURED) if value.texture]

    def is_lit(self):
        """Whether its normal matters."""
        return (any(self.diffuse.color) or any(self.specular) or self.reflectivity > 0.0 or
                (self.opacity < 1.0 and not self.transparent))

    def normals(self):
        return self.normal, self.normal_strength, self.tangent_map

    def mapping(self):
        """(tiling, offset) that all its textures share."""
        mappings = {(texture.tiling, texture.offset) for texture in self.textures()}
        if len(mappings) > 1:
            raise NotPlain("its images are mapped in different ways")
        return mappings.pop() if mappings else ((1.0, 1.0), (0.0, 0.0))

    def wanted_attributes(self):
        """What it takes from the mesh by name: ("color" or "uv", name) pairs, a set."""
        wanted = {("uv", getattr(self, name).texture.uv_map)
                  for name in TEXTURED if getattr(self, name).texture}
        wanted |= {("color", getattr(self, name).attribute)
                   for name in COLORED if getattr(self, name).attribute is not None}
        if self.normal.texture:
            wanted.add(("uv", self.tangent_map))
        return wanted


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


def reflection(color, roughness, weight=1.0):
    """A metal or Glossy BSDF of this colour."""
    peak = max(color)
    if peak <= 0.0 or weight <= 0.0:
        return Surface()
    share = sharpness(roughness)
    rest = tuple(c * weight * (1.0 - share) for c in color)
    specular, exponent = highlight(rest, roughness)
    return Surface(ambient=Value(rest),
                   specular=specular, exponent=exponent,
                   reflectivity=min(peak * share * weight, 1.0),
                   reflection_color=tuple(c / peak for c in color))


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


def sum_values(a, b):
    total = nodes.sum_values(a, b)
    if total is None:
        raise NotPlain("two images are added")
    return total


def add(a, b):
    """a + b, property by property; tints, indices and exponents are means by their weight."""
    clear_a, clear_b = 1.0 - a.opacity, 1.0 - b.opacity
    mapped, other = (a, b) if a.normal.texture else (b, a)
    if mapped.normal.texture and other.is_lit() and other.normals() != mapped.normals():
        raise NotPlain("its parts have different normals")
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
        normal=mapped.normal, normal_strength=mapped.normal_strength,
        tangent_map=mapped.tangent_map)


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
    """Turns shader nodes into Surfaces. `environment_ior` is the surroundings' index. Raises NotPlain
    through the reader's report."""

    def __init__(self, reader, environment_ior):
        self.reader = reader
        self.environment_ior = environment_ior
        self._surfaces = {}  # by socket

    def surface(self, socket, stack=(), depth=0):
        key = nodes.socket_key(socket, stack)
        if key not in self._surfaces:
            self._surfaces[key] = self._read_surface(socket, stack, depth)
        return self._surfaces[key]

    def _read_surface(self, socket, stack, depth):
        node, _, above = self.reader.source(socket, stack)
        if node is None:
            return Surface()
        read = self.READERS.get(node.type)
        if read is None or depth > nodes.MAX_CHAIN:
            self.reader.unsupported(node, "it has no Surface")
        return read(self, node, above, depth)

    def _number(self, node, stack, *names, default=0.0):
        socket = compat.node_input(node, *names)
        return default if socket is None else self.reader.number(socket, stack)

    def _color(self, node, stack, *names):
        socket = compat.node_input(node, *names)
        return Value() if socket is None else self.reader.color(socket, stack)

    def _tint(self, value, node):
        """One colour for rays, which cannot be tinted point by point."""
        if value.varies:
            self.reader.unsupported(node, "one colour tints its rays")
        return value.color

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
        value = self.reader.color(above.inputs["Color"], above_stack)
        if value.texture is None:
            return surface
        return replace(surface, normal=value, tangent_map=above.uv_map,
                       normal_strength=self.reader.number(above.inputs["Strength"], above_stack))

    def _diffuse(self, node, stack, _depth):
        value = self._color(node, stack, "Color")
        return self._bump(Surface(ambient=value, diffuse=value), node, stack)

    def _glossy(self, node, stack, _depth):
        color = self._tint(self._color(node, stack, "Color", "Base Color"), node)
        return self._bump(reflection(color, self._roughness(node, stack)), node, stack)

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

    def _principled(self, node, stack, _depth):
        for names in (("Coat Weight", "Clearcoat"), ("Sheen Weight", "Sheen")):
            if self._number(node, stack, *names) > 0.0:
                self.reader.unsupported(node, f"it has no {names[0]}")
        if "Subsurface Color" in node.inputs and self._number(node, stack, "Subsurface") > 0.0:
            self.reader.unsupported(node, "it has no Subsurface Color")
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
        if metallic > 0.0:
            surface = add(surface, reflection(self._tint(base, node), roughness, metallic))
        if clear > 0.0:
            surface = add(surface, interface(self._tint(base, node), ior, clear))
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
        if node.type != "TEX_IMAGE" or node.image is None:
            self.reader.unsupported(node, "it cuts no holes")
        found = self.reader.texture(node, stack)
        from_alpha = output.name == "Alpha"
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
        hole, solid = (first, second) if first.transparent else (second, first)
        if solid.transparent or not hole.transparent or hole.transmission_color != WHITE:
            self.reader.unsupported(above, "the shaders are mixed by one factor")
        return self._masked(solid, above, output, above_stack, second.transparent)

    def _add(self, node, stack, depth):
        return add(*(self.surface(node.inputs[i], stack, depth + 1) for i in range(2)))

    READERS = {
        "BSDF_DIFFUSE": _diffuse,
        "BSDF_GLOSSY": _glossy,
        "BSDF_ANISOTROPIC": _glossy,
        "BSDF_GLASS": _glass,
        "BSDF_REFRACTION": _refraction,
        "BSDF_TRANSPARENT": _transparent,
        "BSDF_PRINCIPLED": _principled,
        "EMISSION": _emission,
        "MIX_SHADER": _mix,
        "ADD_SHADER": _add,
    }


def _refuse(note):
    raise NotPlain(note)


def read_surface(material, environment_ior):
    """The Surface of a Blender material; raises NotPlain where it would not be all of it."""
    if not compat.uses_nodes(material):
        value = Value(nodes.constant(material.diffuse_color))
        return add(Surface(ambient=value, diffuse=value),
                   reflection(value.color, material.roughness, material.metallic))
    output = nodes.output_node(material.node_tree, "OUTPUT_MATERIAL")
    if output is None:
        return Surface()
    for name in ("Displacement", "Volume"):
        if output.inputs[name].is_linked:
            raise NotPlain(f"it has a {name}")
    reader = nodes.Reader(f"Material '{material.name}'", _refuse)
    surface = Shaders(reader, environment_ior).surface(output.inputs["Surface"])
    surface.mapping()
    return surface
