"""What is shown where not all can be: which problems, which tier, which solvers. The CSV tables hold all of it."""

import math

import pandas as pd

from .inputs import Inputs
from .statistics.cells import NOT_RUN
from .statistics.groups import COUNTED, GROUP
from .statistics.means import mean_time, shift_of
from .solver_facts import library, method

TIER = 1e-6  # that every solver here is meant for
# Columns of tables that are not there.
_ASKED_FOR = ["solver", "tier", "mean", "a", "problems"]
TIERS = (1e-3, 1e-6, 1e-9)  # of the collection; what has many more is a study of precision


def main_tier(inputs: Inputs) -> float:
    """The one nearest to TIER, of problems if there are any, else of sequences."""
    return nearest(inputs.tiers or [tier for campaign in inputs.campaigns for tier in campaign.info["tiers"]])


def nearest(tiers, wanted: float = TIER) -> float:
    """The tier next to `wanted`; that one without any."""
    return min(dict.fromkeys(tiers), key=lambda tier: abs(math.log10(tier / wanted)), default=wanted)


def shown_tiers(inputs: Inputs) -> list[float]:
    """All tiers; the collection's three where a study of precision has many. Loosest first."""
    if len(inputs.tiers) <= 4:
        return inputs.tiers
    usual = [tier for tier in inputs.tiers if any(math.isclose(tier, t, rel_tol=1e-6) for t in TIERS)]
    return usual or [main_tier(inputs)]


def main_cells(inputs: Inputs) -> pd.DataFrame:
    """Cells of the main tier on the problems that count."""
    return inputs.cells[(inputs.cells["tier"] == main_tier(inputs)) & inputs.cells["counts"].astype(bool)]


def size_classes(inputs: Inputs, cells: pd.DataFrame) -> list[str]:
    """Those that `cells` have problems of, smallest first."""
    there = set(cells["size_class"])
    return [of["key"] for of in inputs.size_classes if of["key"] in there]


def table(inputs: Inputs, name: str, tier: float) -> pd.DataFrame:
    """Rows of a table of inputs.analysis: problems that count, and the tier; none where there is no such table."""
    found = inputs.analysis.get(name)
    if found is None:
        return pd.DataFrame(columns=_ASKED_FOR)
    chosen = (found["set"] == COUNTED) & (found["tier"] == tier)
    return found[chosen].drop(columns=[column for column in GROUP if column != "tier"])


def best_own(inputs: Inputs, most: int = 12) -> list[str]:
    """The better setting of every method; the `most` best ones, in the order of the registry."""
    return _best(inputs, {key: method(inputs.entries[key]) for key in inputs.own}, most)


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
    if len(solvers) == 1 or not len(cells):
        return solvers[:1]
    mine = cells[cells["solver"].isin(solvers)]
    # Sizes that a solver is not given at all; a single problem may be excluded for the time that a looser tier took.
    absent = mine["verdict"].isin(NOT_RUN).groupby([mine["solver"], mine["size_class"]]).all()
    absent = absent[absent].reset_index()
    common = mine[~mine["size_class"].isin(absent["size_class"])]
    first = _ranked(common if len(common) else mine, solvers)[0]
    beyond = mine[mine["size_class"].isin(absent.loc[absent["solver"] == first, "size_class"])]
    others = [solver for solver in solvers if beyond.loc[beyond["solver"] == solver, "passes"].any()]
    return [first, _ranked(beyond, others)[0]] if others else [first]
