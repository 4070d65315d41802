#!/usr/bin/python3
"""Makes a report of campaigns: one self-contained interactive HTML page, and beside it a summary in Markdown, figures
(SVG, PDF) and tables (CSV, LaTeX).

    report/generate.py build/results/quick -o build/report/index.html
    report/generate.py standard pathological sequences --motion motion -o report/index.html

Exit status: 0 when all was written, 2 with one line on standard error when the arguments or the files do not fit.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from lcpbench_report import script  # noqa: E402


def main(arguments: list[str] | None = None) -> int:
    parser = script.Parser(description="Make a report of campaigns: an interactive page, figures and tables.")
    parser.add_argument("campaigns", type=Path, nargs="+", metavar="DIR", help="folders of campaigns")
    parser.add_argument("--motion", type=Path, metavar="DIR", help="a folder written by `lcpbench motion`")
    parser.add_argument("--precision", type=Path, metavar="DIR", help="a campaign of `--suite precision`")
    parser.add_argument("--ablation", type=Path, metavar="DIR", help="a campaign of `--suite ablation`")
    parser.add_argument("--pictures", type=Path, metavar="DIR", help="pictures of the scene families (make pictures)")
    parser.add_argument("--previous", type=Path, metavar="DIR", help="an earlier run of the first campaign: summary.md "
                        "tells what changed")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="OUT.html", help="the page to write")
    options = parser.parse_args(arguments)

    def act() -> None:
        from lcpbench_report.inputs import load_inputs
        from lcpbench_report import markdown_summary, summary
        from lcpbench_report.static import write_static
        from lcpbench_report.web import gallery
        from lcpbench_report.web.page import render

        inputs = load_inputs(options.campaigns, options.motion, options.precision, options.ablation)
        for note in inputs.notes:
            print(f"generate.py: note: {note}", file=sys.stderr)
        folder = options.output.parent
        folder.mkdir(parents=True, exist_ok=True)
        pictures = gallery.read(options.pictures) if options.pictures else []
        options.output.write_text(render(inputs, pictures), encoding="utf-8")
        changed = _changes(options.previous, options.campaigns[0]) if options.previous else ""
        words = markdown_summary.render(inputs, summary.summary_lines(inputs), changed)
        (folder / "summary.md").write_text(words, encoding="utf-8")
        write_static(inputs, folder)

    return script.guarded("generate.py", act)


def _changes(previous: Path, now: Path) -> str:
    from lcpbench_report.statistics.changes import compare_campaigns
    from lcpbench_report.statistics.changes_markdown import summary
    from lcpbench_report.statistics.load import load_campaign

    # Read anew: a report counts fewer problems than a comparison.
    old, new = load_campaign(previous), load_campaign(now)
    return summary(str(previous), old, str(now), new, compare_campaigns(old, new))


if __name__ == "__main__":
    sys.exit(main())
