# SPDX-License-Identifier: GPL-3.0-or-later
"""What the scripts that write scene files share. Plain Python, no packages.

Lengths are metres, Z is up, colours are linear Rec. 709. The scripts write next to themselves, and
the same script writes the same file.
"""

import json
import math
import os
import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
DATA = "${KESTREL_SCENE_DATA}"
EFFECT_RELEVANCE = 4  # the paper's K for reflective and refractive objects; plain objects keep 1


def data_file(relative):
    """Path of a file of the scene data; ends the program where it is missing."""
    folder = Path(os.environ.get("KESTREL_SCENE_DATA", FOLDER.parents[1] / "shared" / "scenes"))
    path = folder / relative
    if not path.exists():
        sys.exit(f"'{path}' does not exist: set KESTREL_SCENE_DATA to the folder that has {relative}")
    return path


def dump(value, level=0):
    """JSON with one line for each element of the lists of a scene, numbers without noise."""
    if level < 2 and isinstance(value, dict) and value:
        rows = [f'{"  " * level}  {json.dumps(key)}: {dump(item, level + 1)}'
                for key, item in value.items()]
        return "{\n" + ",\n".join(rows) + "\n" + "  " * level + "}"
    if level == 1 and isinstance(value, list) and value and isinstance(value[0], dict):
        rows = ["    " + dump(item, 2) for item in value]
        return "[\n" + ",\n".join(rows) + "\n  ]"
    return json.dumps(rounded(value), ensure_ascii=False)


def rounded(value):
    if isinstance(value, float):
        value = round(value, 6)
        return int(value) if value == int(value) else value
    if isinstance(value, (list, tuple)):
        return [rounded(item) for item in value]
    if isinstance(value, dict):
        return {key: rounded(item) for key, item in value.items()}
    return value


def write(name, scene):
    path = FOLDER / f"{name}.kscene"
    path.write_text(dump({"kestrel_scene": 1, **scene}) + "\n", encoding="utf-8")
    print(f"wrote {path.name}")


# ---- elements --------------------------------------------------------------------------------

def point(name, position, intensity, color=(1, 1, 1)):
    """`intensity`: radiance that a white surface facing the light reflects at 1 m."""
    return {"name": name, "type": "point", "position": position, "color": color,
            "intensity": intensity}


def spot(name, position, target, intensity, angle, blend=0.15, color=(1, 1, 1)):
    return {"name": name, "type": "spot", "position": position, "target": target,
            "spot_angle": angle, "blend": blend, "color": color, "intensity": intensity}


def sun(name, direction, intensity, color=(1, 1, 1)):
    return {"name": name, "type": "directional", "direction": direction, "color": color,
            "intensity": intensity}


def mirror(name, color=(1, 1, 1)):
    return {"name": name, "diffuse": (0.02, 0.02, 0.02), "reflectivity": 0.95,
            "reflection_color": color}


def glass(name, color=(1, 1, 1), ior=1.5):
    return {"name": name, "diffuse": (0, 0, 0), "opacity": 0, "ior": ior,
            "transmission_color": color}


def key(time, position, look_at):
    return {"time": time, "position": position, "look_at": look_at}


# ---- checks ----------------------------------------------------------------------------------

def path_points(path, steps=400):
    """Positions along a camera path, on the same curve as the command's."""
    points = []
    times = [k["time"] for k in path]

    def slope(i, axis):
        a, b = max(i - 1, 0), min(i + 1, len(path) - 1)
        return (path[b]["position"][axis] - path[a]["position"][axis]) / (times[b] - times[a])

    for step in range(steps + 1):
        time = times[0] + (times[-1] - times[0]) * step / steps
        i = max(j for j in range(len(path) - 1) if times[j] <= time)
        span = times[i + 1] - times[i]
        s = (time - times[i]) / span
        point_now = []
        for axis in range(3):
            p0, p1 = path[i]["position"][axis], path[i + 1]["position"][axis]
            m0, m1 = slope(i, axis) * span, slope(i + 1, axis) * span
            point_now.append((2 * s ** 3 - 3 * s ** 2 + 1) * p0 + (s ** 3 - 2 * s ** 2 + s) * m0
                             + (3 * s ** 2 - 2 * s ** 3) * p1 + (s ** 3 - s ** 2) * m1)
        points.append(point_now)
    return points


def check_clearance(path, spheres, least):
    """Ends the program where the path comes nearer than `least` to a sphere (x, y, z, radius)."""
    for place in path_points(path):
        for x, y, z, radius in spheres:
            gap = math.dist(place, (x, y, z)) - radius
            if gap < least:
                sys.exit(f"the camera comes within {gap:.2f} m of the sphere at {x}, {y}, {z}")
