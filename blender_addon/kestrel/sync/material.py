# SPDX-License-Identifier: GPL-3.0-or-later
"""Sends materials: plain ones as the paper's Table 1 (surface.py), all others as node programs
(shader_nodes/)."""

from .. import compat
from ..native import capi, loader
from .attributes import RENDER_COLOR, attribute_id
from .image import sync_texture
from .nodes import Note
from .program import TooComplex
from .shader_nodes import compile_material
from .surface import COLORED, TEXTURED, NotPlain, Surface, read_surface

# The library's textures, in their order.
SLOTS = ("emission", "ambient", "diffuse", "specular", "normal", "optical")


def _new_item(export, material):
    item = export.session.scene.library.default_material()
    item.name = capi.encode(material.name)  # as Cryptomatte has it, without the library
    item.pass_index = material.pass_index
    item.casts_shadow = getattr(getattr(material, "kestrel", None), "casts_shadow", True)
    return item


def describe(export, material, surface):
    """The capi.Material of a Surface; sends its textures."""
    item = _new_item(export, material)
    item.emission[:] = surface.emission.color
    item.ambient[:] = surface.ambient.color
    item.diffuse[:] = (*surface.diffuse.color, surface.alpha)
    item.specular[:] = (*surface.specular, (surface.exponent - 1.0) / 254.0)
    item.optical[:] = (surface.reflectivity, surface.ior, surface.opacity)
    item.reflection_color[:] = surface.reflection_color
    item.transmission_color[:] = surface.transmission_color
    for name in TEXTURED:
        value = getattr(surface, name)
        if value.texture:
            setattr(item, f"{name}_texture", sync_texture(export, value.texture))
            item.uv_maps[SLOTS.index(name)] = attribute_id(value.texture.uv_map)
    item.tangent_map = attribute_id(surface.tangent_map)
    for name in COLORED:
        attribute = getattr(surface, name).attribute
        if attribute is not None:
            setattr(item, f"{name}_attribute", attribute_id(attribute or RENDER_COLOR))
    item.normal_strength = surface.normal_strength
    item.tiling[:], item.offset[:] = surface.mapping()
    if surface.masked and not compat.blends_alpha(material):
        item.alpha_mode = capi.ALPHA_MASK
        item.alpha_cutoff = compat.alpha_cutoff(material)
    elif surface.masked or surface.alpha < 1.0:
        item.alpha_mode = capi.ALPHA_BLEND
    return item


def describe_program(export, material, program, tangent_map):
    """The capi.Material of a Program; sends its textures."""
    item = _new_item(export, material)
    item.tangent_map = attribute_id(tangent_map)
    textures = [sync_texture(export, texture) for texture in program.textures]
    attributes = [attribute_id(name or (RENDER_COLOR if kind == "color" else ""))
                  for kind, name in program.attributes]
    item.set_program(program, textures, attributes)
    if program.constant_output("alpha") != (1.0,) * 3:
        clips = compat.clips_alpha(material)
        item.alpha_mode = capi.ALPHA_MASK if clips else capi.ALPHA_BLEND
        item.alpha_cutoff = compat.alpha_cutoff(material)
    return item


def read_material(material, environment_ior, report):
    """A Surface, or (Program, UV map of its normal maps or None). `report` takes nodes.Notes of what
    is not done as Blender does it."""
    try:
        return read_surface(material, environment_ior)
    except (NotPlain, RecursionError):  # or a chain of nodes so long that it is not plain
        pass
    try:
        return compile_material(material, report, environment_ior, loader.node_table())
    except TooComplex as error:
        report(Note(f"Material '{material.name}'", "Material Output", str(error),
                    "it is drawn black"))
        return Surface()


def _sent(export, material):
    """(capi.Material, what it takes from meshes)."""
    read = read_material(material, export.environment_ior, export.warn)
    if isinstance(read, Surface):
        return describe(export, material, read), read.wanted_attributes()
    program, tangent_map = read
    item = describe_program(export, material, program, tangent_map)
    return item, {*program.attributes, ("uv", tangent_map or "")}


def sync_material(export, material):
    """(id, wanted attributes) of a material in the core; the id is 0, the default grey, for
    None. The attributes are sorted ("color" or "uv", name) pairs."""
    if material is None:
        return 0, ()
    key = compat.datablock_key(material)
    if key not in export.materials:
        item, wanted = _sent(export, material)
        ident = export.new_id(capi.KIND_MATERIAL, key)
        export.put(capi.KIND_MATERIAL, ident, capi.content(item),
                   lambda: export.scene.set_material(ident, item))
        export.materials[key] = ident, tuple(sorted(wanted - {("uv", "")}))
    return export.materials[key]
