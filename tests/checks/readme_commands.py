# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs every command that README.md shows.

    python3 tests/checks/readme_commands.py BUILD

Each runs in a folder of its own that looks like the checkout, with a private Blender user folder. A
command that is not known here is a fault, so that none can be added without being run.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
LINKED = ("scenes", "packaging")
TIMEOUT_S = 500
UNDER_TEST = {"./dev test": "it runs this very test"}
# What a command must leave behind or print.
RESULTS = {
    "./dev demo": "picture: out/demo/showcase.png",
    "--python packaging/install_addon.py": "installed: ",
    "-o //out_####": Path("out_0001.png"),
    "KESTREL_LOG=debug": "kestrel: debug:",
    "--stats stats.json": Path("stats.json"),
    "-o out.png": Path("out.png"),
    "kestrel info --settings": "budget_ms",
    "kestrel info": "embree",
    "cmake --install": Path("usr_local/include/kestrel/kestrel.h"),
}
MAKE_SCENE = ("import bpy; r = bpy.context.scene.render; r.resolution_x = r.resolution_y = 64; "
              "r.filepath = '//from_scene_'; import os; "
              "bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath('scene.blend'))")


def commands():
    text = (REPOSITORY / "README.md").read_text(encoding="utf-8")
    lines = [line.split("  #")[0].strip() for line in re.findall(r"^(?: {4}| {6,7})(\S.*)$", text, re.M)]
    return [line for line in lines if re.match(r"(\./|build/|blender |cmake |[A-Z_]+=)", line)]


def make_folder(folder, build, environment):
    """A place where the README's relative paths lead somewhere."""
    for name in LINKED:
        (folder / name).symlink_to(REPOSITORY / name)
    (folder / "build").symlink_to(build)
    shutil.copyfile(REPOSITORY / "scenes/showcase.kscene", folder / "scene.kscene")
    for name in ("config", "scripts", "extensions", "bin"):
        (folder / "user" / name).mkdir(parents=True)
    (folder / "user/bin/blender").symlink_to(shutil.which(environment["KESTREL_BLENDER"]))
    subprocess.run([sys.executable, REPOSITORY / "packaging/make_zip.py", "--build", build, "--dist",
                    folder / "dist"], check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["blender", "-b", "--factory-startup", "--python-expr", MAKE_SCENE], check=True,
                   cwd=folder, env=environment, stdout=subprocess.DEVNULL)


def settings(folder):
    return {**os.environ, "KESTREL_NO_INSTALL": "1",
            "KESTREL_BLENDER": os.environ.get("KESTREL_BLENDER", "blender"),
            "KESTREL_SCENE_DATA": os.environ.get("KESTREL_SCENE_DATA",
                                                 str(REPOSITORY.parent / "shared/scenes")),
            "PATH": f"{folder / 'user/bin'}:{os.environ['PATH']}",
            **{f"BLENDER_USER_{name.upper()}": str(folder / "user" / name)
               for name in ("config", "scripts", "extensions")}}


def fault(command, folder, environment):
    """Run one command; returns what is wrong with it, or an empty text."""
    wanted = next((result for part, result in RESULTS.items() if part in command), None)
    if wanted is None:
        return "tests/checks/readme_commands.py does not know what it should do"
    inside = command.replace("/usr/local", str(folder / "usr_local"))
    place = REPOSITORY if command.startswith("./dev") else folder
    done = subprocess.run(["bash", "-c", inside], cwd=place, env=environment, text=True,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, errors="replace", timeout=TIMEOUT_S)
    if done.returncode:
        return f"ended with {done.returncode}:\n{done.stdout[-2000:]}"
    if isinstance(wanted, Path):
        return "" if (folder / wanted).exists() else f"left no {wanted}:\n{done.stdout[-2000:]}"
    return "" if wanted in done.stdout else f"did not print '{wanted}':\n{done.stdout[-2000:]}"


def main():
    build = Path(sys.argv[1]).resolve()
    found, faults = commands(), 0
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        environment = settings(folder)
        make_folder(folder, build, environment)
        for command in found:
            if command in UNDER_TEST:
                print(f"not run: {command}: {UNDER_TEST[command]}", flush=True)
                continue
            if "sponza" in command and not Path(environment["KESTREL_SCENE_DATA"]).is_dir():
                print(f"not run: {command}: there is no scene data (KESTREL_SCENE_DATA)", flush=True)
                continue
            text = fault(command, folder, environment)
            faults += bool(text)
            print(f"{'FAILED' if text else 'ran'}: {command}{': ' if text else ''}{text}", flush=True)
    print(f"{len(found)} commands, {faults} failed")
    return 1 if faults or len(found) < 10 else 0


if __name__ == "__main__":
    sys.exit(main())
