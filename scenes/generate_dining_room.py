# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes dining_room.kscene, the paper's third test scene, from the Mitsuba scene of Bitterli's
dining room in the scene data.

    python3 scenes/generate_dining_room.py

Counts follow the paper's Table 4: 27 objects (the files of one chair, lamp, cup or saucer are one
unit), none reflective, 1 refractive (the pitcher), 139 k triangles: models of more than 1,000
triangles are simplified by one common ratio. Plastics and metals become matte with highlights, so
that one object alone refracts. Two light sources as in the paper's figure 9: a sun through the
blinds and a lamp above the table.
"""

import xml.etree.ElementTree as ElementTree

import kscene

PAPER_TRIANGLES = 139_378
SIMPLIFY_ABOVE = 1_000  # triangles
GLASS_PART = "Mesh003"

# The parts of the files (Mesh...) that make one unit each.
UNIT_PARTS = {
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
UNITS = {f"Mesh{number:03}": unit for unit, numbers in UNIT_PARTS.items() for number in numbers}

# Colour where the file has none, and the highlight's strength and exponent (0: 1, 1: 255).
METALS = {"Gold": (0.85, 0.58, 0.22), "Chrome": (0.45, 0.46, 0.48), "RoughMetal": (0.5, 0.5, 0.52)}
HIGHLIGHTS = {"Gold": (0.5, 0.2), "Chrome": (0.6, 0.3), "RoughMetal": (0.5, 0.2),
              "Ceramic": (0.25, 0.5), "PaintedCeramic": (0.25, 0.5), "WhitePlastic": (0.12, 0.15),
              "BlackPaint": (0.10, 0.1), "FrostedGlass": (0.15, 0.2)}


# ---- matrices: rows of 4x4 lists --------------------------------------------------------------

def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


IDENTITY = [[float(i == j) for j in range(4)] for i in range(4)]
Z_UP_FROM_Y_UP = [[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]
Y_UP_FROM_Z_UP = [[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]]
HALF_TURN_ABOUT_Y = [[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1]]


def twelve(m):
    """The images of X, Y and Z, then the translation."""
    return [float(m[row][column]) for column in range(4) for row in range(3)]


def world_matrix(element):
    """Matrix of a <transform>, rows; Mitsuba's world is Y up."""
    values = [float(word) for word in element.find("transform/matrix").get("value").split()]
    return [values[row * 4:row * 4 + 4] for row in range(4)]


# ---- elements --------------------------------------------------------------------------------

def named(element, tag, name):
    return next((child for child in element.iter(tag) if child.get("name") == name), None)


def material(bsdf, textures):
    """Table 1 material of a <bsdf>; its image is added to the textures."""
    name = bsdf.get("id")
    out = {"name": name, "diffuse": METALS.get(name, (0.5, 0.5, 0.5))}
    for key in ("diffuseReflectance", "reflectance"):
        rgb = named(bsdf, "rgb", key)
        if rgb is not None:
            out["diffuse"] = tuple(0.85 * float(word) for word in rgb.get("value").split(","))
    image = bsdf.find(".//texture/string[@name='filename']")
    if image is not None:
        textures.append({"name": name, "file": f"{kscene.DATA}/dining_room/{image.get('value')}"})
        out.update(diffuse=(1, 1, 1), diffuse_texture=name)
    if name in HIGHLIGHTS:
        strength, exponent = HIGHLIGHTS[name]
        out["specular"] = (strength, strength, strength, exponent)
    return out


def count_triangles(path):
    with open(path, encoding="utf-8") as lines:
        return sum(len(line.split()) - 3 for line in lines if line.startswith("f "))


def read_shapes(root, folder):
    """(mesh element, object element, triangles) of each <shape>."""
    for shape in root.iter("shape"):
        file_name = shape.find("string[@name='filename']")
        world = world_matrix(shape)
        if file_name is None:  # Mitsuba's rectangle is the plane primitive
            yield ({"name": "Rectangle", "primitive": "plane"},
                   {"name": "Walls", "mesh": "Rectangle", "material": shape.find("ref").get("id"),
                    "matrix": twelve(product(Z_UP_FROM_Y_UP, world))}, 2)
            continue
        stem = file_name.get("value").split("/")[-1].removesuffix(".obj")
        unit = UNITS.get(stem, "Walls")
        mesh = {"name": stem, "file": f"{kscene.DATA}/dining_room/{file_name.get('value')}",
                "up": "y"}
        if named(shape, "boolean", "faceNormals") is not None:
            mesh["normals"] = "flat"
        placed = {"name": unit, "mesh": stem,
                  "material": "Glass" if stem == GLASS_PART else shape.find("ref").get("id")}
        if world != IDENTITY:
            placed["matrix"] = twelve(product(product(Z_UP_FROM_Y_UP, world), Y_UP_FROM_Z_UP))
        if stem == GLASS_PART:
            placed["relevance"] = kscene.EFFECT_RELEVANCE
        yield mesh, placed, count_triangles(folder / file_name.get("value"))


def simplify(shapes):
    """Sets the numbers of triangles of the large models so that the whole has the paper's."""
    large = [count for _, _, count in shapes if count > SIMPLIFY_ABOVE]
    small = sum(count for _, _, count in shapes) - sum(large)
    ratio = (PAPER_TRIANGLES - small) / sum(large)
    for mesh, _, count in shapes:
        if count > SIMPLIFY_ABOVE:
            mesh["triangles"] = round(count * ratio)


def camera(root):
    """Mitsuba looks along +Z with X to the left, and has the horizontal field of view."""
    sensor = root.find("sensor")
    matrix = product(product(Z_UP_FROM_Y_UP, world_matrix(sensor)), HALF_TURN_ABOUT_Y)
    return {"fov_x": float(named(sensor, "float", "fov").get("value")), "matrix": twelve(matrix),
            "near": 0.05, "far": 100, "path": [
                kscene.key(0, (-0.587, -9.714, 2.762), (-0.72, 0.4, 2.1)),
                kscene.key(5, (-3.6, -7.6, 2.6), (-0.4, -0.6, 1.2)),
                kscene.key(10, (-1.6, -4.6, 2.2), (-0.3, -1.2, 0.9)),
                kscene.key(15, (2.4, -5.2, 1.9), (-0.6, -0.8, 0.9)),
                kscene.key(20, (1.0, -9.0, 2.9), (-0.6, 0.2, 1.8))]}


def main():
    path = kscene.data_file("dining_room/scene.xml")
    root = ElementTree.parse(path).getroot()
    textures = []
    materials = [material(bsdf, textures) for bsdf in root.findall("bsdf")]
    materials.append(kscene.glass("Glass", (0.92, 0.97, 1), 1.5))
    shapes = list(read_shapes(root, path.parent))
    simplify(shapes)
    kscene.write("dining_room", {
        "description": "The paper's third test scene, from Benedikt Bitterli's dining room (see its "
                       "LICENSE.txt in the scene data). 27 objects, 139 k triangles.",
        "camera": camera(root),
        "settings": {"ambient": (0.16, 0.17, 0.20)},
        "world": {"color": (0.75, 0.85, 1), "strength": 1.1},
        "lights": [kscene.sun("Sun", (-1.0, 0.28, -0.52), 2.6, (1, 0.93, 0.82)),
                   kscene.point("TableLight", (-0.6, -2.2, 5.4), 16.0, (1, 0.82, 0.62))],
        "textures": textures,
        "materials": materials,
        "meshes": [mesh for mesh, _, _ in shapes],
        "objects": [placed for _, placed, _ in shapes],
    })


if __name__ == "__main__":
    main()
