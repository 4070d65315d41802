"""Sequences of motions, and motions that solvers drive: latencies of steps, what comes in time, and what errors do."""

import math

import numpy as np
import pandas as pd

from .. import choice, motion
from ..formats import power
from ..inputs import Inputs
from ..style import SolverStyle, solver_styles
from . import canvas

ALL = "all"  # size of all sequences together
_QUANTILES = ("p50", "p99", "max")
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
    solvers = [key for key in inputs.keys if key in set(table["solver"])]
    sizes = _sizes(table)
    styles = solver_styles(inputs.solvers)
    figure, axes = canvas.panels(1, len(sizes), canvas.PAGE if len(sizes) > 1 else 0.6 * canvas.PAGE,
                                 0.27 * len(solvers) + 1.1, sharey=True, sharex=True)
    for pane, size in zip(axes[0], sizes):
        rows = table[table["size"].astype(str) == str(size)]
        for row, solver in enumerate(solvers):
            for mode, offset in (("cold", -0.17), ("warm", 0.17)):
                found = rows[(rows["solver"] == solver) & (rows["mode"] == mode)]
                if len(found):
                    _latencies(pane, row + offset, found.iloc[0], styles[solver], warm=mode == "warm")
        pane.set_title(_title(size))
        canvas.time_axis(pane, "latency of a step", "x")
        canvas.name_axis(pane, solvers)
    canvas.legend_outside(figure, _legend(), 5)
    return figure


def _latencies(axes, y: float, found: pd.Series, style, warm: bool) -> None:
    """Infinite where not all steps have an answer: drawn to the axis' right end as a dotted line."""
    known = [float(found[level]) for level in _QUANTILES]
    finite = [value for value in known if math.isfinite(value)]
    if not finite:
        axes.text(0.02, y, "no answers", transform=axes.get_yaxis_transform(), fontsize=6, va="center",
                  color=style.colour)
        return
    axes.plot([finite[0], finite[-1]], [y, y], color=style.colour, linewidth=1.0, zorder=3)
    if len(finite) < len(known):
        axes.annotate("", (1, y), (finite[-1], y), xycoords=axes.get_yaxis_transform(), textcoords="data",
                      arrowprops={"arrowstyle": "-", "linestyle": ":", "color": style.colour, "linewidth": 0.9})
    for value, mark, size in zip(known, ("o", "|", "D"), (4, 7, 3.2)):
        if math.isfinite(value):
            axes.plot(value, y, marker=mark, markersize=size, color=style.colour, zorder=4, markeredgewidth=0.9,
                      markerfacecolor=style.colour if warm else "white")


def _legend():
    look = {"linestyle": "none", "color": canvas.FAINT, "markeredgewidth": 0.9}
    made = [canvas.Line2D([], [], label=label, marker=mark, markersize=size, markerfacecolor=canvas.FAINT, **look)
            for label, mark, size in (("median", "o", 4), ("99 %", "|", 7), ("largest", "D", 3.2))]
    return made + [canvas.Line2D([], [], label=label, color=canvas.FAINT, marker="o", markersize=4, linewidth=1,
                                 markeredgewidth=0.9, markerfacecolor=face)
                   for label, face in (("cold start", "white"), ("warm start", canvas.FAINT))]


def deadlines(inputs: Inputs):
    """Share of steps that are in time and verified, against the deadline; None without deadlines."""
    table = _at_tier(inputs.analysis.get("deadline", pd.DataFrame(columns=["tier"])))
    if not len(table):
        return None
    solvers = [key for key in inputs.keys if key in set(table["solver"])][:12]
    sizes = _sizes(table)
    styles = solver_styles(inputs.solvers)
    limits = sorted(set(table["deadline_s"]))
    figure, axes = canvas.panels(1, len(sizes), canvas.PAGE if len(sizes) > 1 else 0.6 * canvas.PAGE, 2.6, sharey=True)
    for pane, size in zip(axes[0], sizes):
        rows = table[table["size"].astype(str) == str(size)]
        for index, solver in enumerate(solvers):
            mine = rows[rows["solver"] == solver].sort_values("deadline_s")
            # A little apart, so that equal shares can be told apart.
            places = [limits.index(limit) + 0.5 * ((index + 0.5) / len(solvers) - 0.5) for limit in mine["deadline_s"]]
            share = 100 * mine["verified_share"]
            errors = [share - 100 * mine["verified_low"], 100 * mine["verified_high"] - share]
            pane.errorbar(places, share, yerr=[error.clip(lower=0) for error in errors], elinewidth=0.8, zorder=4,
                          linestyle="none", **canvas.marker(styles[solver], 4.5))
        pane.set_xticks(range(len(limits)), [canvas.time_tick(limit) for limit in limits])
        pane.set_xlim(-0.5, len(limits) - 0.5)
        pane.set_xlabel("deadline of a step")
        pane.set_title(_title(size))
    axes[0][0].set_ylabel(f"in time and verified at {power(table['tier'].iloc[0])} [%]")
    low, _ = axes[0][0].get_ylim()
    axes[0][0].set_ylim(max(low, -3), 102)
    made = canvas.handles(solvers, styles)
    for handle in made:
        handle.set_linestyle("none")
    canvas.legend_outside(figure, made, 6)
    return figure


def _at_tier(table: pd.DataFrame) -> pd.DataFrame:
    return table[table["tier"] == choice.nearest(table["tier"])]


def _sizes(table: pd.DataFrame) -> list[str]:
    """Smallest first, without `all` where there are others."""
    sizes = list(dict.fromkeys(map(str, table["size"])))
    single = sorted((size for size in sizes if size != ALL), key=float)
    return single or sizes


def _title(size: str) -> str:
    return "all sequences" if size == ALL else f"about {float(size):.0f} rows"


def errors(inputs: Inputs, scene: str, level: str):
    """Colour and marker by solver, dash by tolerance; a cross where the motion was ended."""
    table = motion.of_scene(inputs.motion, scene, level)
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
