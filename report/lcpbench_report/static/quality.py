"""How right the answers are that solvers call solved, what precision costs, and where solvers break."""

import math
import re

import numpy as np
import pandas as pd
from matplotlib.patches import Patch

from .. import choice
from ..formats import power
from ..inputs import PATHOLOGICAL, Inputs
from ..statistics.cells import BELOW_TIER, EXCLUDED, FALSE_SUCCESS, VERIFIED
from ..statistics.precision import delivered_table
from ..statistics.weighted import quantiles
from ..style import solver_styles
from . import canvas

_LEAST = 1e-17  # smaller ones, and 0, are rounding; they stand at the axis' end
_PANELS = (("rho", "scaled natural residual $\\rho$", ("certified", "bounded", "none")),
           ("w_error", "error of $w$ against proved answers, over $1 + |b|_\\infty$", ("certified", "bounded")))
_FEWEST_TIERS = 3
_COLUMNS = {"verified": "verified", "false success": "false_successes", "below the tier": "below_tier", "failed": "failed",
            "excluded": "excluded"}
# family-n40-s1-mass-ratio-1e+08: the change of a problem is what it is meant to break.
_CHANGE = re.compile(r"-n\d+-s\d+-(?P<change>[a-z-]+?)-[-+.\de]+$")
_WORDS = {VERIFIED: "verified", FALSE_SUCCESS: "false success", BELOW_TIER: "below the tier", EXCLUDED: "excluded"}


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
                _distribution(pane, row, quantiles(np.minimum(values, 1e6)), styles[solver])
        pane.axvline(tier, color=canvas.INK, linewidth=0.8, linestyle=(0, (3, 2)), zorder=1)
        canvas.log_axis(pane.xaxis, label, canvas.power_tick)
        low, high = pane.get_xlim()
        pane.set_xlim(low, max(high, 10 * tier))
        canvas.name_axis(pane, solvers)
    axes[0][0].set_title(f"answers called solved at tier {power(tier)} (dashed line)")
    return figure


def _distribution(axes, y: int, found: dict[str, float], style) -> None:
    axes.plot([found["min"], found["max"]], [y, y], color=style.colour, linewidth=0.7, zorder=2,
              solid_capstyle="butt")
    axes.plot([found["p25"], found["p75"]], [y, y], color=style.colour, linewidth=3, zorder=3, alpha=0.55,
              solid_capstyle="butt")
    axes.plot(found["p99"], y, marker="|", markersize=6, markeredgewidth=1, color=style.colour, zorder=4)
    axes.plot(found["median"], y, zorder=5, linestyle="none", **canvas.marker(style))


def bars(inputs: Inputs):
    """A bar per solver, a panel per tier; false successes as numbers beside the bars; None without problems that
    count."""
    table = choice.table(inputs, "coverage")
    tiers = [tier for tier in choice.shown_tiers(inputs) if (table["tier"] == tier).any()]
    if not tiers:
        return None
    solvers = [key for key in inputs.keys if key in set(table["solver"])]
    figure, axes = canvas.panels(1, len(tiers), canvas.PAGE, 0.155 * len(solvers) + 0.95, sharey=True)
    for pane, tier in zip(axes[0], tiers):
        mine = table[table["tier"] == tier].set_index("solver").reindex(solvers)
        left = 0.0 * mine["problems"]
        for verdict, column in _COLUMNS.items():
            share = 100 * mine[column] / mine["problems"]
            pane.barh(range(len(solvers)), share, left=left, height=0.72, color=canvas.VERDICTS[verdict], zorder=3)
            left = left + share
        for row, count in enumerate(mine["false_successes"].fillna(0)):
            if count:
                pane.text(101.5, row, f"{count:.0f}", va="center", fontsize=6, color=canvas.VERDICTS["false success"])
        pane.set_xlim(0, 100)
        pane.set_title(f"tier {power(tier)}")
        pane.set_xlabel("problems [%]")
        canvas.name_axis(pane, solvers)
    handles = [Patch(color=canvas.VERDICTS[verdict], label=verdict) for verdict in _COLUMNS]
    handles[1].set_label("false success (and how many)")
    canvas.legend_outside(figure, handles, 5)
    return figure


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
    solvers = [key for key in choice.best_of(inputs, table) if key in tolerant][:12]
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


def kind_of(problem: str, family: str) -> str:
    """The change that a problem has, else its family."""
    found = _CHANGE.search(problem)
    return found["change"] if found else family


def pathological(inputs: Inputs):
    """Solvers x kinds of pathological problems; None without any."""
    cells = _cells(inputs)
    cells = cells[cells["set"] == PATHOLOGICAL]
    kinds = [kind_of(problem, family) for problem, family in zip(cells["problem"], cells["family"])]
    return _map(inputs, cells, kinds)


def grids(inputs: Inputs):
    """Solvers x grids of the standard problems, each of which varies one property; None without any."""
    cells = _cells(inputs)
    kinds = cells["problem"].map(lambda name: inputs.problems[name].get("grid") or "").astype(str)
    chosen = (kinds != "") & (cells["set"] != PATHOLOGICAL)
    return _map(inputs, cells[chosen], list(kinds[chosen]))


def _cells(inputs: Inputs) -> pd.DataFrame:
    cells = inputs.cells
    return cells[cells["tier"] == choice.main_tier(inputs)]


def _map(inputs: Inputs, cells: pd.DataFrame, kinds: list[str]):
    if not len(cells):
        return None
    verdicts = cells["verdict"].map(lambda verdict: _WORDS.get(verdict, "failed"))
    verdicts[cells["proved_infeasible"].astype(bool)] = "proved infeasible"
    counts = pd.crosstab([cells["solver"], pd.Series(kinds, index=cells.index, name="kind")], verdicts)
    of_problem = dict(zip(cells["problem"], kinds))
    names = list(dict.fromkeys(of_problem[name] for name in inputs.problems if name in of_problem))
    solvers = [key for key in inputs.keys if key in set(cells["solver"])]
    width = min(1.55 + 0.42 * len(names), canvas.PAGE)
    figure, axes = canvas.panels(1, 1, max(width, canvas.COLUMN), 0.155 * len(solvers) + 1.6)
    pane = axes[0][0]
    for (solver, kind), found in counts.iterrows():
        row, left = solvers.index(solver), names.index(kind) - 0.46
        for verdict, colour in canvas.VERDICTS.items():
            share = 0.92 * found.get(verdict, 0) / found.sum()
            if share:
                pane.barh(row, share, left=left, height=0.8, color=colour, zorder=3)
            left += share
    canvas.name_axis(pane, solvers)
    problems = pd.Series(kinds).groupby(kinds).size() // len(solvers)
    pane.set_xticks(range(len(names)), [f"{name} ({problems[name]})" for name in names], rotation=40, ha="left",
                    rotation_mode="anchor")
    pane.tick_params(top=True, bottom=False, labeltop=True, labelbottom=False, length=0, pad=2)
    pane.set_xlim(-0.5, len(names) - 0.5)
    pane.grid(False)
    for side in pane.spines.values():
        side.set_visible(False)
    pane.set_xlabel(f"kind of problem (number of problems), tier {power(choice.main_tier(inputs))}")
    shown = [verdict for verdict in canvas.VERDICTS if verdict in counts.columns]
    canvas.legend_outside(figure, [Patch(color=canvas.VERDICTS[verdict], label=verdict) for verdict in shown],
                          6 if len(names) > 7 else 2)
    return figure
