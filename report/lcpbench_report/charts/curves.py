"""Curves that users ask authors of engines for (studies.py), a figure each."""

from collections.abc import Iterable
from dataclasses import replace
from functools import partial

import numpy as np
import pandas as pd

from .. import studies
from ..formats import power
from ..inputs import Inputs
from ..sentences import say
from ..solver_facts import library
from ..style import OWN_COLOURS, PEER_COLOURS, Look, solver_styles
from .chart import Axis, Chart, Figure, Panel, Trace

_LEAST = 1e-17  # smaller residuals are rounding, and stand at the axis' end
_SHALLOWEST = 1e-12  # m; exact impulses may leave nothing
_MOST = 1.0  # of f = 0; larger ones, and none at all, stand there
_RHO = Axis("residual ρ", "residual", ends=(_LEAST / 2, 3 * _MOST))
_TIME = Axis("time of a solve", "seconds")


def figures(inputs: Inputs) -> Iterable[Figure]:
    """Those whose files there are, in order."""
    for name, title, draw in ((studies.MASS_RATIO, "Residual against the ratio of masses, at equal time", mass_ratio),
                              (studies.REGULARIZATION, "The error that a regularization makes, against its speed", regularization),
                              (studies.SWEEPS, "Sequential impulses: residual and penetration against sweeps", sweeps),
                              (studies.PRECISION, "Single against double precision", precision)):
        if (table := inputs.curves.get(name)) is not None:
            rows = dict.fromkeys((table["rows"].min(), table["rows"].max()))
            words = say(f"{name.replace('-', '_')}_figure", table=table, rows=" to ".join(map(str, rows)),
                        scenes=", ".join(table["scene"].unique()))
            yield Figure(f"curve-{name}", title, words, {(): partial(draw, inputs, table)})


def bounded(values) -> np.ndarray:
    """NaN and infinity as 1."""
    return np.clip(np.nan_to_num(np.asarray(values, dtype=float), nan=_MOST, posinf=_MOST), _LEAST, _MOST)


def _styles(inputs: Inputs, table: pd.DataFrame) -> dict[str, Look]:
    """Also of solvers that no campaign of the report has."""
    found = table.drop_duplicates("solver")
    more = [{"key": key, "origin": origin} for key, origin in zip(found["solver"], found["origin"]) if key not in inputs.entries]
    return solver_styles([*inputs.solvers, *more])


def best_of_libraries(table: pd.DataFrame) -> list[str]:
    """The solver of every library with the least sum of logarithms over the curve."""
    score = table.assign(log=np.log10(bounded(table["rho"]))).groupby("solver", sort=False)["log"].mean()
    best: dict[str, str] = {}
    for solver in score.sort_values(kind="stable").index:
        best.setdefault(library({"key": solver, "origin": "peer"}), solver)
    return list(best.values())


# There are more libraries than muted colours.
_MANY = (*PEER_COLOURS, "#DD8800", "#000000", "#777777")
_MARKS = "os^DvPX*"


def mass_ratio(inputs: Inputs, table: pd.DataFrame) -> Chart:
    """Two panels: ours, and the best of every other library."""
    table, styles = table.assign(rho=bounded(table["rho"])), _styles(inputs, table)
    own = list(dict.fromkeys(table[table["origin"] == "own"]["solver"]))
    peers = best_of_libraries(table[table["origin"] != "own"])
    looks = {solver: styles[solver] for solver in own} | {
        solver: Look(_MANY[k % len(_MANY)], _MARKS[k % len(_MARKS)], ("-", (0, (4, 1.5)))[k // len(_MANY) % 2], False)
        for k, solver in enumerate(peers)}
    medians = table.groupby(["solver", "mass_ratio"])["rho"].median()
    traces = {solver: Trace(solver, medians[solver].index, medians[solver], look) for solver, look in looks.items()}
    return Chart([Panel(Axis("ratio of masses"), _RHO, [traces[solver] for solver in solvers], title)
                  for title, solvers in (("ours", own), ("the best of every other library", peers))], 2)


def regularization(inputs: Inputs, table: pd.DataFrame) -> Chart:
    """Residual, and violation, against the time of a solve; every fifth power of ten of the shift is named."""
    styles, panels = _styles(inputs, table), []
    for column, y in (("rho", _RHO), ("violation", Axis("penetrating acceleration left, relative", "residual", ends=_RHO.ends))):
        traces = []
        for solver, mine in table.groupby("solver", sort=False):
            shifts = mine["regularization"].fillna(0)
            points = mine.assign(value=bounded(mine[column])).groupby(shifts)[["value", "seconds"]].median()
            named = [power(shift) if len(points) > 1 and shift and (round(np.log10(shift)) % 5 == 0 or shift in (1e-12, 1e-2)) else ""
                     for shift in points.index]
            look = styles[solver] if len(points) > 1 else replace(styles[solver], dash=None, size=12)
            traces.append(Trace(solver, points["seconds"], points["value"], look, text=named))
        panels.append(Panel(_TIME, y, traces))
    return Chart(panels, 2)


def _colours(table: pd.DataFrame) -> dict[str, str]:
    return dict(zip(dict.fromkeys(table["scene"]), OWN_COLOURS))


def sweeps(inputs: Inputs, table: pd.DataFrame) -> Chart:
    """Median residual, and deepest penetration, of motions; dotted: that of exact impulses."""
    panels, most = [], table["sweeps"].max()
    for column, least, y in (("rho", _LEAST, Axis("residual ρ, median", "residual")),
                             ("penetration", _SHALLOWEST, Axis("deepest penetration [m]", "residual"))):
        traces = []
        for scene, colour in _colours(table).items():
            of_scene = table[table["scene"] == scene].sort_values("sweeps")
            mine, exact = of_scene[of_scene["sweeps"].notna()], of_scene[of_scene["sweeps"].isna()]
            traces.append(Trace(scene, mine["sweeps"], mine[column].clip(lower=least), Look(colour, "o")))
            if column == "penetration" and len(exact):
                traces.append(Trace(scene, [1, most], 2 * [max(float(exact[column].iloc[0]), least)], Look(colour, dash=(0, (1, 1.5)))))
        panels.append(Panel(Axis("sweeps of a step"), y, traces))
    return Chart(panels, 2)


def precision(inputs: Inputs, table: pd.DataFrame) -> Chart:
    """Residual against time, a panel per ratio of masses."""
    colours, panels = _colours(table), []
    for ratio, of_ratio in table.groupby("mass_ratio"):
        traces = [Trace(f"{scene}, {method}, {kind}", mine["seconds"], bounded(mine["rho"]),
                        Look(colours[scene], "s" if method == "tableau" else "o", "-" if kind == "double" else (0, (1, 1.5)),
                             kind == "double"))
                  for (scene, method, kind), mine in of_ratio.groupby(["scene", "method", "precision"])]
        panels.append(Panel(_TIME, _RHO, traces, f"ratio of masses {power(ratio)}"))
    return Chart(panels, len(panels))
