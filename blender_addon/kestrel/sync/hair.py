# SPDX-License-Identifier: GPL-3.0-or-later
"""Hair: curves objects, and the strands of particle systems, as tubes in object space."""

from itertools import chain

import numpy as np

from .. import compat, tubes
from ..native import capi
from ..session import digest

RADIUS = 0.005  # metres, of curves without a radius of their own


# ---- reading ---------------------------------------------------------------------------------

def curves_strands(curves):
    """(points, radii, counts) of evaluated curves data."""
    points = compat.curve_points(curves)
    radii = compat.curve_radii(curves)
    if radii is None:
        radii = np.full(len(points), RADIUS, np.float32)
    return points, radii, compat.curve_counts(curves)


def strand_systems(obj, for_viewport):
    """The particle systems of an evaluated object whose strands are drawn."""
    return [modifier.particle_system for modifier in obj.modifiers
            if modifier.type == "PARTICLE_SYSTEM"
            and (modifier.show_viewport if for_viewport else modifier.show_render)
            and modifier.particle_system.settings.type == "HAIR"
            and modifier.particle_system.settings.render_type == "PATH"]


def _strand_numbers(system, for_viewport):
    """Which of the system's particles, children counted after their parents, are drawn."""
    settings = system.settings
    parents, children = len(system.particles), len(system.child_particles)
    if for_viewport:
        children = children * settings.display_percentage // 100
    only_children = children and settings.child_type != "NONE" and (
        not settings.use_parent_particles)
    return range(parents if only_children else 0, parents + children)


def _profile(settings, along):
    """Radii in metres at shares `along` of a strand's length, 0 the root."""
    share = 1.0 - along
    shape = settings.shape
    if shape < 0.0:
        share = share ** (1.0 + shape)
    elif shape > 0.0:
        share = share ** (1.0 / (1.0 - shape)) if shape < 1.0 else (share >= 1.0) * 1.0
    half = 0.5 * settings.radius_scale  # the settings are diameters
    return half * (settings.tip_radius + share * (settings.root_radius - settings.tip_radius))


def particle_strands(obj, system, for_viewport):
    """(points, radii, counts) of a particle system, in the space of its evaluated object."""
    settings = system.settings
    step = settings.display_step if for_viewport else settings.render_step
    count = 2 ** step + 1
    if settings.kink == "SPIRAL":
        count += settings.kink_extra_steps
    read, steps = system.co_hair, range(count)
    places = (read(obj, particle_no=number, step=step).to_tuple()
              for number in _strand_numbers(system, for_viewport) for step in steps)
    points = np.fromiter(chain.from_iterable(places), np.float32).reshape(-1, count, 3)
    matrix = np.array(obj.matrix_world.inverted_safe(), np.float32)
    lengths = np.linalg.norm(np.diff(points, axis=1), axis=2)
    points = points @ matrix[:3, :3].T + matrix[:3, 3]
    reached = np.concatenate([np.zeros((len(points), 1), np.float32), lengths.cumsum(axis=1)], 1)
    total = reached[:, -1:]
    along = np.divide(reached, total, out=np.zeros_like(reached), where=total > 0.0)
    radii = _profile(settings, along).astype(np.float32)
    if settings.use_close_tip:
        radii[:, -1] = 0.0
    return points.reshape(-1, 3), radii.reshape(-1), np.full(len(points), count)


# ---- sending ---------------------------------------------------------------------------------

def _send(export, key, name, strands, subdivisions):
    """Id of these strands' tubes, or 0 where there are none."""
    points, radii, counts = strands
    segments = len(points) - len(counts)
    if segments <= 0:
        return 0
    ident = export.new_id(capi.KIND_MESH, key)

    def send():
        sides, steps = tubes.fineness(segments, 2 ** subdivisions)
        made = tubes.tubes(*tubes.smooth(points, radii, counts, steps), sides)
        export.scene.set_mesh(ident, name, made.positions, made.triangles, made.normals)
    export.put(capi.KIND_MESH, ident, (digest(points, radii, counts), subdivisions), send)
    return ident


def _subdivisions(scene):
    """How often each segment of a strand is halved: Cycles' setting where it is there."""
    cycles = getattr(scene, "cycles_curves", None)
    return getattr(cycles, "subdivisions", 2)


def sync_curves(export, obj, scene):
    """Id of a curves object's tubes in the core, or 0 where there are none."""
    original = obj.original
    key = compat.datablock_key(original)
    if original.type != "CURVES":  # geometry nodes make them beside a mesh
        key += "/curves"
    identity = (key, obj.data.as_pointer())
    if identity not in export.meshes:
        subdivisions = _subdivisions(scene)
        ident = export.unchanged_mesh(key, compat.datablock_key(original.data), subdivisions)
        if ident is None:
            ident = _send(export, key, obj.name_full, curves_strands(obj.data), subdivisions)
        export.meshes[identity] = ident
        export.remember_mesh(key, ident, subdivisions)
    return export.meshes[identity]


def sync_strands(export, obj, scene, for_viewport):
    """[(name, mesh id, material slot)] of the particle systems of an evaluated object."""
    owner = compat.datablock_key(obj.original)
    result = []
    for system in strand_systems(obj, for_viewport):
        key = f"{owner}/hair/{system.name}"
        if key not in export.meshes:
            state = (_subdivisions(scene), for_viewport)
            ident = export.unchanged_mesh(key, owner, state)
            if ident is None:
                ident = _send(export, key, f"{obj.name_full}, {system.name}",
                              particle_strands(obj, system, for_viewport), state[0])
            export.meshes[key] = ident
            export.remember_mesh(key, ident, state)
        result.append((f"{obj.name_full}, {system.name}", export.meshes[key],
                       system.settings.material - 1))
    return result
