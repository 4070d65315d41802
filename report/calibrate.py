#!/usr/bin/python3
"""Whether a campaign finds no difference where there is none, and a slow-down where there is one, as Markdown.

    report/calibrate.py build/results/calibration

Exit status: 0 where every comparison came out right, 1 where one did not, or 2 with one line on standard error when the
arguments or the files do not fit.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from lcpbench_report import script  # noqa: E402
from lcpbench_report.statistics.calibration import calibration_table  # noqa: E402
from lcpbench_report.statistics.load import load_campaign  # noqa: E402


def calibrate(folder: Path) -> int:
    table = calibration_table(load_campaign(folder))
    print("| solver | against | tier | problems | time ratio | 95 % interval | expected | found |")
    print("| --- | --- | ---: | ---: | ---: | --- | --- | --- |")
    for row in table.itertuples():
        factor = f"slowed by {row.slowdown:g}" if row.slowdown > 1 else "itself"
        print(f"| `{row.solver}` | {factor} | {row.tier:.0e} | {row.problems} | {row.ratio:.3f} | "
              f"{row.ratio_low:.3f} … {row.ratio_high:.3f} | {row.expected} | "
              f"{row.found if row.right else '**' + row.found + '**'} |")
    return 0 if table["right"].all() else 1


def main(arguments: list[str] | None = None) -> int:
    parser = script.Parser(description="What a campaign finds where the truth is known.")
    parser.add_argument("results", type=Path, metavar="DIR", help="a campaign with variants, see `make calibrate`")
    options = parser.parse_args(arguments)
    return script.guarded("calibrate.py", lambda: calibrate(options.results))


if __name__ == "__main__":
    sys.exit(main())
