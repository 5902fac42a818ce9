# SPDX-License-Identifier: GPL-3.0-or-later
"""The image cases as data. Each is a scene of `tests/image/scenes`, changed by a JSON merge patch,
rendered small by the kestrel command with primary = raster and rays. It is compared with
`tests/references/image/NAME.exr` or, where `same_as` names one, with another case's picture.
Probes are known answers, worked out by hand from the scene alone.
"""

import math
from typing import NamedTuple

SIZE_PX = (256, 144)
BOTH = ("raster", "rays")
EXACT_DB = float("inf")


class Probe(NamedTuple):
    x: int  # pixels from the left
    y: int  # pixels from the top
    rgb: tuple  # scene-linear
    why: str
    tolerance: float = 0.004  # of each channel; a 16-bit lighting buffer rounds to 0.0005 at 1


class Case(NamedTuple):
    name: str
    scene: str
    shows: str
    tolerance_db: float = 45.0
    patch: dict = {}
    settings: dict = {}
    layer: str = "Combined"
    same_as: str = ""
    reference: bool = True  # False: the probes say all
    probes: tuple = ()
    primaries: tuple = BOTH
    samples: int = 4
    size: tuple = SIZE_PX


# ---- scenes seen from above --------------------------------------------------------------------

PIXELS_PER_METRE = 16
WORLD = (0.2, 0.4, 0.6)  # of the scene `materials`
COS_45 = math.sqrt(0.5)


def above(x, y, rgb, why, tolerance=0.004):
    """Probe at a place of the ground, in metres, seen by the cameras that look straight down."""
    return Probe(round(SIZE_PX[0] / 2 + PIXELS_PER_METRE * x),
                 round(SIZE_PX[1] / 2 - PIXELS_PER_METRE * y), rgb, why, tolerance)


def grey(value):
    return (value, value, value)


def scaled(color, factor):
    return tuple(channel * factor for channel in color)


def lamp_lit(x, y, why, albedo=0.8, height=4.0, radiance_1m=20.0):
    """Probe of a floor under a lamp above the origin: inverse square and cosine, taken at the
    centre of the pixel."""
    probe = above(x, y, (), why)
    squared = height ** 2 + ((probe.x + 0.5 - SIZE_PX[0] / 2) / PIXELS_PER_METRE) ** 2 + (
        (probe.y + 0.5 - SIZE_PX[1] / 2) / PIXELS_PER_METRE) ** 2
    return probe._replace(rgb=grey(radiance_1m / squared * height / math.sqrt(squared) * albedo))


MATERIALS = [
    Case("materials", "materials", "diffuse, emission, specular, mirror and clear patches", probes=(
        above(-6, 2, (0.8, 0.4, 0.2), "diffuse colour under a light of 1 that faces it"),
        above(-2, 2, (0.4, 0.2, 0.1), "tilted by 60 degrees: half of it"),
        above(2, 2, (0.25, 0.5, 2.5), "emission, not clamped"),
        above(6, 2, (0.75, 0.6, 0.5), "diffuse and the full highlight"),
        above(-6, -2, (0.3125, 0.275, 0.25), "tilted by 60 degrees, exponent 2: a quarter of it"),
        above(-2, -2, (0.5, 0.6, 0.7), "half diffuse, half the world reflected"),
        above(2, -2, (0.2, 0.2, 0.15), "the world tinted by a gold mirror"),
        above(6, -2, (0.5, 0.6, 0.7), "half diffuse, half the world behind"),
        Probe(2, 2, WORLD, "the world"))),
    Case("ambient", "materials", "nothing but global ambient light", patch={"lights": []},
         settings={"ambient": "0.5 0.25 0"}, probes=(
             above(-6, 2, (0.4, 0.1, 0.0), "ambient light times the surface's colour"),
             above(-2, 2, (0.4, 0.1, 0.0), "from every side alike"),
             above(2, 2, (0.25, 0.5, 2.5), "emission as before"))),
    Case("no_effects", "materials", "selection = none: reflections and refractions left out",
         settings={"selection": "none"}, probes=(
             above(-6, 2, (0.8, 0.4, 0.2), "a matte surface as before"),
             above(-2, -2, grey(0.8), "a mirror that was not selected keeps its lighting"))),
]

SUN_FLOOR = grey(0.8 * COS_45)
POINT = {"lights": [{"type": "point", "position": [0, 0, 4], "color": [20, 20, 20]}]}
SPOT = {"lights": [{"type": "spot", "position": [0, 0, 4], "direction": [0, 0, -1],
                    "spot_angle": 60, "blend": 0, "color": [20, 20, 20]}]}
CLEAR_CARD = {"materials": [{"name": "floor", "diffuse": [0.8, 0.8, 0.8]},
                            {"name": "card", "diffuse": [0.9, 0.2, 0.1], "opacity": 0.4}]}
NO_SHADOW_LIGHT = {"lights": [{"type": "directional", "direction": [1, 0, -1],
                               "casts_shadow": False}]}
NO_SHADOW_CARD = {"materials": [{"name": "floor", "diffuse": [0.8, 0.8, 0.8]},
                                {"name": "card", "diffuse": [0.9, 0.2, 0.1],
                                 "casts_shadow": False}]}

SHADOWS = [
    Case("shadow_sun", "shadows", "sun at 45 degrees: the shadow lies 2 m beside the card", probes=(
        above(1, 0, grey(0), "in the shadow"), above(4, 0, SUN_FLOOR, "beside it"),
        above(-1, 0, scaled((0.9, 0.2, 0.1), COS_45), "the card itself"))),
    Case("shadow_point", "shadows", "lamp 4 m up: the shadow is twice the card", patch=POINT,
         probes=(above(-2.2, 0, grey(0), "in the shadow"),
                 lamp_lit(2, 0, "lit: inverse square and cosine"),
                 lamp_lit(-2.2, 2.3, "past its corner"))),
    Case("shadow_spot", "shadows", "spot 4 m up, hard cone of 60 degrees", patch=SPOT, probes=(
        above(-1.8, 0, grey(0), "in the shadow"), above(3, 0, grey(0), "outside the cone"),
        lamp_lit(1, 0, "inside it, as a lamp's light"))),
    Case("shadow_coloured", "shadows", "card of opacity 0.4: 0.6 (1 - diffuse) shines through",
         patch=CLEAR_CARD, probes=(
             above(1, 0, scaled((0.06, 0.48, 0.54), 0.8 * COS_45), "tinted shadow"),
             above(4, 0, SUN_FLOOR, "beside it"))),
    Case("shadow_light_without", "shadows", "a light that casts no shadow", patch=NO_SHADOW_LIGHT,
         reference=False, probes=(above(1, 0, SUN_FLOOR, "where the shadow would be"),)),
    Case("shadow_material_without", "shadows", "a material that casts no shadow",
         patch=NO_SHADOW_CARD, reference=False,
         probes=(above(1, 0, SUN_FLOOR, "where the shadow would be"),)),
    Case("leaf_shadow", "leaf_shadow", "alpha mask: holes in the card and in its shadow", probes=(
        above(0, 1, grey(0), "shadow of a leaf"), above(-1.5, -1, grey(0), "shadow of a leaf"),
        above(0, -1, SUN_FLOOR, "light through a hole"),
        above(-1.5, 1, SUN_FLOOR, "light through a hole"),
        above(-3.5, -1, SUN_FLOOR, "the floor seen through a hole"),
        above(-5, -1, scaled((0.2, 0.6, 0.1), COS_45), "a leaf"))),
]

RED, GREEN, BLUE, YELLOW = (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0)
SRGB_188 = ((188 / 255 + 0.055) / 1.055) ** 2.4
MISSING = {"textures": [{"name": "holes", "file": "leaf_shadow.kscene"}]}

TEXTURES = [
    Case("textures", "textures", "orientation, tiling, offset, extension, sRGB, normal map",
         samples=1, probes=(
             above(-6.5, 3.25, RED, "upper left of the image"),
             above(-4.5, 3.25, GREEN, "upper right"),
             above(-6.5, 1.25, BLUE, "lower left"), above(-4.5, 1.25, YELLOW, "lower right"),
             above(-2.5, 1.25, RED, "tiling 2 x 1, offset 0, 0.5: first tile, upper left"),
             above(-1.5, 1.25, GREEN, "first tile, upper right"),
             above(-0.5, 1.25, RED, "second tile, upper left"),
             above(-2.5, 3.25, BLUE, "first tile, lower left"),
             above(4.5, 0.75, YELLOW, "clamped: the right edge goes on"),
             above(4.5, 3.25, GREEN, "clamped: the corner goes on"),
             above(6.9, 2.25, grey(SRGB_188), "sRGB 188 is 0.503 linear"),
             above(-7.1, -2.25, grey(0), "clipped: black outside the image"),
             above(-6, -2.75, BLUE, "clipped: the image inside"),
             above(-2, -2.25, grey(0.8), "normal map that leans to the light", 0.008),
             above(0, -2.25, grey(0.4), "normal map that leans aside: 60 degrees", 0.008),
             above(3.5, -2.25, SUN_FLOOR, "normal map of strength 0"))),
    Case("missing_texture", "leaf_shadow", "a file that is no image is magenta", patch=MISSING,
         reference=False, probes=(above(-5, -1, scaled((1, 0, 1), COS_45), "magenta"),)),
]


# ---- mirrors, unfolded -------------------------------------------------------------------------

def cube(material, position, scale, rotation=(0, 0, 0)):
    return {"mesh": "cube", "material": material, "position": list(position), "scale": scale,
            "rotation": list(rotation)}


def unfolded_hall(depth):
    """What two mirrors at y = 2 and y = -2 show: the room again behind each, every other one
    turned, as many as there are reflections."""
    cubes = []
    for k in range(depth + 1):
        for material, (x, y, z), scale in (("red", (-0.9, 0.6, 0), 0.25),
                                           ("green", (0.8, 1.1, -0.3), [0.2, 0.1, 0.3])):
            cubes.append(cube(material, (x, 4 * k + (-1) ** k * y, z), scale))
    return {"objects": cubes}


MIRRORED_CUBES = {"objects": [
    cube("red", (-1.4, 0, 1.1), 0.5, (20, 30, 0)), cube("blue", (1.5, 1, 0.8), [0.4, 0.4, 0.8], (0, 0, 25)),
    cube("red", (-1.4, 0, -1.1), 0.5, (-20, -30, 0)),
    cube("blue", (1.5, 1, -0.8), [0.4, 0.4, 0.8], (0, 0, 25))]}

MIRRORS = [
    Case("mirror_unfolded", "mirror_floor", "no mirror: the cubes again, upside down below the floor",
         patch=MIRRORED_CUBES),
    Case("mirror_floor", "mirror_floor", "a mirror shows what stands before it, turned over",
         same_as="mirror_unfolded"),
    *(case for depth in (1, 2, 4) for case in (
        Case(f"hall_unfolded_{depth}", "facing_mirrors", f"no mirrors: {depth + 1} rooms in a row",
             patch=unfolded_hall(depth)),
        Case(f"facing_mirrors_{depth}", "facing_mirrors", f"max_depth {depth}: {depth} reflections",
             settings={"max_depth": depth}, same_as=f"hall_unfolded_{depth}"))),
]


# ---- glass -------------------------------------------------------------------------------------

FLOOR = {"name": "Floor", "mesh": "plane", "material": "floor", "scale": 10}
SLAB_IOR = 1.5
SIN_INSIDE = math.sin(math.radians(45)) / SLAB_IOR  # Snell's law
SLAB_SHIFT_M = math.tan(math.radians(45)) - math.tan(math.asin(SIN_INSIDE))  # of 1 m of glass


def slab_material(ior):
    return {"materials": [{"name": "floor", "diffuse": [0, 0, 0], "emission": [1, 1, 1],
                           "emission_texture": "checker"},
                          {"name": "glass", "diffuse": [0, 0, 0], "opacity": 0, "ior": ior}]}


GLASS = [
    Case("slab_absent", "slab", "the floor alone", patch={"objects": [FLOOR]}),
    Case("slab_invisible", "slab", "glass of index 1 cannot be seen", same_as="slab_absent"),
    Case("slab_shifted_floor", "slab", f"no glass, the floor moved by {SLAB_SHIFT_M:.4f} m",
         patch={"objects": [{**FLOOR, "position": [SLAB_SHIFT_M, 0, 0]}]}),
    Case("slab_refracts", "slab", "glass of index 1.5 shifts what is behind it by Snell's law",
         patch=slab_material(SLAB_IOR), same_as="slab_shifted_floor"),
    Case("glass_ball", "glass_ball", "a glass ball shows what is behind it upside down", probes=(
        Probe(20, 10, (0.5, 0, 0), "upper left of the picture"),
        Probe(98, 42, (0.5, 0.5, 0), "upper left of the ball: the picture's lower right"),
        Probe(158, 42, (0, 0, 0.5), "upper right of the ball: lower left"),
        Probe(98, 102, (0, 0.5, 0), "lower left of the ball: upper right"),
        Probe(158, 102, (0.5, 0, 0), "lower right of the ball: upper left"))),
]


# ---- world images ------------------------------------------------------------------------------

CUBE_FILES = [f"textures/cube_{name}.png" for name in ("px", "nx", "py", "ny", "pz", "nz")]
FACES = {  # axis: colour of the upper left quarter; axes of the image's right and bottom (GL 4.5,
    # table 8.19), the camera's up and the axis on its right
    "+x": ((1, 0, 0), (1, 0, 0), (0, 0, -1), (0, -1, 0)),
    "-x": ((-1, 0, 0), (0, 1, 1), (0, 0, 1), (0, -1, 0)),
    "+y": ((0, 1, 0), (0, 1, 0), (1, 0, 0), (0, 0, 1)),
    "-y": ((0, -1, 0), (1, 0, 1), (1, 0, 0), (0, 0, -1)),
    "+z": ((0, 0, 1), (0, 0, 1), (1, 0, 0), (0, -1, 0)),
    "-z": ((0, 0, -1), (1, 1, 0), (-1, 0, 0), (0, -1, 0)),
}


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return sum(p * q for p, q in zip(a, b))


def cube_face(name):
    """Looks at one face; the camera's up is the image's top, so the image is seen from its back."""
    axis, color, image_right, image_down = FACES[name]
    up = scaled(image_down, -1)
    camera_right = cross(axis, up)
    flipped = dot(camera_right, image_right) < 0
    probes = []
    for x, y in ((-40, -40), (40, -40), (-40, 40), (40, 40)):
        in_corner = y < 0 and (x > 0) == flipped
        probes.append(Probe(128 + x, 72 + y, color if in_corner else grey(SRGB_188),
                            "the face's own quarter" if in_corner else "the rest of the face"))
    return Case(f"skybox{name}", "sky", f"cube map, face {name}", samples=1, reference=False,
                patch={"camera": {"look_at": list(axis), "up": list(up)},
                       "world": {"cube": CUBE_FILES}}, probes=tuple(probes))


def panorama(name, look_at, up, rgb, why):
    return Case(f"panorama{name}", "sky", f"equirectangular image towards {name}", samples=1,
                patch={"camera": {"look_at": look_at, "up": up},
                       "world": {"image": "textures/sky.png"}},
                reference=False, probes=(Probe(128, 40, rgb, why),))


WORLDS = [
    *(cube_face(name) for name in FACES),
    panorama("+x", [1, 0, 0], [0, 0, 1], RED, "the middle of the image"),
    panorama("+y", [0, 1, 0], [0, 0, 1], GREEN, "a quarter to the left"),
    panorama("-y", [0, -1, 0], [0, 0, 1], BLUE, "a quarter to the right"),
    panorama("-x", [-1, 0, 0], [0, 0, 1], YELLOW, "its edges"),
    panorama("+z", [0, 0, 1], [0, 1, 0], (1, 1, 1), "its top"),
    panorama("-z", [0, 0, -1], [0, 1, 0], (0, 0, 0), "its bottom"),
]


# ---- a room with everything --------------------------------------------------------------------

ORTHO = {"camera": {"fov": None, "type": "orthographic", "scale": 7, "shift_x": 0.1,
                    "shift_y": -0.05}}

ROOM = [
    Case("room", "room", "all effects together", 42.0),
    Case("room_ortho", "room", "orthographic camera with shift", 42.0, patch=ORTHO),
    Case("room_depth_2", "room", "max_depth 2", 42.0, settings={"max_depth": 2}),
    Case("room_rasterised", "room", "selection = none", 42.0, settings={"selection": "none"}),
    Case("room_all", "room", "selection = all is what no budget selects", EXACT_DB,
         settings={"selection": "all"}, same_as="room", primaries=("rays",)),
    Case("room_threads", "room", "one thread gives the same picture", EXACT_DB,
         settings={"threads": 1}, same_as="room", primaries=("rays",)),
    Case("room_filter", "room", "Blackman-Harris filter, 16 samples", 42.0, samples=16,
         settings={"pixel_filter": "blackman_harris", "filter_width": 1.5}),
]

CASES = MATERIALS + SHADOWS + TEXTURES + MIRRORS + GLASS + WORLDS + ROOM


def find(name):
    for case in CASES:
        if case.name == name:
            return case
    raise SystemExit(f"no image case '{name}'. There are: {', '.join(c.name for c in CASES)}")
