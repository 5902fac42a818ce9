# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds a small host against the unpacked tar, through CMake and through pkg-config, and runs it.

    python3 tests/checks/tar_host.py BUILD

The host makes a scene, renders a frame and prints the mean of a pass. The `kestrel` command of the tar
must start too.
"""

import os
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]

HOST = r"""
#include <kestrel/kestrel.h>
#include <stdio.h>

int main(void) {
  KestrelDevice device = kestrelNewDevice();
  KestrelScene scene = kestrelNewScene(device);
  KestrelCamera camera = {0};
  camera.world_from_camera[0] = camera.world_from_camera[4] = camera.world_from_camera[8] = 1.0f;
  camera.left = camera.bottom = -1.0f;
  camera.right = camera.top = 1.0f;
  camera.near_clip = 0.1f;
  camera.far_clip = 100.0f;
  KestrelWorld world = {0};
  world.color[0] = 0.25f;
  const char* reason = "";
  if (kestrelSetCamera(scene, &camera) || kestrelSetWorld(scene, &world) ||
      kestrelSetSetting(scene, "samples", "1") || kestrelCommitScene(scene)) {
    kestrelGetError(&reason);
    return fprintf(stderr, "%s\n", reason), 1;
  }
  KestrelRenderer renderer = kestrelNewRenderer(scene);
  if (kestrelRender(renderer, 8, 8, NULL, NULL)) {
    kestrelGetError(&reason);
    return fprintf(stderr, "%s\n", reason), 1;
  }
  printf("kestrel %s: %.2f\n", kestrelGetVersion(), kestrelGetPassPixels(renderer, "Combined")[0]);
  kestrelReleaseRenderer(renderer);
  kestrelReleaseScene(scene);
  kestrelReleaseDevice(device);
  return 0;
}
"""

CMAKE = """
cmake_minimum_required(VERSION 3.25)
project(host C)
find_package(kestrel {version} REQUIRED)
add_executable(host host.c)
target_link_libraries(host PRIVATE kestrel::kestrel)
"""


def run(*command, **options):
    """What a command prints; raises with its output where it fails."""
    done = subprocess.run([str(word) for word in command], text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, **options)
    if done.returncode:
        raise RuntimeError(f"{' '.join(map(str, command))} ended with {done.returncode}:\n{done.stdout}")
    return done.stdout


def with_cmake(folder, unpacked, version):
    (folder / "CMakeLists.txt").write_text(CMAKE.format(version=version))
    run("cmake", "-G", "Ninja", "-S", folder, "-B", folder / "build", f"-DCMAKE_PREFIX_PATH={unpacked}")
    run("cmake", "--build", folder / "build")
    return run(folder / "build/host")


def with_pkg_config(folder, unpacked):
    environment = {**os.environ, "PKG_CONFIG_PATH": str(unpacked / "lib/pkgconfig")}
    flags = run("pkg-config", "--cflags", "--libs", "kestrel", env=environment).split()
    run("cc", "-o", folder / "host", folder / "host.c", *flags)
    return run(folder / "host", env={**os.environ, "LD_LIBRARY_PATH": str(unpacked / "lib")})


def main():
    build = Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        name = Path(run(sys.executable, REPOSITORY / "packaging/make_tar.py", "--build", build, "--dist",
                        folder / "dist").strip().splitlines()[-1])
        with tarfile.open(name) as archive:
            archive.extractall(folder)
        unpacked = folder / name.name.removesuffix(".tar")
        version = name.name.split("-")[1]
        (folder / "host.c").write_text(HOST)
        for text in (with_cmake(folder, unpacked, version), with_pkg_config(folder, unpacked)):
            print(text, end="")
            if text != f"kestrel {version}: 0.25\n":
                print(f"expected 'kestrel {version}: 0.25'")
                return 1
        print(run(unpacked / "bin/kestrel", "info")[:200])
    return 0


if __name__ == "__main__":
    sys.exit(main())
