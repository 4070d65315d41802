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

Launch k of all solvers of a size class and tier follows those of the others: a *round*, whose state of the machine they
share. So a ratio is formed round by round where two solvers have rounds in common (class_times.ratio), and a resample
draws rounds instead.

A launch whose level is off by more than OFF from that of calm ones, the lower quartile, is *flagged*, and left out where there
are others: what disturbs a launch makes it slower, and of two states of a machine the faster one is the calm one, though it
may be the rarer.
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
QUANTILES = {"p50_s": 0.5, "p90_s": 0.9, "p99_s": 0.99, "max_s": 1.0}
# Weighted medians of verified answers, in the row of all together.
MEDIANS = ("again_s", "first_s", *PART_TIMES)
OF_LAUNCH = ["level", *QUANTILES, "flagged", "began_s"]
COLUMNS = [*KEY, "launch", *OF_LAUNCH, *MEDIANS]
# How far a launch's level may lie from this quantile of those of its solver, size class and tier. Campaigns repeat the round
# of a launch that is as far from their median, without weights.
OFF, CALM = math.log(1.1), 0.25
FEW = 0.25  # of the launches; where more are flagged nobody knows which state is the usual one, and draws have all of them
LEAST_ROUNDS = 2  # in common
_Z = float(stats.norm.ppf((1 + CONFIDENCE) / 2))


def flagged(levels: np.ndarray) -> np.ndarray:
    """@param levels  of launches, NaN where it is not known, which is no flag"""
    known = levels[~np.isnan(levels)]
    return np.abs(levels - np.quantile(known, CALM)) > OFF if len(known) else np.zeros(len(levels), dtype=bool)


def without(times: np.ndarray, off: np.ndarray) -> np.ndarray:
    """Launches x problems; those that are flagged are NaN where a problem has others."""
    calm = ~np.isnan(times) & ~off[:, np.newaxis]
    return np.where(calm | ~calm.any(axis=0), times, math.nan)


def levels_of(times: np.ndarray, medians: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """The level of every launch, NaN of those without times.

    @param times    launches x problems; medians: of every problem, over its launches
    """
    logs = np.log(times / medians)
    return np.array([weighted_median(of[known], weights[known]) for of in logs for known in [~np.isnan(of)]])


def launch_rows(numbers: list[int], fresh: np.ndarray, levels: np.ndarray, off: np.ndarray, passes: np.ndarray, weights: np.ndarray,
                times: dict[str, np.ndarray], began: dict[int, float]) -> list[dict]:
    """Of a solver, size class and tier a row per launch, after one of all launches together (those that are not flagged,
    where there are any). Quantiles are of single solves by the problems' weight, what is not verified infinite.

    @param numbers  of the launches, whose levels and flags and beginnings [s] follow
    @param fresh    launches x problems that the solver was given and that count (all of a class that has none): times, NaN
                    where there is none
    @param times    columns of the table of cells: MEDIANS
    """
    solves = np.where(passes, fresh, math.inf)
    rows = [{"launch": number, "level": level, "flagged": bool(bad), "began_s": began.get(number, math.nan)}
            | quantiles(of, weights=weights, levels=QUANTILES)
            for number, level, bad, of in zip(numbers, levels, off, solves) if not math.isnan(level)]
    known = ~np.isnan(levels)
    whole = solves[known & ~off] if (known & ~off).any() else solves[known]
    whole = whole if len(whole) else np.where(passes, math.nan, math.inf)[np.newaxis]
    together = {"launch": TOGETHER, "level": 0.0, "flagged": False, "began_s": math.nan}
    together |= quantiles(whole.ravel(), weights=np.tile(weights, len(whole)), levels=QUANTILES)
    for key, of in times.items():
        known = passes & ~np.isnan(of)
        together[key] = weighted_median(of[known], weights[known])
    return [together, *rows]


class Levels:
    """Draws of launches: of every solver, size class and tier the same ones each time."""

    def __init__(self, launches: pd.DataFrame | None = None, salt: str = "", times: dict[tuple, pd.DataFrame] | None = None):
        """@param salt  names the draws: those of another name are independent
        @param times  of every launch (cells.Measured); without them there are no rounds
        """
        self._salt, self._drawn, self._times = salt, {}, times or {}
        table = pd.DataFrame(columns=COLUMNS) if launches is None else launches.drop_duplicates([*KEY, "launch"])
        together = table["launch"] == TOGETHER
        self._launches = dict(tuple(table[~together].groupby(KEY, sort=False)[["launch", "level", "flagged"]]))
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

    def rounds(self, side: pd.DataFrame, tier: float) -> pd.DataFrame:
        """Times of problems x numbers of rounds, NaN where there is none.

        @param side  rows by problem, with columns solver, of every problem its own, and size_class
        """
        found = [self._of_rounds((solver, size_class, tier)).reindex(of.index)
                 for (solver, size_class), of in side.groupby(["solver", "size_class"], observed=True)
                 if (solver, size_class, tier) in self._times]
        return pd.concat(found).reindex(side.index) if found else pd.DataFrame(index=side.index)

    def _of_rounds(self, key: tuple) -> pd.DataFrame:
        times, table = self._times[key], self._launches.get(key)
        off = times.columns.isin(table["launch"][table["flagged"].astype(bool)] if table is not None else [])
        return pd.DataFrame(without(times.to_numpy().T, off).T, times.index, times.columns) if off.any() else times

    def spread(self, levels: np.ndarray, whose: str) -> np.ndarray | float:
        """Draws of launches, or of rounds, of these levels: the shift of logarithms in every resample; 0 of fewer than two."""
        count = len(levels)
        if count < 2:
            return 0.0
        rng = np.random.default_rng(zlib.crc32(f"{self._salt}|{whose}".encode()))
        wider = math.sqrt(count / (count - 1)) * float(stats.t.ppf((1 + CONFIDENCE) / 2, count - 1)) / _Z
        return wider * (levels[rng.integers(0, count, (RESAMPLES, count))].mean(axis=1) - levels.mean())

    def _draw(self, key: tuple) -> np.ndarray | float:
        table = self._launches[key]
        calm = ~table["flagged"].astype(bool)
        # The same draws wherever the same number of launches is calm: what a neighbour does may last.
        return self.spread((table[calm] if 1 - FEW <= calm.mean() else table)["level"].to_numpy(dtype=float), key[0])
