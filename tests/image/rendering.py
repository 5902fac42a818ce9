# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders image cases with the kestrel command."""

import json
import os
import subprocess
import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
SCENES = FOLDER / "scenes"
REFERENCES = FOLDER.parent / "references" / "image"
TIMEOUT_S = 300
FILE_KEYS = ("file", "import", "image", "cube")

sys.path.insert(0, str(FOLDER.parent / "parity"))
import exr


def merge_patch(target, patch):
    """JSON merge patch (RFC 7396)."""
    if not isinstance(patch, dict):
        return patch
    merged = dict(target) if isinstance(target, dict) else {}
    for key, value in patch.items():
        if value is None:
            merged.pop(key, None)
        else:
            merged[key] = merge_patch(merged.get(key), value)
    return merged


def write_scene(case, work):
    """The case's scene file with its patch; names of files are made absolute, so it may lie
    anywhere."""
    scene = json.loads((SCENES / f"{case.scene}.kscene").read_text(encoding="utf-8"))
    path = work / f"{case.name}.kscene"
    path.write_text(json.dumps(absolute_files(merge_patch(scene, case.patch)), indent=1),
                    encoding="utf-8")
    return path


def absolute_files(node, names_file=False):
    """A copy in which what FILE_KEYS hold, names or lists of names, are absolute paths."""
    if isinstance(node, dict):
        return {key: absolute_files(value, key in FILE_KEYS) for key, value in node.items()}
    if isinstance(node, list):
        return [absolute_files(value, names_file) for value in node]
    return str(SCENES / node) if names_file and isinstance(node, str) else node


def run_command(build, *arguments):
    """Run build/kestrel; raises RuntimeError with its messages where it fails."""
    command = [str(Path(build) / "kestrel"), *map(str, arguments)]
    run = subprocess.run(command, capture_output=True, text=True, timeout=TIMEOUT_S,
                         env={**os.environ, "KESTREL_LOG": "warning"})
    if run.returncode:
        raise RuntimeError(f"{' '.join(command)} ended with {run.returncode}:\n{run.stderr}")
    return run.stdout


def gl_error(build):
    """Why there is no OpenGL here, or None where there is."""
    info = json.loads(run_command(build, "info"))
    return None if info.get("gl") else info.get("gl_error") or "no OpenGL device"


def render(build, case, primary, work):
    """The case's picture: height x width x 3, first row on top, scene-linear."""
    work.mkdir(parents=True, exist_ok=True)
    scene, out = write_scene(case, work), work / f"{case.name}.{primary}.exr"
    settings = {"samples": case.samples, "pixel_filter": "box", "filter_width": 1,
                "primary": primary, **case.settings}
    options = [word for name, value in settings.items() for word in ("--set", f"{name}={value}")]
    run_command(build, "render", scene, "-o", out, "--size", "{}x{}".format(*case.size),
                "--passes", case.layer, *options)
    return exr.read(out, None if case.layer == "Combined" else case.layer)
