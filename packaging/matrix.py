# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the packaged zip in every Blender that Kestrel supports, and builds the sources on newer Debians.

    packaging/matrix [--all] [--minutes N] [--build build] [WHAT...]

WHAT: 3.4 (this machine's Blender), 4.3 and 5.2 (folders with Debian 13 and sid), and the source builds
build-trixie and build-sid; by default the first three, with --all everything. The folders lie in
KESTREL_MATRIX, by default /var/tmp/kestrel-matrix, take root, debootstrap and a network to make, and
are kept. Where one cannot be made, what needs it is skipped with the reason. With --minutes nothing is
begun after that time. Results, logs and pictures go to --out, by default BUILD/matrix. Exits with 1 if
anything failed.
"""

import argparse
import os
import shutil
import subprocess
import sys
import time
import zipfile
from pathlib import Path

import places
from places import REPOSITORY, Skip

sys.path[:0] = [str(REPOSITORY / "tests" / "matrix"), str(REPOSITORY / "tests" / "parity")]
import bindings
import exr
import metrics

FOLDERS = Path(os.environ.get("KESTREL_MATRIX", "/var/tmp/kestrel-matrix"))
SUITES = {"4.3": "trixie", "5.2": "sid"}
VERSIONS = ("3.4", *SUITES)
BUILDS = ("build-trixie", "build-sid")
# What Blender needs beyond its own dependencies: a display and OpenGL in software, and modules that
# Blender 4.2 and later use without Debian's packages saying so.
BLENDER_PACKAGES = ("blender", "xvfb", "xauth", "libgl1-mesa-dri", "libegl1", "python3-numpy",
                    "python3-cattr", "python3-requests")
AGREE_DB = 45.0
SMOKE = ("--size", "320x180", "--set", "samples=4")
COPIED = ("packaging/install_addon.py", "tests/matrix/steps.py", "tests/matrix/viewport.py",
          "tests/parity/exr.py")


class Failure(Exception):
    """A step's fault."""


def say(text):
    print(text, flush=True)


def tail(text, lines=25):
    return "\n".join(text.splitlines()[-lines:])


# ---- one Blender -----------------------------------------------------------------------------

class Blender:
    """A Blender of one version with a user folder of its own, which holds nothing but the zip."""

    def __init__(self, version, place, program, results):
        self.version, self.place, self.program, self.results = version, place, program, results
        places.fresh(place.work)
        for name in ("config", "scripts", "extensions", "datafiles"):
            (place.work / "user" / name).mkdir(parents=True)
        for name in COPIED:
            target = place.work / name
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(REPOSITORY / name, target)
        self.module = ""

    def put(self, path):
        """Copy a file into the place; returns its path for commands there."""
        shutil.copyfile(path, self.place.work / Path(path).name)
        return self.place.inside / Path(path).name

    def run(self, step, *arguments, window=False, **environment):
        """Run Blender; returns its output, which is kept in the results too. Raises Failure."""
        user = self.place.inside / "user"
        environment |= {f"BLENDER_USER_{name.upper()}": user / name
                        for name in ("config", "scripts", "extensions", "datafiles")}
        shown = ["--window-geometry", 0, 0, 1280, 800] if window else ["-b"]
        words = [self.program, "-noaudio", *shown, *arguments]
        if window:
            environment |= {"LIBGL_ALWAYS_SOFTWARE": 1}
            places.fresh(self.place.work / "display")
            display = f"-screen 0 1280x800x24 -fbdir {self.place.inside / 'display'}"
            words = ["xvfb-run", "-a", "-s", display, *words]
        done = self.place.run(*words, environment=environment)
        (self.results / f"{step}.log").write_text(done.stdout, encoding="utf-8")
        if done.returncode:
            raise Failure(f"Blender ended with {done.returncode}:\n{tail(done.stdout)}")
        return done.stdout

    def step(self, name, *arguments, blend="showcase.blend", **environment):
        """Run a step of tests/matrix/steps.py; returns what it tells."""
        said = self.run(name, *([self.place.inside / blend] if blend else []),
                        "--python-exit-code", 1, "--python",
                        self.place.inside / "tests/matrix/steps.py", "--", name, self.module,
                        self.place.inside, *arguments, **environment)
        return told(said)

    def keep(self, name):
        """Copy a file of the place to the results; returns its path there."""
        return Path(shutil.copyfile(self.place.work / name, self.results / name))


def told(output):
    lines = [line.removeprefix("step: ") for line in output.splitlines()
             if line.startswith("step: ")]
    if not lines:
        raise Failure(f"the step did not get to its end:\n{tail(output)}")
    return "; ".join(lines)


def install(blender, run):
    said = blender.run("install", "--python-exit-code", 1, "--python",
                       blender.place.inside / "packaging/install_addon.py", "--",
                       blender.put(run.zip))
    blender.module = next(line.split()[1] for line in said.splitlines()
                          if line.startswith("installed: "))
    return blender.module


def validate(blender, run):
    if blender.version == "3.4":
        return "there are no extensions yet in this version"
    place = blender.place
    done = place.run(blender.program, "--command", "extension", "validate",
                     place.inside / run.zip.name)
    if done.returncode or "Success" not in done.stdout:
        raise Failure(done.stdout)
    return "the manifest is in order"


def f12(blender, run):
    """The showcase, as a farm renders it; its picture must be that of the first version."""
    if run.showcase is None:
        run.make_showcase(blender)
    blender.put(run.showcase)
    blender.run("f12", blender.place.inside / "showcase.blend", "-E", "KESTREL", "-F", "OPEN_EXR",
                "-o", blender.place.inside / "f12_####", "-f", 1)
    picture = exr.read(blender.keep("f12_0001.exr"))
    if run.picture is None:
        run.picture = picture
        return "the reference for the other versions"
    decibels = metrics.psnr(run.picture, picture)
    if not decibels >= AGREE_DB:
        raise Failure(f"PSNR {decibels:.1f} dB against the first version, wanted {AGREE_DB:g}")
    return f"PSNR {decibels:.1f} dB against the first version"


def viewport(blender, _run):
    if blender.version == "3.4" and shutil.which("xvfb-run") is None:
        raise Skip("xvfb-run is not installed")
    said = blender.run("viewport", blender.place.inside / "showcase.blend", "--python",
                       blender.place.inside / "tests/matrix/viewport.py", "--", blender.module,
                       blender.place.inside, window=True)
    if "step: the window went through every shading" not in said:
        raise Failure(tail(said))
    for picture in blender.place.work.glob("viewport_*.png"):
        blender.keep(picture.name)
    return told(said)


def bound(blender, _run):
    """Which symbols Kestrel's libraries are bound to inside this Blender."""
    logs = places.fresh(blender.place.work / "loader")
    blender.step("bindings", LD_DEBUG="bindings",
                 LD_DEBUG_OUTPUT=blender.place.inside / "loader" / "log")
    found = bindings.bindings(logs.iterdir())
    text, faults = bindings.report(found)
    (blender.results / "bindings.txt").write_text(text, encoding="utf-8")
    shutil.rmtree(logs)  # some 50 MB
    if faults:
        raise Failure("\n".join(faults[:20]))
    return f"{len(found)} symbols, all in Kestrel's own libraries, glibc and the allocator"


def update(blender, run):
    return blender.step("update", blender.put(run.newer_zip()))


STEPS = {
    "install": install,
    "validate": validate,
    "f12": f12,
    "animation": lambda blender, _run: blender.step("animation"),
    "passes": lambda blender, _run: blender.step("passes"),
    "viewport": viewport,
    "bindings": bound,
    "rivals": lambda blender, run: blender.step("rivals", blender.place.inside / run.zip.name),
    "update": update,
    "after_update": lambda blender, _run: blender.step("after_update", blend=None),
    "disable": lambda blender, _run: blender.step("disable"),
    "remove": lambda blender, _run: blender.step("remove"),
}


# ---- all of them -----------------------------------------------------------------------------

class Run:
    """What the versions share: the zip, the scene, the picture to compare with, the time."""

    def __init__(self, build, out, minutes):
        self.build = build
        self.results = places.fresh(out)
        self.began, self.minutes = time.monotonic(), minutes
        self.showcase = self.picture = None
        self.passed, self.failed, self.skipped = [], [], []
        made = subprocess.run([sys.executable, REPOSITORY / "packaging/make_zip.py", "--build",
                               build, "--dist", self.results], check=True, stdout=subprocess.PIPE,
                              text=True)
        self.zip = Path(made.stdout.strip())

    def newer_zip(self):
        """The zip as a later version would be: other numbers, and another library file."""
        newer = self.results / "kestrel-0.1.1-linux-x64.zip"
        with zipfile.ZipFile(self.zip) as old, \
                zipfile.ZipFile(newer, "w", zipfile.ZIP_DEFLATED) as new:
            for info in old.infolist():
                data = old.read(info)
                if info.filename == "kestrel/blender_manifest.toml":
                    data = data.replace(b'\nversion = "0.1.0"', b'\nversion = "0.1.1"')
                elif info.filename == "kestrel/__init__.py":
                    data = data.replace(b'"version": (0, 1, 0)', b'"version": (0, 1, 1)')
                elif info.filename.endswith("libkestrel.so"):
                    data += b"\0"
                new.writestr(info, data)
        return newer

    def make_showcase(self, blender):
        """The showcase scene as a file, written by the first Blender that needs it."""
        shutil.copytree(REPOSITORY / "scenes", blender.place.work / "scenes", dirs_exist_ok=True)
        blender.run("showcase", "--python-exit-code", 1, "--python",
                    blender.place.inside / "scenes/blend/showcase.py", "--", "--out",
                    blender.place.inside / "made.blend")
        self.showcase = self.results / "showcase.blend"
        shutil.copyfile(blender.place.work / "made.blend", self.showcase)

    def minutes_gone(self):
        return (time.monotonic() - self.began) / 60.0

    def attempt(self, name, action):
        """Run one thing and note how it went; returns whether what builds on it can follow."""
        began = time.monotonic()
        try:
            text = action()
            self.passed.append(name)
            word = "passed"
        except Skip as reason:
            self.skipped.append(name)
            word, text = "skipped", str(reason)
        except Exception as fault:  # whatever it is, the other versions are still of interest
            self.failed.append(name)
            word, text = "FAILED", f"{type(fault).__name__}: {fault}"
        say(f"{word}: {name} ({time.monotonic() - began:.0f} s): {text}")
        return word == "passed"

    def in_time(self, name):
        if self.minutes is None or self.minutes_gone() < self.minutes:
            return True
        self.skipped.append(name)
        say(f"skipped: {name}: {self.minutes_gone():.0f} minutes have passed, and after "
            f"{self.minutes:g} nothing is begun; 'packaging/matrix {name}' runs it")
        return False

    def blender(self, version):
        """Every step in one version."""
        results = places.fresh(self.results / version)
        found = []

        def find():
            if version in SUITES:
                suite = SUITES[version]
                place = places.Suite(FOLDERS / suite, suite, BLENDER_PACKAGES)
                program = "blender"
            else:
                place = places.Here(results / "work")
                program = os.environ.get("KESTREL_BLENDER", "blender")
                if shutil.which(program) is None:
                    raise Skip(f"there is no '{program}' (KESTREL_BLENDER may name one)")
            found.append(Blender(version, place, program, results))
            said = place.run(program, "--version").stdout
            return next((line for line in said.splitlines() if line.startswith("Blender ")), said)

        if not self.attempt(f"{version} there", find):
            return
        for name, step in STEPS.items():
            if not self.attempt(f"{version} {name}", lambda: step(found[0], self)) \
                    and name == "install":
                return

    def sources(self, name):
        """A build from source with another Debian's compiler and libraries."""
        suite = name.removeprefix("build-")

        def build():
            packages = subprocess.run([REPOSITORY / "dev", "packages"], check=True,
                                      stdout=subprocess.PIPE, text=True).stdout.split()
            place = places.Suite(FOLDERS / name, suite, packages)
            copy = place.work / "src"
            places.copy_sources(copy)
            said = build_inside(place, self.results / f"{name}.log")
            return f"{said}; {smoke(place, self.build, self.results / f'{name}.exr')}"

        self.attempt(name, build)

    def close(self):
        say(f"matrix: {len(self.passed)} passed, {len(self.failed)} failed, {len(self.skipped)} "
            f"skipped in {self.minutes_gone():.0f} minutes")
        ran = [version for version in VERSIONS if f"{version} install" in self.passed]
        say(f"matrix: Blender {', '.join(ran) or 'none'} ran; built from source on "
            f"{', '.join(name.removeprefix('build-') for name in BUILDS if name in self.passed) or 'none'}")
        return 1 if self.failed or not self.passed else 0


def build_inside(place, log):
    """Configure and build the libraries and the command; returns the versions they use."""
    text = ""
    for words in (("cmake", "-S", "src", "-B", "build", "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                   "-DKESTREL_TESTS=OFF", "-DKESTREL_WERROR=OFF"),
                  ("nice", "-n", "19", "cmake", "--build", "build", "-j", os.cpu_count())):
        done = place.run(*words, environment={"CCACHE_DIR": place.inside / "ccache"}, timeout=1800)
        text += done.stdout
        log.write_text(text, encoding="utf-8")
        if done.returncode:
            raise Failure(f"{words[0]} ended with {done.returncode}:\n{tail(done.stdout, 40)}")
    done = place.run("build/kestrel", "info")
    if done.returncode:
        raise Failure(done.stdout)
    return " ".join(done.stdout.split())


def smoke(place, build, kept):
    """The command renders there what it renders here."""
    scene = "scenes/showcase.kscene"
    done = place.run("build/kestrel", "render", f"src/{scene}", "-o", "smoke.exr", *SMOKE)
    if done.returncode:
        raise Failure(done.stdout)
    shutil.copyfile(place.work / "smoke.exr", kept)
    here = kept.with_name("here.exr")
    subprocess.run([build / "kestrel", "render", REPOSITORY / scene, "-o", here, *SMOKE],
                   check=True, stdout=subprocess.DEVNULL)
    decibels = metrics.psnr(exr.read(here), exr.read(kept))
    if not decibels >= AGREE_DB:
        raise Failure(f"PSNR {decibels:.1f} dB against the build here, wanted {AGREE_DB:g}")
    return f"PSNR {decibels:.1f} dB against the build here"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("what", nargs="*", choices=[*VERSIONS, *BUILDS, []], metavar="WHAT")
    parser.add_argument("--all", action="store_true", help="every Blender and every source build")
    parser.add_argument("--minutes", type=float, help="begin nothing after this time")
    parser.add_argument("--build", type=Path, default=REPOSITORY / "build")
    parser.add_argument("--out", type=Path, help="folder of the results, emptied first")
    args = parser.parse_args()
    wanted = args.what or (VERSIONS + BUILDS if args.all else VERSIONS)
    run = Run(args.build.resolve(), (args.out or args.build / "matrix").resolve(), args.minutes)
    for name in (*VERSIONS, *BUILDS):
        if name in wanted and (name == "3.4" or run.in_time(name)):
            (run.sources if name in BUILDS else run.blender)(name)
    if not set(wanted) & set(BUILDS):
        say("skipped: build-trixie, build-sid: not asked for; 'packaging/matrix --all' runs them")
    return run.close()


if __name__ == "__main__":
    sys.exit(main())
