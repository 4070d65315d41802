"""What changed between two campaigns of one plan, OLD and NEW: another commit, build or machine.

Verdicts, cell by cell. Times, per solver over all problems and per family, by the paired statistics of pairwise.py:
ratios NEW / OLD on the problems that both verified, adjusted by Holm over all these comparisons together. That is done
twice, and both must say the same: once with the median of all repetitions, once with the quickest round's median. What
else a machine does lasts for many cells and some rounds, so that problems are not independent; but it only adds time,
and the quickest rounds had least of it (Chen & Revels 2016). Times of single cells are information only: Welch's t-test
(1947) on the logarithms of the medians of rounds, adjusted by Holm over all cells, and beyond MARGIN by compare.py. A
round is the unit there, for the repetitions of one are not independent (Kalibera & Jones 2013); so a cell needs two
rounds on either side.

A regression is a solver, or a solver on a family, that is slower by that; a cell that was verified and is not any
more; or a false success that was none before. Cells that only one of the campaigns has are told, and judged by nobody.
"""

import math
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy import stats

from ..errors import ReportError
from . import pairwise
from .cells import FALSE_SUCCESS, KEY, VERIFIED, cell_table
from .compare import compare_cells
from .groups import COUNTED, GROUP, with_label
from .holm import holm
from .intervals import share_interval
from .load import Campaign
from .plans import require_same_plan

SLOWER, FASTER = "slower", "faster"
ALL_FAMILIES = "all"
_OLD, _NEW = "old", "new"
_VERDICTS = {pairwise.A_FASTER: FASTER, pairwise.B_FASTER: SLOWER}
# `ratio` is that of medians, `quickest_ratio` that of the quickest rounds; p is the larger of the two.
SPEED_COLUMNS = ["solver", "family", *GROUP, "problems", "ratio", "ratio_low", "ratio_high", "quickest_ratio", "p",
                 "verdict"]
CELL_COLUMNS = [*KEY, "ratio", "ratio_low", "ratio_high", "p", "verdict"]
_LEAST_PROBLEMS = 6  # fewer cannot reach the level, 2 / 2^5 > 0.05, and would cost the others theirs
_LEAST_ROUNDS = 2  # on either side: Welch's test needs two variances


@dataclass
class Changes:
    """Tables of what changed; rows of cells have KEY."""

    cells: pd.DataFrame  # in both: columns of cells.py with the suffixes _old and _new
    only_old: pd.DataFrame  # rows of cells.py
    only_new: pd.DataFrame
    speeds: pd.DataFrame  # SPEED_COLUMNS, all comparisons; `verdict` is SLOWER, FASTER or ""
    single: pd.DataFrame  # CELL_COLUMNS, the cells whose time differs
    tested: int  # single cells

    @property
    def lost(self) -> pd.DataFrame:
        """Verified before, and not now."""
        return self.cells[(self.cells["verdict_old"] == VERIFIED) & (self.cells["verdict_new"] != VERIFIED)]

    @property
    def gained(self) -> pd.DataFrame:
        return self.cells[(self.cells["verdict_old"] != VERIFIED) & (self.cells["verdict_new"] == VERIFIED)]

    @property
    def false_successes(self) -> pd.DataFrame:
        """New ones, those of `lost` among them."""
        return self.cells[(self.cells["verdict_old"] != FALSE_SUCCESS) & (self.cells["verdict_new"] == FALSE_SUCCESS)]

    @property
    def slower(self) -> pd.DataFrame:
        return self.speeds[self.speeds["verdict"] == SLOWER]

    @property
    def faster(self) -> pd.DataFrame:
        return self.speeds[self.speeds["verdict"] == FASTER]

    @property
    def regressed(self) -> bool:
        return not (self.slower.empty and self.lost.empty and self.false_successes.empty)

    @property
    def both_verified(self) -> pd.DataFrame:
        return self.cells[(self.cells["verdict_old"] == VERIFIED) & (self.cells["verdict_new"] == VERIFIED)]

    def agreement(self) -> tuple[int, int, float, float]:
        """Of the cells that both verified: for how many the intervals of the median time overlap, and how many there
        are; and Wilson's interval of that share."""
        both = self.both_verified
        agree = int(((both["solve_low_old"] <= both["solve_high_new"]) &
                     (both["solve_low_new"] <= both["solve_high_old"])).sum())
        return agree, len(both), *share_interval(agree, len(both))

    def overall_ratio(self) -> float:
        """Median over all cells that both verified; what moves all solvers alike shows here."""
        both = self.both_verified
        return float(np.median(both["time_s_new"] / both["time_s_old"])) if len(both) else math.nan


def compare_campaigns(old: Campaign, new: Campaign) -> Changes:
    """@throws ReportError where they are not of one plan, or have no cell in common"""
    require_same_plan(old, new)
    tables = [with_label(cell_table(campaign)) for campaign in (old, new)]
    keys = [pd.MultiIndex.from_frame(table[KEY]) for table in tables]
    cells = tables[0].merge(tables[1].drop(columns=["set", "counts", "family", "rows", "reference"]), on=KEY,
                            suffixes=("_old", "_new"))
    if cells.empty:
        raise ReportError("cells.jsonl", "OLD and NEW have no cell in common", "two campaigns of one plan")
    single, tested = _single_cells(old, new, cells)
    return Changes(cells, tables[0][~keys[0].isin(keys[1])], tables[1][~keys[1].isin(keys[0])],
                   _speeds(old, new, cells), single, tested)


def _speeds(old: Campaign, new: Campaign, cells: pd.DataFrame) -> pd.DataFrame:
    """A row per solver and group, and per family of it where there are several."""
    keys = list(cells[KEY].itertuples(index=False, name=None))
    cells = cells.assign(quickest_old=[_quickest(old, key) for key in keys],
                         quickest_new=[_quickest(new, key) for key in keys])
    parts = []  # (label, cells)
    for (*group, solver), own in cells.groupby([*GROUP, "solver"], sort=False):
        label = {**dict(zip(GROUP, group)), "solver": solver}
        parts.append((label | {"family": ALL_FAMILIES}, own))
        if own["family"].nunique() > 1:
            parts += [(label | {"family": family}, part) for family, part in own.groupby("family", sort=False)]
    medians, quickest = (_comparisons([part for _, part in parts], time) for time in ("time_s", "quickest"))
    rows = []
    for (label, _), by_median, by_quickest in zip(parts, medians, quickest):
        agreed = by_median["verdict"] if by_median["verdict"] == by_quickest["verdict"] else ""
        rows.append(label | {"problems": by_median["both"], "quickest_ratio": by_quickest["ratio"],
                             "p": max(by_median["p"], by_quickest["p"]), "verdict": agreed}
                    | {key: by_median[key] for key in ("ratio", "ratio_low", "ratio_high")})
    table = pd.DataFrame(rows, columns=SPEED_COLUMNS)
    # Problems that count before those that do not; the largest change first.
    order = pd.DataFrame({"rest": table["set"] != COUNTED, "part": table["family"] != ALL_FAMILIES,
                          "size": -abs(np.log(table["ratio"]))}).sort_values(["rest", "part", "size"]).index
    return table.loc[order].reset_index(drop=True)


def _comparisons(parts: list[pd.DataFrame], time: str) -> list[dict]:
    """NEW with OLD on every part, by the column `time`; `p` is adjusted for all of them."""
    found = [pairwise.compare_two(pd.DataFrame({_NEW: part[f"{time}_new"], _OLD: part[f"{time}_old"]}), None, _NEW,
                                  _OLD) for part in parts]
    tests = [row["wilcoxon_p"] if row["both"] >= _LEAST_PROBLEMS else math.nan for row in found]
    for row, adjusted in zip(found, holm(tests)):
        verdict = pairwise.verdict(adjusted, row["direction"], row["ratio_low"], row["ratio_high"])
        row |= {"p": adjusted, "verdict": _VERDICTS.get(verdict, "")}
    return found


def _quickest(campaign: Campaign, key: tuple) -> float:
    """The least median of a round [s]; infinite where the answer was not verified."""
    runs = campaign.cells[key]
    if runs.record["excluded"] or not runs.record["passes"]:
        return math.inf
    return float(min(np.median(times) for times in runs.times()))


def _single_cells(old: Campaign, new: Campaign, cells: pd.DataFrame) -> tuple[pd.DataFrame, int]:
    """The cells whose time differs, and how many were tested."""
    both = cells[(cells["verdict_old"] == VERIFIED) & (cells["verdict_new"] == VERIFIED)]
    keys = list(both[KEY].itertuples(index=False, name=None))
    adjusted = holm([_welch(new.repetitions(*key), old.repetitions(*key)) for key in keys])
    rows = []
    for key, p in zip(keys, adjusted):
        if not p < pairwise.LEVEL:  # NaN is no evidence
            continue
        found = compare_cells(new.repetitions(*key), old.repetitions(*key))
        if found.differs:
            rows.append({**dict(zip(KEY, key)), "ratio": found.ratio, "ratio_low": found.low, "ratio_high": found.high,
                         "p": p, "verdict": SLOWER if found.ratio > 1 else FASTER})
    table = pd.DataFrame(rows, columns=CELL_COLUMNS)
    order = abs(np.log(table["ratio"].astype(float))).sort_values(ascending=False, kind="stable").index
    return table.loc[order].reset_index(drop=True), int(np.count_nonzero(~np.isnan(adjusted)))


def _welch(a: list[list[float]], b: list[list[float]]) -> float:
    """Two-sided p-value; NaN with too few rounds, or where no round differs from another."""
    logs = [np.log([np.median(times) for times in rounds]) for rounds in (a, b)]
    if min(map(len, logs)) < _LEAST_ROUNDS or all(np.ptp(x) == 0 for x in logs):
        return math.nan
    return float(stats.ttest_ind(*logs, equal_var=False).pvalue)
