"""Distributions over problems: performance profiles, how exact the answers are; and how time grows with the number of rows.

Performance profiles (Dolan & Moré 2002):

    r_ps = t_ps / min over s' of t_ps'        P_s(tau) = weight of {p : r_ps <= tau} / that of all p

t is the time that counts: failures and excluded cells lie at infinity. The ranking of all but the best depends on who
takes part (Gould & Scott 2016): pairwise.py compares two without the others.

Growth: t ~ c rows^exponent. The median time of every number of rows, each base of it counting once, is a point: small
problems come in hundreds. By least squares in log-log coordinates, with Student's interval of the slope, and by the
median of pairwise slopes (Theil 1950, Sen 1968), which a few odd problems do not move. Only verified answers have a
time: where a solver begins to fail with size, the exponent is that of what it still solves.
"""

import math

import numpy as np
import pandas as pd
from scipy import stats

from .cells import NOT_RUN, VERIFIED
from .groups import GROUP, common, groups, wide
from .intervals import CONFIDENCE
from .weighted import quantiles, weighted_share

METRICS = ("rho", "backward_error", "w_error", "f_error")
REFERENCES = ("certified", "bounded")
# Value of the column `answers` -> which cells.
_ANSWERS = {"verified": lambda cells: cells["verdict"] == VERIFIED,
            "claimed": lambda cells: cells["claim"] == "solved"}
PROFILE_COLUMNS = [*GROUP, "solver", "problems", "tau", "share", "excluded_share"]
ACCURACY_COLUMNS = [*GROUP, "solver", "reference", "answers", "metric", "problems", *quantiles([])]
LEAST_SIZES = 4
_FIT = ["exponent", "exponent_low", "exponent_high", "seconds_at_1", "r_squared", "theil_sen", "theil_sen_low",
        "theil_sen_high"]
SCALING_COLUMNS = [*GROUP, "solver", "family", "problems", "sizes", "rows_min", "rows_max", *_FIT]
TAUS = np.logspace(0, 4, 81)  # twenty to a decade


def profile(times: pd.DataFrame, taus=TAUS, weights=None) -> pd.DataFrame:
    """@param times  problems x solvers, inf or NaN where the solver failed
    @returns tau x solvers: shares of all problems, those that nobody solved among them
    """
    finite = times.astype(float).replace(np.inf, np.nan)
    ratios = finite.div(finite.min(axis=1), axis=0).fillna(np.inf).to_numpy()
    weights = np.ones(len(ratios)) if weights is None else np.asarray(weights, dtype=float)
    shares = [weights @ (ratios <= tau) / weights.sum() for tau in taus]
    return pd.DataFrame(shares, index=taus, columns=times.columns)


def profile_table(cells: pd.DataFrame) -> pd.DataFrame:
    """A row per group, solver and tau; problems that count only."""
    rows = []
    for label, of_group in groups(cells, counted_only=True):
        shared = common(of_group)
        if shared.empty:
            continue
        times, weights = wide(shared, "time_s"), shared.drop_duplicates("problem")["weight"].to_numpy(dtype=float)
        excluded = wide(shared, "verdict").isin(NOT_RUN).apply(weighted_share, weights=weights)
        for solver, shares in profile(times, weights=weights).items():
            rows += [{**label, "solver": solver, "problems": len(times), "tau": tau, "share": share,
                      "excluded_share": excluded[solver]} for tau, share in shares.items()]
    return pd.DataFrame(rows, columns=PROFILE_COLUMNS)


def accuracy_table(cells: pd.DataFrame) -> pd.DataFrame:
    """A row per group, solver, kind of reference, kind of answer and metric. "claimed" are the answers that the solver
    called solved, false successes among them. A metric that is known nowhere has no row."""
    rows = []
    for label, of_group in groups(cells[cells["reference"].isin(REFERENCES)]):
        for (solver, reference), own in of_group.groupby(["solver", "reference"], sort=False):
            for answers, chosen in _ANSWERS.items():
                for metric in METRICS:
                    known = own[chosen(own) & own[metric].notna()]
                    if len(known):
                        rows.append({**label, "solver": solver, "reference": reference, "answers": answers,
                                     "metric": metric, "problems": len(known),
                                     **quantiles(known[metric], weights=known["weight"])})
    return pd.DataFrame(rows, columns=ACCURACY_COLUMNS)


def fit_exponent(rows, times) -> dict[str, float]:
    """@param rows, times  > 0, at least three, and not all rows equal"""
    x, y = np.log(np.asarray(rows, dtype=float)), np.log(np.asarray(times, dtype=float))
    line = stats.linregress(x, y)
    reach = stats.t.ppf((1 + CONFIDENCE) / 2, len(x) - 2) * line.stderr
    robust = stats.theilslopes(y, x, CONFIDENCE)
    return dict(zip(_FIT, map(float, (line.slope, line.slope - reach, line.slope + reach, math.exp(line.intercept),
                                      line.rvalue**2, robust.slope, robust.low_slope, robust.high_slope))))


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
