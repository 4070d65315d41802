"""Figures by size class. Times against rows (the figure of README.md), and share right against time: the Pareto front.

Every time is the median over the problems of a size class by their weights, where what was not verified took infinitely
long (headline_table.py): a line has a gap where a solver fails on half of them. It has a marker where all are verified,
and stands at the geometric mean of the class's rows.

What is left of the front's line and above it would be better than every single peer. All peers with a finite median are
there, in grey; those of the front and ours have their own markers and names.
"""

import math

import numpy as np
import pandas as pd

from .. import choice
from ..formats import power, size_class
from ..headline_table import ClassRow, Headline
from ..inputs import Inputs
from ..statistics.rivals import FASTEST, PORTFOLIO
from ..statistics.weighted import weighted_median
from . import canvas

_COLUMNS = 3
_LEAST = 47  # per cent: the median of who is right on less than half is infinite


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


def front(inputs: Inputs, found: Headline):
    """None where no class has a front."""
    rows = [row for row in found.classes if any(rival.front for rival in row.rivals.values())]
    if not rows:
        return None
    lines = math.ceil(len(rows) / _COLUMNS)
    figure, axes = canvas.plt.subplots(lines, min(_COLUMNS, len(rows)), figsize=(canvas.PAGE, 1.9 * lines), squeeze=False,
                                       layout="constrained", sharey=True)
    for index, pane in enumerate(axes.flat):
        if index >= len(rows):
            pane.remove()
            continue
        _panel(pane, inputs, found, rows[index])
        pane.set_title(f"{size_class(rows[index].size_class)} rows")
    figure.supylabel("share right [%]", fontsize=8, color=canvas.INK)
    figure.supxlabel(f"median fresh time, tier {power(found.tier)}", fontsize=8, color=canvas.INK)
    return figure


def _panel(pane, inputs: Inputs, found: Headline, row: ClassRow) -> None:
    points = {key: (entry.time_s, 100 * entry.share * entry.taken) for key, entry in row.entries.items()
              if math.isfinite(entry.time_s) and (key in inputs.peers or key == found.own)}
    named = [key for key in points if key == found.own or key == PORTFOLIO or (key in row.rivals and row.rivals[key].front)]
    others = [points[key] for key in points if key not in named]
    pane.plot([x for x, _ in others], [y for _, y in others], "o", markersize=2.5, color=canvas.FAINT, alpha=0.35, zorder=2)
    steps = [points[key] for key, rival in row.rivals.items() if rival.front and key != FASTEST]
    pane.step([x for x, _ in steps], [y for _, y in steps], where="post", color=canvas.FAINT, linewidth=0.8, zorder=2)
    for key in named:
        style = inputs.styles[key]
        pane.plot(*points[key], **canvas.line(style) | {"linestyle": "none", "markersize": 5.5})
        pane.annotate(key, points[key], (3, -3), textcoords="offset points", rotation=-35, rotation_mode="anchor", va="top",
                      fontsize=5.5, color=style.colour)
    pane.set_ylim(_LEAST, 103)
    canvas.time_axis(pane.xaxis)
