"""How right the answers are that solvers call solved, what precision costs, and where solvers break."""

import math
import re

import numpy as np
import pandas as pd
from matplotlib.patches import Patch

from .. import choice
from ..formats import power
from ..inputs import PATHOLOGICAL, Inputs
from ..statistics.cells import FAILED, NOT_RUN, within_rounding
from ..statistics.means import delivered_table
from ..statistics.weighted import quantiles
from . import canvas

_LEAST = 1e-17  # smaller ones, and 0, are rounding; they stand at the axis' end
_PANELS = (("rho", "scaled natural residual $\\rho$", ("certified", "bounded", "none")),
           ("w_error", "error of $w$ against proved answers, over $1 + |b|_\\infty$", ("certified", "bounded")))
_FEWEST_TIERS = 3
_COLUMNS = {"verified": "verified", "false success": "false_successes", "below the tier": "below_tier", "failed": "failed",
            "not asked": "not_asked", "excluded": "excluded"}
# family-n40-s1-mass-ratio-1e+08: the change of a problem is what it is meant to break.
_CHANGE = re.compile(r"-n\d+-s\d+-(?P<change>[a-z-]+?)-[-+.\de]+$")


def distributions(inputs: Inputs):
    """A row per solver: from the smallest to the largest value (thin), middle half (thick), median (marker) and 99 %
    quantile (tick); None without answers."""
    tier, cells = choice.main_tier(inputs), choice.main_cells(inputs)
    cells = cells[(cells["claim"] == "solved") | cells["passes"].astype(bool)]
    solvers = inputs.in_order(cells["solver"])
    if not solvers:
        return None
    figure, panes = canvas.panels(len(_PANELS), canvas.PAGE, 0.155 * len(solvers) + 0.9, sharey=True)
    for pane, (metric, label, references) in zip(panes, _PANELS):
        known = cells[cells["reference"].isin(references)]
        for row, solver in enumerate(solvers):
            values = known.loc[known["solver"] == solver, metric].dropna().clip(lower=_LEAST)
            if len(values):
                found, style = quantiles(np.minimum(values, 1e6)), inputs.styles[solver]
                for ends, look in ((("min", "max"), {"linewidth": 0.7, "zorder": 2}),
                                   (("p25", "p75"), {"linewidth": 3, "zorder": 3, "alpha": 0.55})):
                    pane.plot([found[end] for end in ends], [row, row], color=style.colour, solid_capstyle="butt", **look)
                pane.plot(found["p99"], row, marker="|", markersize=6, markeredgewidth=1, color=style.colour, zorder=4)
                pane.plot(found["median"], row, zorder=5, linestyle="none", **canvas.marker(style))
        pane.axvline(tier, color=canvas.INK, linewidth=0.8, linestyle=(0, (3, 2)), zorder=1)
        canvas.log_axis(pane.xaxis, label, canvas.power_tick)
        low, high = pane.get_xlim()
        pane.set_xlim(low, max(high, 10 * tier))
        canvas.name_axis(pane, solvers)
    panes[0].set_title(f"answers called solved at tier {power(tier)} (dashed line)")
    return figure


def bars(inputs: Inputs):
    """A bar per solver, a panel per tier; false successes as numbers beside the bars; None without problems that
    count."""
    table = choice.table(inputs, "coverage")
    tiers = [tier for tier in choice.shown_tiers(inputs) if (table["tier"] == tier).any()]
    if not tiers:
        return None
    solvers = inputs.in_order(table["solver"])
    figure, panes = canvas.panels(len(tiers), canvas.PAGE, 0.155 * len(solvers) + 0.95, sharey=True)
    for pane, tier in zip(panes, tiers):
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
    handles = _legend(_COLUMNS)
    handles[1].set_label("false success (and how many)")
    canvas.legend_outside(figure, handles, 5)
    return figure


def _legend(verdicts) -> list[Patch]:
    return [Patch(color=canvas.VERDICTS[verdict], label=verdict) for verdict in verdicts]


def _at_every_tier(cells: pd.DataFrame) -> pd.DataFrame:
    """Points of one line must be of the same problems: where several campaigns were read, those of the one with the most
    tiers; and of them, for each solver, those that it was not excluded from at any tier."""
    tiers = cells.groupby("problem")["tier"].transform("nunique")
    run = cells[(tiers == tiers.max()) & ~cells["verdict"].isin(NOT_RUN)]
    return run[run.groupby(["solver", "problem"])["tier"].transform("nunique") == run["tier"].nunique()]


def work_precision(inputs: Inputs):
    """Mean time against the tolerance asked for, and against the residual got for it (90 % quantile), right or not, over
    the problems that a solver was given at every tier; None without several tolerances."""
    cells = _at_every_tier(inputs.counted)
    if cells["tier"].nunique() < _FEWEST_TIERS:
        return None
    table = choice.counted(delivered_table(cells))
    # Only solvers with a tolerance: the line of a direct method is a point.
    solvers = [key for key in choice.best_of(inputs, table) if inputs.entries[key]["uses_tolerance"]][:12]
    if not solvers:
        return None
    figure, panes = canvas.panels(2, canvas.PAGE, 3.1, sharey=True)
    for solver in solvers:
        mine = table[table["solver"] == solver].sort_values("tier", ascending=False)
        for pane, across in zip(panes, (mine["tier"], mine["rho_p90"].clip(lower=1e-17))):
            pane.plot(across, mine["mean_s"], **canvas.line(inputs.styles[solver]))
    shift = canvas.time_tick(float(table["shift"].iloc[0]))
    for pane, label in zip(panes, ("tolerance asked for", "residual $\\rho$ got, 90 % quantile")):
        canvas.log_axis(pane.xaxis, label, lambda x: canvas.power_tick(x) if round(math.log10(x)) % 3 == 0 else "", 20)
        pane.xaxis.set_minor_locator(canvas.NullLocator())
        pane.invert_xaxis()
        canvas.time_axis(pane, f"shifted geometric mean of the time (shift {shift})" if pane is panes[0] else "")
    canvas.legend_outside(figure, canvas.handles(solvers, inputs.styles), 6)
    return figure


def kind_of(problem: str, family: str) -> str:
    """The change that a problem has, else its family."""
    found = _CHANGE.search(problem)
    return found["change"] if found else family


def pathological(inputs: Inputs):
    """Solvers x kinds of pathological problems; None without any."""
    cells = inputs.cells[inputs.cells["set"] == PATHOLOGICAL]
    return _map(inputs, cells, [kind_of(problem, family) for problem, family in zip(cells["problem"], cells["family"])])


def grids(inputs: Inputs):
    """Solvers x grids of the standard problems, each of which varies one property; None without any."""
    cells = inputs.cells[inputs.cells["set"] != PATHOLOGICAL]
    return _map(inputs, cells, [inputs.problems[name].get("grid") or "" for name in cells["problem"]])


def _map(inputs: Inputs, cells: pd.DataFrame, kinds: list[str]):
    """At the main tier, of problems that have a kind."""
    cells = cells.assign(kind=kinds)
    cells = cells[(cells["tier"] == choice.main_tier(inputs)) & (cells["kind"] != "")]
    if not len(cells):
        return None
    verdicts = cells["verdict"].where(~cells["verdict"].str.startswith(FAILED), "failed")
    verdicts[cells["proved_infeasible"].astype(bool)] = "proved infeasible"
    verdicts[within_rounding(cells)] = "infeasible within rounding"
    counts = pd.crosstab([cells["solver"], cells["kind"]], verdicts)
    of_problem = dict(zip(cells["problem"], cells["kind"]))
    names = list(dict.fromkeys(of_problem[name] for name in inputs.problems if name in of_problem))
    solvers = inputs.in_order(cells["solver"])
    width = min(1.55 + 0.42 * len(names), canvas.PAGE)
    figure, (pane,) = canvas.panels(1, max(width, canvas.COLUMN), 0.155 * len(solvers) + 1.6)
    for (solver, kind), found in counts.iterrows():
        row, left = solvers.index(solver), names.index(kind) - 0.46
        for verdict, colour in canvas.VERDICTS.items():
            share = 0.92 * found.get(verdict, 0) / found.sum()
            if share:
                pane.barh(row, share, left=left, height=0.8, color=colour, zorder=3)
            left += share
    canvas.name_axis(pane, solvers)
    problems = cells.groupby("kind").size() // len(solvers)
    pane.set_xticks(range(len(names)), [f"{name} ({problems[name]})" for name in names], rotation=40, ha="left",
                    rotation_mode="anchor")
    pane.tick_params(top=True, bottom=False, labeltop=True, labelbottom=False, length=0, pad=2)
    pane.set_xlim(-0.5, len(names) - 0.5)
    pane.grid(False)
    for side in pane.spines.values():
        side.set_visible(False)
    pane.set_xlabel(f"kind of problem (number of problems), tier {power(choice.main_tier(inputs))}")
    canvas.legend_outside(figure, _legend(verdict for verdict in canvas.VERDICTS if verdict in counts.columns),
                          6 if len(names) > 7 else 2)
    return figure
