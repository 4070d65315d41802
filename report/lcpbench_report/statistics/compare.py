"""Two cells of the same problem, by their repetitions alone: two runs of one binary, say.

The ratio of medians with a percentile bootstrap interval. What is drawn again are whole rounds where both cells have
LEAST_ROUNDS or more, for repetitions of one round share clock rate, memory layout and neighbours, and are not
independent (Kalibera & Jones 2013); with fewer rounds single repetitions, and then the interval says nothing about
what changes between rounds. What is common to all rounds of a run it cannot say in either case: that is what MARGIN is
for.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy import stats

from .intervals import CONFIDENCE, MARGIN, RESAMPLES, SEED

LEAST_ROUNDS = 5


@dataclass
class CellComparison:
    """Times of A over those of B."""

    ratio: float
    low: float
    high: float
    by_rounds: bool  # what was drawn: rounds, else repetitions

    @property
    def differs(self) -> bool:
        """Whether the whole interval lies beyond MARGIN; not where it is unknown."""
        return self.low > MARGIN or self.high < 1 / MARGIN


def compare_cells(a: list[list[float]], b: list[list[float]]) -> CellComparison:
    """@param a, b  solve times [s], a list for every round, none of them empty; see Campaign.repetitions
    @returns an interval of NaN where a cell has fewer than two repetitions
    """
    by_rounds = min(len(a), len(b)) >= LEAST_ROUNDS
    first, second = (_by_rounds(x) if by_rounds else np.concatenate(x)[:, np.newaxis] for x in (a, b))
    ratio = math.exp(_log_median(first) - _log_median(second))
    if min(len(first), len(second)) < 2:
        return CellComparison(ratio, math.nan, math.nan, by_rounds)

    def statistic(i, j, axis):
        return _log_median(first[i]) - _log_median(second[j])

    interval = stats.bootstrap((np.arange(len(first)), np.arange(len(second))), statistic, n_resamples=RESAMPLES,
                               confidence_level=CONFIDENCE, method="percentile", vectorized=True,
                               random_state=np.random.default_rng(SEED)).confidence_interval
    return CellComparison(ratio, math.exp(interval.low), math.exp(interval.high), by_rounds)


def _by_rounds(rounds: list[list[float]]) -> np.ndarray:
    """Rounds x repetitions, NaN where a round has fewer than the longest."""
    table = np.full((len(rounds), max(map(len, rounds))), np.nan)
    for row, times in zip(table, rounds):
        row[:len(times)] = times
    return table


def _log_median(units: np.ndarray) -> np.ndarray:
    """Over the last two axes: units, and the repetitions in each."""
    return np.log(np.nanmedian(units, axis=(-2, -1)))
