"""Distributions over problems: how exact the answers are, where there is an exact one, and times in units of the oracle.

The oracle is one sparse factorisation and solve on the rows that are active in the answer, known in advance
(benchmarks/measure/oracle.h). No method that factors can know less and be faster; 1 is a bound, not a rival.
"""

import numpy as np
import pandas as pd

from .cells import VERIFIED
from .groups import GROUP, groups
from .weighted import quantiles

METRICS = ("rho", "backward_error", "w_error", "f_error")
REFERENCES = ("certified", "bounded")
# Value of the column `answers` -> which cells.
_ANSWERS = {"verified": lambda cells: cells["verdict"] == VERIFIED,
            "claimed": lambda cells: cells["claim"] == "solved"}
ACCURACY_COLUMNS = [*GROUP, "solver", "reference", "answers", "metric", "problems", *quantiles([])]
ORACLE_COLUMNS = [*GROUP, "solver", "problems", *quantiles([])]


def accuracy_table(cells: pd.DataFrame) -> pd.DataFrame:
    """A row per group, solver, kind of reference, kind of answer and metric. "claimed" are the answers that the solver
    called solved, false successes among them. A metric that is known nowhere has no row."""
    rows = []
    for group in groups(cells):
        for (solver, reference), own in group.cells.groupby(["solver", "reference"], sort=False):
            if reference not in REFERENCES:
                continue
            for answers, chosen in _ANSWERS.items():
                for metric in METRICS:
                    known = own[chosen(own) & own[metric].notna()]
                    if len(known):
                        rows.append({**group.label, "solver": solver, "reference": reference, "answers": answers,
                                     "metric": metric, "problems": len(known),
                                     **quantiles(known[metric], weights=known["weight"])})
    return pd.DataFrame(rows, columns=ACCURACY_COLUMNS)


def oracle_table(cells: pd.DataFrame) -> pd.DataFrame:
    """A row per group and solver, over verified answers to problems whose oracle was timed."""
    rows = []
    for group in groups(cells):
        known = group.cells[np.isfinite(group.cells["oracle_ratio"])]
        for solver, own in known.groupby("solver", sort=False):
            rows.append({**group.label, "solver": solver, "problems": len(own),
                         **quantiles(own["oracle_ratio"], weights=own["weight"])})
    return pd.DataFrame(rows, columns=ORACLE_COLUMNS)
