"""Shifted geometric means of times, as in Mittelmann's benchmarks and Achterberg (2007, appendix A.3), of problems p
that weigh v_p:

    G_s = exp(sum over p of v_p log(t_ps + shift) / sum of v_p) - shift

Without the shift the easiest problems, which nobody waits for, would weigh as much as the hardest; a shift that is as
large as the times makes a mean of shifts. It is the power of ten nearest to a tenth of the smallest median of a solver
in the group. An answer that was not verified, an excluded cell too, enters with the time limit of its problem.
"""

import math

import numpy as np
import pandas as pd

from .groups import GROUP, Group, groups
from .intervals import Bootstrap
from .weighted import weighted_median

# Units of time: "oracle" is one factorization with the answer's active set known.
UNITS = ("s", "oracle")
COLUMNS = [*GROUP, "solver", "unit", "shift", "problems", "penalised", "mean", "mean_low", "mean_high", "over_best"]


def shifted_geometric_mean(times, shift: float, weights=None) -> float:
    """NaN without any time."""
    values = np.asarray(times, dtype=float)
    if not len(values):
        return math.nan
    return float(np.exp(np.average(np.log(values + shift), weights=weights)) - shift)


def penalised(times, limits) -> np.ndarray:
    """The limit where the time is inf."""
    return np.where(np.isfinite(times), times, limits)


def shift_of(cells: pd.DataFrame, times: str = "time_s") -> float:
    """The shift of these cells' means, from the medians of all solvers' finite times; NaN without any."""
    finite = cells[np.isfinite(cells[times])]
    least = min((weighted_median(own[times], own["weight"]) for _, own in finite.groupby("solver")), default=math.nan)
    return math.nan if math.isnan(least) else float(10.0 ** round(math.log10(least / 10)))


def mean_table(cells: pd.DataFrame) -> pd.DataFrame:
    """A row per group, solver and unit; problems that count only, and of those for the unit "oracle" the ones whose
    oracle was timed."""
    rows = []
    for group in groups(cells, counted_only=True):
        common = group.common()
        bootstrap = Bootstrap(common.cells)
        for unit in UNITS:
            known = common.cells if unit == "s" else common.cells[common.cells["oracle_s"].notna()]
            size = 1.0 if unit == "s" else known["oracle_s"]
            known = known.assign(counted=penalised(known["time_s"], known["time_limit_s"]) / size)
            shift = shift_of(known.assign(units=known["time_s"] / size), "units")
            shift = shift_of(known, "counted") if math.isnan(shift) else shift  # nobody solved any
            found = [_row(group, solver, unit, shift, own, bootstrap)
                     for solver, own in known.groupby("solver", sort=False)]
            best = min((row["mean"] for row in found), default=math.nan)
            rows += [row | {"over_best": row["mean"] / best} for row in found]
    return pd.DataFrame(rows, columns=COLUMNS)


def _row(group: Group, solver: str, unit: str, shift: float, cells: pd.DataFrame, bootstrap: Bootstrap) -> dict:
    low, high = bootstrap.mean(cells["problem"], np.log(cells["counted"] + shift), cells["weight"])
    return {**group.label, "solver": solver, "unit": unit, "shift": shift, "problems": len(cells),
            "penalised": int((~np.isfinite(cells["time_s"])).sum()),
            "mean": shifted_geometric_mean(cells["counted"], shift, cells["weight"]),
            "mean_low": math.exp(low) - shift, "mean_high": math.exp(high) - shift}
