"""How time grows with the number of rows: t ~ c rows^exponent.

The median time of every number of rows, each base of it counting once, is a point: small problems come in hundreds. By
least squares in log-log coordinates, with Student's interval of the slope. Only verified answers have a time: where a
solver begins to fail with size, the exponent is that of what it still solves.
"""

import numpy as np
import pandas as pd
from scipy import stats

from .groups import GROUP, groups
from .intervals import CONFIDENCE

LEAST_SIZES = 4
_FIT = ["exponent", "exponent_low", "exponent_high"]
COLUMNS = [*GROUP, "solver", "family", "problems", "sizes", "rows_min", "rows_max", *_FIT]


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
    return pd.DataFrame(found, columns=COLUMNS)
