# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the tests of the C interface against the self-contained library, with the system's Embree, TBB
and libstdc++ loaded first, as they are in Blender: cancelling and errors included. Then exceptions
that TBB carries out of tasks, in another library bundled the same way.

    python3 tests/checks/bundle_api.py BUILD
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "packaging"))
import bundle


THROWING = """
import ctypes, sys
sys.exit(0 if ctypes.CDLL(sys.argv[1]).kestrel_test_throwing_tasks() == 100 else 1)
"""


def throwing_status(build, environment):
    """Exit status of a process that has tasks throw 100 exceptions: 0 when all arrived."""
    with tempfile.TemporaryDirectory() as scratch:
        written, _ = bundle.bundle(build / "libthrowing_tasks.so", Path(scratch))
        return subprocess.run([sys.executable, "-c", THROWING, written[0]],
                              env=environment).returncode


def main():
    build = Path(sys.argv[1]).resolve()
    system = [str(path) for path in bundle.needed_libraries(build / "libkestrel.so").values()]
    with tempfile.TemporaryDirectory() as scratch:
        written, _ = bundle.bundle(build / "libkestrel.so", Path(scratch))
        environment = {**os.environ, "LD_LIBRARY_PATH": scratch, "LD_PRELOAD": " ".join(system),
                       "KESTREL_IMAGE_PLUGIN": str(build / "libkestrel_oiio.so")}
        program = build / "tests" / "api_test"
        loaded = subprocess.run(["ldd", program], env=environment, check=True, text=True,
                                stdout=subprocess.PIPE).stdout
        if f"{scratch}/libkestrel.so" not in loaded:
            print(f"the program does not use the bundle:\n{loaded}")
            return 1
        done = subprocess.run([program, "--gtest_brief=1"], env=environment, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    print(done.stdout[-3000:])
    del environment["LD_LIBRARY_PATH"]
    thrown = throwing_status(build, environment)
    print(f"{len(written)} libraries bundled; exceptions out of tasks: "
          f"{'all arrived' if thrown == 0 else f'status {thrown}'}")
    return done.returncode or thrown


if __name__ == "__main__":
    sys.exit(main())
