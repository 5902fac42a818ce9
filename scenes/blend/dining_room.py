# SPDX-License-Identifier: GPL-3.0-or-later
"""Dining Room: the paper's third test scene, from the Mitsuba scene of Bitterli's dining room.

    blender -b --factory-startup --python scenes/blend/dining_room.py -- --out FILE.blend

Counts follow the paper's Table 4: 27 objects (the OBJ parts of one chair, lamp, cup or saucer are
joined), none reflective, 1 refractive (the pitcher is glass), 139 k triangles: meshes of more than
1,000 triangles are collapsed by one common ratio. `--full` keeps all 269,538. Two light sources as
in the paper's figure 9: a hard sun through the blinds and a point light above the table. Plastics
and metals become matte, so that one object alone refracts. Needs the scene data's `dining_room`
folder (exits with status 2 without it). Writes FILE.blend.
"""

import math
import os
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import bpy
import common
import shading
from mathutils import Matrix

SCENE_FILE = "dining_room/scene.xml"
PAPER_TRIANGLES = 139_378
COLLAPSE_ABOVE = 1_000  # triangles
Z_UP_FROM_Y_UP = Matrix.Rotation(math.radians(90.0), 4, "X")
METAL_COLORS = {"Gold": (0.85, 0.58, 0.22), "Chrome": (0.55, 0.56, 0.58),
                "RoughMetal": (0.60, 0.60, 0.62)}
GLASS_PART = "Mesh003"

# The parts of the files (Mesh...) that make one object each.
OBJECT_PARTS = {
    "Chair1": (32, 35, 42), "Chair2": (10, 36, 27), "Chair3": (43, 44, 31),
    "Chair4": (22, 38, 30), "Chair5": (46, 47, 34), "Chair6": (49, 51, 40),
    "LampRight": (13, 15, 16), "LampLeft": (23, 17, 20),
    "Cup1": (26, 18), "Cup2": (37, 4), "Cup3": (2, 9),
    "Saucer1": (21, 5, 19), "Saucer2": (28, 14, 12), "Saucer3": (50, 29, 39),
    "Spoon1": (7,), "Spoon2": (25,), "Spoon3": (45,),
    "TableLegs": (11,), "TableTop": (33,), "TableFrame": (41,),
    "Teapot": (8,), "Pitcher": (3,), "Picture": (1,), "Floor": (6,), "Blinds": (24,),
    "Skirting": (0,),
}


def add_arguments(parser):
    parser.add_argument("--full", action="store_true", help="keep the files' 269,538 triangles")


# ---- Mitsuba XML -----------------------------------------------------------------------------

def parse_matrix(element):
    """World matrix of a <transform>, Z up; Mitsuba's own is Y up, row-major."""
    values = [float(word) for word in element.find("transform/matrix").get("value").split()]
    return Z_UP_FROM_Y_UP @ Matrix([values[row * 4:row * 4 + 4] for row in range(4)])


def named(element, tag, name):
    return next((child for child in element.iter(tag) if child.get("name") == name), None)


def parse_bsdf(element, folder):
    """Blender material of a <bsdf>: its diffuse colour or bitmap; metals get a fixed colour."""
    name = element.get("id")
    texture = element.find(".//texture/string[@name='filename']")
    image = None
    if texture is not None:
        image = bpy.data.images.load(str(folder / texture.get("value")), check_existing=True)
    color = METAL_COLORS.get(name, (0.5, 0.5, 0.5))
    for key in ("diffuseReflectance", "reflectance"):
        rgb = named(element, "rgb", key)
        if rgb is not None:
            color = tuple(0.85 * float(word) for word in rgb.get("value").split(","))
    return shading.principled(name, color, image=image)


def import_obj(path):
    """One mesh object from an OBJ file, coordinates as in the file."""
    before = set(bpy.data.objects)
    bpy.ops.wm.obj_import(filepath=str(path), forward_axis="Y", up_axis="Z")
    return next(obj for obj in bpy.data.objects if obj not in before)


def import_shape(shape, materials, folder):
    """Object of a <shape>: an OBJ file or Mitsuba's rectangle of -1..1."""
    file_name = shape.find("string[@name='filename']")
    if file_name is not None:
        obj = import_obj(folder / file_name.get("value"))
    else:
        obj = common.add_plane("Rectangle", (0.0, 0.0, 0.0), (2.0, 2.0), None)
    flat = named(shape, "boolean", "faceNormals") is not None or file_name is None
    obj.matrix_world = Matrix.Identity(4)
    obj.data.transform(parse_matrix(shape))
    obj.data.polygons.foreach_set("use_smooth", [not flat] * len(obj.data.polygons))
    obj.data.materials.clear()
    obj.data.materials.append(materials[shape.find("ref").get("id")])
    return "Rectangle" if file_name is None else Path(file_name.get("value")).stem, obj


def import_scene(path):
    """Everything but the camera and the environment; returns the XML root and objects by file."""
    root = ElementTree.parse(path).getroot()
    materials = {bsdf.get("id"): parse_bsdf(bsdf, path.parent) for bsdf in root.findall("bsdf")}
    return root, dict(import_shape(shape, materials, path.parent) for shape in root.iter("shape"))


def add_camera(root):
    """The XML's camera: Mitsuba looks along +Z with the horizontal field of view in degrees."""
    sensor = root.find("sensor")
    camera = common.add_camera((0.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    camera.data.angle = math.radians(float(named(sensor, "float", "fov").get("value")))
    camera.matrix_world = parse_matrix(sensor) @ Matrix.Rotation(math.pi, 4, "Y")


# ---- objects and light -----------------------------------------------------------------------

def join_parts(parts):
    """Join the file parts into the 27 objects; walls are what is left over."""
    for name, numbers in OBJECT_PARTS.items():
        common.join(name, [parts.pop(f"Mesh{number:03}") for number in numbers])
    common.join("Walls", list(parts.values()))


def collapse():
    meshes = [obj for obj in bpy.context.scene.objects if obj.type == "MESH"]
    large = [obj for obj in meshes if common.count_triangles(obj) > COLLAPSE_ABOVE]
    small = sum(common.count_triangles(obj) for obj in meshes if obj not in large)
    common.decimate(large, PAPER_TRIANGLES - small)


def main():
    args = common.parse_args(__doc__, add_arguments)
    path = common.require_data(SCENE_FILE)
    common.clear_scene()
    root, parts = import_scene(path)
    parts[GLASS_PART].data.materials[0] = shading.glass("PitcherGlass", (0.92, 0.97, 1.0), 1.5)
    join_parts(parts)
    if not args.full:
        collapse()
    common.set_world((0.75, 0.85, 1.0), 0.7)
    common.add_sun("Sun", (-1.0, 0.28, -0.52), 7.5, (1.0, 0.93, 0.82))
    common.add_point("TableLight", (-0.6, -2.2, 5.4), 1200.0, (1.0, 0.82, 0.62))
    add_camera(root)
    common.finish("dining_room", args)


main()
