#!/usr/bin/python3
"""Everything that is made of the folders of campaigns: tables, the report, comparisons, settings, rules.

    report/report.py analyse build/results/quick
    report/report.py report standard pathological sequences --motion motion -o build/report/index.html

`report/report.py --help` lists the commands; `lcpbench` has the four that are used most. Exit status: 0; 1 where a
comparison found a difference; 2 with one line on standard error when the arguments or the files do not fit; 3 with one
line when output is lost, such as on a full disk.
"""

import argparse
import datetime
import errno
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from lcpbench_report.errors import ReportError, printable  # noqa: E402
from lcpbench_report.files import write_text  # noqa: E402

# What a command needs is imported when it is run: pandas alone takes a second.

# Errors that mean lost output, not a mistake.
_LOST = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO}
_ROOT = Path(__file__).resolve().parents[1]
_COMMANDS: dict[str, tuple[Callable[[argparse.Namespace], int | None], tuple]] = {}


def _tell(line: str) -> None:
    print(printable(line), file=sys.stderr)


class Parser(argparse.ArgumentParser):
    """Tells a mistake in one line, without the usage, and help that cannot be written."""

    def error(self, message: str):
        self.exit(2, f"{printable(f'{self.prog.split()[-1]}: error: {message}')}\n")

    def print_help(self, file=None):
        (file or sys.stdout).write(self.format_help())  # argparse would not tell that it is lost


def main(arguments: list[str] | None = None) -> int:
    if sys.stdout is None:  # it was closed from the start: what is printed is lost
        sys.stdout = os.fdopen(os.open(os.devnull, os.O_RDONLY), "w")
    parser = Parser(prog="report.py", description=__doc__.partition("\n")[0])
    parsers = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for name, (act, wanted) in _COMMANDS.items():
        of_command = parsers.add_parser(name, help=act.__doc__, description=act.__doc__)
        for words, settings in wanted:
            of_command.add_argument(*words, **settings)
    options = argparse.Namespace(command=parser.prog)
    arguments = sys.argv[1:] if arguments is None else arguments
    try:
        try:
            options = parser.parse_args(arguments)
            status = _COMMANDS[options.command][0](options) or 0
        except SystemExit as end:  # of parse_args, which has printed the help, or the mistake
            status = end.code
        sys.stdout.flush()
        return status
    except ReportError as error:
        _tell(f"{options.command}: error: {error}")
    except OSError as error:
        if error.filename is None:
            # Standard output has no name; what is left in it would be told again at the end of the program.
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if error.errno == errno.EPIPE:
            return 141  # as a shell's for SIGPIPE
        _tell(f"{options.command}: error: {error.filename or 'standard output'}: {error.strerror}")
        return 3 if error.filename is None or error.errno in _LOST else 2
    return 2


def _command(name: str, *wanted: tuple):
    """@param wanted  the arguments, see _word; the function's docstring is the help"""
    def register(act):
        _COMMANDS[name] = act, wanted
        return act
    return register


def _word(*words: str, **settings) -> tuple:
    """As argparse's add_argument takes them."""
    return words, settings


def _whole(least: int):
    """The type of an option's whole number >= least."""
    def convert(text: str) -> int:
        try:
            value = int(text)
        except ValueError:
            value = least - 1
        if value < least:
            raise argparse.ArgumentTypeError(f"expected a whole number >= {least}, found '{text}'")
        return value
    return convert


def _file(*words: str, **settings) -> tuple:
    return words, {"type": Path, "metavar": "DIR"} | settings


def _load(options: argparse.Namespace, *folders: Path) -> list:
    from lcpbench_report.statistics.load import load_campaign

    campaigns = [load_campaign(folder) for folder in folders]
    for note in [note for campaign in campaigns for note in campaign.notes]:
        _tell(f"{options.command}: note: {note}")
    return campaigns


@_command("analyse", _file("campaign", help="folder of a campaign; tables go to DIR/analysis"))
def _analyse(options: argparse.Namespace) -> None:
    """Write the statistics of a campaign's folder as CSV tables."""
    from lcpbench_report.statistics import tables

    tables.write_tables(*_load(options, options.campaign), options.campaign / tables.FOLDER)


@_command("compare", _file("old", metavar="OLD", help="folder of a campaign"),
          _file("new", metavar="NEW", help="folder of another one, with solvers and problems in common"),
          _word("--show", type=_whole(0), default=20, metavar="N",
                help="how many are listed of what only one has or what differs, and of the values that agree [%(default)s]"),
          _file("-o", "--output", metavar="FILE", help="instead of standard output"))
def _compare(options: argparse.Namespace) -> int:
    """Tell which answers of two campaigns differ, and how far published times and ratios moved; exit status 1 for a lost
    answer, a new false success, or a value that moved by more than 3 per cent and out of both intervals."""
    from lcpbench_report import comparison
    from lcpbench_report.statistics import changes

    found = changes.compare(*_load(options, options.old, options.new))
    text = comparison.text(f"{options.new} against {options.old}", found, options.show)
    if options.output is None:
        print(text, end="")
    else:
        write_text(options.output, text)
    return int(not found.agrees)


@_command("report", _file("campaigns", nargs="+", metavar="FOLDER", help="written by `lcpbench run`"),
          _file("--motion", nargs="+", default=[], help="folders written by `lcpbench motion`"),
          _file("--pictures", help="pictures of the scene families (make pictures)"),
          _file("-o", "--output", metavar="OUT.html", default=Path("build/report/index.html"),
                help="the page [%(default)s]; figures, tables and summary.md go beside it"))
def _report(options: argparse.Namespace) -> None:
    """Make a report of campaigns: one interactive page without links, a summary, figures and tables."""
    from lcpbench_report import markdown, summary
    from lcpbench_report.inputs import load_inputs
    from lcpbench_report.static import write_static
    from lcpbench_report.web import gallery
    from lcpbench_report.web.page import render

    inputs = load_inputs(options.campaigns, options.motion)
    for note in inputs.notes:
        _tell(f"report: note: {note}")
    folder = options.output.parent
    folder.mkdir(parents=True, exist_ok=True)
    page = render(inputs, gallery.read(options.pictures) if options.pictures else [])
    write_text(options.output, page)
    write_text(folder / "summary.md", markdown.render(inputs, summary.summary_lines(inputs)))
    write_static(inputs, folder)


@_command("tune", _file("--lcpbench", required=True, metavar="FILE", help="the command"),
          _file("--data", default=_ROOT / "data", help="of the problem collection"),
          _file("--space", metavar="FILE", help="what may be set [tuning.json in --data]"),
          _word("--budget", type=_whole(1), default=8,
                help="configurations of a solver, the default among them [%(default)s]"),
          _word("--seed", type=_whole(0), default=1, help="of the drawing [%(default)s]"),
          _word("--solvers", metavar="KEYS", help="only these, divided by commas [all of the build]"),
          _word("--sizes", default="10,100,1000",
                help="rows of the scenes, besides the smoke tier; settings are chosen at each of them [%(default)s]"),
          _word("--problem-seed", type=_whole(0), default=21, help="of the scenes [%(default)s]"),
          _word("--launches", type=_whole(1), default=3, help="timed launches of every configuration [%(default)s]"),
          _word("--cpu", type=_whole(0), help="the processor that solves are kept on"),
          _word("--resume", action="store_true", help="go on with the campaign that the folder has"),
          _file("--folder", default=Path("build/results/tuning"), help="of problems and campaign [%(default)s]"),
          _file("-o", "--output", metavar="FILE", help="what was chosen [tuned.json in --data]"))
def _tune(options: argparse.Namespace) -> int:
    """Tune all solvers with one budget, on problems that nothing is compared on, for `lcpbench run --tuned`."""
    from lcpbench_report.statistics.jsonl import write_object
    from lcpbench_report.tuning import campaign, choice
    from lcpbench_report.tuning.space import draw, load_spaces

    space_file = options.space or options.data / "tuning.json"
    spaces, sizes = load_spaces(space_file), campaign.sizes_of(options.sizes)
    command = campaign.Command(options.lcpbench)
    tried = {key: draw(spaces[key], options.budget, options.seed)
             for key in campaign.chosen_solvers(options.solvers, list(spaces), command.available("solvers"))}
    for key in [key for key, configurations in tried.items() if len(configurations) == 1]:
        print(f"{key}: nothing to tune")
        del tried[key]
    if not tried:
        raise ReportError("--solvers", "none of them has settings to try", "a solver with settings, a larger budget")
    try:
        manifest = options.folder / campaign.PROBLEMS / "manifest.json"
        if not (options.resume and manifest.is_file()):
            campaign.make_problems(command, options.data, options.folder, sizes, options.problem_seed)
        others = campaign.require_disjoint(manifest, options.data)
        print("no tuning problem is in " + ", ".join(others))
        folder = campaign.run_campaign(command, manifest, options.folder, tried, options.launches, options.cpu,
                                       options.resume)
    except subprocess.CalledProcessError as error:
        return error.returncode
    asked = choice.Asked(options.budget, options.seed, space_file, sizes, options.problem_seed)
    date = datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d")
    output = options.output or options.data / "tuned.json"
    write_object(output, choice.describe(*_load(options, folder), spaces, tried, asked, others, date, print))
    print(f"{output}: budget {options.budget}, {sum(map(len, tried.values()))} configurations of {len(tried)} solvers")
    return 0


@_command("thresholds", _file("--lcpbench", required=True, metavar="FILE", help="the command"),
          _file("--data", default=_ROOT / "data", help="of the problem collection, with limits.json [%(default)s]"),
          _word("--only", metavar="NAMES", help="only these limits, divided by commas [all of limits.json]"),
          _word("--launches", type=_whole(1), default=3, help="timed launches of every value [%(default)s]"),
          _word("--problems", type=_whole(1), default=40, help="that are timed of a limit, at most [%(default)s]"),
          _word("--seconds", type=_whole(1), default=10, help="that timed solves of a limit take, about [%(default)s]"),
          _word("--time-limit", type=float, default=1, help="seconds of an untimed solve [%(default)s]"),
          _word("--cpu", type=_whole(0), help="the processor that solves are kept on"),
          _file("--folder", default=Path("build/results/thresholds"), help="of answers and campaigns [%(default)s]"),
          _file("-o", "--output", metavar="FILE", help="the trials as JSON, with commit and machine"))
def _thresholds(options: argparse.Namespace) -> int:
    """Try other values of the limits of auto, on problems without the sealed families and engines, and print the table."""
    from lcpbench_report.statistics.jsonl import write_object
    from lcpbench_report.tuning import campaign, thresholds

    command = campaign.Command(options.lcpbench)
    trials = thresholds.load_trials(options.data / "limits.json", options.only)
    try:
        found = thresholds.run_trials(command, trials, options)
    except subprocess.CalledProcessError as error:
        return error.returncode
    print(thresholds.table(found).markdown(), end="")
    if options.output is not None:
        write_object(options.output, found)
    return 0


@_command("portfolio", _file("folders", nargs="+", metavar="FOLDER", help="of a campaign on tuning problems"),
          _file("-o", "--output", metavar="FILE", help="what was chosen [portfolio.json in data/]"))
def _portfolio(options: argparse.Namespace) -> None:
    """Choose the peers of the portfolio and their order by size class, for `lcpbench run`."""
    from lcpbench_report.statistics.jsonl import write_object
    from lcpbench_report.tuning.portfolio import describe

    found = describe(_load(options, *options.folders))
    write_object(options.output or _ROOT / "data/portfolio.json", found)
    for size_class, keys in found["classes"].items():
        print(f"{size_class}: {', '.join(keys)}")


@_command("headline", _file("folders", nargs="+", metavar="FOLDER", help="of a campaign"),
          _file("--update", nargs="+", metavar="FILE", help="write the blocks of numbers of these Markdown files, and "
                "the figure that they show; files without blocks stay as they are"),
          _file("--root", default=_ROOT, help="of the repository, whose figure and data/ are meant [%(default)s]"))
def _headline(options: argparse.Namespace) -> None:
    """Print the headline of campaigns, or write the numbers of README.md and docs/ that result files hold."""
    from lcpbench_report import markdown, readme_blocks
    from lcpbench_report.headline_table import headline
    from lcpbench_report.inputs import load_inputs
    from lcpbench_report.static import write_figure_of_times

    inputs = load_inputs(options.folders)
    found = headline(inputs)
    if options.update is None:
        print(markdown.full_headline(inputs, found), end="")
        return
    texts = {path: path.read_text(encoding="utf-8") for path in options.update}
    texts = {path: text for path, text in texts.items() if readme_blocks.BLOCK.search(text)}
    if not texts:
        raise ReportError(", ".join(map(str, options.update)), "no block of numbers",
                          "'<!-- numbers:NAME -->' and, after it, '<!-- end -->'")
    # All before the first is written.
    filled = {path: readme_blocks.fill(text, readme_blocks.Page(inputs, found, options.root, path))
              for path, text in texts.items()}
    write_figure_of_times(inputs, options.root / readme_blocks.FIGURE)
    for path, text in filled.items():
        write_text(path, text)


@_command("compact", _file("campaign", metavar="FOLDER", help="of a campaign, or of `lcpbench motion`"),
          _file("-o", "--output", metavar="OUT", required=True, help="the folder to write"))
def _compact(options: argparse.Namespace) -> None:
    """Make a small folder of that of a campaign or of motions, to be kept: a record per solver, class and tier."""
    from lcpbench_report.compact import compact

    for name, size in compact(options.campaign, options.output).items():
        print(f"{options.output / name}: {size / 1e6:.2f} MB")


if __name__ == "__main__":
    sys.exit(main())
