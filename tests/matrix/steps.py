# SPDX-License-Identifier: GPL-3.0-or-later
"""What packaging/matrix.py does inside each Blender, one step a process.

    blender -b FILE.blend --python-exit-code 1 --python tests/matrix/steps.py -- STEP MODULE FOLDER [ZIP]

MODULE is the add-on's in this Blender (`kestrel`, or `bl_ext.user_default.kestrel` for an extension).
Results go to FOLDER and to lines `step: ...`. A step that finds a fault raises.
"""

import faulthandler
import importlib
import shutil
import sys
from pathlib import Path

import addon_utils
import bpy

sys.path[:0] = [str(Path(__file__).resolve().parents[1] / "parity"),
                str(Path(__file__).resolve().parents[2] / "packaging")]
import exr
import install_addon

STEP, MODULE, FOLDER, *REST = sys.argv[sys.argv.index("--") + 1:]
FOLDER = Path(FOLDER)
SMALL_PX = (160, 90)
# May hold one value everywhere in the showcase.
PLAIN = ("Emission", "Specular", "Ambient", "HeuristicMask", "UV", "Vector")


def tell(text):
    print(f"step: {text}", flush=True)


def expect(condition, text):
    if not condition:
        raise RuntimeError(f"{STEP}: {text}")


def part(name):
    """A module of the add-on."""
    return importlib.import_module(f"{MODULE}.{name}")


def engine_owner():
    """Module that the registered engine KESTREL comes from; empty when there is none."""
    return next((kind.__module__.rpartition(".")[0]
                 for kind in bpy.types.RenderEngine.__subclasses__()
                 if getattr(kind, "bl_idname", "") == "KESTREL" and kind.is_registered), "")


def use_format(file_format, **values):
    settings = bpy.context.scene.render.image_settings
    if hasattr(settings, "media_type"):  # 5.0 on
        settings.media_type = ("MULTI_LAYER_IMAGE" if "MULTILAYER" in file_format else "IMAGE")
    if hasattr(settings, "use_exr_interleave"):
        settings.use_exr_interleave = True  # all layers in one part, as before 5.0
    settings.file_format = file_format
    for name, value in values.items():
        setattr(settings, name, value)


def make_small():
    scene = bpy.context.scene
    scene.render.engine = "KESTREL"
    scene.render.resolution_x, scene.render.resolution_y = SMALL_PX
    scene.render.resolution_percentage = 100
    scene.kestrel.samples = 1
    scene.kestrel.primary = "rays"  # "auto" takes the faster, which may change from frame to frame


def render_small():
    """Render one small picture; returns its pixels, height x width x 3, linear."""
    make_small()
    return render_as_it_is()


def render_as_it_is():
    use_format("OPEN_EXR", color_mode="RGB", color_depth="32", exr_codec="ZIP")
    path = FOLDER / f"{STEP}.exr"
    path.unlink(missing_ok=True)
    bpy.context.scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    return exr.read(path)


# ---- steps -----------------------------------------------------------------------------------

def animation():
    """Three frames of a camera that moves."""
    make_small()
    scene = bpy.context.scene
    for frame in (1, 3):
        scene.camera.keyframe_insert("location", frame=frame)
        scene.camera.location.x += 0.5
    scene.frame_start, scene.frame_end = 1, 3
    use_format("OPEN_EXR", color_mode="RGB", color_depth="32", exr_codec="ZIP")
    scene.render.filepath = str(FOLDER / "animation_####")
    bpy.ops.render.render(animation=True)
    pictures = [exr.read(FOLDER / f"animation_{frame:04}.exr") for frame in (1, 2, 3)]
    for before, after in zip(pictures, pictures[1:]):
        expect(abs(before - after).mean() > 1e-3, "two frames are the same")
    tell("3 frames, each of them another picture")


def passes():
    """Every pass that Kestrel has, in one multilayer file."""
    make_small()
    layer, table = bpy.context.view_layer, part("passes")
    for item in table.PASSES:
        if item.toggle:
            setattr(layer, item.toggle, True)
    layer.kestrel.passes = {item.name for item in table.OPTIONAL}
    for collection in (bpy.data.objects, bpy.data.materials):
        for index, item in enumerate(collection):
            item.pass_index = index
    use_format("OPEN_EXR_MULTILAYER", color_mode="RGBA", color_depth="32", exr_codec="ZIP")
    path = FOLDER / "passes.exr"
    bpy.context.scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    data = path.read_bytes()
    attributes, offset = exr.read_header(data)
    planes = exr.read_planes(data, offset, attributes)
    wanted = []
    for item in table.enabled(layer):
        name = part("compat").pass_name(bpy.context.scene, item.blender_name)
        wanted.append(name)
        channels = [plane for channel, plane in planes.items() if f".{name}." in channel]
        expect(channels, f"the pass {name} is not in the file")
        expect(item.name in PLAIN or item.depth > 0
               or any(plane.max() > plane.min() for plane in channels),
               f"the pass {name} has one value everywhere")
    tell(f"{len(wanted)} passes: {', '.join(wanted)}")


def bindings():
    """Renders by rays and by the rasteriser; the caller traces what is bound meanwhile."""
    render_small()
    bpy.context.scene.kestrel.primary = "raster"
    render_small()
    tell(f"library {part('native.loader').library_path()}")


def rivals():
    """A second Kestrel beside the first one says so and does nothing."""
    before = render_small()
    if MODULE == install_addon.EXTENSION:
        second = install_addon.ADD_ON
        bpy.ops.preferences.addon_install(filepath=REST[0], overwrite=True)
    else:
        second = "kestrel_old"
        addons = Path(bpy.utils.user_resource("SCRIPTS", path="addons"))
        shutil.copytree(addons / MODULE, addons / second)
        addon_utils.modules_refresh()
    try:
        check_second(second, before)
    finally:
        addon_utils.disable(second, default_set=True)
        shutil.rmtree(Path(bpy.utils.user_resource("SCRIPTS", path="addons")) / second)
    tell(f"{second} stood back for {MODULE}")


def same(picture, other):
    """Up to rounding: Blender 3.4 adds up vertex normals in whatever order its threads come."""
    return abs(picture - other).max() < 1e-4


def check_second(second, before):
    addon_utils.enable(second, default_set=True)
    module = sys.modules[second]
    expect("Two Kestrels at once" in sys.modules[f"{second}.rivals"]._text,
           "the second Kestrel says nothing")
    expect(engine_owner() == MODULE, f"the engine is {engine_owner()}'s now")
    expect(same(render_small(), before), "the picture changed")
    # Nor does it take over later in this process, where the first one's library is still loaded.
    addon_utils.disable(MODULE)
    addon_utils.disable(second)
    addon_utils.enable(second)
    expect("Two Kestrels at once" in module.loader.error(),
           f"a second library was loaded: {module.loader.error()}")
    addon_utils.disable(second)
    addon_utils.enable(MODULE)
    expect(same(render_small(), before), "the picture changed after enabling again")


def update():
    """The zip of a newer version installed over the one that has just rendered."""
    bpy.context.scene.kestrel.max_depth = 4
    bpy.context.scene.objects[0].kestrel.relevance = 3.0
    render_small()
    bpy.ops.wm.save_as_mainfile(filepath=str(FOLDER / "before_update.blend"))
    install_addon.install(REST[0], MODULE == install_addon.EXTENSION)
    loader = part("native.loader")
    expect("restart Blender" in loader.error(), f"no word of a restart: {loader.error()!r}")
    expect(engine_owner() == MODULE, "there is no engine after the update")
    try:
        bpy.ops.render.render()
    except RuntimeError as error:
        expect("restart Blender" in str(error), f"the render says: {error}")
    else:
        expect(False, "the render said nothing")
    # As someone would who saves the work before the restart.
    bpy.ops.wm.save_as_mainfile(filepath=str(FOLDER / "after_update.blend"))
    bpy.ops.wm.save_userpref()
    tell(loader.error())
    sys.exit(0)  # Blender's own way out would report the render that failed


def after_update():
    """The same scene in a new Blender: the new version renders it, with the settings as they were."""
    expect(bpy.context.preferences.addons.get(MODULE), "the add-on is not enabled any more")
    for name in ("before_update.blend", "after_update.blend"):
        bpy.ops.wm.open_mainfile(filepath=str(FOLDER / name))
        scene = bpy.context.scene
        expect(scene.kestrel.max_depth == 4, f"{name}: max_depth is {scene.kestrel.max_depth}")
        expect(scene.objects[0].kestrel.relevance == 3.0, f"{name}: the relevance is gone")
        expect(render_small().max() > 0, "the picture is black")
    folder = Path(sys.modules[MODULE].__file__).parent
    expect('version = "0.1.1"' in (folder / "blender_manifest.toml").read_text(),
           "the files are the old version's")
    tell("settings kept")


def disable():
    """Disabled, nothing of Kestrel is left; its scenes still open."""
    render_small()
    addon_utils.disable(MODULE, default_set=True)
    expect(engine_owner() == "", "the engine is still there")
    expect(not hasattr(bpy.types.Scene, "kestrel"), "the settings are still there")
    bpy.ops.wm.open_mainfile(filepath=bpy.data.filepath)
    expect(bpy.context.scene.render.engine != "KESTREL", "the scene still has the engine")
    bpy.ops.wm.save_userpref()
    tell("disabled")


def remove():
    """Uninstalled in the Blender that has rendered with it."""
    addon_utils.enable(MODULE, default_set=True)
    render_small()
    folder = Path(sys.modules[MODULE].__file__).parent
    if MODULE == install_addon.EXTENSION:
        repositories = bpy.context.preferences.extensions.repos
        bpy.ops.extensions.package_uninstall(
            repo_index=repositories.find("User Default"), pkg_id="kestrel")
    else:
        # The operator redraws an area, which there is none of in background: its two steps.
        addon_utils.disable(MODULE, default_set=True)
        shutil.rmtree(folder)
    expect(not (folder / "__init__.py").exists(), f"{folder} is still there")
    expect(engine_owner() == "", "the engine is still there")
    tell("removed")


if __name__ == "__main__":
    faulthandler.enable(file=sys.stdout)
    globals()[STEP]()
