"""What changed between two campaigns of one plan, OLD and NEW: another commit, build or machine.

Verdicts, cell by cell. Times, per solver over all problems, per size class and per family, by the paired statistics of
pairwise.py (weights, bases, families, and launches of either campaign): ratios NEW / OLD of fresh times on the problems
that both verified, adjusted by Holm over all these comparisons together. What else a machine does lasts for many problems
and moves whole launches: campaigns of one launch cannot tell that from a change.

A regression is a solver, or a solver on a class or family, that is slower by that; a cell that was verified and is not
any more; or a false success that was none before. Cells that only one of the campaigns has are told, and judged by
nobody. Builds may differ in which solvers they have and of what version; what every solver was asked must not.
"""

import json
import math
from dataclasses import dataclass

import numpy as np
import pandas as pd

from ..errors import ReportError
from . import pairwise
from .cells import BELOW_TIER, FALSE_SUCCESS, KEY, VERIFIED, measured
from .groups import COUNTED, GROUP, with_label
from .intervals import Bootstrap, holm
from .launches import Levels
from .load import TASK_BUDGET, Campaign
from .same import ENVIRONMENT

SLOWER, FASTER = "slower", "faster"
ALL = "all"  # size classes, or families
_OLD, _NEW = "old", "new"
_VERDICTS = {pairwise.A_FASTER: FASTER, pairwise.B_FASTER: SLOWER}
SPEED_COLUMNS = ["solver", "size_class", "family", *GROUP, "problems", "ratio", "ratio_low", "ratio_high", "p", "verdict"]
# What a solver was asked; only variants have `base` and `settings`. The rest describes its build, or is a
# label (`setting`).
_ASKED = {"uses_tolerance": None, "tolerance": None, "ablation": None, "base": "", "settings": {}}
_LEAST_BASES = 6  # fewer cannot reach the level, 2 / 2^5 > 0.05, and would cost the others theirs
_OF_PROBLEMS = ["set", "counts", "base", "weight", "origin", "fill", "family", "rows", "size_class", "reference"]


@dataclass
class Changes:
    """Tables of what changed; rows of cells have KEY."""

    cells: pd.DataFrame  # in both: columns of cells.py with the suffixes _old and _new
    only_old: pd.DataFrame  # rows of cells.py
    only_new: pd.DataFrame
    speeds: pd.DataFrame  # SPEED_COLUMNS, all comparisons; `verdict` is SLOWER, FASTER or ""

    def __post_init__(self):
        old, new = (self.cells[f"verdict_{when}"] for when in (_OLD, _NEW))
        was, is_ = old == VERIFIED, new == VERIFIED
        wrong = (FALSE_SUCCESS, BELOW_TIER)
        self.lost = self.cells[was & ~is_]  # verified before, and not now
        self.gained = self.cells[~was & is_]
        self.both_verified = self.cells[was & is_]
        # New ones, those of `lost` among them; of solvers that were not asked for the tier, answers below it.
        self.false_successes = self.cells[~old.isin(wrong) & new.isin(wrong)]
        self.slower, self.faster = (self.speeds[self.speeds["verdict"] == verdict] for verdict in (SLOWER, FASTER))
        self.regressed = not (self.slower.empty and self.lost.empty and self.false_successes.empty)


def compare_campaigns(old: Campaign, new: Campaign) -> Changes:
    """@throws ReportError where they are not of one plan, or have no cell in common"""
    require_same_plan(old, new)
    both = measured(old), measured(new)
    # What had no turn within the task's budget is as if it were not there: a slow machine is no wrong answer.
    tables = [table[table["excluded"] != TASK_BUDGET] for table in (with_label(one.cells) for one in both)]
    keys = [pd.MultiIndex.from_frame(table[KEY]) for table in tables]
    cells = tables[0].merge(tables[1].drop(columns=_OF_PROBLEMS), on=KEY, suffixes=("_old", "_new"))
    if cells.empty:
        raise ReportError("streams.jsonl", "OLD and NEW have no cell in common", "two campaigns of one plan")
    return Changes(cells, tables[0][~keys[0].isin(keys[1])], tables[1][~keys[1].isin(keys[0])],
                   _speeds(cells, {when: Levels(one.launches, when) for when, one in zip((_OLD, _NEW), both)}))


def require_same_plan(old: Campaign, new: Campaign) -> None:
    """@throws ReportError naming the first key of campaign.json that differs"""
    def require(file: str, what: str, a, b) -> None:
        if a != b:
            words = [text if len(text) <= 80 else text[:77] + "..." for text in map(json.dumps, (a, b))]
            raise ReportError(file, f"{what} is {words[0]} in OLD and {words[1]} in NEW", "two campaigns of one plan")

    for key in dict.fromkeys([*old.info, *new.info]):
        if key not in (*ENVIRONMENT, "solvers"):
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
