# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes backyard.kscene, the paper's fourth test scene: trees with alpha-masked leaves and detailed
shadows, from the plants of the scene data.

    python3 scenes/generate_backyard.py

Counts follow the paper's Table 4: 48 objects, 1 reflective, 2 refractive (the pool's water and a
glass ball), 1,128,786 triangles to within 5. Each kind of plant is joined into one object, the woods
around the yard into one for each kind of tree. Explicit seed.
"""

import math
import random

import kscene

SEED = 48
TRIANGLES = 1_128_786
TREE_KINDS = [f"tree-{kind:02}-{shape}" for kind in (1, 2, 3) for shape in (1, 2, 3, 4)]
WOODS_PER_KIND = 133
YARD = (14.0, 12.0)  # half its size along X and Y, metres; the hedges stand there
# x and y from … to; nothing grows there
HOUSE = (-3.0, 9.0, 3.6, 9.6)
TERRACE = (-3.6, 9.6, 0.6, 3.6)
POOL = (-8.9, -4.1, -3.2, 1.2)
BALLS = [(-2.2, -3.9, 0.95, 0.95), (-3.9, -5.9, 0.55, 0.55)]  # mirror, glass
FEATURE_TREES = [("tree-01-1", -5.6, 2.5, 30, 0.85), ("tree-02-2", -12.6, -13.2, 200, 0.85),
                 ("tree-03-1", 10.6, -0.8, 75, 0.9), ("tree-01-3", 7.6, -9.2, 310, 0.75)]


class Yard:
    """Random places that are free, and the number of triangles so far."""

    def __init__(self):
        self.draw = random.Random(SEED)
        self.triangles = 0
        self.sizes = {}

    def size_of(self, kind):
        """Triangles of a plant's file."""
        if kind not in self.sizes:
            with open(kscene.data_file(f"plants/{kind}.obj"), encoding="utf-8") as lines:
                self.sizes[kind] = sum(line.startswith("f ") for line in lines)
        return self.sizes[kind]

    def plants(self, name, kind, instances):
        """One object of many plants of a kind; instances are x, y, z, degrees, scale."""
        self.triangles += len(instances) * self.size_of(kind)
        out = {"name": name, "import": f"{kscene.DATA}/plants/{kind}.obj", "up": "y", "join": True}
        if kind.startswith("grass"):  # the images are of dry grass
            out["replace"] = [{"material": f"grass-0{i}-material", "with": f"Grass{i}"}
                              for i in (1, 2)]
        return {**out, "instances": instances}

    def instance(self, x, y, low, high, z=0.0):
        return (round(x, 3), round(y, 3), z, round(self.draw.uniform(0, 360), 1),
                round(self.draw.uniform(low, high), 3))

    def lawn_place(self, margin=0.0):
        while True:
            x = self.draw.uniform(-YARD[0] + 0.8, YARD[0] - 0.8)
            y = self.draw.uniform(-YARD[1] + 0.8, YARD[1] - 0.8)
            blocked = any(a - margin < x < b + margin and c - margin < y < d + margin
                          for a, b, c, d in (HOUSE, TERRACE, POOL))
            near_ball = any(math.hypot(x - bx, y - by) < radius * 0.7 + margin
                            for bx, by, _, radius in BALLS)
            if not blocked and not near_ball:
                return x, y

    def lawn(self, count, low, high, z=0.0):
        return [self.instance(*self.lawn_place(0.3), low, high, z) for _ in range(count)]

    def border(self, count, low, high):
        """Along the hedges and the house's front, where beds are."""
        out = []
        for _ in range(count):
            if self.draw.random() < 0.3:
                x = self.draw.choice((self.draw.uniform(-2.8, 1.0), self.draw.uniform(5.0, 8.8)))
                y = TERRACE[3] - 0.45
            elif self.draw.random() < 0.5:
                x = self.draw.uniform(-YARD[0] + 1, YARD[0] - 1)
                y = YARD[1] - self.draw.uniform(1.2, 2.2)
            else:
                x = self.draw.choice((-1, 1)) * (YARD[0] - self.draw.uniform(1.2, 2.2))
                y = self.draw.uniform(-YARD[1] + 4, YARD[1] - 1)
            out.append(self.instance(x, y, low, high))
        return out

    def woods(self, count):
        """A ring around the yard, thinner further out."""
        out = []
        while len(out) < count:
            angle = self.draw.uniform(0, 2 * math.pi)
            distance = 19.0 + 50.0 * self.draw.random() ** 1.3
            x, y = 1.15 * distance * math.cos(angle), distance * math.sin(angle)
            if abs(x) > YARD[0] + 3.5 or abs(y) > YARD[1] + 3.5:
                out.append(self.instance(x, y, 0.8, 1.35))
        return out


def hedge(yard, name, start, end, degrees):
    length = math.dist(start, end)
    count = round(length / 2.6)
    places = [(start[0] + (end[0] - start[0]) * (i + 0.5) / count,
               start[1] + (end[1] - start[1]) * (i + 0.5) / count) for i in range(count)]
    return yard.plants(name, "hedge-01", [
        (round(x, 3), round(y, 3), 0, degrees + (180 if yard.draw.random() < 0.5 else 0),
         round(yard.draw.uniform(0.95, 1.1), 3)) for x, y in places])


def vegetation(yard):
    """36 objects; the last kind of grass fills up to the paper's number of triangles."""
    objects = [yard.plants(f"Tree{i + 1}", kind, [(x, y, 0, turn, scale)])
               for i, (kind, x, y, turn, scale) in enumerate(FEATURE_TREES)]
    objects += [yard.plants(f"Woods {kind}", kind, yard.woods(WOODS_PER_KIND))
                for kind in TREE_KINDS]
    objects += [hedge(yard, "HedgeLeft", (-YARD[0], -YARD[1]), (-YARD[0], YARD[1]), 90),
                hedge(yard, "HedgeBack", (-YARD[0], YARD[1]), (YARD[0], YARD[1]), 0),
                hedge(yard, "HedgeRight", (YARD[0], YARD[1]), (YARD[0], -YARD[1]), 90)]
    for kind, count in (("bush-01", 45), ("bush-02", 45), ("bush-03", 50), ("bush-04", 50)):
        objects.append(yard.plants(f"Bushes {kind}", kind, yard.border(count, 0.8, 1.3)))
    objects.append(yard.plants("Bushes bush-05", "bush-05", yard.woods(60)))
    for kind, count in (("flowers-01", 160), ("flowers-02", 70), ("flowers-03", 160),
                        ("flowers-04", 70)):
        objects.append(yard.plants(f"Flowers {kind}", kind, yard.border(count, 0.7, 1.0)))
    for number in range(1, 6):
        objects.append(yard.plants(f"Clover {number}", f"clover-{number:02}",
                                   yard.lawn(260, 0.5, 0.9, 0.01)))
    for number in (1, 2):
        objects.append(yard.plants(f"Grass {number}", f"grass-{number:02}",
                                   yard.lawn(5200, 0.12, 0.26)))
    return objects


def fill_with_grass(yard):
    count = round((TRIANGLES - yard.triangles) / yard.size_of("grass-03"))
    if not 1000 <= count <= 20000:
        raise SystemExit(f"{count} tufts of grass would be needed; change the number of trees")
    return yard.plants("Grass 3", "grass-03", yard.lawn(count, 0.12, 0.26))


def box(x0, x1, y0, y1, z0, z1):
    """Matrix that makes the cube primitive this box."""
    return ((x1 - x0) / 2, 0, 0, 0, (y1 - y0) / 2, 0, 0, 0, (z1 - z0) / 2,
            (x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2)


def boxes(name, material, *matrices):
    return {"name": name, "mesh": "cube", "material": material, "instances": matrices}


def roof_mesh():
    """Gable roof along X with an overhang of half a metre, as a closed prism: 8 triangles."""
    x0, x1, y0, y1 = HOUSE[0] - 0.5, HOUSE[1] + 0.5, HOUSE[2] - 0.5, HOUSE[3] + 0.5
    ridge_y, eaves_z, ridge_z = (y0 + y1) / 2, 2.95, 5.2
    positions = [x for point in ((x0, y0, eaves_z), (x1, y0, eaves_z), (x1, y1, eaves_z),
                                 (x0, y1, eaves_z), (x0, ridge_y, ridge_z), (x1, ridge_y, ridge_z))
                 for x in point]
    return {"name": "roof", "positions": positions,
            "triangles": [0, 1, 5, 0, 5, 4, 2, 3, 4, 2, 4, 5, 3, 0, 4, 1, 2, 5, 0, 3, 2, 0, 2, 1],
            "uvs": [0, 0, 6, 0, 6, 2, 0, 0, 6, 2, 0, 2, 0, 0, 6, 0, 6, 2, 0, 0, 6, 2, 0, 2,
                    0, 0, 2, 0, 1, 1, 0, 0, 2, 0, 1, 1, 0, 0, 0, 2, 6, 2, 0, 0, 6, 2, 6, 0]}


def buildings(yard):
    """12 objects: house, terrace, pool, ground and the two balls."""
    front = HOUSE[2]
    windows = [(-2.2, -0.8), (0.0, 1.4), (6.6, 8.2)]
    frames = [box(a - 0.12, b + 0.12, front - 0.04, front, 0.88, 2.32) for a, b in windows]
    panes = [box(a, b, front - 0.06, front - 0.01, 1.0, 2.2) for a, b in windows]
    px0, px1, py0, py1 = POOL
    rim = [box(px0 - 0.3, px1 + 0.3, py0 - 0.3, py0, 0, 0.5),
           box(px0 - 0.3, px1 + 0.3, py1, py1 + 0.3, 0, 0.5),
           box(px0 - 0.3, px0, py0, py1, 0, 0.5), box(px1, px1 + 0.3, py0, py1, 0, 0.5)]
    (mx, my, mz, mr), (gx, gy, gz, gr) = BALLS
    relevance = kscene.EFFECT_RELEVANCE
    objects = [
        {"name": "Ground", "mesh": "plane", "material": "Soil", "scale": (90, 80, 1)},
        boxes("Terrace", "Terrace", box(TERRACE[0], TERRACE[1], TERRACE[2], TERRACE[3], 0, 0.12)),
        boxes("House", "Plaster", box(HOUSE[0], HOUSE[1], HOUSE[2], HOUSE[3], 0, 3.0)),
        {"name": "Roof", "mesh": "roof", "material": "Tiles"},
        boxes("Door", "Wood", box(3.4, 4.5, front - 0.05, front, 0.12, 2.3)),
        boxes("WindowFrames", "White", *frames),
        boxes("WindowPanes", "Pane", *panes),
        boxes("PoolFloor", "Mosaic", box(px0, px1, py0, py1, 0, 0.03)),
        boxes("PoolRim", "Stone", *rim),
        {**boxes("Water", "Water", box(px0 + 0.001, px1 - 0.001, py0 + 0.001, py1 - 0.001, 0.031,
                                       0.42)), "relevance": relevance},
        {"name": "GazingBall", "mesh": "ball", "material": "Mirror", "position": (mx, my, mz),
         "scale": mr, "relevance": relevance},
        {"name": "GlassBall", "mesh": "ball", "material": "Glass", "position": (gx, gy, gz),
         "scale": gr, "relevance": relevance},
    ]
    yard.triangles += 2 + 12 * (3 + len(frames) + len(panes) + 1 + len(rim) + 1) + 8 + 2 * 3968
    return objects


MATERIALS = [
    {"name": "Soil", "diffuse": (0.07, 0.12, 0.03)},
    {"name": "Terrace", "diffuse": (1, 1, 1), "diffuse_texture": "slabs"},
    {"name": "Plaster", "diffuse": (0.62, 0.57, 0.48)},
    {"name": "Tiles", "diffuse": (1, 1, 1), "diffuse_texture": "tiles"},
    {"name": "Wood", "diffuse": (0.16, 0.07, 0.03), "specular": (0.08, 0.08, 0.08, 0.1)},
    {"name": "White", "diffuse": (0.8, 0.8, 0.78)},
    {"name": "Pane", "diffuse": (0.03, 0.05, 0.07), "specular": (0.6, 0.6, 0.6, 0.5)},
    {"name": "Mosaic", "diffuse": (1, 1, 1), "diffuse_texture": "mosaic"},
    {"name": "Stone", "diffuse": (0.5, 0.47, 0.42)},
    *({"name": f"Grass{i}", "diffuse": (0.42, 0.72, 0.26), "diffuse_texture": f"grass-0{i}",
       "alpha_mode": "mask"} for i in (1, 2)),
    kscene.glass("Water", (0.75, 0.93, 0.95), 1.33),
    kscene.mirror("Mirror"),
    kscene.glass("Glass", (1, 1, 1), 1.5),
]
TEXTURES = [
    *({"name": f"grass-0{i}", "file": f"{kscene.DATA}/plants/textures/grass-0{i}.png"}
      for i in (1, 2)),
    {"name": "slabs", "checker": {"squares": 8, "texels": 16,
                                  "colors": ((0.46, 0.42, 0.36), (0.36, 0.33, 0.29))}},
    {"name": "tiles", "checker": {"squares": 24, "texels": 4,
                                  "colors": ((0.36, 0.10, 0.05), (0.27, 0.07, 0.04))}},
    {"name": "mosaic", "checker": {"squares": 24, "texels": 8,
                                   "colors": ((0.10, 0.42, 0.50), (0.45, 0.66, 0.68))}},
]


def camera():
    path = [kscene.key(0, (-11.2, -10.6, 1.75), (0.2, 2.0, 1.15)),
            kscene.key(5, (-4.4, -10.2, 1.9), (-0.5, 2.0, 1.3)),
            kscene.key(10, (2.6, -7.4, 2.3), (-3.0, 1.0, 1.0)),
            kscene.key(15, (6.2, -3.0, 2.0), (-6.0, -1.2, 0.7)),
            kscene.key(20, (1.6, -1.2, 1.7), (-9.0, 1.6, 1.4))]
    kscene.check_clearance(path, BALLS, 0.3)
    return {"fov_x": 60, "position": path[0]["position"], "look_at": path[0]["look_at"], "near": 0.05,
            "far": 500, "path": path}


def main():
    yard = Yard()
    objects = buildings(yard) + vegetation(yard)
    objects.append(fill_with_grass(yard))
    print(f"{len(objects)} objects, {yard.triangles} triangles")
    kscene.write("backyard", {
        "description": "The paper's fourth test scene: a house, a pool and woods with alpha-masked "
                       "leaves. 48 objects, 1.13 M triangles. Plants: Shapespark, CC0; sky: Poly "
                       "Haven, CC0 (see SOURCE.txt in the scene data).",
        "camera": camera(),
        "settings": {"ambient": (0.30, 0.34, 0.40)},
        "world": {"image": f"{kscene.DATA}/hdri/noon_grass_1k.hdr", "strength": 0.9},
        "lights": [kscene.sun("Sun", (0.62, 0.38, -0.85), 1.15, (1, 0.95, 0.86))],
        "textures": TEXTURES,
        "materials": MATERIALS,
        "meshes": [{"name": "plane", "primitive": "plane"}, {"name": "cube", "primitive": "cube"},
                   {"name": "ball", "primitive": "sphere", "slices": 64, "stacks": 32}, roof_mesh()],
        "objects": objects,
    })


if __name__ == "__main__":
    main()
