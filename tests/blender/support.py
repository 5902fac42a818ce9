# SPDX-License-Identifier: GPL-3.0-or-later
"""What the add-on's tests share: small scenes and pictures as arrays.

Pictures are float32, height x width x channels, first row on top, scene-linear.
"""

import contextlib
import json
import math
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import bpy
import exr
import numpy as np
from kestrel import final_render, session
from mathutils import Matrix, Vector

ADDON = Path(__file__).resolve().parents[2] / "blender_addon"


class SceneTest(unittest.TestCase):
    """Starts each test with an empty scene for the engine KESTREL, one sample a pixel."""

    size = (32, 32)

    def setUp(self):
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
        self.scene = bpy.context.scene
        render = self.scene.render
        render.engine = "KESTREL"
        render.resolution_x, render.resolution_y = self.size
        render.resolution_percentage = 100
        self.scene.kestrel.samples = 1
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    # ---- scenes ----

    def link(self, name, data, matrix=Matrix()):
        obj = bpy.data.objects.new(name, data)
        self.scene.collection.objects.link(obj)
        obj.matrix_world = matrix
        return obj

    def camera(self, location=(0, 0, 5), target=(0, 0, 0), ortho_scale=None, **settings):
        data = bpy.data.cameras.new("Camera")
        if ortho_scale:
            data.type, data.ortho_scale = "ORTHO", ortho_scale
        for name, value in settings.items():
            setattr(data, name, value)
        self.scene.camera = self.link("Camera", data, look_at(location, target))
        return self.scene.camera

    def light(self, kind, energy, location=(0, 0, 2), target=(0, 0, 0), **settings):
        data = bpy.data.lights.new(kind.title(), kind)
        data.energy = energy
        if kind == "SUN":
            data.angle = 0.0
        elif kind != "AREA":
            data.shadow_soft_size = 0.0
        for name, value in settings.items():
            setattr(data, name, value)
        return self.link(data.name, data, look_at(location, target))

    def world(self, color, strength=1.0):
        world = bpy.data.worlds.new("World")
        world.use_nodes = True
        background = next(n for n in world.node_tree.nodes if n.type == "BACKGROUND")
        background.inputs["Color"].default_value = (*color, 1.0)
        background.inputs["Strength"].default_value = strength
        self.scene.world = world
        return world, background

    def plane(self, name="Plane", size=2.0, material=None, matrix=Matrix(), uv=True):
        h = size / 2
        return self.mesh(name, [(-h, -h, 0), (h, -h, 0), (h, h, 0), (-h, h, 0)], [(0, 1, 2, 3)],
                         material, matrix, [(0, 0), (1, 0), (1, 1), (0, 1)] if uv else None)

    def cube(self, name="Cube", size=1.0, material=None, matrix=Matrix()):
        h = size / 2
        corners = [(x, y, z) for x in (-h, h) for y in (-h, h) for z in (-h, h)]
        faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4),
                 (1, 5, 7, 3)]
        return self.mesh(name, corners, faces, material, matrix)

    def mesh(self, name, vertices, faces, material=None, matrix=Matrix(), uvs=None):
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata(vertices, [], faces)
        if uvs:
            layer = mesh.uv_layers.new(name="UVMap")
            layer.data.foreach_set("uv", [channel for uv in uvs for channel in uv])
        if material:
            mesh.materials.append(material)
        return self.link(name, mesh, matrix)

    def compositor(self):
        """An empty compositor: (tree, socket of the finished picture)."""
        if hasattr(self.scene, "node_tree"):
            self.scene.use_nodes = True
            tree = self.scene.node_tree
            tree.nodes.clear()
            return tree, tree.nodes.new("CompositorNodeComposite").inputs["Image"]
        tree = bpy.data.node_groups.new("Compositing", "CompositorNodeTree")  # 5.0 on
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        self.scene.compositing_node_group = tree
        return tree, tree.nodes.new("NodeGroupOutput").inputs[0]

    # ---- pictures ----

    def render(self, engine_id="KESTREL"):
        """RGBA of the picture through F12."""
        return rgba(self.render_planes(engine_id, "OPEN_EXR"))

    def render_planes(self, engine_id="KESTREL", file_format="OPEN_EXR_MULTILAYER"):
        render = self.scene.render
        render.engine = engine_id
        settings = render.image_settings
        if hasattr(settings, "media_type"):  # 5.0 on
            settings.media_type = ("MULTI_LAYER_IMAGE" if "MULTILAYER" in file_format else "IMAGE")
        if hasattr(settings, "use_exr_interleave"):
            settings.use_exr_interleave = True  # all layers in one part, as before 5.0
        settings.file_format, settings.color_mode = file_format, "RGBA"
        settings.color_depth, settings.exr_codec = "32", "ZIP"
        path = self.folder / f"{engine_id}.exr"
        render.filepath = str(path)
        with keep(render, "film_transparent"):
            bpy.ops.render.render(write_still=True)
        return read_planes(path)

    def render_cycles(self, samples=16):
        """The same by Cycles: direct light, mirrors and glass only."""
        cycles = self.scene.cycles
        cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = samples, False, False
        cycles.pixel_filter_type = "BOX"
        cycles.max_bounces = cycles.glossy_bounces = cycles.transmission_bounces = 8
        cycles.diffuse_bounces = 0
        return self.render("CYCLES")

    def stats(self):
        """Statistics of the last frame."""
        key = final_render.session_key(self.scene, self.scene.view_layers[0])
        return json.loads(session.acquire(key).renderer.stats())

    def assert_color(self, actual, expected, tolerance=1e-3):
        colors = np.asarray(actual)[..., :3]
        np.testing.assert_allclose(colors, np.broadcast_to(expected, colors.shape),
                                   rtol=tolerance, atol=tolerance)


@contextlib.contextmanager
def keep(owner, name):
    value = getattr(owner, name)
    yield
    setattr(owner, name, value)


def look_at(location, target):
    """World matrix of a camera or light at `location` whose -Z points at `target`."""
    direction = Vector(target) - Vector(location)
    if direction.length == 0:
        direction = Vector((0, 0, -1))
    return Matrix.Translation(location) @ direction.to_track_quat("-Z", "Y").to_matrix().to_4x4()


def turned(angle_deg, axis="X"):
    return Matrix.Rotation(math.radians(angle_deg), 4, axis)


def read_planes(path):
    """All channels of an EXR file by name."""
    data = Path(path).read_bytes()
    attributes, offset = exr.read_header(data)
    return exr.read_planes(data, offset, attributes)


def rgba(planes):
    return np.stack([planes[channel] for channel in "RGBA"], axis=-1)


# ---- materials -------------------------------------------------------------------------------

def new_material(name):
    """Material with an empty tree: (material, tree, output node)."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    return material, tree, tree.nodes.new("ShaderNodeOutputMaterial")


def shader_material(name, kind, **inputs):
    """Material of one shader node; keyword Base_Color sets the input 'Base Color'."""
    material, tree, output = new_material(name)
    node = tree.nodes.new(kind)
    for key, value in inputs.items():
        socket = node.inputs[key.replace("_", " ")]
        socket.default_value = (*value, 1.0) if isinstance(value, tuple) else value
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return material


def emission(name, color, strength=1.0):
    return shader_material(name, "ShaderNodeEmission", Color=color, Strength=strength)


def diffuse(name, color):
    return shader_material(name, "ShaderNodeBsdfDiffuse", Color=color)


def image(name, pixels, non_color=False, is_float=False):
    """Generated image from height x width x 4, first row at the bottom."""
    height, width, _ = pixels.shape
    made = bpy.data.images.new(name, width, height, alpha=True, float_buffer=is_float)
    if non_color:
        made.colorspace_settings.name = "Non-Color"
    made.pixels.foreach_set(np.ascontiguousarray(pixels, np.float32).ravel())
    made.update()
    return made


def textured(name, picture, kind="ShaderNodeEmission", **settings):
    """Material whose shader takes its colour from an image; returns (material, image node)."""
    material, tree, output = new_material(name)
    node = tree.nodes.new(kind)
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = picture
    for key, value in settings.items():
        setattr(texture, key, value)
    tree.links.new(texture.outputs["Color"], node.inputs[0])
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return material, texture


# ---- another Blender -------------------------------------------------------------------------

def run_blender(folder, *arguments, library=None):
    """A Blender with settings of its own in `folder`, and the installed add-on enabled; returns the
    finished process. `library` takes the place of the packaged one."""
    config = Path(folder) / "user_config"
    config.mkdir(exist_ok=True)
    environment = dict(os.environ, BLENDER_USER_CONFIG=str(config), PYTHONDONTWRITEBYTECODE="1")
    if library is not None:
        environment["KESTREL_LIBRARY"] = library
    blender = os.environ.get("KESTREL_TEST_BLENDER") or bpy.app.binary_path
    return subprocess.run([blender, "-b", "-noaudio", "--addons", "kestrel", *arguments],
                          env=environment, capture_output=True, text=True, check=False)
