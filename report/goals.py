#!/usr/bin/python3
"""Our solvers against the fastest peer that gets it right, per family and size up to 1000 rows, as Markdown.

    report/goals.py build/results/goals

Exit status: 0, or 2 with one line on standard error when the arguments or the files do not fit.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from lcpbench_report import goals, script  # noqa: E402


def main(arguments: list[str] | None = None) -> int:
    parser = script.parser("Our solvers against the fastest peer that gets it right.")
    parser.add_argument("--tier", type=float, default=1e-6, help="of the comparison (default 1e-6)")
    options = parser.parse_args(arguments)
    return script.run("goals.py", options,
                      lambda cells: print(goals.as_markdown(cells, script.tier_of(cells, options.tier)), end=""))


if __name__ == "__main__":
    sys.exit(main())
