# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything that the depsgraph places in the world: objects, instances and lights.

Instances share their mesh. What one instancer places is one unit of the heuristic and carries the
instancer's name and settings.
"""

from dataclasses import dataclass

import numpy as np
from mathutils import Matrix

from .. import compat
from ..native import capi
from ..object_table import ObjectTable, distinct, instance_ids
from ..session import stable_id
from .hair import sync_curves, sync_strands
from .light import sync_light
from .material import sync_material
from .mesh import GEOMETRY, sync_mesh
from .nodes import followed_objects
from .settings import as_text, rows
from .visibility import visibility

# Drawn by other engines and not by Kestrel.
UNSUPPORTED = {"POINTCLOUD": "point clouds", "VOLUME": "volumes",
               "GPENCIL": "grease pencil strokes", "GREASEPENCIL": "grease pencil strokes"}


def columns(matrix):
    """12 floats: the images of X, Y and Z, and the translation."""
    x, y, z, place = matrix.col
    return (*x[:3], *y[:3], *z[:3], *place[:3])


def object_key(original):
    """Bytes that name an object for as long as the file is open."""
    return compat.datablock_key(original).encode("utf-8", "replace")


def ranges(starts, counts):
    """The numbers from each start on, as many as it counts, one after the other: int64."""
    ends = np.cumsum(counts)
    return np.arange(counts.sum()) + np.repeat(starts - ends + counts, counts)


def identity_of(obj):
    """(name, pass index, asset's name): what compositing tells an object and its hair by. The names
    are Cryptomatte's, without the library; the asset is the topmost parent, or the object."""
    top = obj
    while top.parent is not None:
        top = top.parent
    return obj.name, obj.pass_index, top.name


def from_columns(place):
    """The matrix of columns()."""
    return Matrix(np.vstack([place.reshape(4, 3).T, (0.0, 0.0, 0.0, 1.0)]))


@dataclass
class Instances:
    """What each item of a depsgraph says by itself, in its order."""
    is_instance: np.ndarray   # bool (N,)
    show_self: np.ndarray     # bool (N,)
    show_strands: np.ndarray  # bool (N,)
    places: np.ndarray        # float32 (N, 12), as columns()
    paths: np.ndarray         # int32 (N, 8), persistent ids; of no meaning where it is no instance


def read_instances(depsgraph):
    # As arrays, and not because that is faster alone: an item that is looked at by itself may be
    # freed already when it is the last of its instancer.
    items = depsgraph.object_instances
    count = len(items)

    def read(name, dtype, width=1):
        values = np.empty(count * width, dtype)
        items.foreach_get(name, values)
        return values

    matrices = read("matrix_world", np.float32, 16).reshape(-1, 4, 4)
    # Blender hands matrices out column by column.
    return Instances(read("is_instance", bool), read("show_self", bool),
                     read("show_particles", bool),
                     np.ascontiguousarray(matrices[:, :, :3]).reshape(-1, 12),
                     read("persistent_id", np.int32, 8).reshape(-1, 8))


@dataclass
class Kind:
    """What items of a depsgraph have in common that show the same data of an object for the same
    owner: the instancer, or the object itself."""
    key: bytes           # of the object, and of its owner where that is another
    parts: tuple = ()    # ((key, description), ...): what the core gets for each of them
    light: object = None  # evaluated light instead


class Objects:
    """Sends the objects of one evaluation."""

    def __init__(self, export, depsgraph, shown=None):
        """`shown(object)` says whether an object, or what it places, is drawn; None: all are."""
        self.export = export
        self.depsgraph = depsgraph
        self.scene = depsgraph.scene_eval
        self.for_viewport = depsgraph.mode == "VIEWPORT"
        self.view_layer = depsgraph.view_layer_eval
        self.override = self.view_layer.material_override
        self.shown = shown
        self.settings = rows("object")
        self.keys = {}      # original object: its key
        self.shapes = {}    # (object key, its data, with strands): what shape() says
        self.visibility = {}  # (original, original owner): what visibility() says
        self.owners = {}    # unit: evaluated owner
        self.entangled = set()  # as ObjectTable has it
        self.followed = set()   # materials whose followed_objects() are among them

    def key_of(self, original):
        key = self.keys.get(original)
        if key is None:
            key = self.keys[original] = object_key(original)
        return key

    def send(self):
        instances = read_instances(self.depsgraph)
        kinds, numbers = self.kinds(instances)
        counts = np.bincount(numbers, minlength=len(kinds))
        # The items of kind k are order[starts[k]:starts[k] + counts[k]].
        order, starts = np.argsort(numbers, kind="stable"), np.cumsum(counts) - counts
        owners = np.array([number for number, kind in enumerate(kinds) for _ in kind.parts], int)
        parts = [part for kind in kinds for part in kind.parts]
        items = order[ranges(starts[owners], counts[owners])]
        table = ObjectTable(places=instances.places[items], entangled=self.entangled)
        table.numbers = np.repeat(np.arange(len(parts)), counts[owners])
        table.descriptions = {number: part[1] for number, part in enumerate(parts)}
        for kind, start, count in zip(kinds, starts, counts):
            if kind.light is not None:
                self.send_lights(kind, instances, order[start:start + count])
                table.rows[kind.key] = []
        seeds = np.array([stable_id(key) for key, _ in parts], np.uint64)[table.numbers]
        is_instance = instances.is_instance[items]
        table.ids = distinct(np.where(
            is_instance, instance_ids(seeds, instances.paths[items]), seeds))
        for row in np.flatnonzero(~is_instance).tolist():
            key = kinds[owners[table.numbers[row]]].key  # which is one object's
            table.rows.setdefault(key, []).append(row)
        self.export.put_objects(table)
        self.send_unit_settings(table)

    def send_lights(self, kind, instances, items):
        for item in items:
            path = instances.paths[item].tobytes() if instances.is_instance[item] else b""
            sync_light(self.export, kind.key + path, kind.light,
                       from_columns(instances.places[item]))

    def send_unit_settings(self, table):
        numbers, first = np.unique(table.numbers, return_index=True)
        done = set()
        for number, ident in zip(numbers.tolist(), table.ids[first].tolist()):
            unit = table.descriptions[number][1]
            if unit not in done:
                done.add(unit)
                self.unit_settings(ident, unit, self.owners[unit])

    def kinds(self, instances):
        """The Kinds of all items, and of each item the number of its kind, int64 (N,)."""
        kinds, numbers, found = [], [], {}
        flags = zip(*(values.tolist() for values in (
            instances.is_instance, instances.show_self, instances.show_strands)))
        for item, flag in zip(self.depsgraph.object_instances, flags):
            obj = item.object
            owner = item.parent if flag[0] else None
            key = obj.original, owner and owner.original, obj.data, flag
            number = found.get(key)
            if number is None:
                self.export.check()
                number = found[key] = len(kinds)
                kinds.append(self.kind(obj, owner or obj, *flag))
            numbers.append(number)
        return kinds, np.array(numbers, np.int64)

    def kind(self, obj, owner, is_instance, show_self, show_strands):
        original = obj.original
        own_key = key = self.key_of(original)
        if is_instance:
            owner_key = self.key_of(owner.original)
            self.entangled.update((key, owner_key))
            key = b"%b/%b/" % (owner_key, key)
            if owner.original == original:  # a part of its geometry: the strands are not its own
                show_strands = False
        if obj.particle_systems or obj.type == "META":
            self.entangled.add(own_key)
        kind = Kind(key)
        if not show_self and not (show_strands and obj.particle_systems):
            return kind
        if self.shown and not self.shown(owner):
            return kind
        if obj.type == "LIGHT":
            kind.light = obj.data
        elif obj.type in GEOMETRY or obj.type == "CURVES":
            self.owners.setdefault(owner.name_full, owner)
            visible = self.visibility_of(obj, owner)
            kind.parts = tuple(
                (key + part, (identity[0], owner.name_full, mesh, materials, visible,
                              *identity[1:]))
                for part, mesh, materials, identity in self.shape(obj, original, show_strands)
                if part or show_self)
        elif obj.type in UNSUPPORTED:
            self.export.warn(f"Object '{obj.name}': {UNSUPPORTED[obj.type]} are not supported; it "
                             "is left out.")
        return kind

    def shape(self, obj, original, with_strands):
        """((part, mesh id, material ids by slot, identity), ...) of an evaluated object: itself,
        whose part is empty, and the strands of its particle systems."""
        key = (self.key_of(original), obj.data, with_strands)
        found = self.shapes.get(key)
        if found is None:
            slots, wanted = self.slots(obj)  # first: the library decodes their images meanwhile
            if obj.type == "CURVES":
                mesh = sync_curves(self.export, obj, self.scene)
            else:
                mesh = sync_mesh(self.export, obj, wanted)
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
        """Material ids by slot, and what these materials want of the mesh."""
        used = [self.override or slot.material for slot in obj.material_slots]
        if not used and self.override:
            used = [self.override]
        for item in set(used).difference(self.followed, (None,)):
            self.followed.add(item)
            if compat.uses_nodes(item):
                self.entangled.update(self.key_of(followed.original)
                                      for followed in followed_objects(item.node_tree))
        sent = [sync_material(self.export, item) for item in used]
        return (tuple(ident for ident, _ in sent),
                tuple(sorted({name for _, wanted in sent for name in wanted})))

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
    Objects(export, depsgraph, shown).send()
