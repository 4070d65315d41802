"""Confidence intervals (95 %), and multiple comparisons."""

import math

import numpy as np
import pandas as pd
from scipy import stats

from .model import ORIGIN_GROUPS
from .weighted import effective_number, weighted_share

CONFIDENCE = 0.95
RESAMPLES = 1000
SEED = 20240607  # of the bootstrap: the same tables from the same files
# A ratio of times nearer to 1 than this is never called a difference, however sure its interval is: clock drift, code
# alignment and memory layout move all problems alike by a per cent or so (Mytkowicz et al. 2009), and no resampling of
# problems can see what they have in common.
MARGIN = 1.02
_TAIL = (1 - CONFIDENCE) / 2
_ROUNDING = 1e-5  # of sums of weights in single precision, relative
_Z = float(stats.norm.ppf(1 - _TAIL))
_MANY = 200  # values: of more only those are looked at where medians of resamples lie
_ROOM = 0.03  # of the weight, on either side of them


class Bootstrap:
    """Percentile bootstrap (Efron & Tibshirani 1993, chapter 13) of problems, in strata: own scenes and engines (model.
    ORIGIN_GROUPS) have as much weight in every resample as in the sample. In a stratum families are drawn with replacement,
    and within each family drawn its bases (Davison & Hinkley 1997, section 3.8). Problems of one base, which differ in
    one number, are drawn together; so are families, for another collection would have others. Above problems stand the
    launches, by the argument `shift`: what launches.Levels draws.

    Percentiles and not BCa: that one estimates its acceleration by the jackknife, which is inconsistent for a median
    (Efron & Tibshirani, section 11.6), and is undefined where all values are equal.
    """

    def __init__(self, problems: pd.DataFrame):
        """@param problems  columns problem, origin, family and base; more than one row of a problem does not matter"""
        problems = problems.drop_duplicates("problem")
        clusters = problems[["origin", "family", "base"]].astype(str)
        numbers, known = pd.MultiIndex.from_frame(clusters.assign(origin=clusters["origin"].map(ORIGIN_GROUPS))).factorize()
        self._base_of = pd.Series(numbers, index=problems["problem"].to_numpy())
        self._drawn = _draw(known.droplevel(2).factorize()[0], known.get_level_values(0).factorize()[0])

    def median(self, problems, values, weights, shift=0.0) -> tuple[float, float]:
        """Interval of the weighted median; inf is a value.

        @param problems  the problem of every value; they need not be all
        @param shift     of the values' logarithms in every resample
        @returns NaN twice with fewer than two bases
        """
        values, weights, bases = self._sample(values, weights, problems)
        if len(np.unique(bases)) < 2:
            return math.nan, math.nan
        order = np.argsort(values, kind="stable")
        return interval_of(self._medians(values[order], weights[order].astype(np.float32), bases[order]) * np.exp(shift))

    def mean(self, problems, values, weights, inverse=lambda mean: mean, over=None, shift=0.0) -> tuple[float, float]:
        """Interval of inverse(weighted mean + shift), or of its ratio to that of the values `over`, drawn together."""
        if len(np.unique(self._base_of.loc[np.asarray(problems)])) < 2:
            return math.nan, math.nan
        found = [inverse(self.means(problems, each, weights) + shift) for each in (values, *([] if over is None else [over]))]
        return interval_of(found[0] / found[1] if over is not None else found[0])

    def means(self, problems, values, weights) -> np.ndarray:
        """The weighted mean in every resample; NaN in those that have none of the problems."""
        values, weights, bases = self._sample(values, weights, problems)
        whole = self._sums(bases, weights)
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(whole > 0, self._sums(bases, weights * values) / whole, math.nan)

    def base_means(self, problems, values, weights) -> np.ndarray:
        """The weighted mean of every base that has values."""
        values, weights, bases = self._sample(values, weights, problems)
        whole = np.bincount(bases, weights)
        return np.bincount(bases, weights * values)[whole > 0] / whole[whole > 0]

    def _sample(self, values, weights, problems) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return (np.asarray(values, dtype=float), np.asarray(weights, dtype=float),
                self._base_of.loc[np.asarray(problems)].to_numpy())

    def _sums(self, bases: np.ndarray, values: np.ndarray) -> np.ndarray:
        # Not by BLAS, whose threads wait for each other longer than this takes.
        return np.einsum("b,br->r", np.bincount(bases, values, len(self._drawn)).astype(np.float32), self._drawn)

    def _medians(self, values: np.ndarray, weights: np.ndarray, bases: np.ndarray) -> np.ndarray:
        """The median of every resample, NaN of those that have none; the values are sorted. Among many values only those in the middle are looked
        at: a median beyond them, which is rarer than either tail, becomes the last of them."""
        half = self._sums(bases, weights) / 2
        chosen = half > 0
        windows = [(0, len(values))]
        if len(values) > _MANY:
            share = np.cumsum(weights) / weights.sum()
            middle = int(np.searchsorted(share, 0.5))
            below = self._sums(bases[:middle], weights[:middle])[chosen] / half[chosen] / 2
            reach = 1 - np.quantile(below, [1 - _TAIL, _TAIL]) + [-_ROOM, _ROOM]
            windows.insert(0, tuple(np.searchsorted(share, reach)))
        for first, last in windows:
            sums = self._drawn[bases[first:last]]
            sums *= weights[first:last, np.newaxis]
            np.cumsum(sums, axis=0, out=sums)
            before = self._sums(bases[:first], weights[:first])
            sums += before
            beyond = [(before >= half)[chosen].mean(), (sums[-1] < half)[chosen].mean() if last < len(values) else 0]
            if first == 0 or max(beyond) < _TAIL / 2:
                break
        # Where running sums of weights reach half; the mean with the next one where they equal it.
        values, sums, half = values[first:last], sums[:, chosen], half[chosen]
        low, high = ((sums < half * factor).sum(axis=0) for factor in (1 - _ROUNDING, 1 + _ROUNDING))
        found = np.full(len(chosen), math.nan)
        found[chosen] = (values[np.minimum(low, len(values) - 1)] + values[np.minimum(high, len(values) - 1)]) / 2
        return found


def share_interval(share: float, count: float) -> tuple[float, float]:
    """The interval of a probability whose estimate is a share of so many observations (Wilson 1927); NaN twice where
    there are none."""
    if not count > 0:
        return math.nan, math.nan
    z, reach = _Z, _Z * math.sqrt(share * (1 - share) / count + (_Z / (2 * count)) ** 2)
    centre, size = share + z * z / (2 * count), 1 + z * z / count
    return (centre - reach) / size if share > 0 else 0.0, (centre + reach) / size if share < 1 else 1.0


def share_with_interval(holds, weights, bases, name: str, prefix: str) -> dict[str, float]:
    """The share of the weight where `holds`: {name, prefix_low, prefix_high}. As many observations as the weights of bases
    are worth (weighted.effective_number): problems that differ in one number say little more than one."""
    share = weighted_share(holds, weights)
    low, high = share_interval(share, effective_number(weights, bases))
    return {name: share, f"{prefix}_low": low, f"{prefix}_high": high}


def _draw(families: np.ndarray, strata: np.ndarray) -> np.ndarray:
    """@param families, strata  of every base its family and its stratum, numbered from 0
    @returns bases x RESAMPLES: how often every base is drawn
    """
    rng = np.random.default_rng(SEED)
    drawn = np.zeros((len(families), RESAMPLES), dtype=np.float32)
    for stratum in np.unique(strata):
        there = np.unique(families[strata == stratum])
        often = rng.multinomial(len(there), np.full(len(there), 1 / len(there)), RESAMPLES)
        for family, times in zip(there, often.T):
            own = np.flatnonzero(families == family)
            drawn[own] = rng.multinomial(times * len(own), np.full(len(own), 1 / len(own))).T
    return drawn


def interval_of(found: np.ndarray) -> tuple[float, float]:
    """The interval of the resamples' results, without NaN; outwards to a value that was found, since nothing lies between
    infinite ones."""
    found = found[~np.isnan(found)]
    if not len(found):
        return math.nan, math.nan
    low = int(_TAIL * (len(found) - 1))
    ordered = np.partition(found, [low, len(found) - 1 - low])
    return float(ordered[low]), float(ordered[len(found) - 1 - low])


def holm(p_values) -> np.ndarray:
    """Adjusted p-values of the step-down procedure (Holm 1979): with p ascending, the largest of min(1, (m - j) p_j)
    over j = 0..i. Comparing them with a level keeps the probability of any false alarm among the m tests below it.

    NaN is no test: it stays, and does not count among the m.
    """
    p = np.asarray(p_values, dtype=float)
    order = np.argsort(p)[:np.count_nonzero(~np.isnan(p))]  # NaN is sorted last
    adjusted = np.full(len(p), np.nan)
    factors = len(order) - np.arange(len(order))
    adjusted[order] = np.minimum(np.maximum.accumulate(factors * p[order]), 1.0)
    return adjusted
