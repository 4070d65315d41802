"""Launches: each is a process of its own, which meets every problem of a size class once.

What differs between launches (memory layout, clock rate, neighbours) is common to all solves of one, and no resampling of
problems can see it (Kalibera & Jones 2013). So a launch has a *level*: the weighted median over problems of
log(time in the launch / median time over the launches). Intervals have launches as their top level: a resample draws
the launches of a solver with replacement and multiplies its times by exp(c (mean drawn level - mean level)), on both
sides of a ratio. c = sqrt(L / (L - 1)) t / z widens the draws of L launches to Student's interval (Hesterberg 2015,
"expanded percentile"): two launches say little, and ten nearly what they seem to. The mean is drawn though medians are
compared, because medians of few launches take few values; by simulation 95 % intervals hold in 93 to 96 % for 2 to 10
launches, normal or with Student's tails of three degrees (test_statistics_intervals.py).

A single launch tells nothing of others: then an interval is of problems only.
"""

import math
import zlib

import numpy as np
import pandas as pd
from scipy import stats

from .intervals import CONFIDENCE, RESAMPLES
from .model import PART_TIMES
from .weighted import quantiles, weighted_median

KEY = ["solver", "size_class", "tier"]
TOGETHER = 0  # the number of the row of all launches together
_QUANTILES = {"p50_s": 0.5, "p90_s": 0.9, "p99_s": 0.99, "max_s": 1.0}
# Weighted medians of verified answers, in the row of all together.
MEDIANS = ("again_s", "first_s", *PART_TIMES)
OF_LAUNCH = ["level", *_QUANTILES, "disturbed"]
COLUMNS = [*KEY, "launch", *OF_LAUNCH, *MEDIANS]
_Z = float(stats.norm.ppf((1 + CONFIDENCE) / 2))


def launch_rows(numbers: list[int], fresh: np.ndarray, disturbed: np.ndarray, passes: np.ndarray, weights: np.ndarray,
                times: dict[str, np.ndarray]) -> list[dict]:
    """Of a solver, size class and tier a row per launch, after one of all launches together (those that were not
    disturbed, where there are any). Quantiles are of single solves by the problems' weight, what is not verified infinite.

    @param numbers  of the launches
    @param fresh, disturbed  launches x problems that the solver was given and that count (all of a class that has none):
                             times, NaN where there is none; whether the machine disturbed the launch
    @param times    columns of the table of cells: fresh_s and MEDIANS
    """
    rows, calm = [], []
    for number, of_launch, bad_ones in zip(numbers, fresh, disturbed):
        known = passes & ~np.isnan(of_launch)
        if known.any():
            solves = np.where(passes, of_launch, math.inf)
            bad = bool(bad_ones[known].any())
            level = weighted_median(np.log(of_launch[known] / times["fresh_s"][known]), weights[known])
            rows.append({"launch": number, "level": level, "disturbed": bad} | quantiles(solves, weights=weights, levels=_QUANTILES))
            calm.append((bad, solves))
    whole = [solves for bad, solves in calm if not bad] or [solves for _, solves in calm]
    whole = whole or [np.where(passes, math.nan, math.inf)]
    together = {"launch": TOGETHER, "level": 0.0, "disturbed": False}
    together |= quantiles(np.concatenate(whole), weights=np.tile(weights, len(whole)), levels=_QUANTILES)
    for key in MEDIANS:
        known = passes & ~np.isnan(times[key])
        together[key] = weighted_median(times[key][known], weights[known])
    return [together, *rows]


class Levels:
    """Draws of launches: of every solver, size class and tier the same ones each time."""

    def __init__(self, launches: pd.DataFrame | None = None, salt: str = ""):
        """@param salt  of one of several campaigns, whose launches are drawn independently"""
        self._salt, self._drawn = salt, {}
        table = pd.DataFrame(columns=COLUMNS) if launches is None else launches.drop_duplicates([*KEY, "launch"])
        together = table["launch"] == TOGETHER
        self._launches = dict(tuple(table[~together].groupby(KEY, sort=False)[["level", "disturbed"]]))
        self._together = table[together].set_index(KEY).to_dict("index")

    def together(self, solver: str, size_class: str, tier: float, key: str) -> float:
        """A column of all launches together; NaN where it is not known."""
        return self._together.get((solver, size_class, tier), {}).get(key, math.nan)

    def count(self, solver: str, size_class: str, tier: float) -> int:
        return len(self._launches.get((solver, size_class, tier), ()))

    def draws(self, solver: str, size_class: str, tier: float) -> np.ndarray | float:
        """The shift of logarithms of its times in every resample; 0 with fewer than two launches."""
        key = (solver, size_class, tier)
        if key not in self._drawn:
            self._drawn[key] = self._draw(key) if key in self._launches else 0.0
        return self._drawn[key]

    def shift(self, solvers, size_classes: pd.Series, tier: float, weights) -> np.ndarray | float:
        """The mean of the shifts of several classes, or of several solvers, by weight: how far a median over all of them
        moves, if it moves with each alike.

        @param solvers  one, or of every problem its own
        """
        if not self._launches or not len(weights):
            return 0.0
        classes, of_class = pd.factorize(size_classes)
        who, of_solver = (0, [solvers]) if isinstance(solvers, str) else pd.factorize(solvers)
        sums = np.bincount(classes * len(of_solver) + who, weights, len(of_class) * len(of_solver)) / np.sum(weights)
        return sum(sums[at] * self.draws(of_solver[at % len(of_solver)], of_class[at // len(of_solver)], tier)
                   for at in np.flatnonzero(sums))

    def _draw(self, key: tuple) -> np.ndarray | float:
        table = self._launches[key]
        calm = ~table["disturbed"].astype(bool)
        levels = (table[calm] if calm.any() else table)["level"].to_numpy(dtype=float)
        count = len(levels)
        if count < 2:
            return 0.0
        # The same draws wherever the same number of launches is calm: what a neighbour does may last.
        rng = np.random.default_rng(zlib.crc32(f"{self._salt}|{key[0]}".encode()))
        wider = math.sqrt(count / (count - 1)) * float(stats.t.ppf((1 + CONFIDENCE) / 2, count - 1)) / _Z
        return wider * (levels[rng.integers(0, count, (RESAMPLES, count))].mean(axis=1) - levels.mean())
