"""How right the answers are that solvers call solved: all of them, also those that the verifier refutes."""

import numpy as np

from .. import choice
from ..inputs import Inputs
from ..statistics.weighted import quantiles
from ..style import solver_styles
from ..formats import power
from . import canvas

_LEAST = 1e-17  # smaller ones, and 0, are rounding; they stand at the axis' end
_PANELS = (("rho", "scaled natural residual $\\rho$", ("certified", "bounded", "none")),
           ("w_error", "error of $w$ against proved answers, over $1 + |b|_\\infty$", ("certified", "bounded")))


def distributions(inputs: Inputs):
    """A row per solver: from the smallest to the largest value (thin), middle half (thick), median (marker) and 99 %
    quantile (tick); None without answers."""
    tier = choice.main_tier(inputs)
    cells = choice.main_cells(inputs, tier)
    cells = cells[(cells["claim"] == "solved") | cells["passes"].astype(bool)]
    solvers = [key for key in inputs.keys if key in set(cells["solver"])]
    if not solvers:
        return None
    styles = solver_styles(inputs.solvers)
    figure, axes = canvas.panels(1, len(_PANELS), canvas.PAGE, 0.155 * len(solvers) + 0.9, sharey=True)
    for pane, (metric, label, references) in zip(axes[0], _PANELS):
        known = cells[cells["reference"].isin(references)]
        for row, solver in enumerate(solvers):
            values = known.loc[known["solver"] == solver, metric].dropna().clip(lower=_LEAST)
            if len(values):
                _row(pane, row, quantiles(np.minimum(values, 1e6)), styles[solver])
        pane.axvline(tier, color=canvas.INK, linewidth=0.8, linestyle=(0, (3, 2)), zorder=1)
        canvas.log_axis(pane.xaxis, label, canvas.power_tick)
        low, high = pane.get_xlim()
        pane.set_xlim(low, max(high, 10 * tier))
        canvas.name_axis(pane, solvers)
    axes[0][0].set_title(f"answers called solved at tier {power(tier)} (dashed line)")
    return figure


def _row(axes, y: int, found: dict[str, float], style) -> None:
    axes.plot([found["min"], found["max"]], [y, y], color=style.colour, linewidth=0.7, zorder=2,
              solid_capstyle="butt")
    axes.plot([found["p25"], found["p75"]], [y, y], color=style.colour, linewidth=3, zorder=3, alpha=0.55,
              solid_capstyle="butt")
    axes.plot(found["p99"], y, marker="|", markersize=6, markeredgewidth=1, color=style.colour, zorder=4)
    axes.plot(found["median"], y, zorder=5, linestyle="none", **canvas.marker(style))
