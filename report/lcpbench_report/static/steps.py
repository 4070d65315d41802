"""Sequences of motions, and motions that solvers drive: latencies of steps, what comes in time, and what errors do."""

import math

import numpy as np
import pandas as pd

from .. import choice, motion
from ..formats import power
from ..inputs import Inputs
from ..statistics.latency import ALL
from ..style import SolverStyle
from . import canvas

_QUANTILES = {"p50": ("median", "o", 4), "p99": ("99 %", "|", 7), "max": ("largest", "D", 3.2)}  # label, marker, size
_QUANTITIES = (("energy_error", "energy error, relative"), ("penetration", "deepest penetration so far [m]"))
_LEAST = 1e-17  # smaller values are rounding, and stand at the axis' end
_DASHES = ("-", (0, (5, 2)), (0, (1, 1.5)), (0, (6, 1.5, 1, 1.5)))  # loosest tolerance first


def latency(inputs: Inputs):
    """Median, 99 % quantile and largest latency of a step; cold starts hollow above warm ones. A panel per size; None
    without sequences."""
    table = inputs.analysis.get("latency_by_solver", pd.DataFrame(columns=["mode", "tier"]))
    table = _at_tier(table[table["mode"].isin(("cold", "warm"))])
    if not len(table):
        return None
    solvers = inputs.in_order(table["solver"])
    figure, panes = _panels(table, 0.27 * len(solvers) + 1.1, sharex=True)
    for pane, rows in panes:
        for row, solver in enumerate(solvers):
            for mode, offset in (("cold", -0.17), ("warm", 0.17)):
                found = rows[(rows["solver"] == solver) & (rows["mode"] == mode)]
                if len(found):
                    _latencies(pane, row + offset, found.iloc[0], inputs.styles[solver].colour, warm=mode == "warm")
        canvas.time_axis(pane, "latency of a step", "x")
        canvas.name_axis(pane, solvers)
    grey = {"color": canvas.FAINT, "markeredgewidth": 0.9}
    made = [canvas.Line2D([], [], label=label, marker=mark, markersize=size, markerfacecolor=canvas.FAINT, linestyle="none",
                          **grey) for label, mark, size in _QUANTILES.values()]
    made += [canvas.Line2D([], [], label=label, marker="o", markersize=4, linewidth=1, markerfacecolor=face, **grey)
             for label, face in (("cold start", "white"), ("warm start", canvas.FAINT))]
    canvas.legend_outside(figure, made, 5)
    return figure


def _latencies(axes, y: float, found: pd.Series, colour: str, warm: bool) -> None:
    """Infinite where not all steps have an answer: drawn to the axis' right end as a dotted line."""
    known = {level: float(found[level]) for level in _QUANTILES}
    finite = [value for value in known.values() if math.isfinite(value)]
    if not finite:
        axes.text(0.02, y, "no answers", transform=axes.get_yaxis_transform(), fontsize=6, va="center", color=colour)
        return
    axes.plot([finite[0], finite[-1]], [y, y], color=colour, linewidth=1.0, zorder=3)
    if len(finite) < len(known):
        axes.annotate("", (1, y), (finite[-1], y), xycoords=axes.get_yaxis_transform(), textcoords="data",
                      arrowprops={"arrowstyle": "-", "linestyle": ":", "color": colour, "linewidth": 0.9})
    for level, (_, mark, size) in _QUANTILES.items():
        if math.isfinite(known[level]):
            axes.plot(known[level], y, marker=mark, markersize=size, color=colour, zorder=4, markeredgewidth=0.9,
                      markerfacecolor=colour if warm else "white")


def deadlines(inputs: Inputs):
    """Share of steps that are in time and verified, against the deadline; None without deadlines."""
    table = _at_tier(inputs.analysis.get("deadline", pd.DataFrame(columns=["tier"])))
    if not len(table):
        return None
    solvers = inputs.in_order(table["solver"])[:12]
    limits = sorted(set(table["deadline_s"]))
    figure, panes = _panels(table, 2.6)
    for pane, rows in panes:
        for index, solver in enumerate(solvers):
            mine = rows[rows["solver"] == solver].sort_values("deadline_s")
            # A little apart, so that equal shares can be told apart.
            places = [limits.index(limit) + 0.5 * ((index + 0.5) / len(solvers) - 0.5) for limit in mine["deadline_s"]]
            share = 100 * mine["verified_share"]
            errors = [share - 100 * mine["verified_low"], 100 * mine["verified_high"] - share]
            pane.errorbar(places, share, yerr=[error.clip(lower=0) for error in errors], elinewidth=0.8, zorder=4,
                          linestyle="none", **canvas.marker(inputs.styles[solver], 4.5))
        pane.set_xticks(range(len(limits)), [canvas.time_tick(limit) for limit in limits])
        pane.set_xlim(-0.5, len(limits) - 0.5)
        pane.set_xlabel("deadline of a step")
    first, _ = panes[0]
    first.set_ylabel(f"in time and verified at {power(table['tier'].iloc[0])} [%]")
    first.set_ylim(max(first.get_ylim()[0], -3), 102)
    made = canvas.handles(solvers, inputs.styles)
    for handle in made:
        handle.set_linestyle("none")
    canvas.legend_outside(figure, made, 6)
    return figure


def _at_tier(table: pd.DataFrame) -> pd.DataFrame:
    return table[table["tier"] == choice.nearest(table["tier"])]


def _panels(table: pd.DataFrame, height: float, **options):
    """Figure, and a panel with its rows per size, the smallest first; without `all` where there are others."""
    sizes = sorted(set(table["size"]) - {ALL}, key=float) or [ALL]
    figure, panes = canvas.panels(len(sizes), canvas.PAGE if len(sizes) > 1 else 0.6 * canvas.PAGE, height, sharey=True,
                                  **options)
    for pane, size in zip(panes, sizes):
        pane.set_title("all sequences" if size == ALL else f"about {float(size):.0f} rows")
    return figure, [(pane, table[table["size"] == size]) for pane, size in zip(panes, sizes)]


def errors(inputs: Inputs, scene: str, level: str):
    """Colour and marker by solver, dash by tolerance; a cross where the motion was ended."""
    table = motion.of_scene(inputs.motion, scene, level)
    solvers = [key for key in _shown(inputs) if key in set(table["solver"])]
    if not solvers:
        return None
    tolerances = sorted(set(table["tolerance"]), reverse=True)
    dashes = {tolerance: _DASHES[min(index, len(_DASHES) - 1)] for index, tolerance in enumerate(tolerances)}
    figure, panes = canvas.panels(len(_QUANTITIES), canvas.PAGE, 3.0)
    for pane, (column, label) in zip(panes, _QUANTITIES):
        for index, solver in enumerate(solvers):
            for tolerance, run in table[table["solver"] == solver].groupby("tolerance", sort=False):
                _curve(pane, run, column, inputs.styles[solver], dashes[tolerance], index)
        canvas.log_axis(pane.yaxis, label, canvas.power_tick)
        pane.set_xlabel("time [s]")
        pane.xaxis.set_major_locator(canvas.MaxNLocator(5))
    panes[0].set_title(f"{scene}, {level} level")
    made = [canvas.Line2D([], [], label=solver, linewidth=1.1, **canvas.marker(inputs.styles[solver]))
            for solver in solvers]
    made += [canvas.Line2D([], [], label=f"tolerance {power(tolerance)}", color=canvas.FAINT, linewidth=1,
                           linestyle=dashes[tolerance]) for tolerance in tolerances]
    canvas.legend_outside(figure, made, 6)
    return figure


def _shown(inputs: Inputs) -> list[str]:
    """The best ones; all, in the order of the file, where no problems were measured."""
    driven = list(dict.fromkeys(inputs.motion["solver"]))
    best = [key for key in choice.best_own(inputs, 7) + choice.best_peers(inputs, 3) if key in driven]
    return [key for key in (best or driven[:10]) if key in inputs.entries]


def _curve(axes, run: pd.DataFrame, column: str, style: SolverStyle, dash, index: int) -> None:
    """Markers now and then, at other times for every solver: dashes are the tolerances'."""
    values = run[column].cummax() if column == "penetration" else run[column]
    values = values.clip(lower=_LEAST).iloc[1:].replace(np.inf, np.nan).dropna()
    times = run["time"].loc[values.index]
    axes.plot(times, values, linestyle=dash, linewidth=0.9, zorder=3, markevery=(2 + 3 * index, 30),
              **canvas.marker(style, 3.6))
    if len(values) and isinstance(run["stopped"].iloc[-1], str) and run["stopped"].iloc[-1]:
        axes.plot(times.iloc[-1:], values.iloc[-1:], marker="x", markersize=5, markeredgewidth=1.2, color=style.colour,
                  zorder=4, clip_on=False)
