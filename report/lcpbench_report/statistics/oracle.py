"""Times in units of the oracle: one sparse factorisation and solve on the rows that are active in the answer, known in
advance (benchmarks/measure/oracle.h). No method that factors can know less and be faster; 1 is a bound, not a rival."""

import numpy as np
import pandas as pd

from .groups import GROUP, groups
from .weighted import quantiles

COLUMNS = [*GROUP, "solver", "problems", *quantiles([])]


def oracle_table(cells: pd.DataFrame) -> pd.DataFrame:
    """A row per group and solver, over verified answers to problems whose oracle was timed."""
    rows = []
    for group in groups(cells):
        known = group.cells[np.isfinite(group.cells["oracle_ratio"])]
        for solver, own in known.groupby("solver", sort=False):
            rows.append({**group.label, "solver": solver, "problems": len(own),
                         **quantiles(own["oracle_ratio"], weights=own["weight"])})
    return pd.DataFrame(rows, columns=COLUMNS)
