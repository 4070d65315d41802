#!/usr/bin/python3
"""Makes one self-contained HTML page from a results folder, and beside it the times of all cells as CSV.

    report/generate.py build/results/default -o report.html      # and report.csv

Exit status: 0 when the page was written, 2 with one line on standard error when the arguments or the files do not fit.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from lcpbench_report import script  # noqa: E402


def main(arguments: list[str] | None = None) -> int:
    parser = script.parser("Make one self-contained HTML page from a results folder.")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="OUT.html", help="the page to write")
    options = parser.parse_args(arguments)

    def act(cells) -> None:
        from lcpbench_report import times
        from lcpbench_report.page import render

        page = render(cells)
        options.output.parent.mkdir(parents=True, exist_ok=True)
        options.output.write_text(page, encoding="utf-8")
        options.output.with_suffix(".csv").write_text(times.as_csv(cells), encoding="utf-8")

    return script.run("generate.py", options, act)


if __name__ == "__main__":
    sys.exit(main())
