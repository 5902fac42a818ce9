# SPDX-License-Identifier: GPL-3.0-or-later
"""Says what a test run skipped and why, what failed, and closes with 'N passed, N failed, N skipped'.

    python3 tests/checks/summary.py build/test_results.xml

Reads the JUnit file of `ctest --output-junit`. A test that skips prints a line 'SKIP: reason'.
"""

import sys
import xml.etree.ElementTree as ElementTree


def reason(case):
    text = case.findtext("system-out") or ""
    lines = [line.strip() for line in text.splitlines()]
    for line in lines:
        if "SKIP:" in line:
            return line.split("SKIP:", 1)[1].strip()
    # GoogleTest prints the reason on the line behind 'file:line: Skipped'.
    for line, following in zip(lines, lines[1:]):
        if line.endswith("Skipped"):
            return following
    skipped = case.find("skipped")
    return skipped.get("message", "") if skipped is not None else case.get("status", "")


def main():
    passed, failed, skipped = [], [], []
    for case in ElementTree.parse(sys.argv[1]).getroot().iter("testcase"):
        status = case.get("status")
        group = passed if status == "run" else failed if status == "fail" else skipped
        group.append(case)
    for case in skipped:
        print(f"skipped: {case.get('name')}: {reason(case)}")
    for case in failed:
        print(f"failed: {case.get('name')}")
    print(f"{len(passed)} passed, {len(failed)} failed, {len(skipped)} skipped")
    return 1 if failed or not passed else 0


if __name__ == "__main__":
    sys.exit(main())
