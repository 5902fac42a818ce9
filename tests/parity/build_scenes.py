# SPDX-License-Identifier: GPL-3.0-or-later
"""Write the parity cases as .blend files (images packed) and a list of them, `cases.json`.

    blender -b --factory-startup --python tests/parity/build_scenes.py -- --out DIR [NAME...]

The files select KESTREL where the add-on is enabled (Blender's `--addons kestrel`), else CYCLES.
"""

import argparse
import json
import os
import sys
from pathlib import Path

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import bpy
import cases
import scenes


def parse_args():
    parser = argparse.ArgumentParser(prog="build_scenes.py")
    parser.add_argument("--out", required=True, type=Path, metavar="DIR")
    parser.add_argument("names", nargs="*", help="cases (all by default)")
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else [])


def main():
    args = parse_args()
    folder = args.out.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    bpy.context.preferences.filepaths.save_version = 0
    listed = []
    for case in [cases.find_case(name) for name in args.names] or cases.CASES:
        scenes.build(case)
        path = folder / f"{case.name}.blend"
        bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=True, copy=True)
        listed.append({**case._asdict(), "blend": path.name,
                       "reference": str(cases.reference_path(case.name))})
    (folder / "cases.json").write_text(json.dumps(listed, indent=1) + "\n", encoding="utf-8")
    print(f"wrote {len(listed)} scenes and cases.json to {folder}", flush=True)


main()
