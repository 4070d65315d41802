"""The headline: who is the fastest in every size class, ours or a peer, by how much, and how much of it is right.

A time is a fresh time; a class's time is the median over its problems by their weights, where an answer that was not
verified, or a problem that a solver was not given, took infinitely long. So a solver that fails on hard problems gains
nothing by it, and one that fails on half has no time at all. Right is a solver that verifies RIGHT of a class; the best
one is the quickest of these. Only where no solver is right, those that verify most take part.
"""

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import pandas as pd

from . import choice
from .inputs import Inputs
from .statistics.cells import EXCLUDED
from .statistics.groups import Group
from .statistics.peer_ratio import RIGHT, Ratio, ratio_to_fastest, ratio_to_solver
from .statistics.weighted import weighted_quantile, weighted_share

P99_LEAST = 1000  # problems: the fewest that a 99 % quantile is given of


@dataclass(frozen=True)
class Entry:
    """One solver on the problems of one size class."""

    problems: int
    excluded: int  # not given to the solver, by a rule that was declared before
    share: float  # verified, by weight
    time_s: float  # median; inf where half or more were not verified
    p99_s: float  # NaN of fewer than P99_LEAST problems
    best: bool = False  # or not distinguishable from it


@dataclass(frozen=True)
class ClassRow:
    """The best of ours against the peers in one size class. Ratios are of our time over theirs: above 1 we lose."""

    size_class: str
    problems: int
    own: str | None
    peer: str | None  # the best of the right ones; None where none is
    entries: dict[str, Entry]  # of every solver that was run on the class
    to_fastest: Ratio | None  # over the peer that is the fastest on each problem
    to_peer: Ratio | None  # over `peer`


@dataclass(frozen=True)
class Headline:
    tier: float
    classes: list[ClassRow]
    solvers: list[str]  # of the table by solver
    left_out: list[str]  # solvers that have a better setting, or a better relative, in the table


@lru_cache(maxsize=2)
def headline(inputs: Inputs) -> Headline:
    """By solver: the better setting of every own method, and the best of every peer library."""
    shown = choice.best_own(inputs, 20) + choice.best_peers(inputs, 20)
    tier = choice.main_tier(inputs)
    cells = choice.main_cells(inputs, tier)
    classes = []
    for of in choice.size_classes(inputs, cells):
        # Of a campaign that was stopped half way, only the problems that all have been given.
        chosen = Group({}, cells[cells["size_class"] == of["key"]]).common().cells
        if len(chosen):
            classes.append(_row(inputs, of["key"], chosen))
    ran = [solver for solver in shown if any(solver in row.entries for row in classes)]
    return Headline(tier, classes, ran, [key for key in inputs.keys if key not in shown])


def _row(inputs: Inputs, size_class: str, cells: pd.DataFrame) -> ClassRow:
    of = dict(tuple(cells.groupby("solver", sort=False)))
    entries = {solver: _entry(of[solver]) for solver in inputs.keys if solver in of}
    own = best({solver: entry for solver, entry in entries.items() if solver in inputs.own})
    peers = {solver: entry for solver, entry in entries.items() if solver not in inputs.own}
    peer = best({solver: entry for solver, entry in peers.items() if entry.share >= RIGHT})
    first = best(entries)
    if first is not None:
        rivals = [solver for solver in _right(entries) if solver != first and math.isfinite(entries[solver].time_s)]
        tied = [first, *(s for s in rivals if ratio_to_solver(cells, s, first).low <= 1)]
        entries |= {solver: replace(entries[solver], best=True) for solver in tied}
    return ClassRow(size_class, cells["problem"].nunique(), own, peer, entries,
                    ratio_to_fastest(cells, own, list(peers)) if own and peers else None,
                    ratio_to_solver(cells, own, peer) if own and peer else None)


def _entry(cells: pd.DataFrame) -> Entry:
    weight = cells["weight"]
    p99 = weighted_quantile(cells["time_s"], weight, 0.99) if len(cells) >= P99_LEAST else math.nan
    share = 1.0 if cells["passes"].all() else weighted_share(cells["passes"], weight)
    return Entry(len(cells), int((cells["verdict"] == EXCLUDED).sum()), share, choice.median_time(cells), p99)


def _right(entries: dict[str, Entry]) -> dict[str, Entry]:
    """Those that take part in being the best."""
    least = min(RIGHT, max((entry.share for entry in entries.values()), default=0))
    return {solver: entry for solver, entry in entries.items() if entry.share and entry.share >= least}


def best(entries: dict[str, Entry]) -> str | None:
    """None where nobody verifies more than half."""
    rivals = {solver: entry.time_s for solver, entry in _right(entries).items() if math.isfinite(entry.time_s)}
    return min(rivals, key=rivals.get, default=None)
