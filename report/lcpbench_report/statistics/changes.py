"""Two campaigns, OLD and NEW, compared: of one plan by another commit, build or machine, or of plans that have solvers and
problems in common.

Answers, cell by cell: what was verified and is not any more, what is verified now and was not, and false successes that
were none before. What had no turn within a task's budget is as if it were not there: a slow machine is no wrong answer.
What only one of the campaigns has, and what differs in their plans, is told and judged by nothing.

Values: how far what is published moved, on the problems that both have. Per tier, size class and solver the median time;
and the ratio of ours to every peer of either front and to the portfolio, which is sharper. A value agrees if it moved by at
most REACH, or if either run's value lies in the other's interval, which is what a run promises of the next one. Medians
that are infinite in both agree; in one only, they do not. What is known in neither run is not compared.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd

from ..errors import ReportError
from . import tables
from .cells import BELOW_TIER, FALSE_SUCCESS, KEY, VERIFIED, Measured, measured
from .class_times import ALL, by_solver, class_table, classes, ratio
from .intervals import Bootstrap
from .launches import Levels
from .model import METRICS, TASK_BUDGET, Campaign
from .rivals import FASTEST, PORTFOLIO, Portfolios, is_own, rival_table

SIDES = ("old", "new")
REACH = 0.03  # relative
COLUMNS = ["tier", "size_class", "what", *(f"{side}{end}" for side in SIDES for end in ("", "_low", "_high")),
           "moved", "agrees"]
_RUN = ("started", "environment_hash")  # keys of campaign.json that differ from run to run
_OF_PROBLEM = ("set", "family", "base", "weight", "size_class", "rows", "counts", "reference")
_OF_ANSWER = ("claim", "verdict", "iterations", *METRICS)
_TASK = ["solver", "size_class", "tier"]
_MADE = (FASTEST, PORTFOLIO)  # rivals that are made of several solvers
_MISSING = object()  # the value of a key that is not there

# What differs, and its value in OLD and in NEW.
Difference = tuple[str, str, str]


@dataclass
class Comparison:
    plan: list[Difference]
    problems: list[Difference]
    cells: pd.DataFrame  # in both: KEY, and columns of cells.py with the suffixes _old and _new
    only: pd.DataFrame  # in one alone: columns of cells.py, and `side`
    values: pd.DataFrame  # COLUMNS

    def __post_init__(self):
        old, new = (self.cells[f"verdict_{side}"] for side in SIDES)
        was, is_ = old == VERIFIED, new == VERIFIED
        wrong = (FALSE_SUCCESS, BELOW_TIER)  # of solvers that were not asked for the tier: answers below it
        self.lost, self.gained = self.cells[was & ~is_], self.cells[~was & is_]
        self.false_successes = self.cells[~old.isin(wrong) & new.isin(wrong)]  # those of `lost` among them
        self.agrees = self.lost.empty and self.false_successes.empty and bool(self.values["agrees"].all())

    @property
    def same(self) -> int:
        """Cells in which nothing of the answer differs, to the last digit."""
        pairs = [(self.cells[f"{name}_old"], self.cells[f"{name}_new"]) for name in _OF_ANSWER]
        return int(pd.concat([(a == b) | (a.isna() & b.isna()) for a, b in pairs], axis=1).all(axis=1).sum())


def compare(old: Campaign, new: Campaign) -> Comparison:
    """@throws ReportError where they have no cell in common"""
    runs = measured(old), measured(new)
    first, second = (run.cells[run.cells["excluded"] != TASK_BUDGET] for run in runs)
    cells = first.merge(second, on=KEY, suffixes=("_old", "_new"))
    if cells.empty:
        raise ReportError("campaign.json", "OLD and NEW have no cell in common", "the same solvers on the same problems")
    only = pd.concat([mine[~_among(mine, cells, KEY)].assign(side=side) for side, mine in zip(SIDES, (first, second))])
    own = {key for key, entry in (old.solvers | new.solvers).items() if is_own(entry)}
    plan, problems = (list(_differences(describe(old), describe(new))) for describe in (_plan, _problems))
    return Comparison(plan, problems, cells, only, moved_table(runs, own, (old.portfolio, new.portfolio)))


# ----- plans


def _plan(campaign: Campaign) -> dict:
    """campaign.json with its lists by key."""
    lists = {name: {of["key"]: of for of in campaign.info[name]} for name in ("solvers", "size_classes")}
    return {name: value for name, value in (campaign.info | lists).items() if name not in _RUN}


def _problems(campaign: Campaign) -> dict:
    """What weights and classes are made of; the rest follows from the name, or is measured."""
    return {name: {key: about[key] for key in _OF_PROBLEM} for name, about in campaign.problems.items()}


def _differences(a, b, path: str = "") -> Iterator[Difference]:
    """Every place at which they differ, objects key by key."""
    if isinstance(a, dict) and isinstance(b, dict):
        for key in dict.fromkeys([*a, *b]):
            yield from _differences(a.get(key, _MISSING), b.get(key, _MISSING), f"{path}.{key}" if path else str(key))
    elif a != b:
        yield path, _word(a), _word(b)


def _word(value) -> str:
    if value is _MISSING:
        return "–"
    text = "there" if isinstance(value, dict) else str(value)
    return text if len(text) <= 60 else text[:57] + "..."


# ----- how far what is published moved


def moved_table(runs: tuple[Measured, Measured], own: set[str], portfolios: tuple[Portfolios, Portfolios]) -> pd.DataFrame:
    """A row per value: those that do not agree first, then what moved most.

    @param own         keys of own solvers
    @param portfolios  of each run
    """
    for key in (["problem"], _TASK):
        runs = _shared(runs, key)
    ours = tables.main_own([key for key in dict.fromkeys(runs[0].cells["solver"]) if key in own])
    rivals = [rival_table(run.cells, own, ours, Levels(run.launches, times=run.rounds), portfolio)
              for run, portfolio in zip(runs, portfolios)]
    front = {(of.tier, of.size_class, of.rival) for table in rivals for of in table.itertuples() if of.rival not in _MADE}
    first, second = (_published(run, table, front, ours) for run, table in zip(runs, rivals))
    rows = [_moved(key, first[key], second[key]) for key in first
            if key in second and not (math.isnan(first[key][0]) and math.isnan(second[key][0]))]
    table = pd.DataFrame(rows, columns=COLUMNS)
    return table.sort_values(["agrees", "moved"], key=lambda column: column if column.name == "agrees" else -column.abs(),
                             kind="stable", ignore_index=True)


def _shared(runs: tuple[Measured, Measured], key: list[str]) -> tuple[Measured, ...]:
    """Their cells with values of `key` that both have."""
    return tuple(run._replace(cells=run.cells[_among(run.cells, other.cells, key)]) for run, other in zip(runs, runs[::-1]))


def _among(mine: pd.DataFrame, others: pd.DataFrame, key: list[str]) -> np.ndarray:
    """Of every row whether `others` have one with the same values of `key`."""
    rows, known = (pd.MultiIndex.from_frame(table[key]) for table in (mine, others))
    return rows.isin(known)


def _published(run: Measured, rivals: pd.DataFrame, front: set[tuple], ours: str) -> dict[tuple, tuple]:
    """(tier, size class, what) -> value and interval: medians of every solver, and ratios to the front, the portfolio
    and the fastest peers."""
    levels, found = Levels(run.launches, times=run.rounds), {}
    for of in class_table(run.cells, levels).itertuples():
        if of.size_class != ALL:
            found[of.tier, of.size_class, of.solver] = (of.median_s, of.median_low, of.median_high)
    for label, of_class in classes(run.cells):
        tier, size_class = label["tier"], label["size_class"]
        solvers, bootstrap = by_solver(of_class), Bootstrap(of_class)
        for rival in sorted(key for of_tier, of_size, key in front if (of_tier, of_size) == (tier, size_class)):
            if {ours, rival} <= solvers.keys():
                found[tier, size_class, f"{ours} / {rival}"] = tuple(
                    ratio(solvers[ours], solvers[rival], tier, bootstrap, levels).values())
    return found | {(of.tier, of.size_class, f"{of.own} / {of.rival}" + f" ({of.origin})" * (of.origin != ALL)):
                    (of.ratio, of.ratio_low, of.ratio_high) for of in rivals.itertuples() if of.rival in _MADE}


def _moved(key: tuple, old: tuple[float, float, float], new: tuple[float, float, float]) -> list:
    same = old[0] == new[0]  # also both infinite
    moved = 0.0 if same else new[0] / old[0] - 1
    within = all(map(math.isfinite, (old[0], new[0]))) and any(
        low <= value <= high for value, (_, low, high) in ((old[0], new), (new[0], old)))
    return [*key, *old, *new, moved, same or abs(moved) <= REACH or within]
