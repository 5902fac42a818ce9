# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that the parameter reference in docs/parameters.md is what the command says.

    python3 tests/checks/readme.py BUILD [--write]

The reference is made from `kestrel info --settings`; `--write` brings it up to date. Also checks
that every file that README.md links to is there.
"""

import argparse
import json
import re
import subprocess
import sys
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
REFERENCE = REPOSITORY / "docs" / "parameters.md"
HEAD = """# Parameters

Made from `kestrel info --settings` by `tests/checks/readme.py --write`; a test keeps it true.
In Blender the scene's parameters are `scene.kestrel.NAME` and an object's `object.kestrel.NAME`;
the command takes them as `--set NAME=VALUE`, a scene file under `settings`. "Paper" is the letter
that Heuristic Hybrid Rendering uses.
"""
TITLES = {"scene": "Of a scene", "object": "Of an object"}


def allowed(row):
    if row.get("items"):
        return ", ".join(f"`{item}`" for item in row["items"])
    if row["type"] in ("int", "float", "color"):
        number = "three numbers " if row["type"] == "color" else ""
        unit = f" {row['unit']}" if row["unit"] else ""
        return f"{number}{row['min']:.12g} to {row['max']:.12g}{unit}"
    return "`true`, `false`"


def reference(rows):
    lines = [HEAD]
    for scope, title in TITLES.items():
        lines += [f"## {title}", "", "| name | values | default | paper | what it does |",
                  "|---|---|---|---|---|"]
        lines += [f"| `{row['name']}` | {allowed(row)} | `{row['default']}` | {row['paper']} | "
                  f"{row['help']}. |" for row in rows if row["scope"] == scope]
        lines.append("")
    return "\n".join(lines).rstrip("\n") + "\n"


def broken_links():
    text = (REPOSITORY / "README.md").read_text(encoding="utf-8")
    targets = re.findall(r"\]\(([^)#]+)\)", text)
    return [f"README.md links to {target}, which is not there" for target in targets
            if "://" not in target and not (REPOSITORY / target).exists()]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("build", type=Path)
    parser.add_argument("--write", action="store_true")
    args = parser.parse_args()
    table = subprocess.run([args.build / "kestrel", "info", "--settings"], check=True,
                           stdout=subprocess.PIPE, text=True).stdout
    wanted = reference(json.loads(table))
    if args.write:
        REFERENCE.parent.mkdir(exist_ok=True)
        REFERENCE.write_text(wanted, encoding="utf-8")
    faults = broken_links()
    if not REFERENCE.exists() or REFERENCE.read_text(encoding="utf-8") != wanted:
        faults.append(f"{REFERENCE.relative_to(REPOSITORY)} differs from the parameter table; run "
                      "tests/checks/readme.py BUILD --write")
    print("\n".join(faults) or "README.md and docs/parameters.md are up to date")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
