# SPDX-License-Identifier: GPL-3.0-or-later
"""Installs Kestrel's zip into Blender's user folder, enables it and saves the preferences.

    blender -b --python-exit-code 1 --python packaging/install_addon.py -- kestrel-….zip [--add-on]

The same steps as Install from Disk in the preferences: as an extension in Blender 4.2 and later, else
(or with --add-on) as an add-on. Which user folder that is, the environment variables
BLENDER_USER_SCRIPTS, BLENDER_USER_CONFIG and BLENDER_USER_EXTENSIONS say. Prints `installed: MODULE`.
"""

import sys

import bpy

EXTENSION = "bl_ext.user_default.kestrel"
ADD_ON = "kestrel"


def install(zip_path, as_extension):
    """Install and enable; returns the module's name."""
    if as_extension:
        bpy.ops.extensions.package_install_files(filepath=zip_path, repo="user_default",
                                                 enable_on_install=True)
        return EXTENSION
    bpy.ops.preferences.addon_install(filepath=zip_path, overwrite=True)
    bpy.ops.preferences.addon_enable(module=ADD_ON)
    return ADD_ON


def main():
    arguments = sys.argv[sys.argv.index("--") + 1:]
    module = install(arguments[0], "--add-on" not in arguments and bpy.app.version >= (4, 2, 0))
    if module not in bpy.context.preferences.addons or "KESTREL" not in [
            getattr(kind, "bl_idname", "") for kind in bpy.types.RenderEngine.__subclasses__()]:
        raise RuntimeError(f"'{module}' did not start; the reason stands above")
    bpy.ops.wm.save_userpref()
    print(f"installed: {module}", flush=True)


if __name__ == "__main__":
    main()
