#!/usr/bin/python3
"""The headline of a report for README.md: prints the table of times and shares verified, or writes it between the
markers of a file, with a figure of the times that stands in a file of its own.

    report/headline.py report/reference/standard
    report/headline.py report/reference/standard --update README.md

Exit status: 0, or 2 with one line on standard error when the arguments or the files do not fit.
"""

import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from lcpbench_report import script  # noqa: E402

_FIGURE = Path(__file__).resolve().parent / "reference" / "headline.svg"
_ALT = "Median solve time against the number of rows: own solvers, the best of each peer library, and the oracle"


def main(arguments: list[str] | None = None) -> int:
    parser = script.Parser(description="The headline table of campaigns as Markdown, and its figure.")
    parser.add_argument("folders", nargs="+", type=Path, metavar="FOLDER", help="of a campaign")
    parser.add_argument("--update", type=Path, metavar="FILE", help="write between the markers of FILE, and the figure")
    parser.add_argument("--figure", type=Path, metavar="FILE.svg", help="where it goes (default with --update: "
                        "reference/headline.svg beside this script)")
    options = parser.parse_args(arguments)

    def act() -> None:
        from lcpbench_report import markdown_headline
        from lcpbench_report.headline_table import headline
        from lcpbench_report.inputs import load_inputs

        # Before the minutes that loading may take.
        text = None if options.update is None else options.update.read_text(encoding="utf-8")
        if text is not None:
            markdown_headline.replace_between_markers(text, "", str(options.update))
        inputs = load_inputs(options.folders)
        table = markdown_headline.render(inputs, headline(inputs))
        path = options.figure or (None if text is None else _FIGURE)
        drawn = path is not None and _draw(inputs, path)
        if text is None:
            print(table, end="")
            return
        if drawn:
            link = Path(os.path.relpath(path, options.update.parent)).as_posix()
            table += f"\n![{_ALT}]({link})\n"
        options.update.write_text(markdown_headline.replace_between_markers(text, table, str(options.update)),
                                  encoding="utf-8")

    return script.guarded("headline.py", act)


def _draw(inputs, path: Path) -> bool:
    """@returns whether there was something to draw"""
    from lcpbench_report.static import canvas, times

    with canvas.look():
        figure = times.by_size(inputs)
        if figure is not None:
            canvas.save_svg(figure, path)
            canvas.plt.close(figure)
    return figure is not None


if __name__ == "__main__":
    sys.exit(main())
