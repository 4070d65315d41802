"""Confidence intervals (95 %)."""

import math
from collections.abc import Callable

import numpy as np
from scipy import stats

CONFIDENCE = 0.95
RESAMPLES = 1000
SEED = 20240607  # of the bootstrap: the same tables from the same files
# A ratio of times nearer to 1 than this is never called a difference, however sure its interval is: clock drift, code
# alignment and memory layout move all problems alike by a per cent or so (Mytkowicz et al. 2009), and no resampling of
# problems or repetitions can see what they have in common.
MARGIN = 1.02


def bootstrap_interval(values, statistic: Callable) -> tuple[float, float]:
    """Percentile bootstrap (Efron 1979; Efron & Tibshirani 1993, chapter 13), by scipy.stats.bootstrap.

    Percentiles and not BCa: that one estimates its acceleration by the jackknife, which is inconsistent for a median
    (Efron & Tibshirani, section 11.6), and is undefined where all values are equal.
    @param statistic  takes (values, axis)
    @returns NaN twice with fewer than two values
    """
    sample = np.asarray(values, dtype=float)
    if len(sample) < 2:
        return math.nan, math.nan
    interval = stats.bootstrap((sample,), statistic, n_resamples=RESAMPLES, confidence_level=CONFIDENCE,
                               method="percentile", vectorized=True,
                               random_state=np.random.default_rng(SEED)).confidence_interval
    return float(interval.low), float(interval.high)


def share_interval(count: int, total: int) -> tuple[float, float]:
    """Of a probability after `count` out of `total` (Wilson 1927); NaN twice where the total is 0."""
    if total == 0:
        return math.nan, math.nan
    interval = stats.binomtest(int(count), int(total)).proportion_ci(CONFIDENCE, method="wilson")
    return float(interval.low), float(interval.high)
