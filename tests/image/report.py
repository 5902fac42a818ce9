# SPDX-License-Identifier: GPL-3.0-or-later
"""The report of picture comparisons: one folder per case, and an index.html over all of them.

Each case is written by its own process; index.html is made anew from what lies there. Pictures are
numpy arrays, height x width x 3, first row on top, scene-linear; they are shown in sRGB.
"""

import html
import json
import os
import shutil
import struct
import sys
import zlib
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "parity"))
import exr
import metrics

AMPLIFICATION = 8  # of the difference, after gamma

STYLE = """body{font:14px system-ui,sans-serif;margin:2em;background:#181a1d;color:#ddd}
table{border-collapse:collapse}td,th{padding:.4em .8em;text-align:left;vertical-align:top}
tr{border-bottom:1px solid #333}img{image-rendering:pixelated;max-width:360px;display:block}
.failed{color:#ff7a6b}.passed{color:#7bd88f}.skipped,.informative{color:#aaa}small{color:#999}"""


# ---- pictures --------------------------------------------------------------------------------

def srgb8(linear):
    """8-bit sRGB of scene-linear values."""
    x = numpy.clip(numpy.nan_to_num(numpy.asarray(linear, numpy.float64)), 0.0, 1.0)
    encoded = numpy.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
    return numpy.rint(encoded * 255).astype(numpy.uint8)


def write_png(path, pixels8):
    """8-bit RGB PNG without metadata."""
    height, width, _ = pixels8.shape
    rows = numpy.concatenate([numpy.zeros((height, 1), numpy.uint8),
                              pixels8.reshape(height, width * 3)], axis=1)

    def chunk(kind, data):
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    Path(path).write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) +
                           chunk(b"IDAT", zlib.compress(rows.tobytes(), 6)) + chunk(b"IEND", b""))


def difference8(reference, result):
    """Amplified absolute difference, black where equal."""
    gap = numpy.abs(metrics.display(reference) - metrics.display(result))
    return numpy.rint(numpy.clip(AMPLIFICATION * gap, 0, 1) * 255).astype(numpy.uint8)


# ---- one case --------------------------------------------------------------------------------

def write_case(folder, name, shows, verdict, figures, reference=None, result=None):
    """Write a case and the index. `verdict`: passed, failed, informative or skipped; `figures` maps
    a label to a text. A failed case keeps both pictures as EXR beside the PNGs."""
    case = Path(folder) / name
    shutil.rmtree(case, ignore_errors=True)
    case.mkdir(parents=True)
    pictures = {"reference": reference, "result": result}
    for label, pixels in pictures.items():
        if pixels is not None:
            write_png(case / f"{label}.png", srgb8(pixels))
            if verdict == "failed":
                exr.write(case / f"{label}.exr", pixels)
    if reference is not None and result is not None and reference.shape == result.shape:
        write_png(case / "difference.png", difference8(reference, result))
    entry = {"name": name, "shows": shows, "verdict": verdict, "figures": figures}
    (case / "case.json").write_text(json.dumps(entry, indent=1) + "\n", encoding="utf-8")
    write_index(Path(folder))


# ---- index.html ------------------------------------------------------------------------------

def read_entries(folder):
    entries = []
    for path in sorted(folder.glob("*/case.json")):
        try:
            entries.append((json.loads(path.read_text(encoding="utf-8")), path.parent))
        except (FileNotFoundError, json.JSONDecodeError):
            continue  # being written by another test at this moment; it writes the index again
    return sorted(entries, key=lambda entry: (entry[0]["verdict"] != "failed", entry[0]["name"]))


def picture_cell(case, label):
    if not (case / f"{label}.png").exists():
        return "<td>&ndash;</td>"
    source = f"{case.name}/{label}.png"
    return f'<td><a href="{source}"><img src="{source}" alt="{label}"></a></td>'


def row(entry, case):
    figures = "<br>".join(f"{html.escape(label)}: {html.escape(str(value))}"
                          for label, value in entry["figures"].items())
    cells = "".join(picture_cell(case, label) for label in ("reference", "result", "difference"))
    return (f'<tr id="{case.name}"><td><b>{html.escape(entry["name"])}</b><br>'
            f'<span class="{entry["verdict"]}">{entry["verdict"]}</span><br>'
            f'<small>{html.escape(entry["shows"])}</small><br>{figures}</td>{cells}</tr>')


def write_index(folder):
    entries = read_entries(folder)
    count = {verdict: sum(entry["verdict"] == verdict for entry, _ in entries)
             for verdict in ("passed", "failed", "informative", "skipped")}
    head = ", ".join(f"{number} {verdict}" for verdict, number in count.items())
    body = "\n".join(row(entry, case) for entry, case in entries)
    text = (f'<!doctype html><meta charset="utf-8"><title>Kestrel: pictures</title>'
            f"<style>{STYLE}</style><h1>Pictures</h1><p>{head}. The difference is amplified "
            f"{AMPLIFICATION} times.</p><table><tr><th>case<th>reference<th>result<th>difference"
            f"</tr>\n{body}\n</table>\n")
    part = folder / f"index.{os.getpid()}.part"
    part.write_text(text, encoding="utf-8")
    part.replace(folder / "index.html")
