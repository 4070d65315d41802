"""Curves that users ask authors of engines for (studies.py), a figure each."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
import pandas as pd

from .. import studies
from ..inputs import Inputs
from ..sentences import say
from ..solver_facts import library
from ..style import OWN_COLOURS, PEER_COLOURS, SolverStyle, solver_styles
from . import canvas

_LEAST = 1e-17  # smaller residuals are rounding, and stand at the axis' end
_SHALLOWEST = 1e-12  # m; exact impulses may leave nothing
_MOST = 1.0  # of f = 0; larger ones, and none at all, stand there


@dataclass(frozen=True)
class Figure:
    name: str  # of the file
    title: str
    words: str
    draw: Callable


_TITLES = {studies.MASS_RATIO: "Residual against the ratio of masses, at equal time",
           studies.REGULARIZATION: "The error that a regularization makes, against its speed",
           studies.SWEEPS: "Sequential impulses: residual and penetration against sweeps",
           studies.PRECISION: "Single against double precision"}


def figures(inputs: Inputs) -> Iterator[Figure]:
    """Those whose files there are, in order."""
    draw = {studies.MASS_RATIO: mass_ratio, studies.REGULARIZATION: regularization, studies.SWEEPS: sweeps,
            studies.PRECISION: precision}
    for name, title in _TITLES.items():
        if (table := inputs.curves.get(name)) is not None:
            rows = dict.fromkeys((table["rows"].min(), table["rows"].max()))
            words = say(f"{name.replace('-', '_')}_figure", table=table, rows=" to ".join(map(str, rows)),
                        scenes=", ".join(table["scene"].unique()))
            yield Figure(f"curve-{name}", title, words, partial(draw[name], inputs))


def _shown(values) -> np.ndarray:
    """NaN and infinity as 1."""
    return np.clip(np.nan_to_num(np.asarray(values, dtype=float), nan=_MOST, posinf=_MOST), _LEAST, _MOST)


def _styles(inputs: Inputs, table: pd.DataFrame) -> dict[str, SolverStyle]:
    """Also of solvers that no campaign of the report has."""
    known = inputs.entries
    found = table.drop_duplicates("solver")
    more = [{"key": key, "origin": origin} for key, origin in zip(found["solver"], found["origin"]) if key not in known]
    return solver_styles([*inputs.solvers, *more])


def _residual_axis(axes, label: str) -> None:
    canvas.log_axis(axes.yaxis, label, lambda y: canvas.power_tick(y) if round(math.log10(y)) % 4 == 0 else "", 20)
    axes.yaxis.set_minor_locator(canvas.NullLocator())
    axes.set_ylim(_LEAST / 2, _MOST * 3)


def best_of_libraries(table: pd.DataFrame) -> list[str]:
    """The solver of every library with the least sum of logarithms over the curve."""
    score = table.assign(log=np.log10(_shown(table["rho"]))).groupby("solver", sort=False)["log"].mean()
    best: dict[str, str] = {}
    for solver in score.sort_values(kind="stable").index:
        best.setdefault(library({"key": solver, "origin": "peer"}), solver)
    return list(best.values())


def mass_ratio(inputs: Inputs):
    """Two panels: ours, and the best of every other library."""
    table = inputs.curves[studies.MASS_RATIO]
    styles = _styles(inputs, table)
    table = table.assign(rho=_shown(table["rho"]))
    own = list(dict.fromkeys(table[table["origin"] == "own"]["solver"]))
    peers = best_of_libraries(table[table["origin"] != "own"])
    figure, panes = canvas.panels(2, canvas.PAGE, 4.6, sharey=True)
    for pane, title, solvers in zip(panes, ("ours", "the best of every other library"), (own, peers)):
        for index, solver in enumerate(solvers):
            median = table[table["solver"] == solver].groupby("mass_ratio")["rho"].median()
            pane.plot(median.index, median, **canvas.line(styles[solver]) | _told_apart(index, styles[solver]))
        canvas.log_axis(pane.xaxis, "ratio of masses", canvas.power_tick)
        pane.set_title(title)
        made = [canvas.handle(solver, styles[solver], **_told_apart(index, styles[solver]))
                for index, solver in enumerate(solvers)]
        canvas.legend_below(pane, made, -0.17, fontsize=6)
    _residual_axis(panes[0], "residual $\\rho$")
    return figure


# There are more libraries than muted colours.
_MANY = (*PEER_COLOURS, "#DD8800", "#000000", "#777777")
_MARKS = "os^DvPX*<>"


def _told_apart(index: int, style: SolverStyle) -> dict:
    if style.own:
        return {}
    colour, mark = _MANY[index % len(_MANY)], _MARKS[index % len(_MARKS)]
    return {"color": colour, "markeredgecolor": colour, "marker": mark,
            "linestyle": ("-", (0, (4, 1.5)))[index // len(_MANY) % 2]}


def regularization(inputs: Inputs):
    """Residual, and violation, against the time of a solve."""
    table = inputs.curves[studies.REGULARIZATION]
    styles = _styles(inputs, table)
    figure, panes = canvas.panels(2, canvas.PAGE, 3.2)
    for pane, column, label in zip(panes, ("rho", "violation"), ("residual $\\rho$", "penetrating acceleration left, relative")):
        for solver in dict.fromkeys(table["solver"]):
            mine = table[table["solver"] == solver].assign(value=lambda rows: _shown(rows[column]))
            points = mine.groupby(mine["regularization"].fillna(0))[["value", "seconds"]].median()
            single = len(points) == 1
            look = canvas.line(styles[solver]) | ({"markersize": 7, "linestyle": "none"} if single else {})
            pane.plot(points["seconds"], points["value"], label=solver, **look)
            for shift, point in points.iterrows():
                if not single and (round(math.log10(shift)) % 5 == 0 or shift in (1e-12, 1e-2)):
                    pane.annotate(canvas.power_tick(shift), (point["seconds"], point["value"]), fontsize=6,
                                  textcoords="offset points", xytext=(4, 3))
        canvas.time_axis(pane.xaxis, "time of a solve", finer=True)
        _residual_axis(pane, label)
    canvas.legend_outside(figure, [canvas.handle(solver, styles[solver]) for solver in dict.fromkeys(table["solver"])], 5)
    return figure


def sweeps(inputs: Inputs):
    """Median residual, and deepest penetration, of motions."""
    table = inputs.curves[studies.SWEEPS]
    scenes = list(dict.fromkeys(table["scene"]))
    colours = dict(zip(scenes, OWN_COLOURS))
    figure, panes = canvas.panels(2, canvas.PAGE, 2.9)
    for pane, (column, least) in zip(panes, {"rho": _LEAST, "penetration": _SHALLOWEST}.items()):
        for scene in scenes:
            of_scene = table[table["scene"] == scene]
            mine = of_scene[of_scene["sweeps"].notna()].sort_values("sweeps")
            values = mine[column].clip(lower=least)
            pane.plot(mine["sweeps"], values, color=colours[scene], marker="o", label=scene)
            exact = of_scene[of_scene["sweeps"].isna()]
            if column == "penetration" and len(exact):
                pane.axhline(max(float(exact[column].iloc[0]), least), color=colours[scene], linestyle=":", linewidth=1)
        canvas.log_axis(pane.xaxis, "sweeps of a step")
        canvas.log_axis(pane.yaxis, "residual $\\rho$, median" if column == "rho" else "deepest penetration [m]")
    canvas.legend_outside(figure, panes[0].get_legend_handles_labels()[0], len(scenes))
    return figure


def precision(inputs: Inputs):
    """Residual against time, a panel per ratio of masses."""
    table = inputs.curves[studies.PRECISION]
    ratios = sorted(set(table["mass_ratio"]))
    scenes = list(dict.fromkeys(table["scene"]))
    colours = dict(zip(scenes, OWN_COLOURS))
    figure, panes = canvas.panels(len(ratios), canvas.PAGE, 3.2, sharey=True)
    for pane, ratio in zip(panes, ratios):
        for (scene, method, kind), mine in table[table["mass_ratio"] == ratio].groupby(["scene", "method", "precision"]):
            pane.plot(mine["seconds"], _shown(mine["rho"]), color=colours[scene], linestyle="-" if kind == "double" else ":",
                      marker="s" if method == "tableau" else "o", markersize=5 if method == "tableau" else 3,
                      markerfacecolor=colours[scene] if kind == "double" else "white")
        canvas.time_axis(pane.xaxis, "time")
        pane.set_title(f"ratio of masses {canvas.power_tick(ratio)}")
    _residual_axis(panes[0], "residual $\\rho$")
    grey = {"color": canvas.FAINT, "markersize": 4}
    made = [canvas.Line2D([], [], label=scene, color=colours[scene]) for scene in scenes]
    made += [canvas.Line2D([], [], label=f"{method}, {kind}", marker=mark, linestyle=dash,
                           markerfacecolor=canvas.FAINT if kind == "double" else "white", **grey)
             for method, mark in (("Gauss–Seidel", "o"), ("tableau", "s")) for kind, dash in (("double", "-"), ("single", ":"))]
    canvas.legend_outside(figure, made, 4)
    return figure
