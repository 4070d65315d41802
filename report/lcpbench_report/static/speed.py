"""How fast solvers are: fresh times against the number of rows, performance profiles, exponents.

Of a time's line every point is the median over the problems of a size class by their weights, where what was not
verified took infinitely long (headline_table.py): a line has a gap where a solver fails on half of them. It has a marker
where all are verified, and stands at the geometric mean of the class's rows.
"""

import math

import numpy as np
import pandas as pd

from .. import choice
from ..formats import power
from ..inputs import Inputs
from ..statistics.distributions import profile_table
from ..statistics.load import ORIGINS, TASK_BUDGET
from ..statistics.weighted import weighted_median
from . import canvas

_COLUMNS = 4  # of the small multiples
_FEW = (8, 4)  # own solvers and peers in one small panel
_BAND = 0.62  # height of the band of a solver's families


def by_size(inputs: Inputs):
    """All families together, own solvers on the left, peers on the right, the oracle in both; None without sizes."""
    cells = _regular(inputs)
    if cells["size_class"].nunique() < 2:
        return None
    groups, figure, panes = _own_and_peers(inputs, inputs.keys, 3.5)
    for pane, (title, solvers) in zip(panes, groups):
        first = pane is panes[0]
        _lines(pane, inputs, cells, solvers)
        pane.set_title(f"{title} (marker: all problems verified)" if first else title)
        canvas.size_axis(pane, cells["place"])
        canvas.time_axis(pane, _time_label(inputs) if first else "")
        canvas.legend_below(pane, canvas.handles(solvers, inputs.styles, oracle=True))
    return figure


def by_family(inputs: Inputs):
    """A small panel for every family with two sizes or more; None without any."""
    cells = _regular(inputs)
    sizes = cells.groupby("family")["size_class"].nunique()
    families = [name for name in choice.families(inputs) if sizes.get(name, 0) > 1]
    if not families:
        return None
    solvers = choice.best_own(inputs, _FEW[0]) + choice.best_peers(inputs, _FEW[1])
    columns = min(_COLUMNS, len(families))
    rows = math.ceil(len(families) / columns)
    figure, panes = canvas.panels(columns, canvas.PAGE * (0.3 + 0.7 * columns / _COLUMNS), 1.45 * rows + 0.9, rows,
                                  sharex=True, sharey=True)
    for pane in panes[len(families):]:
        pane.set_visible(False)
    for index, (pane, family) in enumerate(zip(panes, families)):
        _lines(pane, inputs, cells[cells["family"] == family], solvers, marks=False)
        pane.set_title(family, fontsize=7.5)
        canvas.size_axis(pane, cells["place"])
        canvas.time_axis(pane)
        # The last panel of a column carries the label.
        pane.set_xlabel("rows $n$" if index + columns >= len(families) else "")
        pane.tick_params(labelbottom=index + columns >= len(families))
    figure.supylabel(_time_label(inputs), fontsize=8)
    canvas.legend_outside(figure, canvas.handles(solvers, inputs.styles, oracle=True), 5)
    return figure


def _time_label(inputs: Inputs) -> str:
    return f"median fresh time, tier {power(choice.main_tier(inputs))}"


def _regular(inputs: Inputs) -> pd.DataFrame:
    """Without the grids, which vary something else than the size, unless there is nothing else."""
    cells = choice.main_cells(inputs)
    grids = cells["problem"].map(lambda name: bool(inputs.problems[name].get("grid"))).astype(bool)
    cells = cells[~grids] if not grids.all() else cells
    problems = cells.drop_duplicates("problem")
    mean = np.log(problems["rows"].clip(lower=1).astype(float)).groupby(problems["size_class"]).mean()
    return cells.assign(place=np.exp(cells["size_class"].map(mean)))


def _lines(axes, inputs: Inputs, cells: pd.DataFrame, solvers: list[str], marks: bool = True) -> None:
    def medians(chosen: pd.DataFrame, times: str) -> pd.Series:
        return pd.Series({place: weighted_median(own[times], own["weight"]) for place, own in chosen.groupby("place")},
                         dtype=float).replace(math.inf, math.nan)

    oracle = medians(cells.drop_duplicates("problem").dropna(subset=["oracle_s"]), "oracle_s")
    axes.plot(oracle.index, oracle, **canvas.ORACLE)
    for solver in solvers:
        mine = cells[cells["solver"] == solver]
        times, all_pass = medians(mine, "time_s"), mine.groupby("place")["passes"].all()
        axes.plot(times.index, times, **canvas.line(inputs.styles[solver], marks),
                  **({"markevery": list(np.flatnonzero(all_pass))} if marks else {}))


def _own_and_peers(inputs: Inputs, among: list[str], height: float):
    """[(title, the best solvers)], figure and panels: own solvers on the left, peers on the right."""
    groups = [("own solvers", choice.best_own(inputs)), ("best of each peer library", choice.best_peers(inputs))]
    groups = [(title, kept) for title, solvers in groups if (kept := [solver for solver in solvers if solver in among])]
    width = canvas.PAGE if len(groups) > 1 else 0.62 * canvas.PAGE
    return groups, *canvas.panels(len(groups), width, height, sharey=True)


def profile(inputs: Inputs, tier: float):
    """Own solvers on the left, peers on the right, the others of each in grey; None where nothing was compared."""
    table = choice.table(inputs, "profiles", tier)
    curves = {solver: mine.sort_values("tau") for solver, mine in table.groupby("solver", sort=False)}
    if len(curves) < 2:
        return None
    groups, figure, panes = _own_and_peers(inputs, list(curves), 3.3)
    for pane, (title, solvers) in zip(panes, groups):
        for solver, curve in curves.items():
            if solver not in solvers:
                pane.plot(curve["tau"], curve["share"], color=canvas.CONTEXT, linewidth=0.6, zorder=2)
        for index, solver in enumerate(solvers):
            # Markers of different solvers at different places, so that curves on one another can be told apart.
            pane.plot(curves[solver]["tau"], curves[solver]["share"], **canvas.line(inputs.styles[solver]), clip_on=False,
                      markevery=(0.03 + 0.13 * index / len(solvers), 0.13))
        canvas.log_axis(pane.xaxis, "time over the best of all, $\\tau$", canvas.power_tick)
        pane.set_xlim(1, table["tau"].max())
        pane.set_ylim(0, 1.01)
        pane.set_title(title)
        pane.set_ylabel(f"share of {table['problems'].iloc[0]} problems, tier {power(tier)}" if pane is panes[0] else "")
        canvas.legend_below(pane, canvas.handles(solvers, inputs.styles))
    return figure


def profile_by_origin(inputs: Inputs):
    """A panel for every origin at the main tier, with the best of ours and of the peers; None with one origin."""
    cells = choice.main_cells(inputs)
    there = [origin for origin in ORIGINS if (cells["origin"] == origin).any()]
    if len(there) < 2:
        return None
    solvers = choice.best_own(inputs, _FEW[0]) + choice.best_peers(inputs, _FEW[1])
    figure, panes = canvas.panels(len(there), canvas.PAGE, 2.6, sharey=True)
    for pane, origin in zip(panes, there):
        table = profile_table(cells[(cells["origin"] == origin) & (cells["excluded"] != TASK_BUDGET)])
        for solver in solvers:
            curve = table[table["solver"] == solver]
            pane.plot(curve["tau"], curve["share"], **canvas.line(inputs.styles[solver], False), clip_on=False)
        canvas.log_axis(pane.xaxis, "$\\tau$", canvas.power_tick)
        pane.set_xlim(1, 1000)
        pane.set_ylim(0, 1.01)
        problems = table["problems"].iloc[0] if len(table) else 0
        pane.set_title(f"{ORIGINS[origin]}, {problems} problems", fontsize=7.5)
    panes[0].set_ylabel(f"share solved within $\\tau$ times the best, tier {power(choice.main_tier(inputs))}", fontsize=7)
    canvas.legend_outside(figure, canvas.handles(solvers, inputs.styles), 5)
    return figure


def exponents(inputs: Inputs):
    """A band per solver, a point per family (in the same order, from above), the median as a bar; None without any."""
    tier = choice.main_tier(inputs)
    table = choice.table(inputs, "scaling", tier)
    solvers = choice.best_of(inputs, table)
    if not solvers:
        return None
    figure, (pane,) = canvas.panels(1, 0.62 * canvas.PAGE, 0.3 * len(solvers) + 0.6)
    families = choice.families(inputs)
    heights = dict(zip(families, np.linspace(-_BAND / 2, _BAND / 2, len(families))))
    for row, solver in enumerate(solvers):
        mine, style = table[table["solver"] == solver], inputs.styles[solver]
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
