"""Performance profiles (Dolan & Moré 2002).

    r_ps = t_ps / min over s' of t_ps'        P_s(tau) = weight of {p : r_ps <= tau} / that of all p

t is the time that counts: failures and excluded cells lie at infinity. The ranking of all but the best depends on who
takes part (Gould & Scott 2016): pairwise.py compares two without the others.
"""

import numpy as np
import pandas as pd

from .cells import EXCLUDED
from .groups import GROUP, groups
from .weighted import weighted_share

COLUMNS = [*GROUP, "solver", "problems", "tau", "share", "excluded_share"]
_DECADES = 4
_PER_DECADE = 20
TAUS = np.logspace(0, _DECADES, _DECADES * _PER_DECADE + 1)


def profile(times: pd.DataFrame, taus=TAUS, weights=None) -> pd.DataFrame:
    """@param times  problems x solvers, inf where the solver failed
    @returns tau x solvers: shares of all problems, those that nobody solved among them
    """
    ratios = time_ratios(times).to_numpy()
    weights = np.ones(len(ratios)) if weights is None else np.asarray(weights, dtype=float)
    shares = [weights @ (ratios <= tau) / weights.sum() for tau in taus]
    return pd.DataFrame(shares, index=taus, columns=times.columns)


def profile_table(cells: pd.DataFrame) -> pd.DataFrame:
    """A row per group, solver and tau; problems that count only."""
    rows = []
    for group in groups(cells, counted_only=True):
        common = group.common()
        if common.cells.empty:
            continue
        times, weights = common.wide("time_s"), common.weights
        excluded = (common.wide("verdict") == EXCLUDED).apply(weighted_share, weights=weights)
        for solver, shares in profile(times, weights=weights).items():
            rows += [{**group.label, "solver": solver, "problems": len(times), "tau": tau, "share": share,
                      "excluded_share": excluded[solver]} for tau, share in shares.items()]
    return pd.DataFrame(rows, columns=COLUMNS)


def time_ratios(times: pd.DataFrame) -> pd.DataFrame:
    """Each row divided by its smallest entry. Rows are problems, columns solvers, +inf or NaN a failure.

    A failure stays +inf; a row in which all fail is +inf throughout.
    """
    finite = times.astype(float).where(np.isfinite(times.astype(float)))
    return finite.div(finite.min(axis=1), axis=0).fillna(np.inf)
