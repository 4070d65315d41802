"""The mathematics of the report, free of files and column names."""

import math
import statistics
from dataclasses import dataclass

import numpy as np
import pandas as pd


@dataclass
class Slope:
    """t ~ c n^exponent by least squares in log-log over the larger half of the sizes."""

    exponent: float
    coefficient: float  # c, in the unit of t
    n_min: int
    n_max: int
    points: int


def fit_slope(sizes: list[float], times: list[float]) -> Slope | None:
    """Growth of `times` over the larger half (rounded up) of `sizes`; pairs that are not finite and > 0 do not count.

    The larger half, because small problems measure call overhead. None with fewer than two distinct sizes in it.
    """
    pairs = sorted((n, t) for n, t in zip(sizes, times) if math.isfinite(n) and math.isfinite(t) and n > 0 and t > 0)
    distinct = sorted({n for n, _ in pairs})
    upper = distinct[len(distinct) // 2:]
    if len(upper) < 2:
        return None
    x = np.log([n for n, _ in pairs if n >= upper[0]])
    y = np.log([t for n, t in pairs if n >= upper[0]])
    exponent = float(((x - x.mean()) * (y - y.mean())).sum() / ((x - x.mean()) ** 2).sum())
    return Slope(exponent, float(np.exp(y.mean() - exponent * x.mean())), int(upper[0]), int(upper[-1]), len(x))


def time_ratios(times: pd.DataFrame) -> pd.DataFrame:
    """Each row divided by its smallest entry. Rows are problems, columns solvers, +inf or NaN a failure.

    A failure stays +inf; a row in which all fail is +inf throughout.
    """
    clean = times.astype(float).where(np.isfinite(times.astype(float)), np.inf)
    best = clean.min(axis=1)
    ratios = clean.div(best.where(np.isfinite(best), 1.0), axis=0)
    return ratios.where(np.isfinite(clean), np.inf)


def performance_profile(times: pd.DataFrame) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Dolan and More (2002): P_s(x) = share of problems that solver s solves within x times the best time.

    @param times  problems x solvers, +inf or NaN where the solver failed
    @returns per solver the points (x_i, P_i) of the right-continuous step function, x ascending, first x = 1;
             P at the end is the share of problems solved at all, for failures lie at x = +inf
    """
    ratios = time_ratios(times)
    profile = {}
    for solver in ratios.columns:
        solved = np.sort(ratios[solver].to_numpy()[np.isfinite(ratios[solver].to_numpy())])
        steps = np.unique(np.concatenate([[1.0], solved]))
        share = np.searchsorted(solved, steps, side="right") / max(len(ratios), 1)
        profile[solver] = (steps, share)
    return profile


def median(values) -> float:
    """Over the values that are not NaN; NaN without any."""
    known = sorted(float(v) for v in values if not math.isnan(v))
    return statistics.median(known) if known else math.nan


def geometric_mean(values: list[float]) -> float:
    """Over the finite values > 0; NaN without any."""
    logs = [math.log(v) for v in values if math.isfinite(v) and v > 0]
    return math.exp(sum(logs) / len(logs)) if logs else math.nan


def nearest_sizes(sizes: list[int], wanted: list[int]) -> list[int]:
    """For every wanted size the present one with the smallest ratio to it, each at most once, ascending."""
    present = sorted(set(sizes))
    if not present:
        return []
    return sorted({min(present, key=lambda n: abs(math.log(n / target))) for target in wanted})
