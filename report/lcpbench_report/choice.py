"""What is shown where not all can be: which problems, which tier, which solvers. The CSV tables hold all of it.

Which backend to choose, from the data alone: one rule for every class of problems.

Of the solvers that verify nearly as many problems of the class as any does (SHARE of the most), the one with the least
shifted geometric mean of fresh times, by the problems' weights, failures entered with their time limit. So a solver
cannot win by failing, and one failure in a hundred does not cost a fast one its place.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import pandas as pd

from .inputs import Inputs
from .statistics.cells import VERIFIED, ran
from .statistics.groups import COUNTED, GROUP
from .statistics.latency import ALL
from .statistics.means import mean_time, shift_of
from .statistics.weighted import weighted_share
from .solver_facts import library, method

TIER = 1e-6  # that every solver here is meant for
# Columns of tables that are not there.
_ASKED_FOR = ["solver", "tier", "mean", "a", "problems"]


def main_tier(inputs: Inputs) -> float:
    """The one nearest to TIER, of problems if there are any, else of sequences."""
    return nearest(inputs.tiers or [tier for campaign in inputs.campaigns for tier in campaign.info["tiers"]])


def nearest(tiers, wanted: float = TIER) -> float:
    """The tier next to `wanted`; that one without any."""
    return min(dict.fromkeys(tiers), key=lambda tier: abs(math.log10(tier / wanted)), default=wanted)


def main_cells(inputs: Inputs) -> pd.DataFrame:
    """Cells of the main tier on the problems that count."""
    return inputs.cells[(inputs.cells["tier"] == main_tier(inputs)) & inputs.cells["counts"].astype(bool)]


def size_classes(inputs: Inputs, cells: pd.DataFrame) -> list[str]:
    """Those that `cells` have problems of, smallest first."""
    there = set(cells["size_class"])
    return [of["key"] for of in inputs.size_classes if of["key"] in there]


def table(inputs: Inputs, name: str, tier: float, counted: bool = True) -> pd.DataFrame:
    """Rows of a table of inputs.analysis: problems that count, or the others, and the tier; none without such a table."""
    found = inputs.analysis.get(name)
    if found is None:
        return pd.DataFrame(columns=_ASKED_FOR)
    chosen = ((found["set"] == COUNTED) == counted) & (found["tier"] == tier)
    return found[chosen].drop(columns=[column for column in GROUP if column != "tier"])


@lru_cache(maxsize=64)
def best_own(inputs: Inputs, most: int = 12) -> list[str]:
    """The better setting of every method; the `most` best ones, in the order of the registry."""
    return _best(inputs, {key: method(inputs.entries[key]) for key in inputs.own}, most)


@lru_cache(maxsize=64)
def best_peers(inputs: Inputs, most: int = 12) -> list[str]:
    """The best solver of every library (and external ones) on the problems that all the library's solvers were given;
    where it is excluded from larger ones by its size limit, also the best of those that are not. The `most` best of
    them, in the order of the registry."""
    return _best(inputs, {key: library(inputs.entries[key]) for key in inputs.peers}, most)


def _ranked(cells: pd.DataFrame, solvers: list[str]) -> list[str]:
    """By the shifted geometric mean, in which what was not verified has the time limit: failing does not pay."""
    shift = shift_of(cells)
    means = {solver: mean_time(mine, shift) for solver, mine in cells.groupby("solver")}
    return sorted(solvers, key=lambda solver: means.get(solver, math.inf))


def _best(inputs: Inputs, group_of: dict[str, str], most: int) -> list[str]:
    """@param group_of  of every solver in question"""
    groups: dict[str, list[str]] = {}
    for key, group in group_of.items():
        groups.setdefault(group, []).append(key)
    cells = main_cells(inputs)
    chosen = [key for group in groups.values() for key in _best_of(cells, group)]
    kept = set(_ranked(cells, chosen)[:most])
    return [key for key in inputs.keys if key in kept]


def _best_of(cells: pd.DataFrame, solvers: list[str]) -> list[str]:
    """One of them, or two."""
    if len(solvers) == 1 or cells.empty:
        return solvers[:1]
    mine = cells[cells["solver"].isin(solvers)]
    # Sizes that a solver is not given at all; a single problem may be excluded for the time that a looser tier took.
    absent = (~ran(mine)).groupby([mine["solver"], mine["size_class"]]).all()
    absent = absent[absent].reset_index()
    common = mine[~mine["size_class"].isin(absent["size_class"])]
    first = _ranked(common if len(common) else mine, solvers)[0]
    beyond = mine[mine["size_class"].isin(absent.loc[absent["solver"] == first, "size_class"])]
    others = [solver for solver in solvers if beyond.loc[beyond["solver"] == solver, "passes"].any()]
    return [first, _ranked(beyond, others)[0]] if others else [first]


# ----- which backend

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
    for size_class in size_classes(inputs, cells):
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
