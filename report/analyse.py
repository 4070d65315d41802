#!/usr/bin/python3
"""Writes the statistics of a campaign's folder as CSV tables into its subfolder analysis.

    report/analyse.py build/campaigns/small

Exit status: 0, or 2 with one line on standard error when the arguments or the files do not fit.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from lcpbench_report import script  # noqa: E402


def main(arguments: list[str] | None = None) -> int:
    parser = script.Parser(description="Write the statistics of a campaign's folder as CSV tables.")
    parser.add_argument("campaign", type=Path, metavar="DIR", help="folder of a campaign; tables go to DIR/analysis")
    options = parser.parse_args(arguments)

    def act() -> None:
        from lcpbench_report.statistics import tables
        from lcpbench_report.statistics.load import load_campaign

        campaign = load_campaign(options.campaign)
        for note in campaign.notes:
            print(f"analyse.py: note: {note}", file=sys.stderr)
        tables.write_tables(campaign, options.campaign / tables.FOLDER)

    return script.guarded("analyse.py", act)


if __name__ == "__main__":
    sys.exit(main())
