"""Which backend to choose, from the data alone: one rule for every class of problems.

Of the solvers that verify nearly as many problems of the class as any does (SHARE of the most), the one with the least
shifted geometric mean of fresh times, by the problems' weights, failures entered with their time limit. So a solver
cannot win by failing, and one failure in a hundred does not cost a fast one its place.
"""

import math
from dataclasses import dataclass

import pandas as pd

from . import choice
from .inputs import Inputs
from .statistics.cells import VERIFIED
from .statistics.latency import ALL
from .statistics.means import mean_time, shift_of
from .statistics.weighted import weighted_share

SHARE = 0.99


@dataclass(frozen=True)
class Contender:
    solver: str
    own: bool
    mean: float  # of fresh times [s]
    verified: int
    problems: int
    share: float  # verified, by weight


@dataclass(frozen=True)
class Choice:
    """The contenders of one class that verify enough, the fastest first: ours, which can be linked, and all."""

    size_class: str
    redundant: bool
    tier: float
    problems: int
    own: list[Contender]
    everyone: list[Contender]


def contenders(cells: pd.DataFrame, own: list[str]) -> list[Contender]:
    """@param cells  of one tier and class, a row per problem and solver; problems that some solver has not had its turn
    on are left out
    @returns those that verify enough, the fastest first
    """
    turns = cells.groupby("problem")["solver"].transform("nunique")
    cells = cells[turns == turns.max()]
    shift, found = shift_of(cells), []
    for solver, mine in cells.groupby("solver", sort=False):
        good = mine["verdict"] == VERIFIED
        found.append(Contender(solver, solver in own, mean_time(mine, shift), int(good.sum()), len(mine),
                               weighted_share(good, mine["weight"])))
    most = max((contender.share for contender in found), default=0)
    return sorted((c for c in found if c.share and c.share >= SHARE * most), key=lambda c: c.mean)


def by_class(inputs: Inputs) -> list[Choice]:
    """Size classes x redundancy x tiers that have problems that count."""
    cells = inputs.counted
    redundancy = {name: (about.get("redundancy") or 0) > 0 for name, about in inputs.problems.items()}
    dependent = cells["problem"].map(redundancy).astype(bool)
    found = []
    for size_class in choice.size_classes(inputs, cells):
        for redundant in (False, True):
            of_class = cells[(cells["size_class"] == size_class) & (dependent == redundant)]
            for tier in inputs.tiers:
                chosen = of_class[of_class["tier"] == tier]
                everyone = contenders(chosen, inputs.own)
                own = contenders(chosen[chosen["solver"].isin(inputs.own)], inputs.own)
                if everyone:
                    found.append(Choice(size_class, redundant, tier, chosen["problem"].nunique(), own, everyone))
    return found


def by_deadline(inputs: Inputs) -> list[dict]:
    """Per accuracy, size of sequences and deadline the solver that misses the smallest share of steps; of equals the one
    with the least 99th percentile of warm latency.

    @returns a row per accuracy (the loosest first) and size, with an entry per deadline in `choices`
    """
    deadlines = inputs.analysis.get("deadline")
    if deadlines is None:
        return []
    found = []
    if deadlines["size"].nunique() == 2:  # one and all are the same
        deadlines = deadlines[deadlines["size"] != ALL]
    # Loosest tier first; all sizes together come last.
    for (tier, size), rows in sorted(deadlines.groupby(["tier", "size"]), key=lambda part: (
            -part[0][0], math.inf if part[0][1] == ALL else float(part[0][1]))):
        warm = passes(inputs, tier, size=size).set_index("solver")["p99"]
        choices = []
        for deadline in sorted(set(deadlines["deadline_s"])):
            ranked = sorted((1 - row.verified_share, warm.get(row.solver, math.inf), row.solver)
                            for row in rows[rows["deadline_s"] == deadline].itertuples())
            choices.append({"deadline_s": deadline, "solver": ranked[0][2], "missed": ranked[0][0],
                            "p99": ranked[0][1], "next": ranked[1] if ranked[1:] else None} if ranked else None)
        found.append({"tier": tier, "size": size, "choices": choices})
    return found


def passes(inputs: Inputs, tier: float, mode: str = "warm", size: str = ALL) -> pd.DataFrame:
    """latency_by_solver's rows of one mode and size of sequences; of every solver at the tier nearest to `tier`."""
    latency = inputs.analysis.get("latency_by_solver", pd.DataFrame(columns=["solver", "mode", "size", "p99"]))
    rows = latency[(latency["mode"] == mode) & (latency["size"] == size)]
    rows = rows[rows["sequences"] > 0] if len(rows) else rows
    if rows.empty:
        return rows
    return rows.loc[(rows["tier"].map(math.log) - math.log(tier)).abs().groupby(rows["solver"]).idxmin()]
