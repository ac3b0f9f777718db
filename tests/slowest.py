#!/usr/bin/env python3
"""Prints the slowest build steps and tests of some build folders, and last of all the runner's count.

    python3 tests/slowest.py BUILD_FOLDER...

Build steps come from ninja's .ninja_log, which keeps of each step the latest time that it took, whichever build that
was in; tests from the last run's JUnit file, which the test presets name. Times are of the wall clock, and two steps or
tests ran side by side: they show where time goes, and do not add up to it. The last line is ctest's own line of the
last folder's run once more, since what calls `make test` reads the count there.
"""

import pathlib
import sys
import xml.etree.ElementTree

MOST = 20


def read_steps(log):
    """(seconds, output) of each step of a .ninja_log."""
    steps = {}
    for line in log.read_text().splitlines():
        fields = line.split("\t")
        if len(fields) < 5:
            continue  # the head, which names the version
        begin, end, _, output, command = fields[:5]
        # A step with several outputs has a line for each, which agree in the rest; of one output the last line holds.
        seconds = (int(end) - int(begin)) / 1000
        steps[command] = (seconds, output)
    return list(steps.values())


def read_tests(results):
    """(seconds, name) of each test, and ctest's closing line."""
    suite = xml.etree.ElementTree.parse(results).getroot()
    tests = [(float(case.get("time")), case.get("name")) for case in suite.iter("testcase")]
    total = int(suite.get("tests")) - int(suite.get("disabled"))
    failed = int(suite.get("failures"))
    share = int(100 * (total - failed) / max(total, 1) + 0.5)
    if failed > 0:
        share = min(share, 99)
    return tests, f"{share}% tests passed, {failed} tests failed out of {total}"


def print_slowest(title, timed):
    print(f"\n{title}")
    for seconds, name in sorted(timed, reverse=True)[:MOST]:
        print(f"{seconds:9.1f} s  {name}")


def main():
    if len(sys.argv) < 2:
        sys.exit("slowest.py: BUILD_FOLDER is required")
    closing = ""
    for folder in map(pathlib.Path, sys.argv[1:]):
        log, results = folder / ".ninja_log", folder / "Testing" / "tests.xml"
        for file in (log, results):
            if not file.exists():
                sys.exit(f"slowest.py: {file} is not there")
        print_slowest(f"slowest build steps of {folder}", read_steps(log))
        tests, closing = read_tests(results)
        print_slowest(f"slowest tests of {folder}", tests)
    print(f"\n{closing}")


main()
