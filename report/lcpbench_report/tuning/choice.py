"""Which configuration of a solver is chosen, the same rule for every solver.

Times are medians of verified answers; what was not verified enters with its time limit. A configuration may replace
the default only if

    its shifted geometric mean is smaller by more than MARGIN,
    the signed-rank test of the paired times says so (two-sided, adjusted by Holm for all configurations of the solver),
    and it fails on no more problems and has no more false successes than the default.

Of those that may, the one with the least mean is chosen. Problems that a rule excludes are left out: nobody solved them.
"""

import math
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy import stats

from ..statistics.cells import EXCLUDED, FALSE_SUCCESS
from ..statistics.holm import holm
from ..statistics.intervals import CONFIDENCE, MARGIN, RESAMPLES, SEED
from ..statistics.means import SHIFTS, penalised, shifted_geometric_mean
from ..statistics.pairwise import LEVEL, compare_two

SHIFT = SHIFTS["s"]


@dataclass
class Outcome:
    """Of one configuration; `ratio` is its mean over the default's, below 1 where it is faster."""

    key: str
    problems: int
    verified: int
    false_successes: int
    mean_s: float
    ratio: float
    ratio_low: float
    ratio_high: float
    wilcoxon_p_holm: float
    allowed: bool  # to replace the default


def judge(cells: pd.DataFrame, keys: list[str]) -> list[Outcome]:
    """@param cells  of one mode and tier, statistics.cells.COLUMNS
    @param keys   the solver's configurations, the default first
    """
    times, counts = _times(cells, keys)
    default = times[keys[0]].to_numpy()
    pairs = [compare_two(times, None, key, keys[0]) for key in keys[1:]]
    adjusted = [math.nan, *holm([pair["wilcoxon_p"] for pair in pairs])]
    directions = [0, *(pair["direction"] for pair in pairs)]
    outcomes = []
    for key, p, direction in zip(keys, adjusted, directions):
        own = times[key].to_numpy()
        ratio, low, high = _ratio(own, default)
        faster = p < LEVEL and direction < 0 and ratio < 1 / MARGIN
        no_worse = all(counts[key][which] <= counts[keys[0]][which] for which in ("failures", "false_successes"))
        outcomes.append(Outcome(key, len(own), len(own) - counts[key]["failures"], counts[key]["false_successes"],
                                shifted_geometric_mean(own, SHIFT), ratio, low, high, float(p),
                                bool(faster and no_worse)))
    return outcomes


def choose(outcomes: list[Outcome]) -> int:
    """The index of the chosen one; 0 is the default."""
    allowed = [index for index, outcome in enumerate(outcomes) if outcome.allowed]
    return min(allowed, key=lambda index: outcomes[index].mean_s, default=0)


def _times(cells: pd.DataFrame, keys: list[str]) -> tuple[pd.DataFrame, dict[str, dict[str, int]]]:
    """Problems x configurations, failures with their limit, on problems that all of them have; and who failed."""
    own = cells[cells["solver"].isin(keys) & (cells["verdict"] != EXCLUDED)]
    own = own.assign(failed=~np.isfinite(own["time_s"]), false=own["verdict"] == FALSE_SUCCESS,
                     counted_s=penalised(own["time_s"], own["time_limit_s"]))
    common = own.groupby("problem")["solver"].transform("nunique") == len(keys)
    own = own[common]
    counts = {key: {"failures": int(rows["failed"].sum()), "false_successes": int(rows["false"].sum())}
              for key, rows in ((key, own[own["solver"] == key]) for key in keys)}
    return own.pivot(index="problem", columns="solver", values="counted_s").reindex(columns=keys), counts


def _ratio(times: np.ndarray, default: np.ndarray) -> tuple[float, float, float]:
    """Of the means, with a percentile bootstrap interval over the problems, both drawn together."""
    def statistic(a, b, axis=-1):
        return (np.exp(np.mean(np.log(a + SHIFT), axis)) - SHIFT) / (np.exp(np.mean(np.log(b + SHIFT), axis)) - SHIFT)

    if len(times) < 2:
        return math.nan, math.nan, math.nan
    interval = stats.bootstrap((times, default), statistic, paired=True, n_resamples=RESAMPLES, vectorized=True,
                               confidence_level=CONFIDENCE, method="percentile",
                               random_state=np.random.default_rng(SEED)).confidence_interval
    return float(statistic(times, default)), float(interval.low), float(interval.high)
