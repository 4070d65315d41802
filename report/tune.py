#!/usr/bin/python3
"""Tunes all solvers with one budget, on problems that nothing is compared on, and writes what was chosen.

    report/tune.py --lcpbench build/release/lcpbench --budget 8

Exit status: 0, or 2 with one line on standard error when the arguments or the files do not fit.
"""

import datetime
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from lcpbench_report import script  # noqa: E402
from lcpbench_report.errors import ReportError  # noqa: E402

_DATA = Path(__file__).resolve().parents[1] / "data"


def _parser() -> script.Parser:
    parser = script.Parser(description="Tune all solvers with one budget, and write what was chosen.")
    parser.add_argument("--lcpbench", type=Path, required=True, metavar="FILE", help="the command")
    parser.add_argument("--data", type=Path, default=_DATA, metavar="FOLDER", help="of the problem collection")
    parser.add_argument("--space", type=Path, metavar="FILE", help="what may be set [default: tuning.json in --data]")
    parser.add_argument("--budget", type=int, default=8, help="configurations of a solver, the default among them")
    parser.add_argument("--seed", type=int, default=1, help="of the drawing")
    parser.add_argument("--solvers", metavar="KEYS", help="only these, divided by commas [default: all of the build]")
    parser.add_argument("--sizes", default="150,600", help="rows of the scenes, besides the smoke tier")
    parser.add_argument("--problem-seed", type=int, default=21, help="of the scenes")
    parser.add_argument("--passes", type=int, default=3, help="timed passes over every stream")
    parser.add_argument("--cpu", type=int, help="the processor that solves are kept on")
    parser.add_argument("--resume", action="store_true", help="go on with the campaign that the folder has")
    parser.add_argument("--folder", type=Path, default=Path("build/results/tuning"), help="of problems and campaign")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="[default: tuned.json in --data]")
    return parser


def main(arguments: list[str] | None = None) -> int:
    options = _parser().parse_args(arguments)

    def act() -> int:
        from lcpbench_report.statistics.load import load_campaign
        from lcpbench_report.tuning import campaign, record
        from lcpbench_report.tuning.space import draw, load_spaces

        if options.budget < 1:
            raise ReportError("--budget", f"found {options.budget}", "1 or more")
        space_file = options.space or options.data / "tuning.json"
        spaces, sizes = load_spaces(space_file), _sizes(options.sizes)
        command = campaign.Command(options.lcpbench)
        keys = _solvers(options.solvers, list(spaces), command.available())
        tried = {key: draw(spaces[key], options.budget, options.seed) for key in keys}
        idle = [key for key, configurations in tried.items() if len(configurations) == 1]
        for key in idle:
            print(f"{key}: nothing to tune")
        tried = {key: configurations for key, configurations in tried.items() if key not in idle}
        if not tried:
            raise ReportError("--solvers", "none of them has settings to try", "a solver with settings, a larger budget")
        try:
            manifest = options.folder / campaign.PROBLEMS / "manifest.json"
            if not (options.resume and manifest.is_file()):
                campaign.make_problems(command, options.data, options.folder, sizes, options.problem_seed)
            others = campaign.require_disjoint(manifest, options.data)
            print("no tuning problem is in " + ", ".join(others))
            folder = campaign.run_campaign(command, manifest, options.folder, tried, options.passes,
                                           options.cpu, options.resume)
        except campaign.CommandError as error:
            return error.status
        asked = record.Asked(options.budget, options.seed, space_file, sizes, options.problem_seed)
        date = datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d")
        output = options.output or options.data / "tuned.json"
        record.write(output, record.describe(load_campaign(folder), spaces, tried, asked, others, date, print))
        print(f"{output}: budget {options.budget}, {sum(map(len, tried.values()))} configurations of "
              f"{len(tried)} solvers")
        return 0

    return script.guarded("tune.py", act)


def _sizes(text: str) -> list[int]:
    words = text.split(",")
    if not all(word.isdigit() and int(word) for word in words):
        raise ReportError("--sizes", f"found {text!r}", "rows, divided by commas")
    return [int(word) for word in words]


def _solvers(asked: str | None, declared: list[str], available: list[str]) -> list[str]:
    """In the order of the declaration."""
    if asked is None:
        return [key for key in declared if key in available]
    wanted = asked.split(",")
    for key in wanted:
        if key not in declared or key not in available:
            raise ReportError("--solvers", f"{key!r} is not declared or not in this build",
                              "some of " + ", ".join(key for key in declared if key in available))
    return [key for key in declared if key in wanted]


if __name__ == "__main__":
    sys.exit(main())
