#!/usr/bin/python3
"""README's numbers: prints the headline of campaigns, or writes every block of a file that result files hold
(lcpbench_report/readme_blocks.py), and the figure of the times that stands in a file of its own.

    report/headline.py report/reference/core
    report/headline.py report/reference/core --update README.md

Exit status: 0, or 2 with one line on standard error when the arguments or the files do not fit.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from lcpbench_report import script  # noqa: E402


def main(arguments: list[str] | None = None) -> int:
    parser = script.Parser(description="The headline of campaigns as Markdown, its figure, and README's numbers.")
    parser.add_argument("folders", nargs="+", type=Path, metavar="FOLDER", help="of a campaign")
    parser.add_argument("--ablation", type=Path, metavar="DIR", help="a campaign of `--suite ablation`")
    parser.add_argument("--update", type=Path, metavar="FILE", help="write the blocks of numbers of FILE, and the figure "
                        "that it shows")
    options = parser.parse_args(arguments)

    def act() -> None:
        from lcpbench_report import markdown_headline, readme_blocks
        from lcpbench_report.headline_table import headline
        from lcpbench_report.inputs import load_inputs

        inputs = load_inputs(options.folders, ablation=options.ablation)
        if options.update is None:
            print(markdown_headline.render(inputs, headline(inputs)), end="")
            return
        root = options.update.resolve().parent
        text = options.update.read_text(encoding="utf-8")
        filled = readme_blocks.fill(text, readme_blocks.Source(inputs, root), str(options.update))
        _draw(inputs, root / readme_blocks.FIGURE)
        options.update.write_text(filled, encoding="utf-8")

    return script.guarded("headline.py", act)


def _draw(inputs, path: Path) -> None:
    from lcpbench_report.static import canvas, times

    with canvas.look():
        figure = times.by_size(inputs)
        if figure is not None:
            canvas.save_svg(figure, path)
            canvas.plt.close(figure)


if __name__ == "__main__":
    sys.exit(main())
