#!/usr/bin/python3
"""One line that counts the tests that ctest skipped, by reason: skipped.py FILE, written by ctest --output-junit."""

import re
import sys
import xml.etree.ElementTree as ElementTree
from collections import Counter

_GTEST_SKIP = re.compile(r"^\S+:\d+: Skipped\n(.+?)\n", re.M)
_MISSING_SOLVER = re.compile(r"^\S+ is not in this build$")


def _reason(case):
    """What GTEST_SKIP said, else the last words of the test."""
    output = case.findtext("system-out") or ""
    said = _GTEST_SKIP.search(output)
    reason = said[1] if said else (output.strip() or "no reason given").splitlines()[-1]
    return _MISSING_SOLVER.sub("a solver or peer is not in this build", reason)


def summary(xml):
    cases = ElementTree.fromstring(xml).findall("testcase")
    reasons = Counter(_reason(case) for case in cases if case.find("skipped") is not None)
    counted = ", ".join(f"{reason} ({count})" for reason, count in reasons.most_common())
    return f"{reasons.total()} of {len(cases)} tests skipped" + (f": {counted}" if counted else "")


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as file:
        print(summary(file.read()))
