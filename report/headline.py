#!/usr/bin/python3
"""Prints the headline table of a results folder as Markdown, or writes it between the markers of a file.

    report/headline.py build/results/default
    report/headline.py build/results/default --update README.md

Exit status: 0, or 2 with one line on standard error when the arguments or the files do not fit.
"""

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from lcpbench_report.errors import ReportError  # noqa: E402


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="The headline table of a results folder as Markdown.")
    parser.add_argument("results", type=Path, metavar="RESULTS_DIR", help="folder written by `lcpbench run`")
    parser.add_argument("--update", type=Path, metavar="FILE", help="replace the table between the markers of FILE")
    options = parser.parse_args(arguments)
    try:
        from lcpbench_report import markdown
        from lcpbench_report.cells import Cells
        from lcpbench_report.load import load_results

        table = markdown.headline(Cells(load_results(options.results)))
        if options.update is None:
            print(table, end="")
        else:
            text = options.update.read_text(encoding="utf-8")
            options.update.write_text(markdown.replace_between_markers(text, table, str(options.update)),
                                      encoding="utf-8")
    except ReportError as error:
        print(f"headline.py: error: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"headline.py: error: {error.filename}: {error.strerror}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
