"""What a user pays, by size class: every solver's fresh time, how much it solves, and who is as good as the best.

Medians are of the class's weight, failures infinite: failing on the hard ones cannot lower them. In a class a solver is
*tied* with the best where their intervals overlap (intervals.Bootstrap: families, then bases). Problems of a class take
very different times, so that intervals are wide; `over_best`, the median over problems of its time over the best's, is
the sharper figure: what is common to both cancels.
"""

import math
from collections.abc import Iterator

import numpy as np
import pandas as pd

from .cells import VERIFIED
from .coverage import coverage
from .groups import GROUP, groups
from .intervals import Bootstrap
from .load import PART_TIMES, TASK_BUDGET
from .weighted import weighted_median, weighted_quantile

ALL = "all"  # the value of `size_class` for all problems
LEAST_FOR_P99 = 1000  # problems of a class
_SHARES = [f"{share}{end}" for share in ("attempted_share", "verified_share", "verified_of_attempted")
           for end in ("", "_low", "_high")]
_OVER_BEST = ["over_best", "over_best_low", "over_best_high"]
_MEDIANS = ["again_s", "first_s", *PART_TIMES]
COLUMNS = [*GROUP, "size_class", "solver", "asked", "problems", "weight", "attempted", "verified", "false_successes",
           "below_tier", *_SHARES, "median_s", "median_low", "median_high", "p99_s", *_MEDIANS, "tied", *_OVER_BEST]


def class_table(cells: pd.DataFrame) -> pd.DataFrame:
    """A row per group, size class (and `all`) and solver; problems that count only. `p99_s` and the medians of the second
    measure (`again_s`), of the solve that was judged and of the parts are of verified answers that were timed. `tied` and
    `over_best`: with the best of all solvers that were asked."""
    tables = []
    for label, of_class in classes(cells):
        bootstrap = Bootstrap(of_class)
        rows = [label | {"solver": solver} | _row(own, bootstrap)
                for solver, own in of_class.groupby("solver", sort=False)]
        table = pd.DataFrame(rows)
        table["tied"] = tied(table[table["asked"]]).reindex(table.index, fill_value=False)
        tables.append(table.join(_over_best(table, of_class, bootstrap)))
    return pd.concat(tables, ignore_index=True)[COLUMNS] if tables else pd.DataFrame(columns=COLUMNS)


def classes(cells: pd.DataFrame) -> Iterator[tuple[dict, pd.DataFrame]]:
    """Label and cells of every group of problems that count, by size class, and of all together: smallest class first,
    `all` last. Problems that had no turn within a task's budget are left out: their order is drawn by lot, so that the
    others are a fair sample, and a solver that takes long is not thereby wrong."""
    for group in groups(cells, counted_only=True):
        cells = group.cells[group.cells["excluded"] != TASK_BUDGET]
        order = cells.groupby("size_class")["rows"].min().sort_values().index
        for size_class in order:
            yield {**group.label, "size_class": size_class}, cells[cells["size_class"] == size_class]
        yield {**group.label, "size_class": ALL}, cells


def tied(rows: pd.DataFrame) -> pd.Series:
    """Of solvers in one class: whether the interval of the median reaches that of the one with the least median."""
    finite = rows[np.isfinite(rows["median_s"])]
    if finite.empty:
        return pd.Series(False, index=rows.index)
    best = finite.loc[finite["median_s"].idxmin()]
    reach = best["median_s"] if math.isnan(best["median_high"]) else best["median_high"]
    return np.isfinite(rows["median_s"]) & (rows["median_low"].fillna(rows["median_s"]) <= reach)


def p99(cells: pd.DataFrame) -> float:
    """Of the fresh times of one solver's verified answers, where the class has problems enough; else NaN."""
    if len(cells) < LEAST_FOR_P99:
        return math.nan
    timed = cells[(cells["verdict"] == VERIFIED) & cells["fresh_s"].notna()]
    return weighted_quantile(timed["fresh_s"], timed["weight"], 0.99)


def _over_best(rows: pd.DataFrame, cells: pd.DataFrame, bootstrap: Bootstrap) -> pd.DataFrame:
    """On the problems that the best one solves; a failure is infinitely slower."""
    finite = rows[rows["asked"] & np.isfinite(rows["median_s"])]
    if finite.empty:
        return pd.DataFrame(math.nan, rows.index, _OVER_BEST)
    best = cells[cells["solver"] == finite.loc[finite["median_s"].idxmin(), "solver"]].set_index("problem")["time_s"]
    best = best[np.isfinite(best)]
    found = []
    for solver in rows["solver"]:
        own = cells[(cells["solver"] == solver) & cells["problem"].isin(best.index)]
        ratios = own["time_s"].to_numpy() / best[own["problem"]].to_numpy()
        found.append([weighted_median(ratios, own["weight"]),
                      *bootstrap.median(own["problem"], ratios, own["weight"])])
    return pd.DataFrame(found, rows.index, _OVER_BEST)


def _row(cells: pd.DataFrame, bootstrap: Bootstrap) -> dict:
    low, high = bootstrap.median(cells["problem"], cells["time_s"], cells["weight"])
    verified = cells[cells["verdict"] == VERIFIED]
    row = coverage(cells) | {"median_s": weighted_median(cells["time_s"], cells["weight"]), "median_low": low,
                             "median_high": high, "p99_s": p99(cells)}
    weights = verified["weight"].to_numpy(dtype=float)
    for key in _MEDIANS:
        times = verified[key].to_numpy(dtype=float)
        known = ~np.isnan(times)
        row[key] = weighted_median(times[known], weights[known])
    return row
