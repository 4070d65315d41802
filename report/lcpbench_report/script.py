"""What the scripts of report/ have in common: a folder in, text out, one line for what does not fit."""

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

from .cells import Cells
from .errors import ReportError
from .load import load_results, match_tier


class Parser(argparse.ArgumentParser):
    """Tells a mistake in one line, without the usage."""

    def error(self, message: str):
        self.exit(2, f"{self.prog}: error: {message}\n")


def parser(description: str) -> argparse.ArgumentParser:
    made = Parser(description=description)
    made.add_argument("results", type=Path, metavar="RESULTS_DIR", help="folder written by `lcpbench run`")
    return made


def run(name: str, options: argparse.Namespace, act: Callable[[Cells], None]) -> int:
    """@returns the exit status: 0, or 2 with one line on standard error"""
    return guarded(name, lambda: act(Cells(load_results(options.results))))


def guarded(name: str, act: Callable[[], int | None]) -> int:
    """@returns the exit status: that of `act`, 0 where it returns none; or 2 with one line on standard error"""
    try:
        return act() or 0
    except ReportError as error:
        print(f"{name}: error: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"{name}: error: {error.filename}: {error.strerror}", file=sys.stderr)
        return 2


def tier_of(cells: Cells, asked: float) -> float:
    """The tier of the run that was asked for."""
    tier = match_tier(asked, cells.results.tiers)
    if tier is None:
        raise ReportError("--tier", f"{asked:g} was not run", "one of " + ", ".join(
            f"{t:g}" for t in cells.results.tiers))
    return tier
