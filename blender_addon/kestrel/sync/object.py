# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything that the depsgraph places in the world: objects, instances and lights.

Instances share their mesh. What one instancer places is one unit of the heuristic and carries the
instancer's name and settings.
"""

import struct

from .. import compat
from ..native import capi
from .hair import sync_curves, sync_strands
from .light import sync_light
from .material import sync_material
from .mesh import GEOMETRY, sync_mesh
from .settings import as_text, rows
from .visibility import visibility

# Drawn by other engines and not by Kestrel.
UNSUPPORTED = {"POINTCLOUD": "point clouds", "VOLUME": "volumes",
               "GPENCIL": "grease pencil strokes", "GREASEPENCIL": "grease pencil strokes"}


def columns(matrix):
    """12 floats: the images of X, Y and Z, and the translation."""
    x, y, z, place = matrix.col
    return (*x[:3], *y[:3], *z[:3], *place[:3])


def identity_of(obj):
    """(name, pass index, asset's name): what compositing tells an object and its hair by. The names
    are Cryptomatte's, without the library; the asset is the topmost parent, or the object."""
    top = obj
    while top.parent is not None:
        top = top.parent
    return obj.name, obj.pass_index, top.name


class Objects:
    """Sends the objects of one evaluation."""

    def __init__(self, export, depsgraph, shown=None):
        """`shown(object)` says whether an object, or what it places, is drawn; None: all are."""
        self.export = export
        self.scene = depsgraph.scene_eval
        self.for_viewport = depsgraph.mode == "VIEWPORT"
        self.view_layer = depsgraph.view_layer_eval
        self.override = self.view_layer.material_override
        self.shown = shown
        self.settings = rows("object")
        self.units = set()  # whose settings are set
        self.keys = {}      # original object: its key
        self.shapes = {}    # (object key, address of its data): what shape() says
        self.visibility = {}  # (original, original owner): what visibility() says

    def key_of(self, original):
        key = self.keys.get(original)
        if key is None:
            key = self.keys[original] = compat.datablock_key(original).encode("utf-8", "replace")
        return key

    def add(self, instance):
        # First of all what comes from the instance itself: when the first item of the iteration is
        # an instance, Blender has freed its memory by now, and what follows allocates.
        matrix = instance.matrix_world.copy()
        path = struct.pack("8i", *instance.persistent_id) if instance.is_instance else b""
        show_self, show_strands = instance.show_self, instance.show_particles
        obj = instance.object
        if not show_self and not (show_strands and obj.particle_systems):
            return
        original = obj.original
        key, owner = self.key_of(original), obj
        if path:
            owner = instance.parent
            key = b"%b/%b/%b" % (self.key_of(owner.original), key, path)
            if owner.original == original:  # a part of its geometry: the strands are not its own
                show_strands = False
        if self.shown and not self.shown(owner):
            return
        if obj.type == "LIGHT":
            sync_light(self.export, key, obj.data, matrix)
        elif obj.type in GEOMETRY or obj.type == "CURVES":
            for part, *shape in self.shape(obj, original, show_strands):
                if part or show_self:
                    self.add_geometry(owner, key + part, *shape, self.visibility_of(obj, owner),
                                      columns(matrix))
        elif obj.type in UNSUPPORTED:
            self.export.warn(f"Object '{obj.name}': {UNSUPPORTED[obj.type]} are not supported; it "
                             "is left out.")

    def add_geometry(self, owner, key, mesh, materials, identity, visible, matrix):
        unit = owner.name_full
        ident = self.export.new_id(capi.KIND_OBJECT, key)
        name, *rest = identity
        self.export.put_object(ident, (name, unit, mesh, materials, visible, *rest), matrix)
        if unit not in self.units:
            self.units.add(unit)
            self.unit_settings(ident, unit, owner)

    def shape(self, obj, original, with_strands):
        """((part, mesh id, material ids by slot, identity), ...) of an evaluated object: itself,
        whose part is empty, and the strands of its particle systems."""
        key = (self.key_of(original), obj.data.as_pointer(), with_strands)
        found = self.shapes.get(key)
        if found is None:
            slots = self.slots(obj)  # first: the library decodes their images meanwhile
            if obj.type == "CURVES":
                mesh = sync_curves(self.export, obj, self.scene)
            else:
                mesh = sync_mesh(self.export, obj)
            identity = identity_of(obj)
            parts = [(b"", mesh, slots, identity)]
            if with_strands and obj.particle_systems:
                for name, mesh, slot in sync_strands(self.export, obj, self.scene,
                                                     self.for_viewport):
                    parts.append((b"/hair/" + capi.encode(name), mesh,
                                  slots[min(slot, len(slots) - 1):][:1], identity))
            found = self.shapes[key] = tuple(part for part in parts if part[1])
        return found

    def visibility_of(self, obj, owner):
        key = (obj.original, owner.original)
        found = self.visibility.get(key)
        if found is None:
            found = self.visibility[key] = visibility(self.export, obj, owner, self.view_layer)
        return found

    def slots(self, obj):
        used = [self.override or slot.material for slot in obj.material_slots]
        if not used and self.override:
            used = [self.override]
        return tuple(sync_material(self.export, item) for item in used)

    def unit_settings(self, ident, unit, owner):
        """The owner's settings. Units that always had the defaults need no calls."""
        sent = self.export.session.sent_settings
        values = {row["name"]: getattr(owner.kestrel, row["name"]) for row in self.settings}
        if unit not in sent and all(values[row["name"]] == default_value(row)
                                    for row in self.settings):
            return
        sent.add(unit)
        self.export.note(("unit", unit), tuple(values.values()))
        for row in self.settings:
            self.export.scene.set_object_setting(ident, row["name"],
                                                 as_text(row, values[row["name"]]))


def default_value(row):
    """A row's default as the property holds it."""
    return float(row["default"]) if row["type"] == "float" else row["default"]


def sync_objects(export, depsgraph, shown=None):
    objects = Objects(export, depsgraph, shown)
    for instance in depsgraph.object_instances:
        objects.add(instance)
