#!/usr/bin/python3
"""Prints the headline table of a results folder as Markdown, or writes it between the markers of a file.

    report/headline.py build/results/default
    report/headline.py build/results/default --update README.md

Exit status: 0, or 2 with one line on standard error when the arguments or the files do not fit.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from lcpbench_report import script  # noqa: E402


def main(arguments: list[str] | None = None) -> int:
    parser = script.parser("The headline table of a results folder as Markdown.")
    parser.add_argument("--update", type=Path, metavar="FILE", help="replace the table between the markers of FILE")
    options = parser.parse_args(arguments)

    def act(cells) -> None:
        from lcpbench_report import markdown

        table = markdown.headline(cells)
        if options.update is None:
            print(table, end="")
        else:
            text = options.update.read_text(encoding="utf-8")
            options.update.write_text(markdown.replace_between_markers(text, table, str(options.update)),
                                      encoding="utf-8")

    return script.run("headline.py", options, act)


if __name__ == "__main__":
    sys.exit(main())
