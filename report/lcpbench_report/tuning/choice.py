"""Which configuration of a solver is chosen, the same rule for every solver.

Times are fresh ones of verified answers; what was not verified enters with its time limit. Every size class weighs the
same, within it problems as elsewhere. A configuration may replace the default only if

    its shifted geometric mean is smaller by more than MARGIN,
    the signed-rank test of the paired times of bases says so (two-sided, adjusted by Holm for all configurations of the
    solver),
    and it fails on no more problems and has no more false successes than the default.

Of those that may, the one with the least mean is chosen. Problems that a rule excludes are left out: nobody solved them.
"""

import math
from dataclasses import dataclass

import numpy as np
import pandas as pd

from ..statistics.cells import BELOW_TIER, EXCLUDED, FALSE_SUCCESS
from ..statistics.intervals import MARGIN, holm
from ..statistics.means import penalised, shift_of, shifted_geometric_mean
from ..statistics.pairwise import LEVEL, bootstrap_of, compare_two


@dataclass
class Outcome:
    """Of one configuration; `ratio` is its mean over the default's, below 1 where it is faster."""

    key: str
    problems: int
    verified: int
    false_successes: int
    shift_s: float  # of the means: one for all configurations
    mean_s: float
    ratio: float
    ratio_low: float
    ratio_high: float
    wilcoxon_p_holm: float
    allowed: bool  # to replace the default


def judge(cells: pd.DataFrame, keys: list[str]) -> list[Outcome]:
    """@param cells  of one tier, statistics.cells.COLUMNS
    @param keys   the solver's configurations, the default first
    """
    times, about, counts = _times(cells, keys)
    shift = shift_of(cells[cells["solver"].isin(keys)])
    shift = 0.0 if math.isnan(shift) else shift  # none was verified: all are limits
    weights, bootstrap = about["weight"].to_numpy(), bootstrap_of(about)
    pairs = [compare_two(times, about, bootstrap, key, keys[0]) for key in keys[1:]]
    adjusted = [math.nan, *holm([pair["wilcoxon_p"] for pair in pairs])]
    directions = [0, *(pair["direction"] for pair in pairs)]
    means = {key: shifted_geometric_mean(times[key], shift, weights) for key in keys}
    logs = {key: np.log(times[key] + shift) for key in keys}
    outcomes = []
    for key, p, direction in zip(keys, adjusted, directions):
        low, high = bootstrap.ratio_of_means(times.index, logs[key], logs[keys[0]], weights,
                                             lambda mean: np.exp(mean) - shift)
        ratio = means[key] / means[keys[0]]
        faster = p < LEVEL and direction < 0 and ratio < 1 / MARGIN
        no_worse = all(counts[key][which] <= counts[keys[0]][which] for which in ("failures", "false_successes"))
        outcomes.append(Outcome(key, len(times), len(times) - counts[key]["failures"], counts[key]["false_successes"],
                                shift, means[key], ratio, low, high, float(p), bool(faster and no_worse)))
    return outcomes


def choose(outcomes: list[Outcome]) -> int:
    """The index of the chosen one; 0 is the default."""
    allowed = [index for index, outcome in enumerate(outcomes) if outcome.allowed]
    return min(allowed, key=lambda index: outcomes[index].mean_s, default=0)


def _times(cells: pd.DataFrame, keys: list[str]) -> tuple[pd.DataFrame, pd.DataFrame, dict[str, dict[str, int]]]:
    """Problems x configurations, failures with their limit, on problems that all of them have; what is known of the
    problems; and who failed. Of solvers that are never asked for the tier an answer below it is a false success here:
    another setting may be better."""
    own = cells[cells["solver"].isin(keys) & (cells["verdict"] != EXCLUDED)]
    own = own.assign(failed=~np.isfinite(own["time_s"]), false=own["verdict"].isin((FALSE_SUCCESS, BELOW_TIER)),
                     counted_s=penalised(own["time_s"], own["time_limit_s"]))
    common = own.groupby("problem")["solver"].transform("nunique") == len(keys)
    own = own[common]
    counts = {key: {"failures": int(rows["failed"].sum()), "false_successes": int(rows["false"].sum())}
              for key, rows in ((key, own[own["solver"] == key]) for key in keys)}
    times = own.pivot(index="problem", columns="solver", values="counted_s").reindex(columns=keys)
    about = own.drop_duplicates("problem").set_index("problem").loc[times.index,
                                                                    ["family", "base", "weight", "size_class"]]
    about["weight"] /= about.groupby("size_class")["weight"].transform("sum")
    return times, about, counts
