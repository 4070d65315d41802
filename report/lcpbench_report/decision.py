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
from .statistics.means import penalised, shift_of, shifted_geometric_mean
from .statistics.weighted import weighted_median, weighted_share

SHARE = 0.99


@dataclass(frozen=True)
class Contender:
    solver: str
    own: bool
    mean: float  # of fresh times [s]
    verified: int
    problems: int
    share: float  # verified, by weight
    median_rho: float  # of verified answers


@dataclass(frozen=True)
class Choice:
    """Of one class: contenders that verify enough, the fastest first. Of our solvers, which can be linked, and of all."""

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
    shift, found = shift_of(cells) if len(cells) else math.nan, []
    for solver, mine in cells.groupby("solver", sort=False):
        good = mine[mine["verdict"] == VERIFIED]
        times = penalised(mine["time_s"], mine["time_limit_s"])
        found.append(Contender(solver, solver in own, shifted_geometric_mean(times, shift, mine["weight"]),
                               len(good), len(mine), weighted_share(mine["verdict"] == VERIFIED, mine["weight"]),
                               weighted_median(good["rho"], good["weight"])))
    most = max((contender.share for contender in found), default=0)
    return sorted((c for c in found if c.share and c.share >= SHARE * most), key=lambda c: c.mean)


def by_class(inputs: Inputs) -> list[Choice]:
    """Size classes x redundancy x tiers that have problems that count."""
    if inputs.cells.empty:
        return []
    cells = inputs.cells[inputs.cells["counts"].astype(bool)]
    redundancy = {name: (about.get("redundancy") or 0) > 0 for name, about in inputs.problems.items()}
    dependent = cells["problem"].map(redundancy).astype(bool)
    found = []
    for of in choice.size_classes(inputs, cells):
        for redundant in (False, True):
            of_class = cells[(cells["size_class"] == of["key"]) & (dependent == redundant)]
            for tier in inputs.tiers:
                chosen = of_class[of_class["tier"] == tier]
                everyone = contenders(chosen, inputs.own)
                own = contenders(chosen[chosen["solver"].isin(inputs.own)], inputs.own)
                if everyone:
                    found.append(Choice(of["key"], redundant, tier, chosen["problem"].nunique(), own, everyone))
    return found


def by_deadline(inputs: Inputs) -> list[dict]:
    """Per accuracy, size of sequences and deadline the solver that misses the smallest share of steps; of equals the one
    with the least 99th percentile of warm latency.

    @returns a row per accuracy (the loosest first) and size, with an entry per deadline in `choices`
    """
    deadlines, latency = inputs.analysis.get("deadline"), inputs.analysis.get("latency_by_solver")
    if deadlines is None or deadlines.empty:
        return []
    warm = latency[latency["mode"] == "warm"]
    found = []
    for tier in sorted(set(deadlines["tier"]), reverse=True):
        for size in sorted(set(deadlines["size"].astype(str)), key=_number):
            rows = deadlines[(deadlines["tier"] == tier) & (deadlines["size"].astype(str) == size)]
            choices = []
            for deadline in sorted(set(deadlines["deadline_s"])):
                mine = rows[rows["deadline_s"] == deadline]
                ranked = sorted(((1 - row.verified_share, _p99(warm, row.solver, size, tier), row.solver)
                                 for row in mine.itertuples()))
                choices.append({"deadline_s": deadline, "solver": ranked[0][2], "missed": ranked[0][0],
                                "p99": ranked[0][1], "next": ranked[1] if ranked[1:] else None} if ranked else None)
            found.append({"tier": tier, "size": size, "choices": choices})
    return found


def _number(size: str) -> float:
    """For an order: all sizes together come last."""
    return float(size) if size.isdigit() else math.inf


def _p99(warm: pd.DataFrame, solver: str, size: str, tier: float) -> float:
    """Of the warm pass that was asked for the tier nearest to `tier`."""
    rows = warm[(warm["solver"] == solver) & (warm["size"].astype(str) == size)]
    if rows.empty:
        return math.inf
    return float(rows.loc[(rows["tier"].map(math.log) - math.log(tier)).abs().idxmin(), "p99"])


def passes(inputs: Inputs, tier: float, mode: str = "warm") -> pd.DataFrame:
    """latency_by_solver's rows of one mode over sequences of all sizes; of every solver at the tier nearest to `tier`."""
    latency = inputs.analysis.get("latency_by_solver")
    if latency is None or latency.empty:
        return pd.DataFrame(columns=["solver"])
    rows = latency[(latency["mode"] == mode) & (latency["size"].astype(str) == "all")]
    nearest = (rows["tier"].map(math.log) - math.log(tier)).abs().groupby(rows["solver"]).idxmin()
    return rows.loc[nearest]
