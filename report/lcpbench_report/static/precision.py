"""Work over precision: what stricter tolerances cost, and whether they are met."""

import math

import pandas as pd

from .. import choice
from ..inputs import Inputs
from ..statistics.cells import EXCLUDED
from ..statistics.precision import delivered_table
from ..style import solver_styles
from . import canvas

_FEWEST_TIERS = 3


def _at_every_tier(cells: pd.DataFrame) -> pd.DataFrame:
    """Points of one line must be of the same problems: where several campaigns were read, those of the one with the most
    tiers; and of them, for each solver, those that it was not excluded from at any tier."""
    cells = cells[cells["counts"].astype(bool)]
    tiers = cells.groupby("problem")["tier"].transform("nunique")
    cells = cells[tiers == tiers.max()]
    run = cells[cells["verdict"] != EXCLUDED]
    return run[run.groupby(["solver", "problem"])["tier"].transform("nunique") == run["tier"].nunique()]


def work_precision(inputs: Inputs):
    """Mean time against the tolerance asked for, and against the residual got for it (90 % quantile), right or not, over
    the problems that a solver was given at every tier; None without several tolerances."""
    cells = _at_every_tier(inputs.cells)
    if cells["tier"].nunique() < _FEWEST_TIERS:
        return None
    table = choice.counted(delivered_table(cells))
    styles = solver_styles(inputs.solvers)
    # Of what has a tolerance: the line of a direct method is a point.
    tolerant = {entry["key"] for entry in inputs.solvers if entry["uses_tolerance"]}
    solvers = [key for key in choice.best_own(inputs, 20) + choice.best_peers(inputs, 20)
               if key in tolerant and (table["solver"] == key).any()][:12]
    if not solvers:
        return None
    figure, axes = canvas.panels(1, 2, canvas.PAGE, 3.1, sharey=True)
    for solver in solvers:
        mine = table[table["solver"] == solver].sort_values("tier", ascending=False)
        canvas.line(axes[0][0], mine["tier"], mine["mean_s"], styles[solver])
        canvas.line(axes[0][1], mine["rho_p90"].clip(lower=1e-17), mine["mean_s"], styles[solver])
    shift = canvas.time_tick(float(table["shift"].iloc[0]))
    for pane, label in zip(axes[0], ("tolerance asked for", "residual $\\rho$ got, 90 % quantile")):
        canvas.log_axis(pane.xaxis, label, lambda x: canvas.power_tick(x) if round(math.log10(x)) % 3 == 0 else "", 20)
        pane.xaxis.set_minor_locator(canvas.NullLocator())
        pane.invert_xaxis()
        canvas.time_axis(pane, f"shifted geometric mean of the time (shift {shift})" if pane is axes[0][0] else "")
    canvas.legend_outside(figure, canvas.handles(solvers, styles), 6)
    return figure
