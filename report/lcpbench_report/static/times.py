"""Fresh times against the number of rows: the figure of README.md.

Every point is the median over the problems of a size class by their weights, where what was not verified took infinitely
long (headline_table.py): a line has a gap where a solver fails on half of them. It has a marker where all are verified,
and stands at the geometric mean of the class's rows.
"""

import math

import numpy as np
import pandas as pd

from .. import choice
from ..formats import power
from ..inputs import Inputs
from ..statistics.weighted import weighted_median
from . import canvas


def by_size(inputs: Inputs):
    """All families together, own solvers on the left, peers on the right, the oracle in both; None without sizes."""
    cells = _regular(inputs)
    if cells["size_class"].nunique() < 2:
        return None
    groups = {"own solvers": choice.best_own(inputs), "best of each peer library": choice.best_peers(inputs)}
    groups = {title: solvers for title, solvers in groups.items() if solvers}
    width = canvas.PAGE if len(groups) > 1 else 0.62 * canvas.PAGE
    figure, panes = canvas.panels(len(groups), width, 3.5, sharey=True)
    for pane, (title, solvers) in zip(panes, groups.items()):
        first = pane is panes[0]
        _lines(pane, inputs, cells, solvers)
        pane.set_title(f"{title} (marker: all problems verified)" if first else title)
        canvas.size_axis(pane, cells["place"])
        canvas.time_axis(pane.yaxis, f"median fresh time, tier {power(choice.main_tier(inputs))}" if first else "")
        canvas.legend_below(pane, [canvas.handle(solver, inputs.styles[solver]) for solver in solvers]
                            + [canvas.Line2D([], [], label="oracle", **canvas.ORACLE)], -0.2)
    return figure


def _regular(inputs: Inputs) -> pd.DataFrame:
    """Without the grids, which vary something else than the size, unless there is nothing else."""
    cells = choice.main_cells(inputs)
    grids = cells["problem"].map(lambda name: bool(inputs.problems[name].get("grid"))).astype(bool)
    cells = cells[~grids] if not grids.all() else cells
    problems = cells.drop_duplicates("problem")
    mean = np.log(problems["rows"].clip(lower=1).astype(float)).groupby(problems["size_class"]).mean()
    return cells.assign(place=np.exp(cells["size_class"].map(mean)))


def _lines(axes, inputs: Inputs, cells: pd.DataFrame, solvers: list[str]) -> None:
    def medians(chosen: pd.DataFrame, times: str) -> pd.Series:
        return pd.Series({place: weighted_median(own[times], own["weight"]) for place, own in chosen.groupby("place")},
                         dtype=float).replace(math.inf, math.nan)

    oracle = medians(cells.drop_duplicates("problem").dropna(subset=["oracle_s"]), "oracle_s")
    axes.plot(oracle.index, oracle, **canvas.ORACLE)
    for solver in solvers:
        mine = cells[cells["solver"] == solver]
        times, all_pass = medians(mine, "time_s"), mine.groupby("place")["passes"].all()
        axes.plot(times.index, times, markevery=list(np.flatnonzero(all_pass)), **canvas.line(inputs.styles[solver]))
