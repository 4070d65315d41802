#!/usr/bin/python3
"""Makes one self-contained HTML page from a results folder, and beside it the times of all cells as CSV.

    report/generate.py build/results/default -o report.html      # and report.csv

Exit status: 0 when the page was written, 2 with one line on standard error when the arguments or the files do not fit.
"""

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from lcpbench_report.errors import ReportError  # noqa: E402


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Make one self-contained HTML page from a results folder.")
    parser.add_argument("results", type=Path, metavar="RESULTS_DIR", help="folder written by `lcpbench run`")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="OUT.html", help="the page to write")
    options = parser.parse_args(arguments)
    try:
        # After the arguments: Matplotlib takes a second to import.
        from lcpbench_report.load import load_results

        results = load_results(options.results)
        from lcpbench_report import times
        from lcpbench_report.cells import Cells
        from lcpbench_report.page import render

        cells = Cells(results)
        page = render(cells)
        options.output.parent.mkdir(parents=True, exist_ok=True)
        options.output.write_text(page, encoding="utf-8")
        options.output.with_suffix(".csv").write_text(times.as_csv(cells), encoding="utf-8")
    except ReportError as error:
        print(f"generate.py: error: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"generate.py: error: {error.filename}: {error.strerror}; expected a readable folder and a writable page",
              file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
