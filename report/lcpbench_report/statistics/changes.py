"""Two campaigns, OLD and NEW, compared in one of three ways.

Changes (compare_campaigns): of one plan, by another commit, build or machine. Verdicts, cell by cell. Times, per solver
over all problems, per size class and per family, by the paired statistics of pairwise.py (weights, bases, families, and
launches of either campaign): ratios NEW / OLD of fresh times on the problems that both verified, adjusted by Holm over
all these comparisons together. What else a machine does lasts for many problems and moves whole launches: campaigns of
one launch cannot tell that from a change. A regression is a solver, or a solver on a class or family, that is slower by
that; a cell that was verified and is not any more; or a false success that was none before. Cells that only one of the
campaigns has are told, and judged by nobody. Builds may differ in which solvers they have and of what version; what every
solver was asked must not.

How far what is published moved (moved_table): two runs of the same solvers on the same size classes. Per tier, size class
and solver the median time; and the ratio of ours to every peer of either front and to the portfolio, which is sharper. A
value agrees if it moved by at most REACH, or if either run's value lies in the other's interval, which is what a run
promises of the next one. Medians that are infinite in both agree; in one only, they do not. What is known in neither run
is not compared.

The same results (same_results): all that must not depend on when, where and in how many parts a campaign was run. The
plan but for the environment, what is known of the problems but for the oracle's time, and of every cell the answer and
its verdict when it was judged. Timed passes are not compared: how many there are depends on times.
"""

import json
import math
from collections.abc import Callable, Collection
from dataclasses import dataclass

import numpy as np
import pandas as pd

from ..errors import ReportError
from . import pairwise, tables
from .cells import BELOW_TIER, FALSE_SUCCESS, KEY, VERIFIED, Measured, cell_table, measured
from .class_times import ALL, by_solver, class_table, classes, ratio
from .groups import COUNTED, GROUP, with_label
from .intervals import Bootstrap, holm
from .launches import Levels
from .model import METRICS, TASK_BUDGET, Campaign
from .rivals import FASTEST, is_own, rival_table

SLOWER, FASTER = "slower", "faster"
_OLD, _NEW = _SIDES = ("old", "new")
_VERDICTS = {pairwise.A_FASTER: FASTER, pairwise.B_FASTER: SLOWER}
SPEED_COLUMNS = ["solver", "size_class", "family", *GROUP, "problems", "ratio", "ratio_low", "ratio_high", "p", "verdict"]
_ENVIRONMENT = ("started", "environment", "environment_hash")  # keys that say where and when
# What a solver was asked; only variants have `base` and `settings`. The rest describes its build, or is a
# label (`setting`).
_ASKED = {"uses_tolerance": None, "tolerance": None, "ablation": None, "base": "", "settings": {}}
_LEAST_BASES = 6  # fewer cannot reach the level, 2 / 2^5 > 0.05, and would cost the others theirs
_OF_PROBLEMS = ["set", "counts", "base", "weight", "origin", "fill", "family", "rows", "size_class", "reference"]
REACH = 0.03  # relative
MOVED_COLUMNS = ["tier", "size_class", "what", *(f"{side}{end}" for side in _SIDES for end in ("", "_low", "_high")),
                 "moved", "agrees"]
CELL_FIELDS = ("excluded", "claim", "passes", "best_tier", "at_floor", "false_success", "false_infeasible",
               "proved_infeasible", "infeasible_within_rounding", "iterations", *METRICS)
_MISSING = object()  # the value of a key that is not there


# ----- what changed


@dataclass
class Changes:
    """Tables of what changed; rows of cells have KEY."""

    cells: pd.DataFrame  # in both: columns of cells.py with the suffixes _old and _new
    only: dict[str, pd.DataFrame]  # OLD and NEW -> rows of cells.py
    speeds: pd.DataFrame  # SPEED_COLUMNS, all comparisons; `verdict` is SLOWER, FASTER or ""

    def __post_init__(self):
        old, new = (self.cells[f"verdict_{when}"] for when in _SIDES)
        was, is_ = old == VERIFIED, new == VERIFIED
        wrong = (FALSE_SUCCESS, BELOW_TIER)
        self.lost = self.cells[was & ~is_]  # verified before, and not now
        self.gained = self.cells[~was & is_]
        # New ones, those of `lost` among them; of solvers that were not asked for the tier, answers below it.
        self.false_successes = self.cells[~old.isin(wrong) & new.isin(wrong)]
        self.slower, self.faster = (self.speeds[self.speeds["verdict"] == verdict] for verdict in (SLOWER, FASTER))
        self.regressed = not (self.slower.empty and self.lost.empty and self.false_successes.empty)


def compare_campaigns(old: Campaign, new: Campaign) -> Changes:
    """@throws ReportError where they are not of one plan, or have no cell in common"""
    _require_same_plan(old, new)
    both = measured(old), measured(new)
    # What had no turn within the task's budget is as if it were not there: a slow machine is no wrong answer.
    first, second = (table[table["excluded"] != TASK_BUDGET] for table in (with_label(one.cells) for one in both))
    cells = first.merge(second.drop(columns=_OF_PROBLEMS), on=KEY, suffixes=("_old", "_new"))
    if cells.empty:
        raise ReportError("streams.jsonl", "OLD and NEW have no cell in common", "two campaigns of one plan")
    keys = [pd.MultiIndex.from_frame(table[KEY]) for table in (first, second)]
    only = {"OLD": first[~keys[0].isin(keys[1])], "NEW": second[~keys[1].isin(keys[0])]}
    return Changes(cells, only, _speeds(cells, {when: Levels(one.launches, when) for when, one in zip(_SIDES, both)}))


def _require_same_plan(old: Campaign, new: Campaign) -> None:
    """@throws ReportError naming the first key of campaign.json that differs"""
    def require(file: str, what: str, a, b) -> None:
        if a != b:
            words = [text if len(text) <= 80 else text[:77] + "..." for text in map(json.dumps, (a, b))]
            raise ReportError(file, f"{what} is {words[0]} in OLD and {words[1]} in NEW", "two campaigns of one plan")

    for key in dict.fromkeys([*old.info, *new.info]):
        if key not in (*_ENVIRONMENT, "solvers"):
            require("campaign.json", f"key '{key}'", old.info.get(key), new.info.get(key))
    asked = [{key: {k: entry.get(k, absent) for k, absent in _ASKED.items()} for key, entry in c.solvers.items()}
             for c in (old, new)]
    for key, settings in asked[0].items():
        require("campaign.json", f"solver {key!r}", settings, asked[1].get(key, settings))
    for name, about in old.problems.items():
        other = new.problems.get(name, about)
        for key in ("set", "family", "base", "weight", "size_class", "rows", "counts", "reference"):
            require("problems.jsonl", f"key '{key}' of problem {name!r}", about[key], other[key])


def _speeds(cells: pd.DataFrame, levels: dict[str, Levels]) -> pd.DataFrame:
    """A row per solver and group, and per size class and family of it where there are several; `p` is adjusted for all
    of them."""
    rows = []
    for group, of_group in cells.groupby(GROUP, sort=False):
        label = dict(zip(GROUP, group))
        for chosen, of_part in _parts(of_group):
            bootstrap = Bootstrap(of_part)
            rows += [label | chosen | {"solver": solver} | _comparison(solver, own, label["tier"], bootstrap, levels)
                     for solver, own in of_part.groupby("solver", sort=False)]
    tests = [row["wilcoxon_p"] if row["bases"] >= _LEAST_BASES else math.nan for row in rows]
    for row, adjusted in zip(rows, holm(tests)):
        verdict = pairwise.verdict(adjusted, row["direction"], row["ratio_low"], row["ratio_high"])
        row |= {"problems": row["both"], "p": adjusted, "verdict": _VERDICTS.get(verdict, "")}
    table = pd.DataFrame(rows, columns=SPEED_COLUMNS)
    # Problems that count before those that do not; the largest change first.
    order = pd.DataFrame({"rest": table["set"] != COUNTED,
                          "part": (table["family"] != ALL) | (table["size_class"] != ALL),
                          "size": -abs(np.log(table["ratio"]))}).sort_values(["rest", "part", "size"]).index
    return table.loc[order].reset_index(drop=True)


def _comparison(solver: str, part: pd.DataFrame, tier: float, bootstrap: Bootstrap, levels: dict[str, Levels]) -> dict:
    """NEW with OLD."""
    part = part.set_index("problem")
    times = pd.DataFrame({when: part[f"time_s_{when}"] for when in (_NEW, _OLD)})
    return pairwise.compare_two(times, part, bootstrap, _NEW, _OLD, None,
                                lambda when, classes, weights: levels[when].shift(solver, classes, tier, weights))


def _parts(cells: pd.DataFrame) -> list[tuple[dict, pd.DataFrame]]:
    whole = {"size_class": ALL, "family": ALL}
    parts = [(whole, cells)]
    for column in whole:
        if cells[column].nunique() > 1:
            parts += [(whole | {column: value}, part) for value, part in cells.groupby(column, sort=False)]
    return parts


# ----- how far what is published moved


def moved_table(old: Campaign, new: Campaign) -> tuple[pd.DataFrame, list[str]]:
    """A row per value, the one that moved most first; and what only one of the campaigns has.

    @throws ReportError where they have no solver and class in common
    """
    runs = [measured(old), measured(new)]
    parts = [set(zip(*(run.cells[key] for key in ("solver", "size_class", "tier")))) for run in runs]
    common = parts[0] & parts[1]
    if not common:
        raise ReportError("campaign.json", "OLD and NEW have no solver and size class in common", "two runs of the same")
    alone = [f"{side} only: {solver} at {size_class} rows, tier {tier:g}" for side, own in zip(_SIDES, parts)
             for solver, size_class, tier in sorted(own - common)]
    runs = [Measured(*(table[[key in common for key in zip(table["solver"], table["size_class"], table["tier"])]]
                       for table in run)) for run in runs]
    own = {key for key, entry in (old.solvers | new.solvers).items() if is_own(entry)}
    ours = tables.main_own([key for key in dict.fromkeys(runs[0].cells["solver"]) if key in own])
    rivals = [rival_table(run.cells, own, ours, Levels(run.launches)) for run in runs]
    front = {(of.tier, of.size_class, of.rival) for table in rivals for of in table.itertuples() if of.rival != FASTEST}
    first, second = (_published(run, table, front, ours) for run, table in zip(runs, rivals))
    rows = [_moved(key, first[key], second[key]) for key in first
            if key in second and not (math.isnan(first[key][0]) and math.isnan(second[key][0]))]
    if not rows:
        raise ReportError("campaign.json", "no median is known in OLD and NEW", "two runs of the same")
    table = pd.DataFrame(rows, columns=MOVED_COLUMNS)
    return table.sort_values(["agrees", "moved"], key=lambda column: column if column.name == "agrees" else -column.abs(),
                             kind="stable", ignore_index=True), alone


def _published(run: Measured, rivals: pd.DataFrame, front: set[tuple], ours: str) -> dict[tuple, tuple]:
    """(tier, size class, what) -> value and interval: medians of every solver, and ratios to the front, the portfolio
    and the fastest peers."""
    levels, found = Levels(run.launches), {}
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
                    (of.ratio, of.ratio_low, of.ratio_high) for of in rivals.itertuples() if of.rival == FASTEST}


def _moved(key: tuple, old: tuple[float, float, float], new: tuple[float, float, float]) -> list:
    same = old[0] == new[0]  # also both infinite
    moved = 0.0 if same else new[0] / old[0] - 1
    within = all(map(math.isfinite, (old[0], new[0]))) and any(
        low <= value <= high for value, (_, low, high) in ((old[0], new), (new[0], old)))
    return [*key, *old, *new, moved, same or abs(moved) <= REACH or within]


# ----- the same results


@dataclass
class Part:
    """Which of the plan's keys, the problems or the cells differ between A, the OLD one, and B."""

    both: int  # there in A and in B
    lists: dict[str, list[str]]  # "": those that differ, with what does; "A only: ", "B only: "
    out_of_time: int = 0  # of those that differ: cells where a time limit ended a solve

    @property
    def same(self) -> bool:
        return not any(self.lists.values())


def same_results(a: Campaign, b: Campaign) -> dict[str, Part]:
    plans = [{k: {k: v} for k, v in c.info.items() if k not in _ENVIRONMENT} for c in (a, b)]
    problems = [{name: about | {"oracle_s": None} for name, about in c.problems.items()} for c in (a, b)]
    return {"keys of the plan": _compared(*plans), "problems": _compared(*problems), "cells": _compared_cells(a, b)}


def _compared(a: dict, b: dict) -> Part:
    return _part(a, b, lambda key: _differences("", a[key], b[key]))


def _part(a: Collection, b: Collection, differences: Callable[..., list[str]], name: Callable = str) -> Part:
    both = [key for key in a if key in b]
    differ = [f"{name(key)}: {'; '.join(found)}" for key in both if (found := differences(key))]
    return Part(len(both), {"": differ, "A only: ": [name(key) for key in a if key not in b],
                            "B only: ": [name(key) for key in b if key not in a]})


def _compared_cells(a: Campaign, b: Campaign) -> Part:
    first, second = (pd.concat([cell_table(c), cell_table(c, True)]).set_index(KEY)[list(CELL_FIELDS)] for c in (a, b))
    common = first.index.intersection(second.index, sort=False)
    one, two = first.loc[common], second.loc[common]
    other = ~((one == two) | (one.isna() & two.isna())).to_numpy()
    differ = {common[at]: [f"{name} {_word(one.iat[at, k])} | {_word(two.iat[at, k])}" for k, name in enumerate(CELL_FIELDS)
                           if other[at, k]] for at in np.flatnonzero(other.any(axis=1))}
    part = _part(first.index, second.index, lambda key: differ.get(key, []), cell_name)
    late = one["claim"].isin(("time_limit", "killed")) | two["claim"].isin(("time_limit", "killed"))
    part.out_of_time = int((late & other.any(axis=1)).sum())
    return part


def cell_name(key: tuple) -> str:
    """@param key  the values of KEY"""
    problem, solver, tier = key
    return f"solve/{problem}/{solver}/{tier:g}"


def _differences(path: str, a, b) -> list[str]:
    """Every place at which they differ, objects key by key. True is not 1 here."""
    if isinstance(a, dict) and isinstance(b, dict):
        return [place for key in dict.fromkeys([*a, *b]) for place in
                _differences(f"{path}.{key}" if path else str(key), a.get(key, _MISSING), b.get(key, _MISSING))]
    same = a == b and isinstance(a, bool) == isinstance(b, bool)
    return [] if same else [f"{path} {_word(a)} | {_word(b)}"]


def _word(value) -> str:
    if value is _MISSING:
        return "missing"
    if isinstance(value, float):
        return repr(value) if math.isfinite(value) else "not known"  # all digits: it may be the last one
    text = str(value)
    return text if len(text) <= 60 else text[:57] + "..."
