# SPDX-License-Identifier: GPL-3.0-or-later
"""The hall of the two Sponza scenes: the glTF Sponza joined into three objects, or a stand-in.

Both have the floor at z = 4 m, the nave along X from -20 to 17 m with its middle at y = 0.75 m, and
about 262,087 triangles in the three objects Hall, Cloth and Details. Needs
`sponza/Sponza_plain.gltf` of the scene data; without it the stand-in (a procedural colonnade) is
built and a line on stdout says so.
"""

import math

import bpy

import common
import shading

FLOOR_Z = 4.0
NAVE_Y = 0.75
CLOTH_MATERIALS = "Fabric"
DETAIL_MATERIALS = ("Chain", "Lion", "Plants", "Pole", "PotPlant", "Shield", "Vase")


def build_hall():
    """Build the three hall objects; True where they are the real Sponza."""
    path = common.find_data("sponza/Sponza_plain.gltf")
    if path is None:
        print("building the procedural stand-in for Sponza instead", flush=True)
        build_stand_in()
        return False
    import_gltf(path)
    return True


def import_gltf(path):
    import numpy
    if "bool" not in vars(numpy):
        numpy.bool = bool  # Blender 3.4's importer on a newer numpy
    bpy.ops.import_scene.gltf(filepath=str(path), import_pack_images=False)
    scene = bpy.context.scene
    bpy.data.batch_remove([obj for obj in scene.objects if obj.type != "MESH"])
    shading.make_all_matte()
    groups = {"Hall": [], "Cloth": [], "Details": []}
    for obj in scene.objects:
        material = obj.data.materials[0].name
        group = ("Cloth" if material.startswith(CLOTH_MATERIALS) else
                 "Details" if material.startswith(DETAIL_MATERIALS) else "Hall")
        groups[group].append(obj)
    for name, objects in groups.items():
        common.join(name, objects)


# ---- stand-in --------------------------------------------------------------------------------

def build_stand_in():
    """A colonnade of the same size, open to the sky over the nave: 261,808 triangles."""
    stone = shading.diffuse("Stone", (0.55, 0.48, 0.40))
    tiles = shading.diffuse("Tiles", image=checker_image())
    shell = [
        common.add_grid("Floor", lambda u, v: (-22 + 42 * u, -9 + 19.5 * v, FLOOR_Z),
                        128, 64, tiles, smooth=False),
        common.add_grid("WallLeft", lambda u, v: (-22 + 42 * u, 10, FLOOR_Z + 13 * v),
                        64, 32, stone, smooth=False),
        common.add_grid("WallRight", lambda u, v: (20 - 42 * u, -8.5, FLOOR_Z + 13 * v),
                        64, 32, stone, smooth=False),
        common.add_grid("WallEnd", lambda u, v: (-21, -9 + 19.5 * u, FLOOR_Z + 13 * v),
                        48, 16, stone, smooth=False),
        common.add_grid("WallFront", lambda u, v: (18, 10.5 - 19.5 * u, FLOOR_Z + 13 * v),
                        8, 8, stone, smooth=False),
    ]
    for y in (NAVE_Y - 3.9, NAVE_Y + 3.9):
        shell.append(common.add_box("Architrave", (-1, y, FLOOR_Z + 5.8), (42, 1.4, 0.6), stone))
    for side in (-1, 1):
        shell.append(common.add_box("Gallery", (-1, NAVE_Y + side * 6.6, FLOOR_Z + 6.3),
                                    (42, 6.6, 0.4), stone))
    columns = [column(x, y, stone) for y in (NAVE_Y - 3.9, NAVE_Y + 3.9)
               for x in range(-18, 18, 3)]
    common.join("Hall", shell)
    common.join("Details", columns)
    common.join("Cloth", [drape(index) for index in range(8)])


def checker_image():
    def texel(u, v):
        light = (int(u * 84) + int(v * 39)) % 2
        return (0.72, 0.66, 0.56, 1.0) if light else (0.45, 0.38, 0.33, 1.0)
    return shading.image_from_function("Tiles", 336, 156, texel)


def column(x, y, material):
    """Fluted column, 5.5 m high, 7,680 triangles."""
    def point(u, v):
        angle = 2 * math.pi * u
        swell = 0.42 + 0.20 * (max(0.0, abs(v - 0.5) * 2 - 0.85) / 0.15)
        radius = swell * (1.0 - 0.05 * math.cos(16 * angle) ** 2)
        return (x + radius * math.cos(angle), y + radius * math.sin(angle), FLOOR_Z + 5.5 * v)
    return common.add_grid("Column", point, 96, 40, material)


def drape(index):
    """Hanging cloth between two columns, 6,400 triangles."""
    color = ((0.55, 0.08, 0.06), (0.08, 0.30, 0.10), (0.07, 0.14, 0.45))[index % 3]
    side = -1 if index % 2 else 1
    x = -13.5 + 6 * (index // 2)

    def point(u, v):
        fold = 0.12 * math.sin(2 * math.pi * 7 * u + index) * (1.0 - 0.5 * v)
        return (x - 1.1 + 2.2 * u, NAVE_Y + side * 3.9 + fold, FLOOR_Z + 2.2 + 3.3 * v)
    return common.add_grid("Drape", point, 80, 40, shading.diffuse(f"Drape{index}", color))


# ---- light -----------------------------------------------------------------------------------

def add_hall_lights():
    """Late morning sun through the open roof, a lamp under the gallery and two spots."""
    # Faint, because ambient light reaches every corner in Kestrel: nothing occludes it.
    common.set_world((0.46, 0.55, 0.72), 0.3)
    common.add_sun("Sun", (-0.32, 0.10, -1.0), 6.0, (1.0, 0.93, 0.82))
    common.add_point("Lamp", (-4.0, NAVE_Y - 1.9, FLOOR_Z + 4.4), 1400.0, (1.0, 0.72, 0.45))
    common.add_spot("SpotWarm", (13.5, NAVE_Y + 2.4, FLOOR_Z + 4.6),
                    (5.0, NAVE_Y - 0.6, FLOOR_Z), 3200.0, 50.0, 0.15, (1.0, 0.85, 0.65))
    common.add_spot("SpotCool", (4.0, NAVE_Y - 2.2, FLOOR_Z + 5.0),
                    (-4.0, NAVE_Y + 0.8, FLOOR_Z), 2600.0, 40.0, 0.15, (0.65, 0.80, 1.0))
