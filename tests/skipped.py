#!/usr/bin/python3
"""One line that counts the tests that were skipped, by reason: skipped.py FILE FOLDER.

FILE is written by ctest --output-junit. Programs of GoogleTest run many tests in one of ctest's: what these were is in
the files that the programs write to FOLDER.
"""

import sys
import xml.etree.ElementTree as ElementTree
from collections import Counter
from pathlib import Path


def _of_ctest(case) -> str:
    return ((case.findtext("system-out") or "").strip() or "no reason given").splitlines()[-1]


def _of_gtest(case) -> str:
    """The message of <skipped> has the place in its first line."""
    return case.find("skipped").get("message", "").partition("\n")[2].strip() or "no reason given"


def summary(ctest: str, gtest: dict[str, str]) -> str:
    """@param gtest  test of ctest -> the file that its program wrote"""
    cases = [(case, _of_ctest) for case in ElementTree.fromstring(ctest).findall("testcase") if case.get("name") not in gtest]
    cases += [(case, _of_gtest) for xml in gtest.values() for case in ElementTree.fromstring(xml).iter("testcase")
              if case.get("status") == "run"]
    reasons = Counter(reason(case) for case, reason in cases if case.find("skipped") is not None)
    counted = ", ".join(f"{reason} ({count})" for reason, count in reasons.most_common())
    return f"{reasons.total()} of {len(cases)} tests skipped" + (f": {counted}" if counted else "")


if __name__ == "__main__":
    print(summary(Path(sys.argv[1]).read_text(encoding="utf-8"),
                  {path.stem: path.read_text(encoding="utf-8") for path in Path(sys.argv[2]).glob("*.xml")}))
