/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * Kestrel: the C interface of libkestrel.so, the only public header.
 *
 * Conventions
 * - World space is right-handed, Z up, metres. Colours are linear Rec. 709, scene-referred.
 * - Matrices are 12 floats, column-major 3x4: the images of X, Y and Z, then the translation.
 * - Pictures are row-major, row 0 at the bottom, float32.
 * - Handles are reference-counted; a child keeps its parent alive. Ids are the caller's own 64-bit
 *   names, unique per kind within a scene; 0 means none.
 * - Arrays and strings are copied during the call.
 * - Every function may be called from any thread. Calls on one scene are serialised; while a
 *   renderer renders, its scene may be edited: the frame keeps the state it began with.
 * - On failure a function returns KESTREL_ERROR_… (or NULL, 0, false) and leaves everything as it
 *   was; kestrelGetError() has the reason and a remedy. Success does not clear an earlier error.
 * - A handle that is NULL, already released or of another kind is an error, never a crash.
 *   Releasing NULL does nothing.
 * - Numbers that are not finite are errors that name the field. What has a natural range (a
 *   reflectivity, an opacity, an angle) is clamped to it, with a warning.
 */
#ifndef KESTREL_H
#define KESTREL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define KESTREL_API __attribute__((visibility("default")))

/* Changes whenever a struct or a function below changes incompatibly. */
#define KESTREL_ABI_VERSION 1

typedef enum KestrelError {
  KESTREL_ERROR_NONE = 0,
  KESTREL_ERROR_UNKNOWN = 1,
  KESTREL_ERROR_INVALID_ARGUMENT = 2,
  KESTREL_ERROR_INVALID_OPERATION = 3,
  KESTREL_ERROR_OUT_OF_MEMORY = 4,
  KESTREL_ERROR_UNSUPPORTED = 5,
  KESTREL_ERROR_CANCELLED = 6,
  KESTREL_ERROR_FILE = 7
} KestrelError;

typedef enum KestrelLogLevel {
  KESTREL_LOG_DEBUG = 0,
  KESTREL_LOG_INFO = 1,
  KESTREL_LOG_WARNING = 2,
  KESTREL_LOG_ERROR = 3
} KestrelLogLevel;

/* ---- Library -------------------------------------------------------------------------------- */

/* "0.1.0". Never NULL. */
KESTREL_API const char* kestrelGetVersion(void);

/* KESTREL_ABI_VERSION of the library; refuse to go on when it differs from the header's. */
KESTREL_API uint32_t kestrelGetAbiVersion(void);

/* The last error on this thread, and clears it. `message` (may be NULL) receives a text that stays
 * valid until the next call into Kestrel on this thread. */
KESTREL_API KestrelError kestrelGetError(const char** message);

/* Sends log messages to `callback` (NULL: to standard error), from any thread. Once this returns,
 * the callback set before is not running and is not called again; so it must not be called from
 * within a log callback. The level starts from KESTREL_LOG=debug|info|warning|error. */
typedef void (*KestrelLogCallback)(void* user, KestrelLogLevel level, const char* text);
KESTREL_API void kestrelSetLogCallback(KestrelLogCallback callback, void* user);
KESTREL_API void kestrelSetLogLevel(KestrelLogLevel level);

/* The parameter table as a JSON array: name, scope ("scene", "object"), type, default, min, max,
 * items, unit, paper, help. Never NULL. */
KESTREL_API const char* kestrelGetParameterTable(void);

/* Fingerprint of bytes, to tell whether content has changed: the same bytes give the same 128 bits.
 * `hash` (two numbers) holds what came before, {0, 0} at first, and receives the fingerprint of
 * that with these bytes added. No protection against contents made to collide. */
KESTREL_API KestrelError kestrelHash(const void* data, size_t byte_count, uint64_t hash[2]);

/* ---- Device: the machine --------------------------------------------------------------------- */

typedef struct KestrelDeviceImpl* KestrelDevice;

/* Never needs a display or a GPU; OpenGL is started when first used. */
KESTREL_API KestrelDevice kestrelNewDevice(void);
KESTREL_API void kestrelRetainDevice(KestrelDevice device);
KESTREL_API void kestrelReleaseDevice(KestrelDevice device);

/* JSON: versions of Kestrel, Embree, the image plug-in; threads; the GL device ("gl": null with
 * "gl_error" where there is none). Starts OpenGL. The text lives as long as the device. */
KESTREL_API const char* kestrelGetDeviceInfo(KestrelDevice device);

/* ---- Scene ----------------------------------------------------------------------------------- */

typedef struct KestrelSceneImpl* KestrelScene;

/* Edits gather until kestrelCommitScene(), which checks the whole and makes it what renderers see.
 * A Set call with a known id replaces that item. Items keep the order in which their ids were
 * first set, but lights are in that of their ids; units in that of their first object. */
KESTREL_API KestrelScene kestrelNewScene(KestrelDevice device);
KESTREL_API void kestrelRetainScene(KestrelScene scene);
KESTREL_API void kestrelReleaseScene(KestrelScene scene);

/* Values at the corners for materials that ask for them by id. */
typedef struct KestrelMeshAttribute {
  uint64_t id;         /* not 0; one of each kind per mesh: of equal ones the first counts */
  int32_t channels;    /* 2: a UV map, 3: linear colours */
  const float* values; /* `channels` per corner */
} KestrelMeshAttribute;

typedef struct KestrelMesh {
  const char* name;
  size_t vertex_count;
  const float* positions; /* 3 per vertex, object space */
  size_t triangle_count;
  const uint32_t* triangles;          /* 3 vertex indices per triangle */
  const float* corner_normals;        /* 3 per corner (9 per triangle), or NULL: flat faces */
  const float* corner_uvs;            /* 2 per corner, or NULL: (0, 0) */
  const float* corner_tangents;       /* 4 per corner: xyz, sign of the bitangent; or NULL: made
                                         from the UVs where a normal map needs them */
  const uint32_t* triangle_materials; /* object slot per triangle, 0…65535, or NULL: 0 */
  size_t motion_count;                /* shapes at even steps of time, 2…129; 0: keeps its shape.
                                         What the steps are says kestrelSetObjectMotion() */
  const float* motion_positions;      /* as `positions`, shape after shape */
  const float* motion_corner_normals; /* as `corner_normals`, likewise; NULL: flat, or as those */
  uint64_t uv_map; /* id by which materials may also ask for corner_uvs; 0: none */
  size_t attribute_count;
  const KestrelMeshAttribute* attributes; /* further UV maps, and colours */
} KestrelMesh;

/* At most 2^29 vertices and as many triangles; none is fine. Index out of range: error. Triangles
 * with a vertex that is not finite, or with no area, are left out with a warning; normals that are
 * not finite or zero become the face's. */
KESTREL_API KestrelError kestrelSetMesh(KestrelScene scene, uint64_t id, const KestrelMesh* mesh);

typedef enum KestrelExtension {
  KESTREL_EXTENSION_REPEAT = 0,
  KESTREL_EXTENSION_CLAMP = 1, /* the edge's texels go on */
  KESTREL_EXTENSION_CLIP = 2   /* transparent black outside */
} KestrelExtension;

typedef struct KestrelTextureOptions {
  const char* name;  /* for messages; may be NULL */
  bool srgb;         /* 8-bit texels, and 16-bit ones of files, are sRGB-encoded colour */
  bool nearest;      /* no interpolation */
  int32_t extension; /* KestrelExtension */
} KestrelTextureOptions;

/* An image file, at most 32768 pixels a side. It is read at the first commit in which a material
 * or the world uses it (many in parallel), through the image plug-in. A file that is missing or
 * unreadable becomes magenta, with one warning. */
KESTREL_API KestrelError kestrelSetTextureFile(KestrelScene scene, uint64_t id, const char* path,
                                               const KestrelTextureOptions* options);
/* The same from the bytes of an image file. */
KESTREL_API KestrelError kestrelSetTextureMemory(KestrelScene scene, uint64_t id, const void* data,
                                                 size_t byte_count,
                                                 const KestrelTextureOptions* options);
/* RGBA, straight alpha, row 0 at the bottom, 1…32768 pixels a side; 8-bit (srgb decides) or float
 * (linear). */
KESTREL_API KestrelError kestrelSetTexturePixels8(KestrelScene scene, uint64_t id, int width,
                                                  int height, const uint8_t* rgba,
                                                  const KestrelTextureOptions* options);
KESTREL_API KestrelError kestrelSetTexturePixelsFloat(KestrelScene scene, uint64_t id, int width,
                                                      int height, const float* rgba,
                                                      const KestrelTextureOptions* options);

typedef enum KestrelAlphaMode {
  KESTREL_ALPHA_OPAQUE = 0, /* diffuse alpha is ignored */
  KESTREL_ALPHA_MASK = 1,   /* below the cutoff there is no surface */
  KESTREL_ALPHA_BLEND = 2   /* alpha is coverage */
} KestrelAlphaMode;

/* Each property is its colour times its texture (0: none). Start from kestrelDefaultMaterial(). */
typedef struct KestrelMaterial {
  const char* name;
  float emission[3];
  float ambient[3];
  float diffuse[4];            /* A: alpha */
  float specular[4];           /* A: 0 = exponent 1, 1 = exponent 255, linear between */
  float optical[3];            /* reflectivity 0…1, index of refraction, opacity 0…1 */
  float reflection_color[3];   /* tints what is reflected */
  float transmission_color[3]; /* tints what shines through */
  uint64_t emission_texture;
  uint64_t ambient_texture;
  uint64_t diffuse_texture; /* its alpha multiplies the diffuse alpha */
  uint64_t specular_texture;
  uint64_t normal_texture; /* tangent space, +Y up; load it with srgb = false */
  uint64_t optical_texture;
  float normal_strength; /* 1: as painted, 0: no effect */
  float tiling[2];       /* uv' = offset + uv * tiling */
  float offset[2];
  bool casts_shadow;
  int32_t alpha_mode; /* KestrelAlphaMode */
  float alpha_cutoff; /* 0…1, for KESTREL_ALPHA_MASK */
  int32_t pass_index; /* for the pass MaterialIndex */
  /* What the mesh brings, by id. UV maps: of each texture above, in their order, 0 being the
   * mesh's corner_uvs; (0, 0) where the mesh has no such map. */
  uint64_t uv_maps[6];
  uint64_t tangent_map;        /* UV map along which the normal map lies */
  uint64_t emission_attribute; /* colours that multiply; 0: none; black where the mesh has none */
  uint64_t ambient_attribute;
  uint64_t diffuse_attribute;
} KestrelMaterial;

/* Grey, matte, opaque: diffuse and ambient 0.8, no specular, index of refraction 1. */
KESTREL_API void kestrelDefaultMaterial(KestrelMaterial* material);
KESTREL_API KestrelError kestrelSetMaterial(KestrelScene scene, uint64_t id,
                                            const KestrelMaterial* material);

typedef enum KestrelLightType {
  KESTREL_LIGHT_DIRECTIONAL = 0,
  KESTREL_LIGHT_POINT = 1,
  KESTREL_LIGHT_SPOT = 2
} KestrelLightType;

typedef struct KestrelLight {
  const char* name;
  int32_t type;          /* KestrelLightType */
  float color[3];        /* radiance that a white Lambert surface facing the light reflects; for
                            point and spot at 1 m */
  float position[3];     /* point, spot */
  float direction[3];    /* the way the light travels; directional, spot; need not be unit */
  float attenuation[3];  /* 1 / (a + b d + c d²); {0, 0, 1} is physical */
  float spot_angle;      /* full angle of the cone, radians, 0…π */
  float spot_blend;      /* 0 hard edge … 1 soft all the way in */
  float spot_exponent;   /* >= 0: within the cone, light falls off with this power of the cosine to
                            its axis; 0: not at all */
  float specular_factor; /* scales highlights only */
  bool casts_shadow;
} KestrelLight;

/* White point light at the origin, physical attenuation, casting shadows. */
KESTREL_API void kestrelDefaultLight(KestrelLight* light);
KESTREL_API KestrelError kestrelSetLight(KestrelScene scene, uint64_t id,
                                         const KestrelLight* light);

/* Kinds of rays, as bits. */
typedef enum KestrelRays {
  KESTREL_RAYS_CAMERA = 1, /* rasterised pictures and primary rays, also where they go on straight
                              through alpha */
  KESTREL_RAYS_SHADOW = 2,
  KESTREL_RAYS_REFLECTION = 4,
  KESTREL_RAYS_REFRACTION = 8
} KestrelRays;

typedef struct KestrelObject {
  const char* name;
  uint64_t mesh;
  const uint64_t* materials; /* by slot; 0 entries and missing slots: the default grey */
  size_t material_count;
  float world_from_object[12];
  const char* unit;     /* objects of one unit are selected together; NULL: its own name */
  uint32_t hidden_from; /* KestrelRays that do not meet the object; 0: all meet it */
  bool holdout;         /* where the camera sees it, the picture is black with an alpha of 0 */
  int32_t pass_index;   /* for the pass ObjectIndex */
  const char* asset;    /* what it is a part of, for Cryptomatte; NULL: its own name */
} KestrelObject;

/* An object whose mesh has no triangles, or whose matrix has no inverse (a scale of zero), is not
 * rendered. Ids of mesh and materials are looked up at the commit. */

KESTREL_API KestrelError kestrelSetObject(KestrelScene scene, uint64_t id,
                                          const KestrelObject* object);

/* kestrelSetObject() of `count` objects that differ in their ids and places alone: 12 floats each,
 * which stand in for the object's own. An error leaves those before it set. */
KESTREL_API KestrelError kestrelSetObjects(KestrelScene scene, const uint64_t* ids,
                                           const float* world_from_object, size_t count,
                                           const KestrelObject* object);

/* Moves an object without sending it again. */
KESTREL_API KestrelError kestrelSetObjectTransform(KestrelScene scene, uint64_t id,
                                                   const float world_from_object[12]);

/* The same of `count` objects, 12 floats each. An error leaves those before it moved. */
KESTREL_API KestrelError kestrelSetObjectTransforms(KestrelScene scene, const uint64_t* ids,
                                                    const float* world_from_object, size_t count);

/* How an object moves: its matrices, 12 floats each, at `count` even steps of time (2…129; 0: it
 * stands still, as at first). With the setting `motion_blur` the steps begin where the shutter
 * opens and end where it closes. Without, the first and the last are the object's places in the
 * frames before and after, and only the pass Vector looks at them. The motion outlives
 * kestrelSetObject() and goes with the object. */
KESTREL_API KestrelError kestrelSetObjectMotion(KestrelScene scene, uint64_t id,
                                                const float* world_from_object, size_t count);

/* A setting of the object's unit, by the table's names: relevance, cost, shadows … Of several
 * objects of a unit the last call decides. It outlives kestrelSetObject() and goes with the object;
 * an unknown id is an error. */
KESTREL_API KestrelError kestrelSetObjectSetting(KestrelScene scene, uint64_t id, const char* name,
                                                 const char* value);

typedef enum KestrelKind {
  KESTREL_KIND_MESH = 0,
  KESTREL_KIND_TEXTURE = 1,
  KESTREL_KIND_MATERIAL = 2,
  KESTREL_KIND_LIGHT = 3,
  KESTREL_KIND_OBJECT = 4
} KestrelKind;

/* Removes one item; an unknown id is an error. What still refers to it fails the next
 * commit. */
KESTREL_API KestrelError kestrelRemove(KestrelScene scene, KestrelKind kind, uint64_t id);

/* The same of `count` items of a kind. An error leaves those before it removed. */
KESTREL_API KestrelError kestrelRemoveItems(KestrelScene scene, KestrelKind kind,
                                            const uint64_t* ids, size_t count);

typedef enum KestrelProjection {
  KESTREL_PERSPECTIVE = 0,
  KESTREL_ORTHOGRAPHIC = 1
} KestrelProjection;

/* Looks along its -Z, +Y up. The window is the part of the plane z = -1 that the picture shows
 * (perspective, ratios) or of any plane across the view (orthographic, metres). */
typedef struct KestrelCamera {
  int32_t projection;          /* KestrelProjection */
  float world_from_camera[12]; /* its scale is ignored */
  float left, right, bottom, top;
  float near_clip, far_clip; /* metres; 0 < near < far (orthographic: near < far) */
  float aperture_radius;     /* metres; 0: a pinhole, everything is in focus */
  float focus_distance;      /* metres along the view to the plane in focus */
  int32_t aperture_blades;   /* corners of the aperture; below 3: round */
  float aperture_rotation;   /* radians, anticlockwise */
  float aperture_ratio;      /* its height over its width; 0: 1 */
} KestrelCamera;

/* With an aperture every sample looks through another point of it. A frame of one sample within a
 * budget has a pinhole. */

KESTREL_API KestrelError kestrelSetCamera(KestrelScene scene, const KestrelCamera* camera);

/* How the camera moves: its states at `count` even steps of time (2…129), as those of
 * kestrelSetObjectMotion(). All must have the camera's projection. Ends with kestrelSetCamera(). */
KESTREL_API KestrelError kestrelSetCameraMotion(KestrelScene scene, const KestrelCamera* states,
                                                size_t count);

typedef enum KestrelWorldKind {
  KESTREL_WORLD_COLOR = 0,
  KESTREL_WORLD_EQUIRECTANGULAR = 1, /* textures[0]; u = 0.5 - atan2(y, x) / 2 pi,
                                        v = 0.5 + asin(z) / pi of the direction, as in Blender */
  KESTREL_WORLD_CUBE = 2             /* textures +X -X +Y -Y +Z -Z, with GL's face axes */
} KestrelWorldKind;

typedef struct KestrelWorld {
  int32_t kind;            /* KestrelWorldKind */
  float color[3];          /* radiance; factor on the textures */
  uint64_t textures[6];    /* every one that the kind reads must be given */
  float map_from_world[9]; /* column-major 3x3 rotation applied to directions before the lookup */
  float mist_start;        /* metres: the pass Mist is 0 up to here, */
  float mist_depth;        /* and 1 so many metres further on; 0: 0 on every surface */
  float mist_falloff;      /* power of what lies between; 0 as 1: linear */
} KestrelWorld;

KESTREL_API KestrelError kestrelSetWorld(KestrelScene scene, const KestrelWorld* world);

/* A setting by its name in the table; values as text. */
KESTREL_API KestrelError kestrelSetSetting(KestrelScene scene, const char* name, const char* value);
/* The value as text, or NULL. Valid until the next call on this thread. */
KESTREL_API const char* kestrelGetSetting(KestrelScene scene, const char* name);

/* Checks everything and publishes it to the scene's renderers: all or nothing. Needs a camera;
 * objects, lights and a world may be missing. What did not change is shared with the state
 * published before, so that renderers upload and build nothing twice. */
KESTREL_API KestrelError kestrelCommitScene(KestrelScene scene);

/* Makes a running kestrelCommitScene() return KESTREL_ERROR_CANCELLED soon, at the latest when the
 * textures that are just being decoded are done; what was published stays. From any thread. */
KESTREL_API void kestrelCancelCommit(KestrelScene scene);

/* Writes the scene of the last commit to a scene file that the kestrel command renders: `path`, and
 * beside it `path`.bin with the arrays. Image files are named, not copied. What the commit renders
 * is kept to the bit, in order of the ids of objects and lights: the same content gives the same
 * bytes, however it came about. `width` x `height` is the size at which the command renders it
 * unless told otherwise; 0 x 0: the file does not say. Each file appears whole or not at all. */
KESTREL_API KestrelError kestrelWriteScene(KestrelScene scene, const char* path, int width,
                                           int height);

/* ---- Rendering ------------------------------------------------------------------------------- */

typedef struct KestrelRendererImpl* KestrelRenderer;

/* A renderer keeps what frames share: acceleration structures, what was selected, costs learned. */
KESTREL_API KestrelRenderer kestrelNewRenderer(KestrelScene scene);
KESTREL_API void kestrelRetainRenderer(KestrelRenderer renderer);
KESTREL_API void kestrelReleaseRenderer(KestrelRenderer renderer);

/* Called now and then from a rendering thread; `fraction` 0…1. Return false to cancel. */
typedef bool (*KestrelProgressCallback)(void* user, float fraction, const char* status);

/* Passes that the next frames keep: names separated by commas, or "all", as at first: all but
 * Cryptomatte beyond its third pass of a kind. Each takes memory of the picture's size; those left
 * out cannot be read. A Cryptomatte pass keeps those before it too. An unknown name is an error. */
KESTREL_API KestrelError kestrelSetPasses(KestrelRenderer renderer, const char* passes);

/* What the next frames render of their pictures, in pixels from the lower left corner: a frame and
 * its passes then have this size, and with `primary` = rays the very bits that the whole picture
 * has there. 0 x 0: all, as at first. kestrelRender() refuses what lies outside of its picture. */
KESTREL_API KestrelError kestrelSetRegion(KestrelRenderer renderer, int x, int y, int width,
                                          int height);

/* Renders one frame of the committed scene, `width` x `height` pixels (1…65536). Blocks. While it
 * runs, another kestrelRender() of the same renderer, and reading its passes, size or statistics,
 * fail with KESTREL_ERROR_INVALID_OPERATION (waiting could never end in a progress callback). It
 * waits for others that are just reading the last frame. After an error or a cancel the last whole
 * frame stays readable. */
KESTREL_API KestrelError kestrelRender(KestrelRenderer renderer, int width, int height,
                                       KestrelProgressCallback progress, void* user);

/* Copies a pass of the frame under way as far as it is, of the last frame where none is, or of a
 * cancelled one what it had: averages over the samples so far. Pixels that have none yet stay as
 * they are in `pixels`, width * height * channels floats of the frame. From
 * any thread, also in a progress callback; the frame's threads hardly wait for it. Passes that are
 * not averaged (Depth, ids …) are there after the first sample. An error before the first frame. */
KESTREL_API KestrelError kestrelReadPassSoFar(KestrelRenderer renderer, const char* name,
                                              float* pixels, size_t float_count);

/* Makes a running kestrelRender() return KESTREL_ERROR_CANCELLED soon. From any thread. */
KESTREL_API void kestrelCancel(KestrelRenderer renderer);

/* Size in pixels of the last whole frame; an error before the first one. */
KESTREL_API KestrelError kestrelGetFrameSize(KestrelRenderer renderer, int* width, int* height);

/* Passes of every frame, in a fixed order. Channels are one letter each ("RGBA", "XYZ", "Z"). */
KESTREL_API size_t kestrelGetPassCount(KestrelRenderer renderer);
KESTREL_API const char* kestrelGetPassName(KestrelRenderer renderer, size_t index);
KESTREL_API const char* kestrelGetPassChannels(KestrelRenderer renderer, const char* name);

/* Copies a pass, channels interleaved: `float_count` must be width * height * channels. */
KESTREL_API KestrelError kestrelReadPass(KestrelRenderer renderer, const char* name, float* pixels,
                                         size_t float_count);

/* The same without a copy: width * height * channels floats that stay as they are until the next
 * kestrelRender() on this renderer, or its release. NULL on failure. */
KESTREL_API const float* kestrelGetPassPixels(KestrelRenderer renderer, const char* name);

/* The number that Cryptomatte makes of a name: MurmurHash3 for 32 bits. 0 for NULL. */
KESTREL_API uint32_t kestrelGetCryptomatteHash(const char* name);

/* Cryptomatte of the last frame: the names that the passes of a `layer` ("CryptoObject",
 * "CryptoMaterial", "CryptoAsset") tell apart, as a JSON object of the ids' eight hexadecimal
 * digits by name. Valid until the next call on this thread. NULL where the frame kept none of its
 * passes. */
KESTREL_API const char* kestrelGetCryptomatteManifest(KestrelRenderer renderer, const char* layer);

/* Times, rays and what was selected in the last frame, as the JSON of one entry of "frames".
 * Valid until the next call on this thread. NULL before the first frame. */
KESTREL_API const char* kestrelGetStats(KestrelRenderer renderer);

/* Writes passes ("Combined,Depth", or "all" that the frame kept) to `path`: .exr linear with one
 * layer a pass, and Cryptomatte's metadata, .png the first of them in sRGB. The file appears whole
 * or not at all. Needs the image plug-in. */
KESTREL_API KestrelError kestrelWriteImage(KestrelRenderer renderer, const char* path,
                                           const char* passes);

#ifdef __cplusplus
}
#endif

#endif /* KESTREL_H */
