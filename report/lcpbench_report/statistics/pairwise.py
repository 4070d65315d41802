"""Two solvers without the others, for the joint ranking depends on who takes part (Gould & Scott 2016).

Counts are of the problems on which both have a cell; a failure loses against a verified answer. Times are compared where
both are verified, by d_p = log(t_Ap / t_Bp): the ratio exp(weighted median d) with its bootstrap interval
(launches.Levels, intervals.Bootstrap), and the signed-rank test (Wilcoxon 1945; zeros left out), two-sided and adjusted by Holm within a
set and tier. What differs in one number is not independent: the test has one value per base, the mean of its d_p.

"Faster" is claimed only if the adjusted signed-rank p is below LEVEL, the whole interval of the ratio lies beyond
MARGIN, and both point the same way. Anything else is "no difference": none that matters was shown.
"""

import itertools
import math
import os
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from functools import partial

import numpy as np
import pandas as pd
from scipy import stats

from .cells import ran
from .groups import COUNTED, GROUP, groups, wide
from .intervals import MARGIN, Bootstrap, holm
from .launches import Levels
from .weighted import weighted_median

LEVEL = 0.05
ABOUT = ["origin", "family", "base", "weight", "size_class"]  # what is known of problems
A_FASTER, B_FASTER, NO_DIFFERENCE = "A faster", "B faster", "no difference"
_MANY_PAIRS = 500  # from here on, processes that share them are worth their start
COLUMNS = [*GROUP, "a", "b", "problems", "both", "bases", "a_only", "b_only", "neither", "a_excluded", "b_excluded", "a_faster",
           "b_faster", "ratio", "ratio_low", "ratio_high", "wilcoxon_p", "wilcoxon_p_holm", "verdict"]


def signed_rank_test(differences: np.ndarray) -> tuple[float, int]:
    """Two-sided p-value, and the sign of the rank sum: -1 where A is faster. NaN and 0 without a difference."""
    moved = differences[differences != 0]
    if not len(moved):
        return math.nan, 0
    above = stats.rankdata(abs(moved))[moved > 0].sum()
    return float(stats.wilcoxon(moved).pvalue), int(np.sign(above - len(moved) * (len(moved) + 1) / 4))


def verdict(adjusted_p: float, direction: int, low: float, high: float) -> str:
    """@param low, high  interval of the time ratio A / B
    @param direction  of the signed ranks
    """
    if not adjusted_p < LEVEL:  # NaN is no evidence
        return NO_DIFFERENCE
    if direction < 0 and high < 1 / MARGIN:
        return A_FASTER
    return B_FASTER if direction > 0 and low > MARGIN else NO_DIFFERENCE


def compare_pairs(times: pd.DataFrame, about: pd.DataFrame, excluded: pd.DataFrame | None = None,
                  levels: Levels = Levels(), tier: float = math.nan) -> pd.DataFrame:
    """@param times  problems x solvers: inf where the solver failed, NaN where there is no cell
    @param about     problems x ABOUT
    @param excluded  as `times`: whether the cell was excluded by rule, or the solver not asked
    @param levels, tier  of the launches; without them intervals are of problems only
    @returns a row per ordered pair; columns of COLUMNS without those of the group
    """
    bootstrap = Bootstrap(about.assign(problem=about.index))
    pairs = _compare_all(times, about, bootstrap, excluded, levels, tier)
    for pair, adjusted in zip(pairs, holm([pair["wilcoxon_p"] for pair in pairs])):
        pair["wilcoxon_p_holm"] = adjusted
        pair["verdict"] = verdict(pair["wilcoxon_p_holm"], pair["direction"], pair["ratio_low"], pair["ratio_high"])
    rows = [row for pair in pairs for row in (pair, _mirrored(pair))]
    return pd.DataFrame(rows, columns=COLUMNS[len(GROUP):])


def pairwise_table(cells: pd.DataFrame, levels: Levels = Levels()) -> pd.DataFrame:
    """A row per group and ordered pair of solvers. Problems that do not count enter where both are verified."""
    tables = []
    for label, of_group in groups(cells):
        times = wide(of_group, "time_s")
        if label["set"] != COUNTED:
            times = times.where(np.isfinite(times))
        about = of_group.drop_duplicates("problem").set_index("problem")[ABOUT].astype({"size_class": "category"})
        excluded = wide(of_group.assign(out=~ran(of_group)), "out").eq(True)
        table = compare_pairs(times, about, excluded, levels, label["tier"]).assign(**label)[COLUMNS]
        if not table.empty:
            tables.append(table)
    return pd.concat(tables, ignore_index=True) if tables else pd.DataFrame(columns=COLUMNS)


def compare_two(times: pd.DataFrame, about: pd.DataFrame, bootstrap: Bootstrap, a: str, b: str,
                excluded: pd.DataFrame | None = None,
                shift: Callable[[str, pd.Series, np.ndarray], np.ndarray | float] = lambda of, classes, weights: 0.0) -> dict:
    """The columns `a` and `b` of `times`, not yet adjusted for other comparisons; see compare_pairs.

    @param shift  of a column, of the logarithms of times in every resample, given size classes and weights of problems
    """
    present = (times[a].notna() & times[b].notna()).to_numpy()
    t_a, t_b = times[a].to_numpy(dtype=float)[present], times[b].to_numpy(dtype=float)[present]
    problems, weights = times.index[present], about["weight"].to_numpy(dtype=float)[present]
    left_out = {name: int(excluded[name].to_numpy()[present].sum()) if excluded is not None else 0 for name in (a, b)}
    solved_a, solved_b = np.isfinite(t_a), np.isfinite(t_b)
    both = solved_a & solved_b
    differences = np.log(t_a[both] / t_b[both])
    of = about["size_class"][present][both], weights[both]
    low, high = bootstrap.median(problems[both], np.exp(differences), weights[both], shift(a, *of) - shift(b, *of))
    of_bases = bootstrap.base_means(problems[both], differences, weights[both])
    p, direction = signed_rank_test(of_bases)
    return {"a": a, "b": b, "problems": int(present.sum()), "both": len(differences), "bases": len(of_bases),
            "a_only": int(np.sum(solved_a & ~solved_b)), "b_only": int(np.sum(solved_b & ~solved_a)),
            "neither": int(np.sum(~solved_a & ~solved_b)), "a_excluded": left_out[a], "b_excluded": left_out[b],
            "a_faster": int(np.sum(differences < 0)), "b_faster": int(np.sum(differences > 0)),
            "ratio": math.exp(weighted_median(differences, weights[both])), "ratio_low": low,
            "ratio_high": high, "wilcoxon_p": p, "direction": direction}


def _compare_all(*tables) -> list[dict]:
    """compare_two of every pair, on all processors where there are many: of 100 solvers they take minutes.

    @param tables  times, about, bootstrap and excluded of compare_two, levels and tier of compare_pairs
    """
    pairs = list(itertools.combinations(tables[0].columns, 2))
    workers = len(os.sched_getaffinity(0)) if len(pairs) >= _MANY_PAIRS else 1
    if workers == 1:
        return _compare_some(tables, pairs)
    with ProcessPoolExecutor(workers) as pool:
        done = list(pool.map(partial(_compare_some, tables), [pairs[k::workers] for k in range(workers)]))
    return [done[k % workers][k // workers] for k in range(len(pairs))]


def _compare_some(tables, pairs) -> list[dict]:
    times, about, bootstrap, excluded, levels, tier = tables

    def shift(solver: str, size_classes: pd.Series, weights: np.ndarray):
        return levels.shift(solver, size_classes, tier, weights)
    return [compare_two(times, about, bootstrap, a, b, excluded, shift) for a, b in pairs]


def _mirrored(pair: dict) -> dict:
    """The same comparison with A and B exchanged."""
    ends = ("", "_only", "_excluded", "_faster")
    row = pair | {f"{new}{end}": pair[f"{old}{end}"] for new, old in ("ab", "ba") for end in ends}
    row |= {"ratio": 1 / pair["ratio"], "ratio_low": 1 / pair["ratio_high"], "ratio_high": 1 / pair["ratio_low"]}
    row["verdict"] = {A_FASTER: B_FASTER, B_FASTER: A_FASTER}.get(pair["verdict"], NO_DIFFERENCE)
    return row
