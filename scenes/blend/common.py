# SPDX-License-Identifier: GPL-3.0-or-later
"""What the scene scripts of this folder share.

Runs inside Blender 3.4 or newer (background mode is enough). Lengths are Blender units (metres),
Z is up, colours are scene-linear RGB in 0..1. Light energies are Blender's: watts for point and
spot lights, watts per square metre for suns. Every light made here is hard (radius 0, sun angle 0).

Downloaded scene data is looked for in the folder named by the environment variable
KESTREL_SCENE_DATA, by default `../shared/scenes` beside the repository.
"""

import argparse
import math
import os
import sys
from pathlib import Path

import bmesh
import bpy
from mathutils import Matrix, Vector

REPOSITORY = Path(__file__).resolve().parents[2]
RENDER_SIZE_PX = (1280, 720)
EFFECT_RELEVANCE = 4.0  # the paper's K for reflective and refractive objects; plain objects keep 1


# ---- command line and scene data ------------------------------------------------------------

def parse_args(description, add_arguments=None):
    """Parse what stands after `--` on Blender's command line."""
    script = Path(sys.argv[sys.argv.index("--python") + 1]).name if "--python" in sys.argv else None
    parser = argparse.ArgumentParser(prog=script, description=description.split("\n")[0])
    parser.add_argument("--out", required=True, metavar="FILE.blend", help="the file to write")
    parser.add_argument("--pack", action="store_true", help="store the images inside the file")
    if add_arguments:
        add_arguments(parser)
    own = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    return parser.parse_args(own)


def data_folder():
    """Folder of the downloaded scene data; it may not exist."""
    default = REPOSITORY.parent / "shared" / "scenes"
    return Path(os.environ.get("KESTREL_SCENE_DATA", default)).resolve()


def find_data(relative):
    """Path of a data file, or None after saying on stdout that it is missing."""
    path = data_folder() / relative
    if path.exists():
        return path
    print(f"scene data missing: {relative} is not under {data_folder()} "
          "(set KESTREL_SCENE_DATA to the folder that has it)", flush=True)
    return None


def require_data(relative):
    """Path of a data file; leaves Blender with status 2 where it is missing."""
    path = find_data(relative)
    if path is None:
        sys.stdout.flush()
        os._exit(2)
    return path


# ---- scene -----------------------------------------------------------------------------------

def clear_scene():
    """Remove everything from the open file, keeping preferences and enabled add-ons."""
    for collection in (bpy.data.objects, bpy.data.meshes, bpy.data.lights, bpy.data.cameras,
                       bpy.data.materials, bpy.data.images, bpy.data.textures, bpy.data.worlds,
                       bpy.data.collections):
        bpy.data.batch_remove(list(collection))
    return bpy.context.scene


def link(obj, collection=None):
    """Link a new object into a collection (the scene's own one by default)."""
    (collection or bpy.context.scene.collection).objects.link(obj)
    return obj


def look_at(location, target):
    """World matrix of a camera or light at `location` whose -Z points at `target`."""
    direction = Vector(target) - Vector(location)
    return Matrix.Translation(location) @ direction.to_track_quat("-Z", "Y").to_matrix().to_4x4()


def add_camera(location, target, lens_mm=35.0):
    """Perspective camera with a 36 mm wide sensor; becomes the scene's camera."""
    data = bpy.data.cameras.new("Camera")
    data.lens = lens_mm
    data.clip_end = 1000.0
    camera = link(bpy.data.objects.new("Camera", data))
    camera.matrix_world = look_at(location, target)
    bpy.context.scene.camera = camera
    return camera


def add_sun(name, direction, energy, color=(1.0, 1.0, 1.0)):
    """Sun shining along `direction` (need not be normalised), energy in W/m2, angle 0."""
    data = bpy.data.lights.new(name, "SUN")
    data.energy, data.color, data.angle = energy, color, 0.0
    sun = link(bpy.data.objects.new(name, data))
    sun.matrix_world = look_at((0.0, 0.0, 0.0), direction)
    return sun


def add_point(name, location, energy, color=(1.0, 1.0, 1.0)):
    """Point light of radius 0, energy in W."""
    data = bpy.data.lights.new(name, "POINT")
    data.energy, data.color, data.shadow_soft_size = energy, color, 0.0
    point = link(bpy.data.objects.new(name, data))
    point.location = location
    return point


def add_spot(name, location, target, energy, angle_deg=45.0, blend=0.15, color=(1.0, 1.0, 1.0)):
    """Spot light of radius 0, energy in W, full cone angle in degrees, blend 0..1."""
    data = bpy.data.lights.new(name, "SPOT")
    data.energy, data.color, data.shadow_soft_size = energy, color, 0.0
    data.spot_size, data.spot_blend = math.radians(angle_deg), blend
    spot = link(bpy.data.objects.new(name, data))
    spot.matrix_world = look_at(location, target)
    return spot


def set_world(color, strength=1.0, image=None):
    """Constant world colour, or an equirectangular environment where an image is given."""
    world = bpy.data.worlds.new("World")
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    background = next(node for node in nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (*color, 1.0)
    background.inputs["Strength"].default_value = strength
    world.color = tuple(channel * strength for channel in color)
    if image:
        texture = nodes.new("ShaderNodeTexEnvironment")
        texture.image = image
        links.new(texture.outputs["Color"], background.inputs["Color"])
    bpy.context.scene.world = world
    return world


# ---- meshes ----------------------------------------------------------------------------------

def object_from_bmesh(name, bm, material, smooth):
    mesh = bpy.data.meshes.new(name)
    bm.to_mesh(mesh)
    bm.free()
    mesh.polygons.foreach_set("use_smooth", [smooth] * len(mesh.polygons))
    if material:
        mesh.materials.append(material)
    return link(bpy.data.objects.new(name, mesh))


def add_sphere(name, location, radius, material, segments=64, rings=32):
    """Smooth UV sphere of 2 * segments * (rings - 1) triangles, with UVs."""
    bm = bmesh.new()
    bm.loops.layers.uv.new("UVMap")
    bmesh.ops.create_uvsphere(bm, u_segments=segments, v_segments=rings, radius=radius,
                              calc_uvs=True)
    sphere = object_from_bmesh(name, bm, material, smooth=True)
    sphere.location = location
    return sphere


def add_box(name, location, size, material, rotation_z_deg=0.0):
    """Flat-shaded box with UVs; `size` is its full extent, 12 triangles."""
    bm = bmesh.new()
    bm.loops.layers.uv.new("UVMap")
    bmesh.ops.create_cube(bm, size=1.0, calc_uvs=True)
    bmesh.ops.scale(bm, vec=size, verts=bm.verts)
    box = object_from_bmesh(name, bm, material, smooth=False)
    box.location = location
    box.rotation_euler = (0.0, 0.0, math.radians(rotation_z_deg))
    return box


def add_plane(name, location, size, material):
    """Horizontal rectangle facing up, with UVs 0..1; `size` is (x, y)."""
    x, y = size[0] / 2, size[1] / 2
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(-x, -y, 0), (x, -y, 0), (x, y, 0), (-x, y, 0)], [], [(0, 1, 2, 3)])
    uv = mesh.uv_layers.new(name="UVMap")
    uv.data.foreach_set("uv", [0, 0, 1, 0, 1, 1, 0, 1])
    if material:
        mesh.materials.append(material)
    plane = link(bpy.data.objects.new(name, mesh))
    plane.location = location
    return plane


def add_grid(name, point, columns, rows, material, smooth=True):
    """Grid surface of 2 * columns * rows triangles; `point(u, v)` gives positions, u, v in 0..1."""
    vertices = [point(c / columns, r / rows) for r in range(rows + 1) for c in range(columns + 1)]
    stride = columns + 1
    faces = [(r * stride + c, r * stride + c + 1, (r + 1) * stride + c + 1, (r + 1) * stride + c)
             for r in range(rows) for c in range(columns)]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    uv = mesh.uv_layers.new(name="UVMap")
    uv.data.foreach_set("uv", [channel for face in faces for index in face
                               for channel in (index % stride / columns, index // stride / rows)])
    mesh.polygons.foreach_set("use_smooth", [smooth] * len(mesh.polygons))
    if material:
        mesh.materials.append(material)
    return link(bpy.data.objects.new(name, mesh))


def join(name, objects):
    """Join mesh objects into one (world transforms applied by Blender); returns it."""
    for obj in objects:
        if obj.data.users > 1:
            obj.data = obj.data.copy()
    bpy.ops.object.select_all(action="DESELECT")
    for obj in objects:
        obj.select_set(True)
    bpy.context.view_layer.objects.active = objects[0]
    if len(objects) > 1:
        bpy.ops.object.join()
    joined = bpy.context.view_layer.objects.active
    joined.name = joined.data.name = name
    bpy.ops.object.select_all(action="DESELECT")
    bpy.data.batch_remove([mesh for mesh in bpy.data.meshes if mesh.users == 0])
    return joined


def count_triangles(obj):
    return sum(len(polygon.vertices) - 2 for polygon in obj.data.polygons)


def decimate(objects, target):
    """Collapse the meshes by one common ratio until they have about `target` triangles together."""
    total = sum(count_triangles(obj) for obj in objects)
    if target >= total:
        return
    depsgraph = bpy.context.evaluated_depsgraph_get
    for obj in objects:
        modifier = obj.modifiers.new("Decimate", "DECIMATE")
        modifier.ratio = target / total
        modifier.use_collapse_triangulate = True
        reduced = bpy.data.meshes.new_from_object(obj.evaluated_get(depsgraph()))
        obj.modifiers.clear()
        old, obj.data = obj.data, reduced
        reduced.name = old.name
        if old.users == 0:
            bpy.data.meshes.remove(old)


# ---- finishing -------------------------------------------------------------------------------

EFFECT_NODES = {"BSDF_GLOSSY": "reflective", "BSDF_GLASS": "refractive",
                "BSDF_REFRACTION": "refractive"}


def effect_of(obj):
    """'reflective', 'refractive' or None, from the object's material nodes."""
    for slot in obj.material_slots:
        for node in slot.material.node_tree.nodes if slot.material else ():
            if node.type in EFFECT_NODES:
                return EFFECT_NODES[node.type]
            if node.type == "BSDF_PRINCIPLED" and node.inputs["Metallic"].default_value >= 0.5:
                return "reflective"
    return None


def set_relevance():
    """Give reflective and refractive objects a higher static relevancy where the add-on is on."""
    for obj in bpy.context.scene.objects:
        if obj.type == "MESH" and hasattr(obj, "kestrel") and effect_of(obj):
            obj.kestrel.relevance = EFFECT_RELEVANCE


def set_render_settings(size_px=RENDER_SIZE_PX):
    """Render size, plain sRGB view, the KESTREL engine if it is registered, comparable Cycles."""
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = size_px
    scene.render.resolution_percentage = 100
    scene.view_settings.view_transform = "Standard"
    scene.view_settings.look = "None"
    try:
        scene.render.engine = "KESTREL"
    except TypeError:
        scene.render.engine = "CYCLES"
    set_cycles(scene.cycles, samples=64)


def set_cycles(cycles, samples):
    """Cycles as the reference renderer: direct light, mirrors and glass 10 deep, nothing else."""
    cycles.device = "CPU"
    cycles.samples = samples
    cycles.seed = 1
    cycles.use_denoising = False
    cycles.use_adaptive_sampling = False
    cycles.pixel_filter_type = "BOX"
    cycles.max_bounces = cycles.glossy_bounces = cycles.transmission_bounces = 10
    cycles.diffuse_bounces = cycles.volume_bounces = 0
    cycles.transparent_max_bounces = 64
    cycles.caustics_reflective = cycles.caustics_refractive = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.blur_glossy = 0.0
    cycles.light_sampling_threshold = 0.0


def report(name):
    """Print the counts of the paper's Table 4 and the lights, one line each."""
    meshes = [obj for obj in bpy.context.scene.objects if obj.type == "MESH"]
    effects = [effect_of(obj) for obj in meshes]
    print(f"{name}: {len(meshes)} objects, {sum(map(count_triangles, meshes))} triangles, "
          f"{effects.count('reflective')} reflective, {effects.count('refractive')} refractive")
    for obj in bpy.context.scene.objects:
        if obj.type == "LIGHT":
            print(f"{name}: light {obj.name}: {obj.data.type} energy {obj.data.energy:g}")


def finish(name, args):
    """Set what every scene sets, print the counts and write the .blend file."""
    set_render_settings()
    set_relevance()
    report(name)
    out = Path(args.out).resolve()
    out.parent.mkdir(parents=True, exist_ok=True)
    for image in bpy.data.images:
        if image.source == "FILE" and not image.packed_file:
            image.filepath = bpy.path.abspath(image.filepath, library=image.library)
            if args.pack:
                image.pack()
    bpy.context.preferences.filepaths.save_version = 0
    bpy.ops.wm.save_as_mainfile(filepath=str(out), relative_remap=False, compress=True)
    print(f"{name}: wrote {out}", flush=True)
