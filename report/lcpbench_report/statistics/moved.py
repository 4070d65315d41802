"""Two runs of the same solvers on the same size classes, OLD and NEW: how far what is published moved.

Per tier, size class and solver the median time; and the ratio of ours to every peer of either front and to the portfolio,
which is sharper. A value agrees if it moved by at most REACH, or if either run's value lies in the other's interval, which
is what a run promises of the next one. Medians that are infinite in both agree; in one only, they do not. What is known in
neither run is not compared.
"""

import math

import pandas as pd

from ..errors import ReportError
from . import tables
from .cells import Measured, measured
from .class_times import ALL, by_solver, classes, ratio
from .intervals import Bootstrap
from .launches import Levels
from .load import Campaign
from .rivals import FASTEST, is_own, rival_table

REACH = 0.03  # relative
_SIDES = ("old", "new")
_KEY = ["tier", "size_class", "what"]
COLUMNS = [*_KEY, *(f"{side}{end}" for side in _SIDES for end in ("", "_low", "_high")), "moved", "agrees"]


def moved_table(old: Campaign, new: Campaign) -> tuple[pd.DataFrame, list[str]]:
    """A row per value, the one that moved most first; and what only one of the campaigns has.

    @throws ReportError where they have no solver and class in common
    """
    runs = dict(zip(_SIDES, map(measured, (old, new))))
    parts = [set(zip(run.cells["solver"], run.cells["size_class"], run.cells["tier"])) for run in runs.values()]
    common = parts[0] & parts[1]
    if not common:
        raise ReportError("campaign.json", "OLD and NEW have no solver and size class in common", "two runs of the same")
    alone = [f"{side} only: {solver} at {size_class} rows, tier {tier:g}" for side, own in zip(_SIDES, parts)
             for solver, size_class, tier in sorted(own - common)]
    runs = {side: _kept(run, common) for side, run in runs.items()}
    solvers = old.solvers | new.solvers
    own = {key for key, entry in solvers.items() if is_own(entry)}
    ours = tables.main_own([key for key in dict.fromkeys(runs["old"].cells["solver"]) if key in own])
    rivals = {side: rival_table(run.cells, own, ours, Levels(run.launches)) for side, run in runs.items()}
    front = {(of.tier, of.size_class, of.rival) for table in rivals.values() for of in table.itertuples()
             if of.rival != FASTEST}
    found = [_values(run, front, ours) | {_key(of): (of.ratio, of.ratio_low, of.ratio_high) for of in rivals[side].itertuples()
                                          if of.rival == FASTEST} for side, run in runs.items()]
    rows = [_row(key, found[0][key], found[1][key]) for key in found[0]
            if key in found[1] and not (math.isnan(found[0][key][0]) and math.isnan(found[1][key][0]))]
    if not rows:
        raise ReportError("campaign.json", "no median is known in OLD and NEW", "two runs of the same")
    table = pd.DataFrame(rows, columns=COLUMNS)
    return table.sort_values(["agrees", "moved"], key=lambda column: column if column.name == "agrees" else -column.abs(),
                             kind="stable", ignore_index=True), alone


def _kept(run: Measured, common: set[tuple]) -> Measured:
    return Measured(*(table[[key in common for key in zip(table["solver"], table["size_class"], table["tier"])]] for table in run))


def _key(of) -> tuple:
    return of.tier, of.size_class, f"{of.own} / {of.rival}" + f" ({of.origin})" * (of.origin != ALL)


def _values(run: Measured, front: set[tuple], ours: str) -> dict[tuple, tuple[float, float, float]]:
    """Key -> value and interval: medians of every solver, and ratios to the front and the portfolio."""
    levels, found = Levels(run.launches), {}
    for of in tables.class_table(run.cells, levels).itertuples():
        if of.size_class != ALL:
            found[of.tier, of.size_class, of.solver] = (of.median_s, of.median_low, of.median_high)
    for label, of_class in classes(run.cells):
        tier, size_class = label["tier"], label["size_class"]
        solvers, bootstrap = by_solver(of_class), Bootstrap(of_class)
        for rival in sorted(key for of_tier, of_size, key in front if (of_tier, of_size) == (tier, size_class)):
            if {ours, rival} <= solvers.keys():
                found[tier, size_class, f"{ours} / {rival}"] = tuple(
                    ratio(solvers[ours], solvers[rival], tier, bootstrap, levels).values())
    return found


def _row(key: tuple, old: tuple[float, float, float], new: tuple[float, float, float]) -> list:
    same = old[0] == new[0]  # also both infinite
    moved = 0.0 if same else new[0] / old[0] - 1
    within = all(map(math.isfinite, (old[0], new[0]))) and any(
        low <= value <= high for value, (_, low, high) in ((old[0], new), (new[0], old)))
    return [*key, *old, *new, moved, same or abs(moved) <= REACH or within]
