#!/usr/bin/env python3
"""Prints the last lines of each failed test of a build folder's last run, and fails.

    cmake --workflow --preset release || python3 tests/failed.py build/release

A failure stands far above the end of a long run's output, and what calls `make test` may keep the end alone. Reads the
JUnit file that the test presets name; where a build failed before any test, there is none, and nothing is printed.
"""

import pathlib
import sys
import xml.etree.ElementTree

LAST_LINES = 40


def main():
    if len(sys.argv) != 2:
        sys.exit("failed.py: one BUILD_FOLDER is required")
    results = pathlib.Path(sys.argv[1]) / "Testing" / "tests.xml"
    if results.exists():
        for case in xml.etree.ElementTree.parse(results).getroot().iter("testcase"):
            if case.get("status") != "fail":
                continue
            lines = (case.findtext("system-out") or "").splitlines()[-LAST_LINES:]
            print(f"\n{case.get('name')} failed after {float(case.get('time')):.1f} s; its last {len(lines)} lines:")
            print("\n".join(lines))
    sys.exit(1)


main()
