# SPDX-License-Identifier: GPL-3.0-or-later
"""From an evaluated depsgraph to the core's scene."""

from ..session import Export
from .camera import sync_camera
from .changes import moved_objects, sync_moved, touched_geometry
from .object import sync_objects
from .settings import sync_settings
from .world import sync_world

# What a viewport decides from frame to frame.
VIEWPORT_SETTINGS = ("budget_ms", "samples", "first_sample")


def export_depsgraph(session, depsgraph, camera, say, settings=None, check=None, commit=None):
    """Send everything that this depsgraph shows through `camera`, an evaluated object or None.

    `settings`, as {name: text}, take the place of the scene's own. Returns the camera.Picture to
    render. `say(text)` takes warnings. Raises KestrelError; the session is then unfit for use,
    unless it was Cancelled: `check()` is called between items and may raise that. `commit()` takes
    the place of the session's.
    """
    scene = depsgraph.scene_eval
    export = Export(session, say, scene.kestrel.environment_ior, check=check)
    picture = sync_camera(export, camera, scene.render)
    ambient = sync_world(export, scene.world)
    sync_settings(export, scene, depsgraph.view_layer_eval, ambient)
    for name, value in (settings or {}).items():
        export.scene.set_setting(name, value)
    sync_objects(export, depsgraph)
    export.finish()
    (commit or session.commit)()
    return picture


def export_viewport(session, depsgraph, space, say, everything=True, other_objects=True):
    """Send what a 3D view (`space`) shows, but for the camera and without a commit.

    `everything`: whether more may have changed since the last time than the depsgraph says;
    `other_objects`: whether the view may show others. Raises KestrelError; the session is then
    unfit for use.
    """
    scene = depsgraph.scene_eval
    touched = None if everything else touched_geometry(depsgraph)
    export = Export(session, say, scene.kestrel.environment_ior, touched)
    if not (everything or other_objects):
        moved = moved_objects(depsgraph, session.objects.entangled)
        if moved is not None:
            sync_moved(export, moved)
            return
    ambient = sync_world(export, scene.world)
    sync_settings(export, scene, depsgraph.view_layer_eval, ambient, VIEWPORT_SETTINGS)
    sync_objects(export, depsgraph, lambda obj: obj.visible_in_viewport_get(space))
    export.finish()
