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
    """The case's scene file with its patch. It is put beside nothing: names of files in it are
    relative to `tests/image/scenes` and made absolute here."""
    scene = json.loads((SCENES / f"{case.scene}.kscene").read_text(encoding="utf-8"))
    scene = merge_patch(scene, case.patch)
    path = work / f"{case.name}.kscene"
    path.write_text(json.dumps(absolute_files(scene), indent=1), encoding="utf-8")
    return path


def absolute_files(node):
    """A copy in which every value of a key 'file', and of 'files', is an absolute path."""
    if isinstance(node, dict):
        return {key: absolute_name(value) if key in ("file", "files") else absolute_files(value)
                for key, value in node.items()}
    return [absolute_files(value) for value in node] if isinstance(node, list) else node


def absolute_name(value):
    if isinstance(value, list):
        return [absolute_name(name) for name in value]
    return str(SCENES / value) if isinstance(value, str) else absolute_files(value)


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
