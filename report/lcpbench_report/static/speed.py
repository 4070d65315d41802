"""How fast solvers are: fresh times against the number of rows, performance profiles, exponents.

Of a time's line every point is the median over the problems of a size class by their weights, where what was not verified took
infinitely long (headline_table.py): a line has a gap where a solver fails on half of them. It has a marker where all are
verified, and stands at the geometric mean of the class's rows.
"""

import math

import numpy as np
import pandas as pd

from .. import choice
from ..formats import power
from ..inputs import Inputs
from ..statistics.weighted import weighted_median
from ..style import ORACLE_COLOUR, SolverStyle, solver_styles
from . import canvas

_COLUMNS = 4  # of the small multiples
_FEW = (8, 4)  # own solvers and peers in one small panel
_BAND = 0.62  # height of the band of a solver's families


def by_size(inputs: Inputs):
    """All families together, own solvers on the left, peers on the right, the oracle in both; None without sizes."""
    tier = choice.main_tier(inputs)
    cells = _regular(inputs, tier)
    if cells["size_class"].nunique() < 2:
        return None
    styles = solver_styles(inputs.solvers)
    groups, figure, axes = _own_and_peers(inputs, set(inputs.keys), 3.5)
    for pane, (title, solvers) in zip(axes[0], groups):
        _lines(pane, cells, solvers, styles)
        pane.set_title(title if pane is not axes[0][0] else f"{title} (marker: all problems verified)")
        canvas.size_axis(pane, cells["place"])
        canvas.time_axis(pane, f"median fresh time, tier {power(tier)}" if pane is axes[0][0] else "")
        canvas.legend_below(pane, canvas.handles(solvers, styles, oracle=True), 3)
    return figure


def by_family(inputs: Inputs):
    """A small panel for every family with two sizes or more; None without any."""
    tier = choice.main_tier(inputs)
    cells = _regular(inputs, tier)
    sizes = cells.groupby("family")["size_class"].nunique()
    families = [name for name in choice.families(inputs) if sizes.get(name, 0) > 1]
    if not families:
        return None
    styles = solver_styles(inputs.solvers)
    solvers = choice.best_own(inputs, _FEW[0]) + choice.best_peers(inputs, _FEW[1])
    columns = min(_COLUMNS, len(families))
    rows = math.ceil(len(families) / columns)
    figure, axes = canvas.panels(rows, columns, canvas.PAGE * (0.3 + 0.7 * columns / _COLUMNS), 1.45 * rows + 0.9,
                                 sharex=True, sharey=True)
    for index, pane in enumerate(axes.flat):
        if index >= len(families):
            pane.set_visible(False)
            continue
        _lines(pane, cells[cells["family"] == families[index]], solvers, styles, marks=False)
        pane.set_title(families[index], fontsize=7.5)
        canvas.size_axis(pane, cells["place"])
        canvas.time_axis(pane)
        # The last panel of a column carries the label.
        pane.set_xlabel("rows $n$" if index + columns >= len(families) else "")
        pane.tick_params(labelbottom=index + columns >= len(families))
    figure.supylabel(f"median fresh time, tier {power(tier)}", fontsize=8)
    canvas.legend_outside(figure, canvas.handles(solvers, styles, oracle=True), 5)
    return figure


def _regular(inputs: Inputs, tier: float) -> pd.DataFrame:
    """Without the grids, which vary something else than the size, unless there is nothing else."""
    cells = choice.main_cells(inputs, tier)
    grids = cells["problem"].map(lambda name: bool(inputs.problems[name].get("grid"))).astype(bool)
    cells = cells[~grids] if not grids.all() else cells
    at = np.log(cells.drop_duplicates("problem").set_index("problem")["rows"].astype(float))
    mean = at.groupby(cells.drop_duplicates("problem").set_index("problem")["size_class"]).mean()
    return cells.assign(place=np.exp(cells["size_class"].map(mean)))


def _lines(axes, cells: pd.DataFrame, solvers: list[str], styles: dict[str, SolverStyle], marks: bool = True) -> None:
    known = cells.drop_duplicates("problem").dropna(subset=["oracle_s"])
    oracle = pd.Series({place: weighted_median(own["oracle_s"], own["weight"]) for place, own in known.groupby("place")},
                       dtype=float)
    axes.plot(oracle.index, oracle, color=ORACLE_COLOUR, linestyle=canvas.ORACLE_DASH, linewidth=1.2, zorder=5)
    for solver in solvers:
        by_place = dict(tuple(cells[cells["solver"] == solver].groupby("place")))
        times = pd.Series({place: choice.median_time(mine) for place, mine in by_place.items()}, dtype=float)
        times = times.replace(math.inf, math.nan)
        all_pass = [bool(mine["passes"].all()) for mine in by_place.values()]
        canvas.line(axes, times.index, times, styles[solver], marks=marks,
                    **({"markevery": list(np.flatnonzero(all_pass))} if marks else {}))


def _own_and_peers(inputs: Inputs, among: set[str], height: float):
    """[(title, the best solvers)], figure and axes: own solvers on the left, peers on the right."""
    groups = [("own solvers", choice.best_own(inputs)), ("best of each peer library", choice.best_peers(inputs))]
    groups = [(title, kept) for title, solvers in groups if (kept := [solver for solver in solvers if solver in among])]
    width = canvas.PAGE if len(groups) > 1 else 0.62 * canvas.PAGE
    return groups, *canvas.panels(1, len(groups), width, height, sharey=True)


def profile(inputs: Inputs, tier: float):
    """Own solvers on the left, peers on the right, the others of each in grey; None where nothing was compared."""
    table = choice.table(inputs, "profiles", tier)
    if table["solver"].nunique() < 2:
        return None
    styles = solver_styles(inputs.solvers)
    curves = {solver: mine.sort_values("tau") for solver, mine in table.groupby("solver", sort=False)}
    groups, figure, axes = _own_and_peers(inputs, set(table["solver"]), 3.3)
    for pane, (title, solvers) in zip(axes[0], groups):
        for solver, curve in curves.items():
            if solver not in solvers:
                pane.plot(curve["tau"], curve["share"], color=canvas.CONTEXT, linewidth=0.6, zorder=2)
        for index, solver in enumerate(solvers):
            curve = curves[solver]
            # Markers of different solvers at different places, so that curves on one another can be told apart.
            canvas.line(pane, curve["tau"], curve["share"], styles[solver], clip_on=False,
                        markevery=(0.03 + 0.13 * index / len(solvers), 0.13))
        canvas.log_axis(pane.xaxis, "time over the best of all, $\\tau$", canvas.power_tick)
        pane.set_xlim(1, max(curve["tau"].max() for curve in curves.values()))
        pane.set_ylim(0, 1.01)
        problems = int(table["problems"].iloc[0])
        pane.set_title(title)
        pane.set_ylabel(f"share of {problems} problems, tier {power(tier)}" if pane is axes[0][0] else "")
        canvas.legend_below(pane, canvas.handles(solvers, styles), 3)
    return figure


def exponents(inputs: Inputs):
    """A band per solver, a point per family (in the same order, from above), the median as a bar; None without any."""
    tier = choice.main_tier(inputs)
    table = choice.table(inputs, "scaling", tier)
    solvers = choice.best_of(inputs, table)
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
