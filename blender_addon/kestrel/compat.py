# SPDX-License-Identifier: GPL-3.0-or-later
"""Every difference between the Blender versions that Kestrel supports: 3.4, 4.3 and 5.2.

Each function looks at what the object at hand offers instead of comparing version numbers.
"""

import ctypes

import numpy as np

INT, FLOAT = np.int32, np.float32


def datablock_key(datablock):
    """Text that names a datablock for as long as the file is open, across undo and copies."""
    uid = getattr(datablock, "session_uid", 0)
    kind = datablock.bl_rna.identifier
    if uid:
        return f"{kind}/{uid}"
    library = datablock.library
    return f"{kind}/{datablock.name_full}/{library.filepath if library else ''}"


# ---- meshes ----------------------------------------------------------------------------------

def _attribute(mesh, name, channel, width, count, dtype):
    """An attribute's values as (count, width), or None where the mesh has none of that name."""
    attribute = mesh.attributes.get(name)
    if attribute is None or len(attribute.data) != count:
        return None
    values = np.empty(count * width, dtype)
    attribute.data.foreach_get(channel, values)
    return values.reshape(count, width)


def vertex_positions(mesh):
    """float32 (V, 3), object space."""
    count = len(mesh.vertices)
    values = _attribute(mesh, "position", "vector", 3, count, FLOAT)
    if values is None:
        values = np.empty(3 * count, FLOAT)
        mesh.vertices.foreach_get("co", values)
    return values.reshape(count, 3)


def _stored_ints(collection, name, width=1):
    """int32 (N, width): a property of every item, read where Blender keeps the items in one block
    of equal records; None where that cannot be made sure of.

    Asking for a value item by item takes 50 ns each, this 1. The field is the one whose values are
    those that Blender gives for a sample of the items.
    """
    count = len(collection)
    if count < 64:
        return None
    first, second = (collection[i].as_pointer() for i in range(2))
    stride = second - first
    if not 4 * width <= stride <= 64 or stride % 4:
        return None
    places = np.linspace(0, count - 1, 32).astype(np.int64)
    sample = [collection[int(i)] for i in places]
    if any(item.as_pointer() != first + int(i) * stride for i, item in zip(places, sample)):
        return None
    block = (ctypes.c_int32 * (count * stride // 4)).from_address(first)
    records = np.frombuffer(block, INT).reshape(count, stride // 4)
    values = np.array([getattr(item, name) for item in sample], INT).reshape(-1, width)
    fields = [field for field in range(records.shape[1] - width + 1)
              if (records[places, field:field + width] == values).all()]
    if len(fields) != 1:
        return None
    return np.ascontiguousarray(records[:, fields[0]:fields[0] + width])


def _ints(collection, name, width=1):
    """int32 (N * width,): a property of every item."""
    values = _stored_ints(collection, name, width)
    if values is None:
        values = np.empty(len(collection) * width, INT)
        collection.foreach_get(name, values)
    return values.reshape(-1)


def corner_vertices(mesh):
    """int32 (C,): the vertex of each corner."""
    values = _attribute(mesh, ".corner_vert", "value", 1, len(mesh.loops), INT)
    return _ints(mesh.loops, "vertex_index") if values is None else values.reshape(-1)


def corner_totals(mesh):
    """int32 (P,): how many corners each polygon has."""
    return _ints(mesh.polygons, "loop_total")


def _vectors(items, channel="vector"):
    values = np.empty(3 * len(items), FLOAT)
    items.foreach_get(channel, values)
    return values.reshape(-1, 3)


def _unsplit_normals(mesh):
    """Corner normals until 4.0 where nothing splits them: those of the vertices, and on flat
    polygons the polygon's. None where every face is flat."""
    smooth = np.empty(len(mesh.polygons), bool)
    mesh.polygons.foreach_get("use_smooth", smooth)
    if not smooth.any():
        return None
    values = _vectors(mesh.vertex_normals)[corner_vertices(mesh)]
    if not smooth.all():
        totals = corner_totals(mesh)
        flat = ~np.repeat(smooth, totals)
        values[flat] = np.repeat(_vectors(mesh.polygon_normals), totals, axis=0)[flat]
    return values


def corner_normals(mesh):
    """float32 (C, 3), object space; None where every face is flat."""
    if hasattr(mesh, "corner_normals"):  # 4.1 on
        return None if mesh.normals_domain == "FACE" else _vectors(mesh.corner_normals)
    if not mesh.use_auto_smooth:  # then Blender ignores custom normals
        return _unsplit_normals(mesh)
    values = _vectors(mesh.loops, "normal")  # zeros unless the evaluation has worked them out
    if not values.any():
        mesh.calc_normals_split()
        values = _vectors(mesh.loops, "normal")
        mesh.free_normals_split()
    return values


def corner_uvs(layer):
    """float32 (C, 2) of a UV layer."""
    values = np.empty(2 * len(layer.data), FLOAT)
    if hasattr(layer, "uv"):  # 3.5 on
        layer.uv.foreach_get("vector", values)
    else:
        layer.data.foreach_get("uv", values)
    return values.reshape(-1, 2)


def curve_points(curves):
    """float32 (N, 3): the points of all curves, one curve after the other, object space."""
    values = np.empty(3 * len(curves.points), FLOAT)
    curves.points.foreach_get("position", values)
    return values.reshape(-1, 3)


def curve_counts(curves):
    """int32 (C,): how many points each curve has."""
    return _ints(curves.curves, "points_length")


def curve_uvs(curves):
    """float32 (C, 2): where on its surface each curve is rooted, or None where that is not known."""
    return _attribute(curves, "surface_uv_coordinate", "vector", 2, len(curves.curves), FLOAT)


def curve_radii(curves):
    """float32 (N,): the radius at each point, metres; None where there is no such attribute."""
    values = _attribute(curves, "radius", "value", 1, len(curves.points), FLOAT)
    return None if values is None else values.reshape(-1)


# The channel in which an attribute of a type has its values, and how many there are.
_CHANNELS = {
    "FLOAT": ("value", 1), "INT": ("value", 1), "BOOLEAN": ("value", 1), "INT8": ("value", 1),
    "FLOAT2": ("vector", 2), "FLOAT_VECTOR": ("vector", 3),
    "FLOAT_COLOR": ("color", 4), "BYTE_COLOR": ("color", 4),  # bytes too come as linear floats
}


def attribute_values(attribute):
    """float32 (N, 1...4) of an attribute, colours linear; None where its type has no numbers."""
    if attribute.data_type not in _CHANNELS:
        return None
    channel, width = _CHANNELS[attribute.data_type]
    values = np.empty(len(attribute.data) * width, FLOAT)
    if attribute.data_type == "BOOLEAN":
        flags = np.empty(len(values), bool)
        attribute.data.foreach_get(channel, flags)
        values[:] = flags
    else:
        attribute.data.foreach_get(channel, values)
    return values.reshape(-1, width)


def render_color(mesh):
    """The colour attribute that rendering uses, or None."""
    index = mesh.color_attributes.render_color_index
    return mesh.color_attributes[index] if 0 <= index < len(mesh.color_attributes) else None


def polygon_materials(mesh):
    """int32 (P,): the material slot of each polygon; None where all use the first."""
    values = _attribute(mesh, "material_index", "value", 1, len(mesh.polygons), INT)
    return None if values is None else values.reshape(-1)


def triangle_corners(mesh):
    """int32 (3T,): the corners of each loop triangle."""
    return _ints(mesh.loop_triangles, "loops", 3)


def triangle_polygons(mesh):
    """int32 (T,): the polygon that each loop triangle comes from."""
    if not hasattr(mesh, "loop_triangle_polygons"):  # until 3.5
        return _ints(mesh.loop_triangles, "polygon_index")
    values = np.empty(len(mesh.loop_triangles), INT)
    mesh.loop_triangle_polygons.foreach_get("value", values)
    return values


# ---- render results --------------------------------------------------------------------------

# What passes are called from 5.0 on, by their names before.
NEW_PASS_NAMES = {"DiffCol": "Diffuse Color", "Emit": "Emission", "IndexMA": "Material Index",
                  "IndexOB": "Object Index"}


def pass_name(scene, name):
    """The name in this Blender of a pass that was called so before 5.0."""
    return name if hasattr(scene, "node_tree") else NEW_PASS_NAMES.get(name, name)


def write_passes(layer, pixels_of):
    """Fill a result layer. `pixels_of(pass)` gives its float32 pixels, channels interleaved."""
    passes = list(layer.passes)
    pixels = [np.ascontiguousarray(pixels_of(item), FLOAT).reshape(-1) for item in passes]
    try:
        for item, values in zip(passes, pixels):
            item.rect.foreach_set(values)  # 4.1 on
    except (AttributeError, TypeError, RuntimeError):
        # One call for all passes of the layer, in its order: assigning one by one takes seconds.
        whole = pixels[0] if len(pixels) == 1 else np.concatenate(pixels)
        layer.passes.foreach_set("rect", whole)


class CombinedWriter:
    """Writes a result layer's Combined pass again and again, and no other."""

    def __init__(self, layer, pixel_count):
        self._layer = layer
        sizes = [pixel_count * item.channels for item in layer.passes]
        index = next(i for i, item in enumerate(layer.passes) if item.name == "Combined")
        first = sum(sizes[:index])
        # All passes of the layer, in its order: what can be written in every version.
        self._whole = np.zeros(sum(sizes), FLOAT)
        self._index = index
        self.pixels = self._whole[first:first + sizes[index]].reshape(-1, 4)  # to be filled

    def write(self):
        try:
            self._layer.passes[self._index].rect.foreach_set(self.pixels.reshape(-1))  # 4.1 on
        except (AttributeError, TypeError, RuntimeError):
            self._layer.passes.foreach_set("rect", self._whole)


# ---- cameras ---------------------------------------------------------------------------------

def motion_blur_position(scene):
    """Where in the time that the shutter is open the frame lies: START, CENTER or END."""
    owner = scene.render  # 4.2 on
    if not hasattr(owner, "motion_blur_position"):
        owner = getattr(scene, "cycles", None)
    return getattr(owner, "motion_blur_position", "CENTER")


# ---- materials, lights -----------------------------------------------------------------------

def node_input(node, *names):
    """The first of these sockets that this version's node has; None where it has none."""
    for name in names:
        if name in node.inputs:
            return node.inputs[name]
    return None


def specular_follows_ior(node):
    """Whether a Principled BSDF's dielectric part has the index of refraction (4.0 on), adjusted by
    its Specular; before, Specular alone counted."""
    return "Specular IOR Level" in node.inputs


def specular_f0(node, specular, ior):
    """Reflectance at normal incidence of a Principled BSDF's dielectric part."""
    if specular_follows_ior(node):  # 0.5 leaves what the index gives
        return ((ior - 1.0) / (ior + 1.0)) ** 2 * 2.0 * specular
    return 0.08 * specular


def uses_nodes(datablock):
    """Whether a material, light or world is described by its node tree."""
    return datablock.node_tree is not None and getattr(datablock, "use_nodes", True)


def chooses_nodes(datablock):
    """Whether this version leaves it to the artist if a node tree is used."""
    prop = datablock.bl_rna.properties.get("use_nodes")
    return prop is not None and not getattr(prop, "is_deprecated", False)


def alpha_cutoff(material):
    """Alpha below which a masked surface is absent."""
    if clips_alpha(material):
        return material.alpha_threshold
    return 0.5


def clips_alpha(material):
    """Whether the artist chose holes with hard edges over see-through alpha."""
    return getattr(material, "blend_method", "") == "CLIP"


def blends_alpha(material):
    """Whether the artist chose see-through alpha over holes with hard edges."""
    return getattr(material, "blend_method", "") == "BLEND"


def light_factor(light):
    """What newer versions multiply a light's colour and energy with."""
    factor = np.full(3, 2.0 ** getattr(light, "exposure", 0.0))
    if getattr(light, "use_temperature", False):
        factor = factor * np.array(light.temperature_color[:3])
    return factor


def spot_exponent(version):
    """Power of the cosine to a spot's axis with which its light falls off within the cone, in the
    Cycles of this Blender version."""
    return 1.0 if version < (4, 0, 0) else 0.0


def light_casts_shadow(light):
    """Both switches count where there are two: Blender's own and Cycles'."""
    cycles = getattr(light, "cycles", None)
    return (getattr(light, "use_shadow", True) and
            bool(getattr(cycles, "cast_shadow", True)))
