#!/usr/bin/python3
"""The numbers of README.md and docs/: prints the headline of campaigns, or writes every block of Markdown files that
result files hold (lcpbench_report/readme_blocks.py), and the figure of the times that stands in a file of its own.

    report/headline.py report/reference/core
    report/headline.py report/reference/core --ablation report/reference/ablation --update README.md docs/*.md

Exit status: 0, or 2 with one line on standard error when the arguments or the files do not fit.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from lcpbench_report import script  # noqa: E402


def main(arguments: list[str] | None = None) -> int:
    parser = script.Parser(description="The headline of campaigns as Markdown, its figure, and the numbers of README.md and "
                           "docs/.")
    parser.add_argument("folders", nargs="+", type=Path, metavar="FOLDER", help="of a campaign")
    parser.add_argument("--ablation", type=Path, metavar="DIR", help="a campaign of `--suite ablation`")
    parser.add_argument("--update", nargs="+", type=Path, metavar="FILE", help="write the blocks of numbers of these files, "
                        "and the figure that they show; files without blocks stay as they are")
    parser.add_argument("--root", type=Path, metavar="DIR", default=Path(__file__).resolve().parents[1],
                        help="of the repository, whose figure and data/ are meant [default: the one of this script]")
    options = parser.parse_args(arguments)

    def act() -> None:
        from lcpbench_report import markdown_headline, readme_blocks
        from lcpbench_report.errors import ReportError
        from lcpbench_report.headline_table import headline
        from lcpbench_report.inputs import load_inputs

        inputs = load_inputs(options.folders, ablation=options.ablation)
        found = headline(inputs)
        if options.update is None:
            print(markdown_headline.render(inputs, found), end="")
            return
        texts = {path: path.read_text(encoding="utf-8") for path in options.update}
        texts = {path: text for path, text in texts.items() if readme_blocks.has_blocks(text)}
        if not texts:
            raise ReportError(", ".join(str(path) for path in options.update), "no block of numbers",
                              "'<!-- numbers:NAME -->' and, after it, '<!-- end -->'")
        source = readme_blocks.Source(inputs, found, options.root)
        # All before the first is written.
        filled = {path: readme_blocks.fill(text, readme_blocks.Page(source, path)) for path, text in texts.items()}
        _draw(inputs, options.root / readme_blocks.FIGURE)
        for path, text in filled.items():
            path.write_text(text, encoding="utf-8")

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
