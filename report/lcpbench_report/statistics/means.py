"""Shifted geometric means of times, as in Mittelmann's benchmarks and Achterberg (2007, appendix A.3), of problems p
that weigh v_p:

    G_s = exp(sum over p of v_p log(t_ps + shift) / sum of v_p) - shift

Without the shift the easiest problems, which nobody waits for, would weigh as much as the hardest; a shift that is as
large as the times makes a mean of shifts. It is the power of ten nearest to a tenth of the smallest median of a solver
in the group. An answer that was not verified enters with the time limit of its problem; so does a cell that is excluded,
or whose solver was not asked, for means over other problems would not compare.

Scaling: how time grows with the number of rows, t ~ c rows^exponent. The median time of every number of rows, each base of
it counting once, is a point: small problems come in hundreds. By least squares in log-log coordinates, with Student's
interval of the slope. Only verified answers have a time: where a solver begins to fail with size, the exponent is that of
what it still solves.
"""

import math

import numpy as np
import pandas as pd
from scipy import stats

from .cells import VERIFIED, ran
from .groups import GROUP, common, groups, with_label
from .intervals import CONFIDENCE, Bootstrap
from .launches import Levels
from .weighted import quantiles, weighted_median, weighted_share

COLUMNS = [*GROUP, "solver", "shift", "problems", "penalised", "mean", "mean_low", "mean_high", "over_best"]
DELIVERED = ("rho", "w_error")
DELIVERED_COLUMNS = ["set", "solver", "tier", "problems", "verified_share", "shift", "mean_s", "answers",
                     *(name for metric in DELIVERED for name in quantiles([], f"{metric}_"))]
LEAST_SIZES = 4
_FIT = ["exponent", "exponent_low", "exponent_high"]
SCALING_COLUMNS = [*GROUP, "solver", "family", "problems", "sizes", "rows_min", "rows_max", *_FIT]


def shifted_geometric_mean(times, shift: float, weights=None) -> float:
    """NaN without any time."""
    values = np.asarray(times, dtype=float)
    return float(np.exp(np.average(np.log(values + shift), weights=weights)) - shift) if len(values) else math.nan


def penalised(cells: pd.DataFrame) -> pd.Series:
    """The time that counts, with the problem's limit where it is not finite."""
    return cells["time_s"].where(np.isfinite(cells["time_s"]), cells["time_limit_s"])


def mean_time(cells: pd.DataFrame, shift: float) -> float:
    """The mean over one solver's cells, failures entered with their limit: failing does not pay."""
    return shifted_geometric_mean(penalised(cells), shift, cells["weight"])


def shift_of(cells: pd.DataFrame, times: str = "time_s") -> float:
    """The shift of these cells' means, from the medians of all solvers' finite times; NaN without any."""
    finite = cells[np.isfinite(cells[times].astype(float))]
    least = min((weighted_median(own[times], own["weight"]) for _, own in finite.groupby("solver")), default=math.nan)
    return math.nan if math.isnan(least) else float(10.0 ** round(math.log10(least / 10)))


def mean_table(cells: pd.DataFrame, levels: Levels = Levels()) -> pd.DataFrame:
    """A row per group and solver; problems that count only."""
    rows = []
    for label, of_group in groups(cells, counted_only=True):
        shared = common(of_group)
        shared = shared.assign(counted=penalised(shared))
        bootstrap = Bootstrap(shared)
        shift = shift_of(shared)
        shift = shift_of(shared, "counted") if math.isnan(shift) else shift  # nobody solved any
        found = []
        for solver, own in shared.groupby("solver", sort=False):
            low, high = bootstrap.mean(own["problem"], np.log(own["counted"] + shift), own["weight"],
                                       shift=levels.shift(solver, own["size_class"], label["tier"], own["weight"]))
            found.append(label | {"solver": solver, "shift": shift, "problems": len(own),
                                  "penalised": int((~np.isfinite(own["time_s"])).sum()),
                                  "mean": shifted_geometric_mean(own["counted"], shift, own["weight"]),
                                  "mean_low": math.exp(low) - shift, "mean_high": math.exp(high) - shift})
        best = min((row["mean"] for row in found), default=math.nan)
        rows += [row | {"over_best": row["mean"] / best} for row in found]
    return pd.DataFrame(rows, columns=COLUMNS)


def delivered_table(cells: pd.DataFrame) -> pd.DataFrame:
    """A row per set, solver and tier: what the solver takes for the tolerance it is asked for, and how exact its
    answers are by the common metrics, whether they pass or not. The time of an answer that is not verified is that of
    the solve that was judged, for nothing wrong is timed fresh."""
    rows = []
    run = with_label(cells[ran(cells)])
    run = run.assign(taken_s=run["fresh_s"].fillna(run["first_s"]).fillna(run["time_limit_s"]))
    shifts = {label: shift_of(own, "taken_s") for label, own in run.groupby("set")}  # one for all tiers: they compare
    for (label, solver, tier), own in run.groupby(["set", "solver", "tier"], sort=False):
        row = {"set": label, "solver": solver, "tier": tier, "problems": len(own),
               "verified_share": weighted_share(own["verdict"] == VERIFIED, own["weight"]), "shift": shifts[label],
               "mean_s": shifted_geometric_mean(own["taken_s"], shifts[label], own["weight"]),
               "answers": int(own["rho"].notna().sum())}
        for metric in DELIVERED:
            row |= quantiles(own[metric], f"{metric}_", own["weight"])
        rows.append(row)
    return pd.DataFrame(rows, columns=DELIVERED_COLUMNS)


def fit_exponent(rows, times) -> dict[str, float]:
    """@param rows, times  > 0, at least three, and not all rows equal"""
    x, y = np.log(np.asarray(rows, dtype=float)), np.log(np.asarray(times, dtype=float))
    line = stats.linregress(x, y)
    reach = stats.t.ppf((1 + CONFIDENCE) / 2, len(x) - 2) * line.stderr
    return dict(zip(_FIT, map(float, (line.slope, line.slope - reach, line.slope + reach))))


def scaling_table(cells: pd.DataFrame) -> pd.DataFrame:
    """A row per group, solver and family with verified answers at LEAST_SIZES numbers of rows or more."""
    found = []
    for label, of_group in groups(cells[np.isfinite(cells["time_s"]) & (cells["rows"] > 0)]):
        for (solver, family), own in of_group.groupby(["solver", "family"], sort=False):
            points = own.groupby(["rows", "base"])["time_s"].median().groupby("rows").median()
            if len(points) < LEAST_SIZES:
                continue
            found.append({**label, "solver": solver, "family": family, "problems": len(own), "sizes": len(points),
                          "rows_min": own["rows"].min(), "rows_max": own["rows"].max(),
                          **fit_exponent(points.index, points)})
    return pd.DataFrame(found, columns=SCALING_COLUMNS)
