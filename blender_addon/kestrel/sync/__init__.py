# SPDX-License-Identifier: GPL-3.0-or-later
"""From an evaluated depsgraph to the core's scene."""

from ..session import Export
from .camera import sync_camera
from .object import sync_objects
from .settings import sync_settings
from .world import sync_world


def export_depsgraph(session, depsgraph, camera, say):
    """Send everything that this depsgraph shows through `camera`, an evaluated object or None.

    Returns the (width, height) to render. `say(text)` takes warnings. Raises KestrelError; the
    session is then unfit for use.
    """
    scene = depsgraph.scene_eval
    export = Export(session, say, scene.kestrel.environment_ior)
    size = sync_camera(export, camera, scene.render)
    ambient = sync_world(export, scene.world)
    sync_settings(export, scene, ambient)
    sync_objects(export, depsgraph)
    export.finish()
    return size
