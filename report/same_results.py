#!/usr/bin/python3
"""Tells whether two campaign folders have the same results apart from times: the parts of a divided campaign, merged,
and the whole, say.

    report/same_results.py build/results/merged build/results/whole

Exit status: 0 where they have, 1 where not, 2 with one line on standard error when the arguments or files do not fit.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from lcpbench_report import script  # noqa: E402

_SHOWN = 10  # differences of a kind


def main(arguments: list[str] | None = None) -> int:
    parser = script.Parser(description="Tell whether two campaigns have the same results apart from times.")
    parser.add_argument("a", type=Path, metavar="A", help="folder of a campaign")
    parser.add_argument("b", type=Path, metavar="B", help="folder of another one")
    parser.add_argument("--show", type=int, default=_SHOWN, help="differences of a kind that are listed [%(default)s]")
    options = parser.parse_args(arguments)

    def act() -> int:
        from lcpbench_report.statistics import same
        from lcpbench_report.statistics.load import load_campaign

        a, b = load_campaign(options.a), load_campaign(options.b)
        for note in a.notes + b.notes:
            print(f"same_results.py: note: {note}", file=sys.stderr)
        parts = {"keys of the plan": same.differing_plan(a.info, b.info), "problems": same.differing_problems(a, b),
                 "cells": same.differing_cells(a, b)}
        for what, part in parts.items():
            _tell(what, part, options.show)
        return 0 if all(part.same for part in parts.values()) else 1

    return script.guarded("same_results.py", act)


def _tell(what: str, part, shown: int) -> None:
    if part.same:
        print(f"{what}: {part.both}, all the same")
        return
    late = f" ({part.out_of_time} of them with a solve that a time limit ended)" if part.out_of_time else ""
    print(f"{what}: {part.both} in both, {len(part.differ)} differ{late}; {len(part.only_a)} in A only, "
          f"{len(part.only_b)} in B only")
    lists = (part.differ, [f"A only: {name}" for name in part.only_a], [f"B only: {name}" for name in part.only_b])
    for lines in lists:
        for line in lines[:shown]:
            print(f"  {line}")
        if len(lines) > shown:
            print(f"  ... and {len(lines) - shown} more")


if __name__ == "__main__":
    sys.exit(main())
