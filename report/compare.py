#!/usr/bin/python3
"""What changed between two campaigns of one plan, as Markdown: what became slower, faster or wrong.

    report/compare.py build/results/before build/results/after

Exit status: 0; 1 for a regression; 2 with one line on standard error when the arguments or the files do not fit.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from lcpbench_report import script  # noqa: E402


def main(arguments: list[str] | None = None) -> int:
    parser = script.Parser(description="What changed between two campaigns of one plan, as Markdown.")
    parser.add_argument("old", type=Path, metavar="OLD", help="folder of a campaign")
    parser.add_argument("new", type=Path, metavar="NEW", help="folder of a later one")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="instead of standard output")
    options = parser.parse_args(arguments)

    def act() -> int:
        from lcpbench_report.statistics.changes import compare_campaigns
        from lcpbench_report.statistics.changes_markdown import summary
        from lcpbench_report.statistics.load import load_campaign

        old, new = load_campaign(options.old), load_campaign(options.new)
        for note in old.notes + new.notes:
            print(f"compare.py: note: {note}", file=sys.stderr)
        changes = compare_campaigns(old, new)
        text = summary(str(options.old), old, str(options.new), new, changes)
        if options.output is None:
            print(text, end="")
        else:
            options.output.write_text(text, encoding="utf-8")
        return 1 if changes.regressed else 0

    return script.guarded("compare.py", act)


if __name__ == "__main__":
    sys.exit(main())
