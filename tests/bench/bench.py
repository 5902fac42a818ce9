#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Benchmarks: rows T5, H, E, C and M for Sponza Spheres, as ratios measured in one run.

    python3 tests/bench/bench.py [--quick] [--build DIR]

Writes build/bench/report.md (tables) and build/bench/report.json (all figures), and prints the
tables. `--quick` takes fewer repetitions and leaves EEVEE out. Needs the build, the zip in dist/
(./dev bench makes both), Blender for rows C and M, and the scene data for all rows; what is missing
is said in the row. Times are milliseconds, medians after a warm-up.
"""

import argparse
import json
import os
import shutil
import statistics
import subprocess
import sys
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "parity"))

import exr  # noqa: E402
import metrics  # noqa: E402

SIZE = (1280, 720)
SCENE = ROOT / "scenes" / "sponza_spheres.kscene"
QUALITY = 0.95  # SSIM to the picture with all effects


class Missing(Exception):
    """A row that cannot be measured here, and why."""


def kestrel_frames(args, name, frames, **settings):
    """Statistics of `frames` frames after one warm-up frame, and the last picture."""
    picture, stats = args.work / f"{name}.exr", args.work / f"{name}.json"
    command = [args.build / "kestrel", "render", SCENE, "-o", picture, "--stats", stats,
               "--size", "{}x{}".format(*SIZE), "--passes", "Combined", "--frames", str(frames + 1),
               "--set", "samples=1"]
    for key, value in settings.items():
        command += ["--set", f"{key}={value}"]
    result = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if result.returncode:
        raise Missing(result.stderr.strip().splitlines()[-1] if result.stderr else "no output")
    return json.loads(stats.read_text())["frames"][1:], exr.read(picture)


def still_scene(args):
    """The benchmark scene without its camera path: every frame shows the same view."""
    scene = json.loads(SCENE.read_text())
    scene["camera"].pop("path", None)
    path = args.work / "sponza_spheres.kscene"
    path.write_text(json.dumps(scene))
    return path


def median(frames, *keys):
    values = []
    for frame in frames:
        value = frame
        for key in keys:
            value = value[key]
        values.append(value)
    return statistics.median(values)


# ---- rows of the command ---------------------------------------------------------------------

def measure_frames(args, frames):
    """Rows T5, H and E share their runs."""
    base, reference = kestrel_frames(args, "rays_only", frames, primary="rays", selection="all")
    full_ms, full_trace = median(base, "frame_ms"), median(base, "stages_ms", "trace")
    table = []
    for share in (1.0, 0.75, 0.5, 0.25):
        settings = {"primary": "auto", "selection": "graph"}
        if share < 1.0:
            settings["budget_ms"] = f"{share * full_trace:.3f}"
        # Budgets are kept by learning: give them more frames to settle.
        run, picture = kestrel_frames(args, f"hybrid_{int(100 * share)}", 2 * frames, **settings)
        run = run[-frames:]
        table.append({
            "budget_share": share,
            "frame_ms": median(run, "frame_ms"),
            **{stage: median(run, "stages_ms", stage)
               for stage in ("raster", "heuristic", "trace", "blend")},
            "speedup": full_ms / median(run, "frame_ms"),
            "ssim": metrics.ssim(reference, picture),
            "primary": run[-1]["primary"],
            "selected": sum(o["selected"] for o in run[-1]["objects"])})
    overhead = statistics.median(
        f["stages_ms"]["trace"] * args.threads / f["trace_calls_ms"] for f in base)
    good = [t["speedup"] for t in table if t["ssim"] >= QUALITY]
    return {
        "T5": {"rays_only_frame_ms": full_ms, "budgets": table,
               "speedup_at_quality": max(good) if good else None},
        "H": {"share_of_frame": statistics.median(t["heuristic"] / t["frame_ms"] for t in table),
              **heuristic_crowd(args)},
        "E": {"trace_over_embree_calls": overhead, "threads": args.threads,
              "note": "trace stage times threads over thread time inside Embree calls"},
    }


def heuristic_crowd(args):
    """Stage 2 with 10,000 objects in view, by the Google Benchmark program."""
    program = args.build / "bench" / "heuristic_bench"
    if not program.exists():
        return {"ms_10000_objects": None, "note": f"{program.name} is not built"}
    result = subprocess.run(
        [program, "--benchmark_filter=BM_Frame/10000", "--benchmark_repetitions=5",
         "--benchmark_report_aggregates_only=true", "--benchmark_format=json"],
        capture_output=True, text=True, check=True)
    runs = json.loads(result.stdout)["benchmarks"]
    return {"ms_10000_objects": next(r["real_time"] for r in runs if r["name"].endswith("median"))}


# ---- rows of Blender -------------------------------------------------------------------------

def install_addon(args):
    """The packaged add-on in a Blender user folder of the benchmark's own."""
    zips = sorted((ROOT / "dist").glob("kestrel-*.zip"), key=lambda z: z.stat().st_mtime)
    if not zips:
        raise Missing("there is no zip in dist/; run ./dev package")
    addons = args.work / "scripts" / "addons"
    shutil.rmtree(addons, ignore_errors=True)
    addons.mkdir(parents=True)
    with zipfile.ZipFile(zips[-1]) as archive:
        archive.extractall(addons)


def blender(args, *arguments, display=False, environment={}):
    executable = os.environ.get("KESTREL_BLENDER", "blender")
    if not shutil.which(executable):
        raise Missing(f"there is no '{executable}'")
    command = (["xvfb-run", "-a", executable] if display else [executable, "-b"])
    environment = {**os.environ, **environment,
                   "BLENDER_USER_SCRIPTS": str(args.work / "scripts")}
    result = subprocess.run(command + [str(a) for a in arguments], capture_output=True, text=True,
                            env=environment)
    if result.returncode:
        raise Missing("Blender failed: " + (result.stdout + result.stderr).strip()[-300:])
    return result.stdout


def f12(args, blend, run):
    """Milliseconds of one whole render() call, and the peak memory of the process in MB. KESTREL is
    the install from source, whose image plug-in reads files; KESTREL_ZIP the zip alone, to which
    Blender hands over pixels."""
    engine = "KESTREL" if run == "KESTREL_ZIP" else run
    display = engine == "BLENDER_EEVEE"
    plugin = {"KESTREL_IMAGE_PLUGIN": str(args.build / "libkestrel_oiio.so")}
    out = blender(args, *([] if display else ["--factory-startup"]), blend, "--python-exit-code", 1,
                  "--python", ROOT / "tests" / "bench" / "blender_f12.py", "--", engine,
                  display=display, environment=plugin if run == "KESTREL" else {})
    line = next(x for x in out.splitlines() if x.startswith("F12 "))
    return json.loads(line[4:])


def measure_blender(args, repetitions):
    install_addon(args)
    blend = args.work / "sponza_spheres.blend"
    blender(args, "--factory-startup", "--python-exit-code", 1, "--python",
            ROOT / "scenes" / "blend" / "sponza_spheres.py", "--", "--out", blend)
    engines = ["KESTREL", "KESTREL_ZIP", "CYCLES"] + ([] if args.quick else ["BLENDER_EEVEE"])
    runs = {engine: [] for engine in engines}
    for _ in range(repetitions + 1):  # engines take turns; the first round warms up
        for engine in engines:
            runs[engine].append(f12(args, blend, engine))
    row_c, row_m = {}, {}
    for engine, results in runs.items():
        row_c[f"{engine}_ms"] = statistics.median(r["ms"] for r in results[1:])
        row_m[f"{engine}_mb"] = statistics.median(r["peak_mb"] for r in results[1:])
        if not engine.startswith("KESTREL"):
            row_c[f"{engine}_over_KESTREL"] = row_c[f"{engine}_ms"] / row_c["KESTREL_ms"]
            row_m[f"KESTREL_over_{engine}"] = row_m["KESTREL_mb"] / row_m[f"{engine}_mb"]
    if args.quick:
        row_c["note"] = "EEVEE is left out with --quick"
    row_m["triangles_M"] = 0.272
    return {"C": row_c, "M": row_m}


# ---- report ----------------------------------------------------------------------------------

def figure(value):
    return "–" if value is None else f"{value:.3g}" if isinstance(value, float) else str(value)


def report(rows):
    lines = ["# Benchmarks", "", f"Sponza Spheres, {SIZE[0]}x{SIZE[1]}, 1 sample. Milliseconds and "
             "megabytes are medians of this run; ratios are what counts.", ""]
    for name, row in rows.items():
        lines += [f"## {name}", ""]
        budgets = row.get("budgets", []) if isinstance(row, dict) else []
        if budgets:
            keys = list(budgets[0])
            lines += ["| " + " | ".join(keys) + " |", "|" + " --- |" * len(keys)]
            lines += ["| " + " | ".join(figure(b[k]) for k in keys) + " |" for b in budgets] + [""]
        lines += [f"- {key}: {figure(value)}" for key, value in row.items() if key != "budgets"]
        lines.append("")
    return "\n".join(lines)


def main():
    global SCENE
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="fewer repetitions, no EEVEE")
    parser.add_argument("--build", type=Path, default=ROOT / "build")
    args = parser.parse_args()
    args.build = args.build.resolve()
    args.work = args.build / "bench" / "work"
    args.work.mkdir(parents=True, exist_ok=True)
    args.threads = len(os.sched_getaffinity(0))
    SCENE = still_scene(args)
    rows = {}
    for names, measure, count in ((("T5", "H", "E"), measure_frames, 3 if args.quick else 7),
                                  (("C", "M"), measure_blender, 2 if args.quick else 5)):
        try:
            rows.update(measure(args, count))
        except Missing as reason:
            rows.update({name: {"not measured": str(reason)} for name in names})
    folder = args.build / "bench"
    (folder / "report.json").write_text(json.dumps(rows, indent=1) + "\n")
    (folder / "report.md").write_text(report(rows))
    print(report(rows))
    print(f"{folder / 'report.md'}")


if __name__ == "__main__":
    main()
