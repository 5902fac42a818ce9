# SPDX-License-Identifier: GPL-3.0-or-later
"""Installs an add-on zip into Blender's user folder, enables it and saves the preferences.

    blender -b --python-exit-code 1 --python packaging/install_addon.py -- kestrel-….zip

The same two steps as Preferences > Add-ons > Install from Disk. Which user folder that is, the
environment variables BLENDER_USER_SCRIPTS and BLENDER_USER_CONFIG say.
"""

import sys

import bpy

zip_path = sys.argv[sys.argv.index("--") + 1]
bpy.ops.preferences.addon_install(filepath=zip_path, overwrite=True)
bpy.ops.preferences.addon_enable(module="kestrel")
if "kestrel" not in bpy.context.preferences.addons:
    raise RuntimeError("the add-on 'kestrel' did not start; the reason stands above")
bpy.ops.wm.save_userpref()
