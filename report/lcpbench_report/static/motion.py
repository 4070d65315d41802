"""What a solver's error does to a motion: energy error and penetration over time."""

import numpy as np
import pandas as pd

from .. import choice
from ..inputs import Inputs
from ..style import SolverStyle, solver_styles
from ..formats import power
from . import canvas

_QUANTITIES = (("energy_error", "energy error, relative"), ("penetration", "deepest penetration so far [m]"))
_LEAST = 1e-17  # smaller values are rounding, and stand at the axis' end
_DASHES = ("-", (0, (5, 2)), (0, (1, 1.5)), (0, (6, 1.5, 1, 1.5)))  # loosest tolerance first


def errors(inputs: Inputs, scene: str, level: str):
    """Colour and marker by solver, dash by tolerance; a cross where the motion was ended."""
    table = inputs.motion[(inputs.motion["scene"] == scene) & (inputs.motion["level"] == level)]
    styles = solver_styles(inputs.solvers)
    solvers = [key for key in _shown(inputs) if key in set(table["solver"])]
    if not solvers:
        return None
    tolerances = sorted(set(table["tolerance"]), reverse=True)
    dashes = {tolerance: _DASHES[min(index, len(_DASHES) - 1)] for index, tolerance in enumerate(tolerances)}
    figure, axes = canvas.panels(1, len(_QUANTITIES), canvas.PAGE, 3.0)
    for pane, (column, label) in zip(axes[0], _QUANTITIES):
        for index, solver in enumerate(solvers):
            for tolerance, run in table[table["solver"] == solver].groupby("tolerance", sort=False):
                _curve(pane, run, column, styles[solver], dashes[tolerance], index)
        canvas.log_axis(pane.yaxis, label, canvas.power_tick)
        pane.set_xlabel("time [s]")
        pane.xaxis.set_major_locator(canvas.MaxNLocator(5))
    axes[0][0].set_title(f"{scene}, {level} level")
    made = [canvas.Line2D([], [], label=solver, linewidth=1.1, **canvas.marker(styles[solver]))
            for solver in solvers]
    made += [canvas.Line2D([], [], label=f"tolerance {power(tolerance)}", color=canvas.FAINT, linewidth=1,
                           linestyle=dashes[tolerance]) for tolerance in tolerances]
    canvas.legend_outside(figure, made, 6)
    return figure


def _shown(inputs: Inputs) -> list[str]:
    """The best ones; all, in the order of the file, where no problems were measured."""
    driven = list(dict.fromkeys(inputs.motion["solver"]))
    known = [entry["key"] for entry in inputs.solvers]
    best = [key for key in choice.best_own(inputs, 7) + choice.best_peers(inputs, 3) if key in driven]
    return [key for key in (best or driven[:10]) if key in known]


def _curve(axes, run: pd.DataFrame, column: str, style: SolverStyle, dash, index: int) -> None:
    """Markers now and then, at other times for every solver: dashes are the tolerances'."""
    colour = style.colour
    values = run[column].cummax() if column == "penetration" else run[column]
    values = values.clip(lower=_LEAST).iloc[1:].replace(np.inf, np.nan).dropna()
    times = run["time"].loc[values.index]
    axes.plot(times, values, color=colour, linestyle=dash, linewidth=0.9, zorder=3,
              markevery=(2 + 3 * index, 30), **{k: v for k, v in canvas.marker(style, 3.6).items() if k != "color"})
    if len(values) and isinstance(run["stopped"].iloc[-1], str) and run["stopped"].iloc[-1]:
        axes.plot(times.iloc[-1:], values.iloc[-1:], marker="x", markersize=5, markeredgewidth=1.2, color=colour,
                  zorder=4, clip_on=False)
