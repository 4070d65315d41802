"""Shifted geometric means of times, as in Mittelmann's benchmarks and Achterberg (2007, appendix A.3):

    G_s = exp(mean over p of log(t_ps + shift)) - shift

Without the shift the easiest problems, which nobody waits for, would weigh as much as the hardest. An answer that was
not verified, an excluded cell too, enters with the time limit of its problem.
"""

import math

import numpy as np
import pandas as pd

from .groups import GROUP, groups
from .intervals import bootstrap_interval

# Unit of the time -> shift in that unit. "oracle": one factorisation with the answer's active set known.
SHIFTS = {"s": 1e-3, "oracle": 1.0}
COLUMNS = [*GROUP, "solver", "unit", "shift", "problems", "penalised", "mean", "mean_low", "mean_high", "over_best"]


def shifted_geometric_mean(times, shift: float) -> float:
    """NaN without any time."""
    values = np.asarray(times, dtype=float)
    return float(np.exp(np.mean(np.log(values + shift))) - shift) if len(values) else math.nan


def shifted_mean_interval(times, shift: float) -> tuple[float, float]:
    """Bootstrap over the problems."""
    low, high = bootstrap_interval(np.log(np.asarray(times, dtype=float) + shift), np.mean)
    return math.exp(low) - shift, math.exp(high) - shift


def penalised(times, limits) -> np.ndarray:
    """The limit where the time is inf."""
    return np.where(np.isfinite(times), times, limits)


def mean_table(cells: pd.DataFrame) -> pd.DataFrame:
    """A row per group, solver and unit; problems that count only, and of those for the unit "oracle" the ones whose
    oracle was timed."""
    rows = []
    for group in groups(cells, counted_only=True):
        common = group.common()
        for unit, shift in SHIFTS.items():
            found = [_row(common, solver, unit, shift) for solver in common.solvers]
            best = min((row["mean"] for row in found if not math.isnan(row["mean"])), default=math.nan)
            rows += [row | {"over_best": row["mean"] / best} for row in found if row["problems"]]
    return pd.DataFrame(rows, columns=COLUMNS)


def _row(group, solver: str, unit: str, shift: float) -> dict:
    cells = group.cells[group.cells["solver"] == solver]
    if unit == "oracle":
        cells = cells[cells["oracle_s"].notna()]
    times = penalised(cells["time_s"], cells["time_limit_s"]) / (cells["oracle_s"] if unit == "oracle" else 1.0)
    low, high = shifted_mean_interval(times, shift)
    return {**group.label, "solver": solver, "unit": unit, "shift": shift, "problems": len(cells),
            "penalised": int((~np.isfinite(cells["time_s"])).sum()), "mean": shifted_geometric_mean(times, shift),
            "mean_low": low, "mean_high": high}
