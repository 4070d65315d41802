#!/usr/bin/python3
"""Median time and verdict of every solver, family, size and tier of a results folder.

    report/times.py build/results/default > times.csv
    report/times.py build/results/default --markdown --tier 1e-6 --families disc-pile,tall-stacks

Exit status: 0, or 2 with one line on standard error when the arguments or the files do not fit.
"""

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from lcpbench_report.errors import ReportError  # noqa: E402


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Median time and verdict of every cell of a results folder.")
    parser.add_argument("results", type=Path, metavar="RESULTS_DIR", help="folder written by `lcpbench run`")
    parser.add_argument("--markdown", action="store_true", help="tables of one tier instead of CSV")
    parser.add_argument("--tier", type=float, default=1e-6, help="of the Markdown tables (default 1e-6)")
    parser.add_argument("--families", default="", help="of the Markdown tables, comma-separated (default: all)")
    options = parser.parse_args(arguments)
    try:
        from lcpbench_report import times
        from lcpbench_report.cells import Cells
        from lcpbench_report.load import load_results, match_tier

        cells = Cells(load_results(options.results))
        if not options.markdown:
            print(times.as_csv(cells), end="")
            return 0
        tier = match_tier(options.tier, cells.results.tiers)
        if tier is None:
            raise ReportError("--tier", f"{options.tier:g} was not run", "one of " + ", ".join(
                f"{t:g}" for t in cells.results.tiers))
        families = [name for name in options.families.split(",") if name] or cells.results.families
        for family in families:
            if family not in cells.results.families:
                raise ReportError("--families", f"'{family}' was not run", "some of " + ", ".join(
                    cells.results.families))
        print(times.as_markdown(cells, tier, families), end="")
    except ReportError as error:
        print(f"times.py: error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
