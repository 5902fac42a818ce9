# SPDX-License-Identifier: GPL-3.0-or-later
"""kestrel.h for ctypes: the structs, the functions, and thin owners of its handles.

Arrays are C-contiguous numpy arrays; the library copies them during the call. Every failure
raises KestrelError with the library's own text, which names the cause and a remedy.
"""

import ctypes
from ctypes import (POINTER, Structure, byref, c_bool, c_char_p, c_float, c_int, c_int32, c_size_t,
                    c_uint8, c_uint32, c_uint64, c_void_p)

import numpy as np

ABI_VERSION = 1  # KESTREL_ABI_VERSION

ERROR_NONE = 0
ERROR_CANCELLED = 6

LOG_WARNING = 2
LOG_ERROR = 3

EXTENSION_REPEAT, EXTENSION_CLAMP, EXTENSION_CLIP = range(3)
ALPHA_OPAQUE, ALPHA_MASK, ALPHA_BLEND = range(3)
LIGHT_DIRECTIONAL, LIGHT_POINT, LIGHT_SPOT = range(3)
KIND_MESH, KIND_TEXTURE, KIND_MATERIAL, KIND_LIGHT, KIND_OBJECT = range(5)
PERSPECTIVE, ORTHOGRAPHIC = range(2)
RAYS_CAMERA, RAYS_SHADOW, RAYS_REFLECTION, RAYS_REFRACTION = 1, 2, 4, 8
WORLD_COLOR, WORLD_EQUIRECTANGULAR, WORLD_CUBE = range(3)

float_p = POINTER(c_float)
uint32_p = POINTER(c_uint32)
uint64_p = POINTER(c_uint64)
uint8_p = POINTER(c_uint8)

LogCallback = ctypes.CFUNCTYPE(None, c_void_p, c_int, c_char_p)
ProgressCallback = ctypes.CFUNCTYPE(c_bool, c_void_p, c_float, c_char_p)


class KestrelError(Exception):
    """What went wrong and what to do about it, in words for the artist."""


class Cancelled(KestrelError):
    """The frame was given up because someone asked for it."""


class MeshAttribute(Structure):
    _fields_ = [
        ("id", c_uint64),
        ("channels", c_int32),
        ("values", float_p),
    ]


class Mesh(Structure):
    _fields_ = [
        ("name", c_char_p),
        ("vertex_count", c_size_t),
        ("positions", float_p),
        ("triangle_count", c_size_t),
        ("triangles", uint32_p),
        ("corner_normals", float_p),
        ("corner_uvs", float_p),
        ("corner_tangents", float_p),
        ("triangle_materials", uint32_p),
        ("motion_count", c_size_t),
        ("motion_positions", float_p),
        ("motion_corner_normals", float_p),
        ("uv_map", c_uint64),
        ("attribute_count", c_size_t),
        ("attributes", POINTER(MeshAttribute)),
    ]


class TextureOptions(Structure):
    _fields_ = [
        ("name", c_char_p),
        ("srgb", c_bool),
        ("nearest", c_bool),
        ("extension", c_int32),
    ]


class NodeInstruction(Structure):
    _fields_ = [
        ("op", c_uint32),
        ("mode", c_uint32),
        ("result", c_int32),
        ("data", c_int32),
        ("operands", c_int32 * 8),
    ]


class NodeProgram(Structure):
    _fields_ = [
        ("instructions", POINTER(NodeInstruction)),
        ("instruction_count", c_size_t),
        ("constants", float_p),
        ("constant_count", c_size_t),
        ("textures", uint64_p),
        ("texture_count", c_size_t),
        ("attributes", uint64_p),
        ("attribute_count", c_size_t),
        ("outputs", c_int32 * 10),
    ]


class Material(Structure):
    _fields_ = [
        ("name", c_char_p),
        ("emission", c_float * 3),
        ("ambient", c_float * 3),
        ("diffuse", c_float * 4),
        ("specular", c_float * 4),
        ("optical", c_float * 3),
        ("reflection_color", c_float * 3),
        ("transmission_color", c_float * 3),
        ("emission_texture", c_uint64),
        ("ambient_texture", c_uint64),
        ("diffuse_texture", c_uint64),
        ("specular_texture", c_uint64),
        ("normal_texture", c_uint64),
        ("optical_texture", c_uint64),
        ("normal_strength", c_float),
        ("tiling", c_float * 2),
        ("offset", c_float * 2),
        ("casts_shadow", c_bool),
        ("alpha_mode", c_int32),
        ("alpha_cutoff", c_float),
        ("pass_index", c_int32),
        ("uv_maps", c_uint64 * 6),
        ("tangent_map", c_uint64),
        ("emission_attribute", c_uint64),
        ("ambient_attribute", c_uint64),
        ("diffuse_attribute", c_uint64),
        ("program", POINTER(NodeProgram)),
    ]
    program_content = None  # what the program says, comparable

    def set_program(self, program, textures, attributes):
        """Let a sync.program.Program compute the properties; ids of its textures and attributes."""
        textures, attributes = (np.array(ids, np.uint64) for ids in (textures, attributes))
        made = NodeProgram(
            pointer(program.instructions, POINTER(NodeInstruction), np.int32),
            len(program.instructions), pointer(program.constants, float_p, np.float32),
            len(program.constants), pointer(textures, uint64_p, np.uint64), len(textures),
            pointer(attributes, uint64_p, np.uint64), len(attributes))
        made.outputs[:] = program.outputs
        self.program = ctypes.pointer(made)
        self._kept_alive = program, textures, attributes, made
        self.program_content = (program.instructions.tobytes(), program.constants.tobytes(),
                                textures.tobytes(), attributes.tobytes(), program.outputs)


class Light(Structure):
    _fields_ = [
        ("name", c_char_p),
        ("type", c_int32),
        ("color", c_float * 3),
        ("position", c_float * 3),
        ("direction", c_float * 3),
        ("attenuation", c_float * 3),
        ("spot_angle", c_float),
        ("spot_blend", c_float),
        ("spot_exponent", c_float),
        ("specular_factor", c_float),
        ("casts_shadow", c_bool),
    ]


class Object(Structure):
    _fields_ = [
        ("name", c_char_p),
        ("mesh", c_uint64),
        ("materials", uint64_p),
        ("material_count", c_size_t),
        ("world_from_object", c_float * 12),
        ("unit", c_char_p),
        ("hidden_from", c_uint32),
        ("holdout", c_bool),
        ("pass_index", c_int32),
        ("asset", c_char_p),
    ]


class Camera(Structure):
    _fields_ = [
        ("projection", c_int32),
        ("world_from_camera", c_float * 12),
        ("left", c_float),
        ("right", c_float),
        ("bottom", c_float),
        ("top", c_float),
        ("near_clip", c_float),
        ("far_clip", c_float),
        ("aperture_radius", c_float),
        ("focus_distance", c_float),
        ("aperture_blades", c_int32),
        ("aperture_rotation", c_float),
        ("aperture_ratio", c_float),
    ]


class World(Structure):
    _fields_ = [
        ("kind", c_int32),
        ("color", c_float * 3),
        ("textures", c_uint64 * 6),
        ("map_from_world", c_float * 9),
        ("mist_start", c_float),
        ("mist_depth", c_float),
        ("mist_falloff", c_float),
    ]


# name: (result, arguments). A result of c_int is a KestrelError to be checked.
FUNCTIONS = {
    "kestrelGetVersion": (c_char_p, []),
    "kestrelGetAbiVersion": (c_uint32, []),
    "kestrelGetError": (c_int, [POINTER(c_char_p)]),
    "kestrelSetLogCallback": (None, [LogCallback, c_void_p]),
    "kestrelSetLogLevel": (None, [c_int]),
    "kestrelGetParameterTable": (c_char_p, []),
    "kestrelGetNodeTable": (c_char_p, []),
    "kestrelHash": (c_int, [c_void_p, c_size_t, uint64_p]),
    "kestrelNewDevice": (c_void_p, []),
    "kestrelRetainDevice": (None, [c_void_p]),
    "kestrelReleaseDevice": (None, [c_void_p]),
    "kestrelGetDeviceInfo": (c_char_p, [c_void_p]),
    "kestrelNewScene": (c_void_p, [c_void_p]),
    "kestrelRetainScene": (None, [c_void_p]),
    "kestrelReleaseScene": (None, [c_void_p]),
    "kestrelSetMesh": (c_int, [c_void_p, c_uint64, POINTER(Mesh)]),
    "kestrelSetTextureFile": (c_int, [c_void_p, c_uint64, c_char_p, POINTER(TextureOptions)]),
    "kestrelSetTextureMemory": (
        c_int, [c_void_p, c_uint64, c_char_p, c_size_t, POINTER(TextureOptions)]),
    "kestrelSetTexturePixels8": (
        c_int, [c_void_p, c_uint64, c_int, c_int, uint8_p, POINTER(TextureOptions)]),
    "kestrelSetTexturePixelsFloat": (
        c_int, [c_void_p, c_uint64, c_int, c_int, float_p, POINTER(TextureOptions)]),
    "kestrelDefaultMaterial": (None, [POINTER(Material)]),
    "kestrelSetMaterial": (c_int, [c_void_p, c_uint64, POINTER(Material)]),
    "kestrelDefaultLight": (None, [POINTER(Light)]),
    "kestrelSetLight": (c_int, [c_void_p, c_uint64, POINTER(Light)]),
    "kestrelSetObject": (c_int, [c_void_p, c_uint64, POINTER(Object)]),
    "kestrelSetObjectTransform": (c_int, [c_void_p, c_uint64, float_p]),
    "kestrelSetObjects": (c_int, [c_void_p, uint64_p, float_p, c_size_t, POINTER(Object)]),
    "kestrelSetObjectTransforms": (c_int, [c_void_p, uint64_p, float_p, c_size_t]),
    "kestrelSetObjectMotion": (c_int, [c_void_p, c_uint64, float_p, c_size_t]),
    "kestrelSetObjectSetting": (c_int, [c_void_p, c_uint64, c_char_p, c_char_p]),
    "kestrelRemove": (c_int, [c_void_p, c_int, c_uint64]),
    "kestrelRemoveItems": (c_int, [c_void_p, c_int, uint64_p, c_size_t]),
    "kestrelSetCamera": (c_int, [c_void_p, POINTER(Camera)]),
    "kestrelSetCameraMotion": (c_int, [c_void_p, POINTER(Camera), c_size_t]),
    "kestrelSetWorld": (c_int, [c_void_p, POINTER(World)]),
    "kestrelSetSetting": (c_int, [c_void_p, c_char_p, c_char_p]),
    "kestrelGetSetting": (c_char_p, [c_void_p, c_char_p]),
    "kestrelCommitScene": (c_int, [c_void_p]),
    "kestrelCancelCommit": (None, [c_void_p]),
    "kestrelWriteScene": (c_int, [c_void_p, c_char_p, c_int, c_int]),
    "kestrelNewRenderer": (c_void_p, [c_void_p]),
    "kestrelRetainRenderer": (None, [c_void_p]),
    "kestrelReleaseRenderer": (None, [c_void_p]),
    "kestrelRender": (c_int, [c_void_p, c_int, c_int, ProgressCallback, c_void_p]),
    "kestrelCancel": (None, [c_void_p]),
    "kestrelGetFrameSize": (c_int, [c_void_p, POINTER(c_int), POINTER(c_int)]),
    "kestrelGetPassCount": (c_size_t, [c_void_p]),
    "kestrelGetPassName": (c_char_p, [c_void_p, c_size_t]),
    "kestrelGetPassChannels": (c_char_p, [c_void_p, c_char_p]),
    "kestrelSetRegion": (c_int, [c_void_p, c_int, c_int, c_int, c_int]),
    "kestrelSetPasses": (c_int, [c_void_p, c_char_p]),
    "kestrelReadPass": (c_int, [c_void_p, c_char_p, float_p, c_size_t]),
    "kestrelReadPassSoFar": (c_int, [c_void_p, c_char_p, float_p, c_size_t]),
    "kestrelGetPassPixels": (float_p, [c_void_p, c_char_p]),
    "kestrelGetCryptomatteHash": (c_uint32, [c_char_p]),
    "kestrelGetCryptomatteManifest": (c_char_p, [c_void_p, c_char_p]),
    "kestrelGetStats": (c_char_p, [c_void_p]),
    "kestrelWriteImage": (c_int, [c_void_p, c_char_p, c_char_p]),
}


def declare(library):
    """Give every function of a CDLL its types; AttributeError names a missing one."""
    for name, (result, arguments) in FUNCTIONS.items():
        function = getattr(library, name)
        function.restype = result
        function.argtypes = arguments
    return library


def encode(text):
    return text.encode("utf-8", "replace")


def pointer(array, kind, dtype):
    """Pointer to an array's data, None for None. The caller keeps the array alive."""
    if array is None:
        return None
    if array.dtype != dtype or not array.flags.c_contiguous:
        raise TypeError(f"expected a contiguous array of {np.dtype(dtype)}, got {array.dtype}")
    return array.ctypes.data_as(kind)


def content(item):
    """What a Material or Light says, comparable between structs."""
    plain = type(item).from_buffer_copy(item)
    plain.name = None
    program = getattr(item, "program_content", None)
    if program:
        plain.program = None
    return item.name, program, bytes(plain)


class Library:
    """The loaded library, its version checked."""

    def __init__(self, cdll):
        self.c = declare(cdll)
        self._device = None

    def version(self):
        return self.c.kestrelGetVersion().decode()

    def parameter_table(self):
        """The table as JSON text."""
        return self.c.kestrelGetParameterTable().decode()

    def node_table(self):
        """The table of node instructions as JSON text."""
        return self.c.kestrelGetNodeTable().decode()

    def set_log_callback(self, callback):
        """`callback` is a LogCallback, kept alive by the caller, or None for standard error."""
        self.c.kestrelSetLogCallback(callback or LogCallback(), None)

    def check(self, code):
        if code != ERROR_NONE:
            raise self.last_error()

    def last_error(self):
        message = c_char_p()
        code = self.c.kestrelGetError(byref(message))
        text = (message.value or b"").decode("utf-8", "replace")
        if code == ERROR_CANCELLED:
            return Cancelled(text or "The render was cancelled.")
        return KestrelError(text or "Kestrel failed without giving a reason.")

    def handle(self, value):
        if not value:
            raise self.last_error()
        return c_void_p(value)

    @property
    def device(self):
        """One device for everything that Blender does; made when first needed."""
        if self._device is None:
            self._device = self.handle(self.c.kestrelNewDevice())
        return self._device

    def device_info(self):
        """JSON text about the machine. Starts OpenGL."""
        text = self.c.kestrelGetDeviceInfo(self.device)
        if text is None:
            raise self.last_error()
        return text.decode()

    def release(self):
        if self._device is not None:
            self.c.kestrelReleaseDevice(self._device)
            self._device = None

    def hash(self, *buffers):
        """16 bytes: the library's fingerprint of contiguous buffers (arrays, bytes), in order."""
        state = (c_uint64 * 2)()
        for buffer in buffers:
            data = np.frombuffer(buffer, np.uint8)
            self.check(self.c.kestrelHash(data.ctypes.data, data.nbytes, state))
        return bytes(state)

    def default_material(self):
        material = Material()
        self.c.kestrelDefaultMaterial(byref(material))
        return material

    def cryptomatte_hash(self, name):
        """The 32-bit number that Cryptomatte makes of a name."""
        return self.c.kestrelGetCryptomatteHash(encode(name))

    def default_light(self):
        light = Light()
        self.c.kestrelDefaultLight(byref(light))
        return light


class Scene:
    """Owner of a scene handle. Ids are 64-bit, not 0; names are text."""

    def __init__(self, library):
        self.library = library
        self.c = library.c
        self._handle = library.handle(self.c.kestrelNewScene(library.device))

    @property
    def handle(self):
        if self._handle is None:
            raise KestrelError("The scene was freed. Start the render again.")
        return self._handle

    def release(self):
        if self._handle is not None:
            self.c.kestrelReleaseScene(self._handle)
            self._handle = None

    def set_mesh(self, ident, name, positions, triangles, corner_normals=None, corner_uvs=None,
                 triangle_materials=None, uv_map=0, attributes=(), motion=None):
        """float32 (V, 3), uint32 (T, 3), float32 (3T, 3), float32 (3T, 2), uint32 (T,); the id of
        the UVs; [(id, float32 (3T, 2) for UVs or (3T, 3) for colours), ...]. `motion`: positions
        and corner normals, or None for those, of several shapes one after the other."""
        moved, moved_normals = motion or (None, None)
        more = (MeshAttribute * len(attributes))(*(
            MeshAttribute(ident, values.shape[1], pointer(values, float_p, np.float32))
            for ident, values in attributes))
        mesh = Mesh(
            encode(name), len(positions), pointer(positions, float_p, np.float32),
            len(triangles), pointer(triangles, uint32_p, np.uint32),
            pointer(corner_normals, float_p, np.float32),
            pointer(corner_uvs, float_p, np.float32), None,
            pointer(triangle_materials, uint32_p, np.uint32),
            0 if moved is None else len(moved) // len(positions),
            pointer(moved, float_p, np.float32), pointer(moved_normals, float_p, np.float32),
            uv_map, len(more), more)
        self.library.check(self.c.kestrelSetMesh(self.handle, ident, byref(mesh)))

    def set_texture_file(self, ident, path, options):
        self.library.check(self.c.kestrelSetTextureFile(
            self.handle, ident, path.encode("utf-8", "surrogateescape"), byref(options)))

    def set_texture_memory(self, ident, data, options):
        self.library.check(self.c.kestrelSetTextureMemory(
            self.handle, ident, data, len(data), byref(options)))

    def set_texture_pixels(self, ident, pixels, options):
        """uint8 or float32 (height, width, 4), row 0 at the bottom."""
        height, width, _ = pixels.shape
        if pixels.dtype == np.uint8:
            code = self.c.kestrelSetTexturePixels8(
                self.handle, ident, width, height, pointer(pixels, uint8_p, np.uint8),
                byref(options))
        else:
            code = self.c.kestrelSetTexturePixelsFloat(
                self.handle, ident, width, height, pointer(pixels, float_p, np.float32),
                byref(options))
        self.library.check(code)

    def set_material(self, ident, material):
        self.library.check(self.c.kestrelSetMaterial(self.handle, ident, byref(material)))

    def set_light(self, ident, light):
        self.library.check(self.c.kestrelSetLight(self.handle, ident, byref(light)))

    def set_objects(self, idents, world_from_object, name, unit, mesh, materials, visibility,
                    pass_index, asset):
        """Objects that differ in id and place alone: uint64 (N,), and float32 (N, 12), column by
        column. `materials` are ids by slot, `visibility` the RAYS_… that do not meet them and
        whether they are holdouts."""
        slots = (c_uint64 * len(materials))(*materials)
        item = Object(encode(name), mesh, slots, len(materials), (c_float * 12)(), encode(unit),
                      *visibility, pass_index, encode(asset))
        self.library.check(self.c.kestrelSetObjects(
            self.handle, pointer(idents, uint64_p, np.uint64),
            pointer(world_from_object, float_p, np.float32), len(idents), byref(item)))

    def set_object_transforms(self, idents, world_from_object):
        """uint64 (N,), and float32 (N, 12), column by column."""
        self.library.check(self.c.kestrelSetObjectTransforms(
            self.handle, pointer(idents, uint64_p, np.uint64),
            pointer(world_from_object, float_p, np.float32), len(idents)))

    def set_object_motion(self, ident, world_from_object):
        """float32 (S, 12), as in set_object_transforms(), at even steps of time; none: it stands
        still."""
        self.library.check(self.c.kestrelSetObjectMotion(
            self.handle, ident, pointer(world_from_object, float_p, np.float32),
            len(world_from_object)))

    def set_object_setting(self, ident, name, value):
        self.library.check(self.c.kestrelSetObjectSetting(
            self.handle, ident, encode(name), encode(value)))

    def remove(self, kind, idents):
        """Remove items of a kind, ids in any sequence."""
        idents = np.asarray(idents, np.uint64)
        self.library.check(self.c.kestrelRemoveItems(
            self.handle, kind, pointer(idents, uint64_p, np.uint64), len(idents)))

    def set_camera(self, camera):
        self.library.check(self.c.kestrelSetCamera(self.handle, byref(camera)))

    def set_camera_motion(self, cameras):
        """Its states at even steps of time; ends with set_camera()."""
        self.library.check(self.c.kestrelSetCameraMotion(
            self.handle, (Camera * len(cameras))(*cameras), len(cameras)))

    def set_world(self, world):
        self.library.check(self.c.kestrelSetWorld(self.handle, byref(world)))

    def set_setting(self, name, value):
        self.library.check(self.c.kestrelSetSetting(self.handle, encode(name), encode(value)))

    def get_setting(self, name):
        value = self.c.kestrelGetSetting(self.handle, encode(name))
        if value is None:
            raise self.library.last_error()
        return value.decode()

    def commit(self):
        self.library.check(self.c.kestrelCommitScene(self.handle))

    def cancel_commit(self):
        """Let a commit() on another thread raise Cancelled, if there is one."""
        if self._handle is not None:
            self.c.kestrelCancelCommit(self._handle)

    def write(self, path, size=(0, 0)):
        """Write what was last committed to a scene file, with its arrays in `path`.bin. `size`: of
        the picture in pixels, for the kestrel command; (0, 0) leaves it open."""
        self.library.check(self.c.kestrelWriteScene(
            self.handle, path.encode("utf-8", "surrogateescape"), *size))


class Renderer:
    """Owner of a renderer handle."""

    def __init__(self, scene):
        self.library = scene.library
        self.c = scene.c
        self._handle = self.library.handle(self.c.kestrelNewRenderer(scene.handle))

    @property
    def handle(self):
        if self._handle is None:
            raise KestrelError("The renderer was freed. Start the render again.")
        return self._handle

    def release(self):
        if self._handle is not None:
            self.c.kestrelReleaseRenderer(self._handle)
            self._handle = None

    def render(self, width, height, progress):
        """Blocks. `progress(fraction, status)` is called from any thread; False cancels."""
        def forward(_user, fraction, status):
            return bool(progress(fraction, (status or b"").decode("utf-8", "replace")))
        callback = ProgressCallback(forward)
        self.library.check(self.c.kestrelRender(self.handle, width, height, callback, None))

    def cancel(self):
        self.c.kestrelCancel(self.handle)

    def passes(self):
        """Names and channels of the passes that can be read, in the library's order."""
        names = [self.c.kestrelGetPassName(self.handle, index).decode()
                 for index in range(self.c.kestrelGetPassCount(self.handle))]
        return {name: self.c.kestrelGetPassChannels(self.handle, encode(name)).decode()
                for name in names}

    def set_region(self, area):
        """Pixels (left, bottom, right, top) of the picture that the next frames have; None: all."""
        left, bottom, right, top = area or (0, 0, 0, 0)
        self.library.check(self.c.kestrelSetRegion(self.handle, left, bottom, right - left,
                                                   top - bottom))

    def set_passes(self, names):
        """Passes that the next frames keep."""
        self.library.check(self.c.kestrelSetPasses(self.handle, encode(",".join(names))))

    def read_pass(self, name, width, height):
        """float32 (height * width, channels), row 0 at the bottom: the library's own memory, which
        stays as it is until the next render."""
        channels = self.c.kestrelGetPassChannels(self.handle, encode(name))
        if channels is None:
            raise self.library.last_error()
        size = c_int(), c_int()
        self.library.check(self.c.kestrelGetFrameSize(self.handle, *map(byref, size)))
        if (size[0].value, size[1].value) != (width, height):
            raise ValueError(f"the frame has {size[0].value} x {size[1].value} pixels")
        pixels = self.c.kestrelGetPassPixels(self.handle, encode(name))
        if not pixels:
            raise self.library.last_error()
        return np.ctypeslib.as_array(pixels, (height * width, len(channels)))

    def read_so_far(self, name, pixels):
        """Copy a pass of the frame under way as far as it is into float32 `pixels`, those that are
        not there yet left alone. From any thread."""
        self.library.check(self.c.kestrelReadPassSoFar(
            self.handle, encode(name), pointer(pixels, float_p, np.float32), pixels.size))

    def cryptomatte_manifest(self, layer):
        """JSON text: the ids of the names in the last frame's passes "CryptoObject" and so on."""
        text = self.c.kestrelGetCryptomatteManifest(self.handle, encode(layer))
        if text is None:
            raise self.library.last_error()
        return text.decode()

    def stats(self):
        """JSON text about the last frame, None before the first."""
        text = self.c.kestrelGetStats(self.handle)
        return None if text is None else text.decode()
