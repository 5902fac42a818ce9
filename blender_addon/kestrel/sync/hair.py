# SPDX-License-Identifier: GPL-3.0-or-later
"""Hair: curves objects, and the strands of particle systems, as tubes in object space."""

from dataclasses import dataclass
from itertools import chain

import numpy as np

from .. import compat, tubes
from ..native import capi
from ..session import digest

RADIUS = 0.005  # metres, of curves without a radius of their own


@dataclass(frozen=True)
class Strands:
    points: np.ndarray      # float32 (N, 3), object space, one strand after the other
    radii: np.ndarray       # float32 (N,), metres
    counts: np.ndarray      # int (S,): points of each strand
    uvs: np.ndarray = None  # float32 (S, 2): where on the surface it grows; None: not known


# ---- reading ---------------------------------------------------------------------------------

def curves_strands(curves):
    """The Strands of evaluated curves data."""
    points = compat.curve_points(curves)
    radii = compat.curve_radii(curves)
    if radii is None:
        radii = np.full(len(points), RADIUS, np.float32)
    return Strands(points, radii, compat.curve_counts(curves), compat.curve_uvs(curves))


def strand_modifiers(obj, for_viewport):
    """The modifiers of an evaluated object whose particle systems' strands are drawn."""
    return [modifier for modifier in obj.modifiers
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


def _strand_uvs(obj, modifier, numbers):
    """float32 (S, 2): the emitter's UVs where these strands grow; None where it has none."""
    layers = getattr(obj.data, "uv_layers", ())
    index = next((i for i, layer in enumerate(layers) if layer.active_render), None)
    system = modifier.particle_system
    if index is None or not system.particles:
        return None
    read, particles = system.uv_on_emitter, system.particles
    last = len(particles) - 1  # children are told by their number alone
    places = (tuple(read(modifier, particle=particles[min(number, last)], particle_no=number,
                         uv_no=index)) for number in numbers)
    return np.fromiter(chain.from_iterable(places), np.float32).reshape(-1, 2)


def particle_strands(obj, modifier, for_viewport):
    """The Strands of a particle system."""
    system = modifier.particle_system
    settings = system.settings
    step = settings.display_step if for_viewport else settings.render_step
    count = 2 ** step + 1
    if settings.kink == "SPIRAL":
        count += settings.kink_extra_steps
    read, steps, numbers = system.co_hair, range(count), _strand_numbers(system, for_viewport)
    places = (read(obj, particle_no=number, step=step).to_tuple()
              for number in numbers for step in steps)
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
    return Strands(points.reshape(-1, 3), radii.reshape(-1), np.full(len(points), count),
                   _strand_uvs(obj, modifier, numbers))


# ---- sending ---------------------------------------------------------------------------------

def _send(export, key, name, strands, subdivisions):
    """Id of these strands' tubes, or 0 where there are none."""
    segments = len(strands.points) - len(strands.counts)
    if segments <= 0:
        return 0
    ident = export.new_id(capi.KIND_MESH, key)

    def send():
        sides, steps = tubes.fineness(segments, 2 ** subdivisions)
        made = tubes.tubes(
            *tubes.smooth(strands.points, strands.radii, strands.counts, steps), sides)
        uvs = None if strands.uvs is None else np.repeat(strands.uvs[made.curves], 3, axis=0)
        export.scene.set_mesh(ident, name, made.positions, made.triangles, made.normals, uvs)
    content = digest(strands.points, strands.radii, strands.counts, strands.uvs)
    export.put(capi.KIND_MESH, ident, (content, subdivisions), send)
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
    for modifier in strand_modifiers(obj, for_viewport):
        system = modifier.particle_system
        key = f"{owner}/hair/{system.name}"
        if key not in export.meshes:
            state = (_subdivisions(scene), for_viewport)
            ident = export.unchanged_mesh(key, owner, state)
            if ident is None:
                ident = _send(export, key, f"{obj.name_full}, {system.name}",
                              particle_strands(obj, modifier, for_viewport), state[0])
            export.meshes[key] = ident
            export.remember_mesh(key, ident, state)
        result.append((f"{obj.name_full}, {system.name}", export.meshes[key],
                       system.settings.material - 1))
    return result
