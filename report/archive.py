#!/usr/bin/python3
"""Makes of the folder of a campaign or of motions a small one to be kept: rounded to few digits and compressed.

    report/archive.py build/results/standard report/reference/standard

What reads campaigns reads it too. Exit status: 0, or 2 with one line on standard error when something does not fit.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from lcpbench_report import script  # noqa: E402


def main(arguments: list[str] | None = None) -> int:
    parser = script.Parser(description="Make a small folder of that of a campaign or of motions, to be kept.")
    parser.add_argument("campaign", type=Path, metavar="DIR", help="folder of a campaign, or of `lcpbench motion`")
    parser.add_argument("output", type=Path, metavar="OUT", help="the folder to write")
    options = parser.parse_args(arguments)

    def act() -> None:
        from lcpbench_report.archive import archive

        for name, size in archive(options.campaign, options.output).items():
            print(f"{options.output / name}: {size / 1e6:.2f} MB")

    return script.guarded("archive.py", act)


if __name__ == "__main__":
    sys.exit(main())
