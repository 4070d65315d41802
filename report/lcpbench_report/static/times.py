"""Fresh time against the number of rows.

Every point is the median over the problems of a size class by their weights, where what was not verified took
infinitely long (headline_table.py): a line has a gap where a solver fails on half of them. It has a marker where all are
verified, and stands at the geometric mean of the class's rows.
"""

import math

import numpy as np
import pandas as pd

from .. import choice
from ..inputs import Inputs
from ..statistics.weighted import weighted_median
from ..style import ORACLE_COLOUR, SolverStyle, solver_styles
from ..formats import power
from . import canvas

_COLUMNS = 4  # of the small multiples
_FEW = (8, 4)  # own solvers and peers in one small panel


def by_size(inputs: Inputs):
    """All families together, own solvers on the left, peers on the right, the oracle in both; None without sizes."""
    tier = choice.main_tier(inputs)
    cells = _regular(inputs, tier)
    if cells["size_class"].nunique() < 2:
        return None
    styles = solver_styles(inputs.solvers)
    groups = [("own solvers", choice.best_own(inputs)), ("best of each peer library", choice.best_peers(inputs))]
    groups = [group for group in groups if group[1]]
    width = canvas.PAGE if len(groups) > 1 else 0.62 * canvas.PAGE
    figure, axes = canvas.panels(1, len(groups), width, 3.5, sharey=True)
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
