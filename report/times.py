#!/usr/bin/python3
"""Median time and verdict of every solver, family, size and tier of a results folder.

    report/times.py build/results/default > times.csv
    report/times.py build/results/default --markdown --tier 1e-6 --families disc-pile,tall-stacks

Exit status: 0, or 2 with one line on standard error when the arguments or the files do not fit.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from lcpbench_report import script  # noqa: E402
from lcpbench_report.errors import ReportError  # noqa: E402


def main(arguments: list[str] | None = None) -> int:
    parser = script.parser("Median time and verdict of every cell of a results folder.")
    parser.add_argument("--markdown", action="store_true", help="tables of one tier instead of CSV")
    parser.add_argument("--tier", type=float, default=1e-6, help="of the Markdown tables (default 1e-6)")
    parser.add_argument("--families", default="", help="of the Markdown tables, comma-separated (default: all)")
    options = parser.parse_args(arguments)

    def act(cells) -> None:
        from lcpbench_report import times

        if not options.markdown:
            print(times.as_csv(cells), end="")
            return
        tier = script.tier_of(cells, options.tier)
        families = [name for name in options.families.split(",") if name] or cells.results.families
        for family in families:
            if family not in cells.results.families:
                raise ReportError("--families", f"'{family}' was not run", "some of " + ", ".join(
                    cells.results.families))
        print(times.as_markdown(cells, tier, families), end="")

    return script.run("times.py", options, act)


if __name__ == "__main__":
    sys.exit(main())
