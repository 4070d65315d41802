"""The headline: who is the fastest in every size class, ours or a peer, by how much, and how much of it is right.

All of it is from the tables class_times and peer_ratio of the statistics, at the main tier; here is chosen who stands
where. The best are the fastest of those that are right on RIGHT of a class (where nobody is, of those that are on as
much as any). What is not told apart from the best of all is tied with it: the interval of the ratio of their times,
problem by problem, reaches 1.
"""

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import pandas as pd

from . import choice
from .inputs import Inputs
from .statistics.class_times import ALL, LEAST_TURNS, RIGHT
from .statistics.intervals import Bootstrap


@dataclass(frozen=True)
class Entry:
    """One solver on the problems of one size class."""

    problems: int  # that had their turn within the solver's budget for the class, without those below
    not_asked: int  # that it does not take as they are given
    attempted: int  # the others were not given to the solver, by a rule that was declared before
    share: float  # verified, by weight
    time_s: float  # median of the weight; inf where half or more were not verified
    p99_s: float  # NaN where there are few problems
    taken: float = 1.0  # the share, by weight, that it takes as it is given
    best: bool = False  # of all, or tied with it


class Ratio(NamedTuple):
    """A weighted median with its interval."""

    median: float
    low: float
    high: float


@dataclass(frozen=True)
class ClassRow:
    """The best of ours against the peers in one size class. Ratios are of our time over theirs: above 1 we lose."""

    size_class: str
    problems: int
    entries: dict[str, Entry]  # of every solver that was run on the class
    own: str | None = None
    peer: str | None = None  # the best of the right ones; None where none is
    to_fastest: Ratio | None = None  # over the peer that is the fastest on each problem
    to_peer: Ratio | None = None  # over `peer`


@dataclass(frozen=True)
class Headline:
    tier: float
    classes: list[ClassRow]
    solvers: list[str]  # of the table by solver
    left_out: list[str]  # solvers that have a better setting, or a better relative, in the table
    no_peer: str = ""  # why there is none to compare with; empty where there is


def verdicts(found: Headline) -> tuple[list[ClassRow], list[ClassRow], list[ClassRow]]:
    """Size classes in which our best solver loses to the fastest peer of every problem, is not told apart, and wins."""
    rows = [row for row in found.classes if row.to_fastest is not None]
    lost = [row for row in rows if row.to_fastest.low > 1]
    won = [row for row in rows if row.to_fastest.high < 1]
    return lost, [row for row in rows if row not in lost and row not in won], won


@lru_cache(maxsize=2)
def headline(inputs: Inputs) -> Headline:
    """By solver: the better setting of every own method, and the best of every peer library."""
    shown = choice.best_own(inputs, 20) + choice.best_peers(inputs, 20)
    tier, cells = choice.main_tier(inputs), choice.main_cells(inputs)
    ratios = choice.table(inputs, "peer_ratio", tier).set_index(["size_class", "solver"])
    times = choice.table(inputs, "class_times", tier)
    classes = [_row(inputs, key, rows, ratios, cells[cells["size_class"] == key])
               for key, rows in times.groupby("size_class", sort=False) if key != ALL]
    ran = [solver for solver in shown if any(solver in row.entries for row in classes)]
    return Headline(tier, classes, ran, [key for key in inputs.keys if key not in shown], _no_peer(inputs))


def _no_peer(inputs: Inputs) -> str:
    if inputs.peers:
        return ""
    missing = any(entry["origin"] != "own" and not entry["available"] for entry in inputs.solvers)
    return "no peer in this build: `make peers`" if missing else "no peer was run"


def _row(inputs: Inputs, size_class: str, times: pd.DataFrame, ratios: pd.DataFrame, cells: pd.DataFrame) -> ClassRow:
    entries = {of.solver: Entry(of.problems - of.not_asked, of.not_asked, of.attempted, of.verified_share, of.median_s,
                                of.p99_s, of.taken_share)
               for of in times.itertuples()}
    rivals = _rivals({key: entry for key, entry in entries.items() if key in inputs.own})
    entries |= {solver: replace(entries[solver], best=True) for solver in tied(cells, entries)}
    row = ClassRow(size_class, cells["problem"].nunique(), entries)
    if not rivals:
        return row
    own = min(rivals, key=rivals.get)
    of = ratios.loc[(size_class, own)]
    return replace(row, own=own, peer=of["peer"] or None, to_fastest=_ratio(of, "ratio"),
                   to_peer=_ratio(of, "peer_ratio"))


def _ratio(of: pd.Series, name: str) -> Ratio | None:
    return None if math.isnan(of[name]) else Ratio(*(float(of[name + end]) for end in ("", "_low", "_high")))


def _rivals(entries: dict[str, Entry]) -> dict[str, float]:
    """Median times of those that can be the best, for few problems say little; empty where nobody verifies half."""
    most = max((entry.problems for entry in entries.values()), default=0)
    sampled = {solver: entry for solver, entry in entries.items()
               if entry.problems >= min(LEAST_TURNS, most) and entry.taken >= RIGHT}
    least = min(RIGHT, max((entry.share for entry in sampled.values()), default=0))
    return {solver: entry.time_s for solver, entry in sampled.items()
            if entry.share >= least and math.isfinite(entry.time_s)}


def tied(cells: pd.DataFrame, entries: dict[str, Entry]) -> list[str]:
    """The best of all and those that it is not told apart from."""
    rivals = _rivals(entries)
    if not rivals:
        return []
    first = min(rivals, key=rivals.get)
    chosen = cells[cells["solver"].isin(rivals)]
    times = chosen.pivot(index="problem", columns="solver", values="time_s")
    weights = chosen.drop_duplicates("problem").set_index("problem")["weight"]
    bootstrap = Bootstrap(chosen)
    found = [first]
    for solver in rivals:
        both = times.index[np.isfinite(times[first]) & np.isfinite(times[solver])]
        if solver != first:
            low, _ = bootstrap.median(both, times.loc[both, solver] / times.loc[both, first], weights[both])
            found += [solver] * (low <= 1)
    return found
