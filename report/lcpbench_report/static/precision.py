"""Work over precision: what stricter tolerances cost, and whether they are met."""

import math

from .. import choice
from ..inputs import Inputs
from ..style import solver_styles
from . import canvas

_FEWEST_TIERS = 3


def work_precision(inputs: Inputs):
    """Mean time against the tolerance asked for, and against the residual got for it (90 % quantile), over all problems
    that were run, right or not; None without several tolerances."""
    table = inputs.analysis.get("delivered")
    table = None if table is None else choice.counted(table, inputs)
    if table is None or table["tier"].nunique() < _FEWEST_TIERS:
        return None
    styles = solver_styles(inputs.solvers)
    # Of what has a tolerance: the line of a direct method is a point.
    tolerant = {entry["key"] for entry in inputs.solvers if entry["uses_tolerance"]}
    solvers = [key for key in choice.best_own(inputs, 8) + choice.best_peers(inputs, 4)
               if key in tolerant and (table["solver"] == key).any()]
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
