# SPDX-License-Identifier: GPL-3.0-or-later
"""Where packaging/matrix.py runs commands: on this machine, or in a folder with another Debian."""

import os
import shutil
import subprocess
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[1]
SUITE = REPOSITORY / "packaging" / "suite"
SKIPPED = 77


class Skip(Exception):
    """The reason why something cannot be run here."""


class Here:
    """This machine. `work` is the folder to work in, the same for commands and for the caller."""

    def __init__(self, work):
        self.work = Path(work)
        self.inside = self.work

    def command(self, words):
        return list(map(str, words))

    def run(self, *words, environment=None, timeout=600):
        """Run a command; returns the finished process, output and errors in `stdout`. One that
        takes longer than `timeout` seconds is a failure."""
        settings = [f"{name}={value}" for name, value in (environment or {}).items()]
        command = self.command(["env", *settings, *words])
        try:
            return subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                  stderr=subprocess.STDOUT, text=True, errors="replace",
                                  timeout=timeout, cwd=self.work)
        except subprocess.TimeoutExpired as error:
            said = error.stdout or b""
            said = said if isinstance(said, str) else said.decode("utf-8", "replace")
            return subprocess.CompletedProcess(command, 124, f"{said}\ntook more than {timeout} s")


class Suite(Here):
    """A folder with a Debian suite; commands see only what lies in it."""

    def __init__(self, folder, suite, packages):
        self.folder = Path(folder)
        made = subprocess.run([SUITE, "make", folder, suite, *packages], stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if made.returncode == SKIPPED:
            raise Skip(next(line.removeprefix("SKIP: ") for line in made.stdout.splitlines()
                            if line.startswith("SKIP: ")))
        if made.returncode:
            raise Skip(f"making {folder} failed: {made.stdout[-500:]}")
        super().__init__(self.folder / "kestrel")
        self.inside = Path("/kestrel")
        self.work.mkdir(exist_ok=True)

    def command(self, words):
        return [str(SUITE), "run", str(self.folder), "sh", "-c", 'cd "$1" && shift && exec "$@"',
                "sh", str(self.inside), *map(str, words)]


def fresh(folder):
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder


def source_files():
    """The checkout's files, as git lists them: tracked ones, and new ones that are not ignored."""
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "-z"], cwd=REPOSITORY,
                            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    if listed.returncode:
        raise Skip("this is no git checkout, so what its sources are is unknown")
    return [name for name in map(os.fsdecode, filter(None, listed.stdout.split(b"\0")))
            if (REPOSITORY / name).is_file()]


def copy_sources(folder):
    """Bring a copy up to date; what did not change keeps its time, so that a build stays short."""
    names = source_files()
    for path in [path for path in folder.rglob("*") if path.is_file()]:
        if str(path.relative_to(folder)) not in set(names):
            path.unlink()
    for name in names:
        source, target = REPOSITORY / name, folder / name
        if not target.exists() or target.read_bytes() != source.read_bytes():
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, target)
            shutil.copymode(source, target)
