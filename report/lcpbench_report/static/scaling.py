"""Exponents of time ~ rows^exponent, a point per family with its interval."""

import numpy as np

from .. import choice
from ..inputs import Inputs
from ..style import solver_styles
from ..formats import power
from . import canvas

_BAND = 0.62  # height of the band of a solver's families


def exponents(inputs: Inputs):
    """A band per solver, a point per family (in the same order, from above), the median as a bar; None without any."""
    tier = choice.main_tier(inputs)
    table = inputs.analysis.get("scaling")
    table = None if table is None else choice.counted(table, tier)
    solvers = [] if table is None else [key for key in choice.best_own(inputs, 20) + choice.best_peers(inputs, 20)
                                        if (table["solver"] == key).any()]
    if not solvers:
        return None
    styles = solver_styles(inputs.solvers)
    figure, axes = canvas.panels(1, 1, 0.62 * canvas.PAGE, 0.3 * len(solvers) + 0.6)
    pane = axes[0][0]
    heights = dict(zip(choice.families(inputs), np.linspace(-_BAND / 2, _BAND / 2, len(choice.families(inputs)))))
    for row, solver in enumerate(solvers):
        mine, style = table[table["solver"] == solver], styles[solver]
        places = row + mine["family"].map(heights).to_numpy()
        pane.hlines(places, mine["exponent_low"], mine["exponent_high"], color=style.colour, linewidth=0.6, alpha=0.6)
        pane.plot(mine["exponent"], places, linestyle="none", zorder=4, **canvas.marker(style, 2.6))
        middle = mine["exponent"].median()
        pane.plot([middle, middle], [row - 0.42, row + 0.42], color=canvas.INK, linewidth=1.3, zorder=5)
    # Intervals of three or four noisy points may be as wide as they like.
    pane.set_xlim(min(0, np.floor(2 * table["exponent"].min()) / 2), np.ceil(2 * table["exponent"].max()) / 2)
    pane.set_xlabel(f"exponent of $n$, tier {power(tier)}")
    pane.set_title("points: families, with 95 % intervals; bars: medians")
    for whole in range(1, int(pane.get_xlim()[1]) + 1):
        pane.axvline(whole, color="#ccd3da", linewidth=0.7, zorder=1)
    canvas.name_axis(pane, solvers)
    return figure
