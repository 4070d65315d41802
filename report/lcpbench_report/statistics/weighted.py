"""Statistics of problems that weigh differently: each of the k variants of one base weighs 1/k, so that one recipe with
many variants says no more than another one with few.

With equal weights they are the usual ones.
"""

import math

import numpy as np

_LEVELS = {"min": 0, "p25": 0.25, "median": 0.5, "p75": 0.75, "p90": 0.9, "p99": 0.99, "max": 1}
_ROUNDING = 1e-9  # of sums of weights, relative


def weighted_quantiles(values, weights, levels) -> list[float]:
    """The quantile of each level: the least value with at least that share of the weight at or below it; where that is
    exactly the level, the mean of it and the next one (Hyndman & Fan 1996, definition 2, with weights). inf is a value; NaN without
    any."""
    values, weights = np.asarray(values, dtype=float), np.asarray(weights, dtype=float)
    if not len(values):
        return [math.nan] * len(levels)
    order = np.argsort(values, kind="stable")
    values, below = values[order], np.cumsum(weights[order])
    below /= below[-1]
    found = []
    for level in levels:
        at = min(int(np.searchsorted(below, level - _ROUNDING)), len(order) - 1)
        after = min(at + 1, len(order) - 1) if below[at] <= level + _ROUNDING and level > 0 else at
        found.append(float((values[at] + values[after]) / 2))
    return found


def weighted_median(values, weights) -> float:
    return weighted_quantiles(values, weights, [0.5])[0]


def weighted_share(holds, weights) -> float:
    """The share of the weight where `holds`; NaN without any."""
    weights = np.asarray(weights, dtype=float)
    return float(weights[np.asarray(holds, dtype=bool)].sum() / weights.sum()) if len(weights) else math.nan


def effective_number(weights, bases) -> float:
    """How many equally weighted bases say as much (Kish 1965): (sum of v)^2 / sum of v^2, where v is the weight of a base.

    @param bases  of every problem the base that it is a variant of, or anything that names it
    """
    of_bases = np.bincount(np.unique(np.asarray(bases), return_inverse=True)[1], np.asarray(weights, dtype=float))
    return float(of_bases.sum() ** 2 / (of_bases ** 2).sum()) if of_bases.any() else 0.0


def quantiles(values, prefix: str = "", weights=None, levels: dict[str, float] | None = None) -> dict[str, float]:
    """Of the values that are not NaN, NaN without any; by default smallest, quartiles, 90 and 99 per cent, largest."""
    values = np.asarray(values, dtype=float)
    weights = np.ones(len(values)) if weights is None else np.asarray(weights, dtype=float)
    known, levels = ~np.isnan(values), levels or _LEVELS
    found = weighted_quantiles(values[known], weights[known], list(levels.values()))
    return {prefix + name: value for name, value in zip(levels, found)}
