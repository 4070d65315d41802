"""The headline: solver x size, time and share verified.

A column's time is the median over all its problems, where an answer that was not verified, or a problem that a solver
was not given, took infinitely long. So a solver that fails on hard problems gains nothing by it, and one that fails on
half has no time at all. The best of a column is the quickest of those that verify most: in general, all problems.
"""

import math
from dataclasses import dataclass

import pandas as pd

from . import choice
from .inputs import Inputs
from .statistics.cells import EXCLUDED, FALSE_SUCCESS
from .statistics.groups import Group

# Rows from ... to; half decades, which hold two or three sizes of the collection each.
CLASSES = ((1, 10), (11, 30), (31, 100), (101, 300), (301, 1000), (1001, math.inf))


@dataclass(frozen=True)
class Entry:
    """One solver on the problems of one size class."""

    problems: int
    verified: int
    false_successes: int
    excluded: int  # not given to the solver, by a rule that was declared before
    time_s: float  # median; inf where half or more were not verified
    best: bool = False


@dataclass(frozen=True)
class Headline:
    tier: float
    columns: list[tuple[str, int]]  # label, problems
    rows: dict[str, list[Entry | None]]  # by solver; None: was not run
    left_out: list[str]  # solvers that have a better setting, or a better relative, in the table


def headline(inputs: Inputs, solvers: list[str] | None = None) -> Headline:
    """@param solvers  default: the better setting of every own method, and the best of every peer library"""
    shown = choice.best_own(inputs, 20) + choice.best_peers(inputs, 20) if solvers is None else solvers
    tier = choice.main_tier(inputs)
    cells = choice.standard_cells(inputs, tier)
    columns, entries = [], []
    for low, high in CLASSES:
        chosen = cells[(cells["rows"] >= low) & (cells["rows"] <= high)]
        # Of a campaign that was stopped half way, only the problems that all have been given.
        chosen = Group({}, chosen).common().cells if len(chosen) else chosen
        if not len(chosen):
            continue
        low = low if columns else min(chosen["rows"])
        columns.append((_label(low, high), chosen["problem"].nunique()))
        entries.append(_with_best({solver: _entry(chosen[chosen["solver"] == solver]) for solver in shown}))
    ran = [solver for solver in shown if any(column[solver] for column in entries)]
    return Headline(tier, columns, {solver: [column[solver] for column in entries] for solver in ran},
                    [key for key in inputs.keys if key not in shown])


def _label(low: int, high: float) -> str:
    return f"{low}–{int(high)}" if math.isfinite(high) else f"> {low - 1}"


def _entry(cells: pd.DataFrame) -> Entry | None:
    if not len(cells):
        return None
    verdicts = cells["verdict"]
    return Entry(len(cells), int(cells["passes"].sum()), int((verdicts == FALSE_SUCCESS).sum()),
                 int((verdicts == EXCLUDED).sum()), choice.median_time(cells["time_s"]))


def _with_best(column: dict[str, Entry | None]) -> dict[str, Entry | None]:
    most = max((entry.verified for entry in column.values() if entry), default=0)
    rivals = {solver: entry.time_s for solver, entry in column.items() if entry and most and entry.verified == most}
    best = min(rivals, key=rivals.get, default=None)
    if best is None or not math.isfinite(rivals[best]):
        return column
    entry = column[best]
    return column | {best: Entry(entry.problems, entry.verified, entry.false_successes, entry.excluded, entry.time_s,
                                 True)}
