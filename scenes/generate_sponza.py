# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes sponza_spheres.kscene and sponza_armadillo.kscene, the paper's first two test scenes.

    python3 scenes/generate_sponza.py

Counts follow the paper's Table 4. Spheres: 29 objects (Sponza joined into 3, and 26 spheres), 3
reflective, 23 refractive, 262,087 + 17 * 400 + 9 * 360 = 272,127 triangles. Armadillo: 25 objects
(Sponza's 3, a pedestal, the statue, 20 spheres), 21 refractive, 292,544 triangles in all, for which
the statue is simplified to 23,245. The floor is at z = 4 m, the nave along X with its middle at
y = 0.75 m.
"""

import random

import kscene

FLOOR_Z = 4.0
NAVE_Y = 0.75
SPONZA = f"{kscene.DATA}/sponza/Sponza_plain.gltf"
CLOTH = ["Fabric*"]
DETAILS = ["Chain*", "Lion*", "Plants*", "Pole*", "PotPlant*", "Shield*", "Vase*"]

# x, offset from the nave's middle, height of the centre above the floor, radius; metres
MIRRORS = [(5.0, 1.55, 0.85, 0.85), (3.4, -1.45, 1.75, 0.65), (-5.5, 0.3, 1.3, 1.1)]
GLASSES = [
    (7.9, -0.95, 0.50, 0.50), (8.3, 0.85, 0.34, 0.34), (7.0, 0.05, 1.25, 0.32),
    (6.9, 2.05, 2.20, 0.34), (6.4, -2.05, 1.10, 0.36), (5.2, -0.55, 0.58, 0.58),
    (4.3, 0.55, 2.75, 0.45), (3.0, 0.60, 0.48, 0.48), (2.2, -2.0, 0.55, 0.55),
    (1.6, -0.65, 0.40, 0.40), (1.2, 1.85, 1.90, 0.60), (0.2, -0.60, 2.50, 0.60),
    (-0.9, -1.9, 0.80, 0.60), (-1.5, 1.60, 0.65, 0.65), (-2.4, 0.9, 3.60, 0.60),
    (-3.2, -1.7, 1.80, 0.60), (-4.3, 2.1, 2.00, 0.55), (-3.6, -0.3, 0.45, 0.45),
    (-6.6, -1.9, 3.10, 0.65), (-8.3, -1.4, 0.80, 0.80), (-9.5, 1.5, 3.40, 0.75),
    (-11.0, -0.2, 4.40, 0.80), (-12.0, 1.4, 0.90, 0.90),
]
TINTS = [(1, 1, 1), (1, 1, 1), (1, 0.72, 0.6), (0.65, 0.9, 1), (0.75, 1, 0.72), (1, 0.92, 0.6)]
STATUE_TINTS = [(1, 1, 1), (0.7, 0.92, 1), (1, 0.8, 0.62), (0.78, 1, 0.76)]
STATUE_X, PEDESTAL_HEIGHT = 5.2, 0.5
# The statue's file is Z up, 0.999 units high from -0.573, and becomes 2.6 m high.
STATUE_SCALE = 2.6 / 0.999259
STATUE_LOWEST = -0.572936
STATUE_TRIANGLES = 292_544 - 262_087 - 12 - 20 * 360


def hall():
    """Sponza as the three objects Cloth, Details and Hall."""
    return {"import": SPONZA, "join": True,
            "units": [{"unit": "Cloth", "match": CLOTH}, {"unit": "Details", "match": DETAILS},
                      {"unit": "Hall"}]}


def hall_lights():
    """Late morning sun through the open roof, a lamp under the gallery and two spots."""
    return [kscene.sun("Sun", (-0.32, 0.10, -1.0), 2.2, (1, 0.93, 0.82)),
            kscene.point("Lamp", (-4.0, NAVE_Y - 1.9, FLOOR_Z + 4.4), 10.0, (1, 0.72, 0.45)),
            kscene.spot("SpotWarm", (13.5, NAVE_Y + 2.4, FLOOR_Z + 4.6),
                        (5.0, NAVE_Y - 0.6, FLOOR_Z), 32.0, 50, color=(1, 0.85, 0.65)),
            kscene.spot("SpotCool", (4.0, NAVE_Y - 2.2, FLOOR_Z + 5.0),
                        (-4.0, NAVE_Y + 0.8, FLOOR_Z), 35.0, 40, color=(0.65, 0.8, 1))]


def place(x, y, z):
    """From the tables' frame, above the floor beside the nave's middle, to the world's."""
    return (x, NAVE_Y + y, FLOOR_Z + z)


def camera(fov_x, position, look_at, path):
    path = [kscene.key(time, place(*a), place(*b)) for time, a, b in path]
    return {"fov_x": fov_x, "position": place(*position), "look_at": place(*look_at), "near": 0.05,
            "far": 200, "path": path}


def common(view):
    return {"camera": view, "settings": {"ambient": (0.20, 0.21, 0.25)},
            "world": {"color": (0.46, 0.55, 0.72), "strength": 1.6}, "lights": hall_lights()}


def sphere_object(name, material, position, radius, mesh):
    return {"name": name, "mesh": mesh, "material": material, "position": position, "scale": radius,
            "relevance": kscene.EFFECT_RELEVANCE}


SPHERE_MESHES = [{"name": "coarse", "primitive": "sphere", "slices": 20, "stacks": 10},
                 {"name": "medium", "primitive": "sphere", "slices": 20, "stacks": 11}]


def spheres_scene():
    draw = random.Random(20)
    spheres = [(place(*s[:3]), s[3], i < len(MIRRORS)) for i, s in enumerate(MIRRORS + GLASSES)]
    medium = {s[0] for s in sorted(spheres, key=lambda s: -s[1])[:17]}
    materials, objects = [kscene.mirror("Mirror")], [hall()]
    for index, (position, radius, is_mirror) in enumerate(spheres):
        name = f"Mirror{index + 1}" if is_mirror else f"Glass{index - len(MIRRORS) + 1:02}"
        if not is_mirror:
            materials.append(kscene.glass(name, TINTS[index % len(TINTS)],
                                          round(draw.uniform(1.3, 1.6), 2)))
        objects.append(sphere_object(name, "Mirror" if is_mirror else name, position, radius,
                                     "medium" if position in medium else "coarse"))
    view = camera(62, (12.2, -0.6, 2.7), (0.0, 0.1, 1.7), [
        (0, (12.2, -0.6, 2.7), (0.0, 0.1, 1.7)),
        (5, (9.4, 0.2, 2.9), (2.0, 0.0, 1.6)),
        (10, (6.0, -0.6, 3.6), (-2.0, 0.3, 1.6)),
        (15, (1.8, 0.7, 4.3), (-6.0, 0.1, 1.7)),
        (20, (-2.6, -0.5, 4.4), (-9.5, 0.3, 1.8)),
    ])
    kscene.check_clearance(view["path"], [(*p, r) for p, r, _ in spheres], 0.25)
    return {"description": "The paper's first test scene: Sponza with 3 mirror and 23 glass spheres. "
                           "29 objects, 272,127 triangles. Sponza: see its SOURCE.txt in the scene "
                           "data.",
            **common(view), "materials": materials, "meshes": SPHERE_MESHES, "objects": objects}


def armadillo_scene():
    draw = random.Random(21)
    spheres = []
    for index in range(20):
        side = -1 if index % 2 else 1
        radius = draw.uniform(0.28, 0.62)
        x = 8.0 - 0.95 * index + draw.uniform(-0.25, 0.25)
        height = radius if index % 3 else draw.uniform(1.2, 2.8)
        spheres.append((place(x, side * draw.uniform(1.35, 2.1), height), radius))
    materials = [kscene.glass("Armadillo", (0.86, 0.96, 0.9), 1.5),
                 {"name": "Marble", "diffuse": (0.45, 0.44, 0.42)}]
    statue_z = PEDESTAL_HEIGHT - STATUE_SCALE * STATUE_LOWEST
    objects = [hall(),
               {"name": "Pedestal", "mesh": "cube", "material": "Marble",
                "position": place(STATUE_X, 0, PEDESTAL_HEIGHT / 2),
                "scale": (0.8, 0.8, PEDESTAL_HEIGHT / 2)},
               {"name": "Armadillo", "mesh": "armadillo", "material": "Armadillo",
                "position": place(STATUE_X, 0, statue_z), "rotation": (0, 0, 90),
                "scale": STATUE_SCALE, "relevance": kscene.EFFECT_RELEVANCE}]
    for index, (position, radius) in enumerate(spheres):
        name = f"Glass{index + 1:02}"
        materials.append(kscene.glass(name, STATUE_TINTS[index % len(STATUE_TINTS)],
                                      round(draw.uniform(1.3, 1.6), 2)))
        objects.append(sphere_object(name, name, position, radius, "coarse"))
    view = camera(59, (11.4, -0.9, 1.9), (2.0, 0.1, 1.75), [
        (0, (11.4, -0.9, 1.9), (2.0, 0.1, 1.75)),
        (4, (9.0, -0.6, 2.1), (4.6, 0.0, 1.8)),
        (8, (6.3, -2.6, 3.4), (4.6, 0.1, 1.7)),
        (12, (2.4, -0.9, 3.4), (5.0, 0.0, 1.6)),
        (16, (-1.2, 0.4, 3.0), (5.0, 0.0, 1.6)),
        (20, (-5.0, 0.0, 2.5), (5.0, 0.0, 1.6)),
    ])
    statue = (*place(STATUE_X, 0, PEDESTAL_HEIGHT + 1.3), 1.4)
    kscene.check_clearance(view["path"], [(*p, r) for p, r in spheres] + [statue], 0.25)
    meshes = [SPHERE_MESHES[0], {"name": "cube", "primitive": "cube"},
              {"name": "armadillo", "file": f"{kscene.DATA}/stanford/armadillo_292k_derived.ply",
               "normals": "smooth", "triangles": STATUE_TRIANGLES}]
    return {"description": "The paper's second test scene: Sponza with a glass armadillo and 20 glass "
                           "spheres. 25 objects, 292,544 triangles. Sponza, armadillo: see their "
                           "SOURCE.txt in the scene data.",
            **common(view), "materials": materials, "meshes": meshes, "objects": objects}


if __name__ == "__main__":
    kscene.write("sponza_spheres", spheres_scene())
    kscene.write("sponza_armadillo", armadillo_scene())
