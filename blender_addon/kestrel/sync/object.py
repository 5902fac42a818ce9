# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything that the depsgraph places in the world: objects, instances and lights.

Instances share their mesh. What one instancer places is one unit of the heuristic and carries the
instancer's name and settings.
"""

from .. import compat
from ..native import capi
from .light import sync_light
from .material import sync_material
from .mesh import GEOMETRY, sync_mesh
from .settings import as_text, rows

# Drawn by other engines and not by Kestrel.
UNSUPPORTED = {"CURVES": "hair curves", "POINTCLOUD": "point clouds", "VOLUME": "volumes",
               "GPENCIL": "grease pencil strokes", "GREASEPENCIL": "grease pencil strokes"}


def columns(matrix):
    """12 floats: the images of X, Y and Z, and the translation."""
    x, y, z, place = matrix.col
    return (*x[:3], *y[:3], *z[:3], *place[:3])


class Objects:
    """Sends the objects of one evaluation."""

    def __init__(self, export, override):
        """`override`: the view layer's material for everything, or None."""
        self.export = export
        self.override = override
        self.settings = rows("object")
        self.units = set()   # whose settings are set
        self.materials = {}  # object: ids by slot

    def instance_key(self, instance):
        if not instance.is_instance:
            return compat.datablock_key(instance.object.original)
        path = ".".join(map(str, instance.persistent_id))
        return (f"{compat.datablock_key(instance.parent.original)}/"
                f"{compat.datablock_key(instance.object.original)}/{path}")

    def slots(self, obj):
        """Material ids by slot."""
        key = (obj.original, obj.data.name_full)
        if key not in self.materials:
            used = [self.override or slot.material for slot in obj.material_slots]
            if not used and self.override:
                used = [self.override]
            self.materials[key] = tuple(sync_material(self.export, item) for item in used)
        return self.materials[key]

    def unit_settings(self, ident, unit, owner):
        """The owner's settings, once for each unit. Units that always had the defaults need no
        calls."""
        if unit in self.units:
            return
        self.units.add(unit)
        group = getattr(owner, "kestrel", None)
        sent = self.export.session.sent_settings
        values = {row["name"]: as_text(row, getattr(group, row["name"]))
                  for row in self.settings} if group else {}
        changed = {row["name"] for row in self.settings if group and
                   getattr(group, row["name"]) != default_value(row)}
        if changed or unit in sent:
            for name, value in values.items():
                self.export.scene.set_object_setting(ident, name, value)
            sent.add(unit)

    def add(self, instance):
        obj = instance.object
        if not instance.show_self:
            return
        if obj.type == "LIGHT":
            sync_light(self.export, self.instance_key(instance), obj.data, instance.matrix_world)
        elif obj.type in GEOMETRY:
            self.add_geometry(instance, obj)
        elif obj.type in UNSUPPORTED:
            self.export.warn(f"Object '{obj.name}': {UNSUPPORTED[obj.type]} are not supported; it "
                             "is left out.")

    def add_geometry(self, instance, obj):
        mesh = sync_mesh(self.export, obj)
        if not mesh:
            return
        owner = instance.parent if instance.is_instance else obj
        unit = owner.name_full
        ident = self.export.new_id(capi.KIND_OBJECT, self.instance_key(instance))
        description = (obj.name_full, unit, mesh, self.slots(obj))
        self.export.put_object(ident, description, columns(instance.matrix_world))
        self.unit_settings(ident, unit, owner)


def default_value(row):
    """A row's default as the property holds it."""
    return float(row["default"]) if row["type"] == "float" else row["default"]


def sync_objects(export, depsgraph):
    objects = Objects(export, depsgraph.view_layer_eval.material_override)
    for instance in depsgraph.object_instances:
        objects.add(instance)
