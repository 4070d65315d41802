"""Which backend to choose, from the data alone: one rule for every class of problems.

Of the solvers that verify nearly as many problems of the class as any does (SHARE of the most), the one with the least
shifted geometric mean of times, failures entered with their time limit. So a solver cannot win by failing, and one
failure in a hundred does not cost a fast one its place.
"""

import math
from dataclasses import dataclass

import pandas as pd

from .inputs import Inputs
from .statistics.cells import VERIFIED
from .statistics.means import penalised, shifted_geometric_mean

SHARE = 0.99
# Rows: from, up to.
SIZES = ((1, 10), (11, 100), (101, 1000), (1001, 10000), (10001, math.inf))
MODE = "cold"
_SHIFT = 1e-6  # [s]: problems of a class are alike, and the small ones take microseconds


@dataclass(frozen=True)
class Contender:
    solver: str
    own: bool
    mean: float  # [s]
    verified: int
    problems: int
    median_rho: float  # of verified answers

    @property
    def share(self) -> float:
        return self.verified / self.problems


@dataclass(frozen=True)
class Choice:
    """Of one class: contenders that verify enough, the fastest first. Of our solvers, which can be linked, and of all."""

    rows: tuple[float, float]
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
    found = []
    for solver, mine in cells.groupby("solver", sort=False):
        verified = mine["verdict"] == VERIFIED
        times = penalised(mine["time_s"], mine["time_limit_s"])
        found.append(Contender(solver, solver in own, shifted_geometric_mean(times, _SHIFT), int(verified.sum()),
                               len(mine), float(mine.loc[verified, "rho"].median())))
    most = max((contender.verified for contender in found), default=0)
    return sorted((c for c in found if c.verified and c.verified >= SHARE * most), key=lambda c: c.mean)


def by_class(inputs: Inputs) -> list[Choice]:
    """Size classes x redundancy x tiers that have problems that count."""
    if inputs.cells.empty:
        return []
    cells = inputs.cells[(inputs.cells["mode"] == MODE) & inputs.cells["counts"].astype(bool)]
    redundancy = {name: (about.get("redundancy") or 0) > 0 for name, about in inputs.problems.items()}
    dependent = cells["problem"].map(redundancy).astype(bool)
    found = []
    for low, high in SIZES:
        for redundant in (False, True):
            of_class = cells[(cells["rows"] >= low) & (cells["rows"] <= high) & (dependent == redundant)]
            for tier in inputs.tiers:
                chosen = of_class[of_class["tier"] == tier]
                everyone = contenders(chosen, inputs.own)
                own = contenders(chosen[chosen["solver"].isin(inputs.own)], inputs.own)
                if everyone:
                    found.append(Choice((low, high), redundant, tier, chosen["problem"].nunique(), own, everyone))
    return found


def by_deadline(inputs: Inputs) -> list[dict]:
    """Per deadline and size of sequences the solver that verifies the largest share of steps in time; of equals the one
    with the least 99th percentile of warm latency."""
    deadlines, latency = inputs.analysis.get("deadline"), inputs.analysis.get("latency_by_solver")
    if deadlines is None or deadlines.empty:
        return []
    warm = latency[latency["mode"] == "warm"].set_index(["solver", "size"])["p99"].groupby(level=[0, 1]).min()
    table = deadlines.assign(p99=[warm.get((row.solver, row.size), math.inf) for row in deadlines.itertuples()])
    found = []
    for (deadline, size, tier), rows in table.groupby(["deadline_s", "size", "tier"], sort=True):
        ranked = rows.sort_values(["verified_share", "p99"], ascending=[False, True])
        best = ranked.iloc[0]
        found.append({"deadline_s": deadline, "size": size, "tier": tier, "solver": best["solver"],
                      "verified_share": best["verified_share"], "p99": best["p99"], "steps": int(best["steps"]),
                      "others": [(row.solver, row.verified_share) for row in ranked.iloc[1:4].itertuples()]})
    return found


def by_warm_start(inputs: Inputs) -> list[dict]:
    """What a warm start gains: per solver the median of cold over warm latency, over sequences of all sizes."""
    latency = inputs.analysis.get("latency_by_solver")
    if latency is None or latency.empty:
        return []
    rows = latency[(latency["mode"] == "warm") & (latency["size"].astype(str) == "all")]
    return rows.sort_values("warm_gain", ascending=False)[
        ["solver", "tier", "warm_gain", "warm_gain_low", "warm_gain_high", "p50", "p99", "max",
         "verified_share"]].to_dict("records")
