"""Charts of problems: times by size, the front of peers, profiles, exactness and what becomes of every problem.

A time of a size class is the median over its problems by their weights, where what was not verified took infinitely long
(headline_table.py): a line has a gap where a solver fails on half of them. It has a marker where all are verified, and
stands at the geometric mean of the class's rows.
"""

import math
from collections.abc import Iterable
from dataclasses import replace
from functools import partial

import numpy as np
import pandas as pd

from .. import choice
from ..formats import power, size_class
from ..headline_table import ClassRow, headline
from ..inputs import PATHOLOGICAL, Inputs
from ..sentences import say
from ..statistics.cells import BELOW_TIER, EXCLUDED, FALSE_SUCCESS, NOT_ASKED, OUT_OF_TIME, VERIFIED, within_rounding
from ..statistics.groups import common, wide
from ..statistics.model import ORIGINS
from ..statistics.rivals import FASTEST
from ..statistics.weighted import weighted_median
from ..style import ORACLE_COLOUR, Look
from .chart import NAMES, Axis, Chart, Figure, Panel, Trace

_LEAST = 1e-18  # smaller residuals stand there
_GREY = Look("#5c6672", "o", None, size=4, opacity=0.35)
_STEPS = Look("#5c6672", strong=False)
_ORACLE = Look(ORACLE_COLOUR, dash=(0, (6, 2)))
_MEDIAN, _TAIL = Look("#0072B2", "o", None), Look("#D55E00", "D", None, False, 6)
NAME_AXIS = Axis(kind=NAMES)
_LARGEST_RATIO = 1000
_METRICS = {"time_s": Axis("fresh time", "seconds"), "again_s": Axis("time of the same matrix with another b", "seconds"),
            "problem_s": Axis("part: checks, forms of A", "seconds"), "prepare_s": Axis("part: preparation", "seconds"),
            "convert_s": Axis("part: conversion for a library", "seconds"), "solve_s": Axis("part: solve", "seconds"),
            "iterations": Axis("iterations (each solver's own)"), "rho": Axis("residual ρ", "residual"),
            "backward_error": Axis("largest backward error", "residual"), "w_error": Axis("error of w", "residual")}
# What becomes of a problem -> colour, safe for colour blindness: blue is good, red is a lie, pale ones are honest failures.
_OUTCOMES = {VERIFIED: "#2b7bba", "proved infeasible": "#56a3a6", "infeasible within rounding": "#9cc9cb",
             FALSE_SUCCESS: "#b3261e", "false claim of infeasibility": "#d8604f", BELOW_TIER: "#dd9a84",
             "changed": "#cdb04b", "solved its own model": "#e8a33d", "iteration limit": "#f2cf66", OUT_OF_TIME: "#e3b7a0",
             "numerical failure": "#c9a0c9", "infeasible": "#f0dca0", "crashed": "#6b4c9a",
             "out of memory": "#a58fc9", "other failure": "#c8b8a8", NOT_ASKED: "#cfe0dc", EXCLUDED: "#e4e8ec"}


def figures(inputs: Inputs) -> Iterable[Figure]:
    """Those that the inputs have something for, in the page's order."""
    if not len(inputs.cells):
        return
    tiers = {power(tier): tier for tier in sorted(inputs.tiers, key=lambda tier: tier != choice.main_tier(inputs))}
    parts = _parts(inputs)
    yield Figure("time-by-size", "Fresh time by size", say("times_figure"),
                 {(words, name): partial(by_size, inputs, tier, cells=cells) for name, cells in parts.items()
                  for words, tier in tiers.items()}, ("tier", "problems"))
    yield Figure("metrics", "Parts of a time, iterations, errors", say("metrics_figure"),
                 {(words, _METRICS[column].title): partial(by_size, inputs, tier, column) for column in [*_METRICS][1:]
                  for words, tier in tiers.items()}, ("tier", "metric"))
    yield Figure("front", "Time and share right, by size", say("front_figure"), {(): partial(front, inputs)})
    yield Figure("profiles", "Performance profiles", say("profiles_figure"),
                 {(name,): partial(profiles, inputs, cells) for name, cells in parts.items()}, ("problems",))
    if inputs.friction is not None:
        yield Figure("friction-profiles", "Performance profiles with friction", say("profiles_figure"),
                     {(): partial(profiles, inputs.friction, inputs.friction.cells)})
    yield Figure("accuracy", "Errors of verified answers", say("accuracy_figure"),
                 {(words,): partial(accuracy, inputs, tier) for words, tier in tiers.items()}, ("tier",))
    for name, title, cells in (("coverage", "What becomes of problems", inputs.counted),
                               ("pathological", "Problems that are meant to break something",
                                inputs.cells[inputs.cells["set"] == PATHOLOGICAL])):
        yield Figure(name, title, say(f"{name}_figure"),
                     {(words,): partial(coverage, inputs, cells[cells["tier"] == tier]) for words, tier in tiers.items()}, ("tier",))
    if len(table := inputs.analysis["scaling"]):
        families = {"all": table, **dict(tuple(table.groupby("family", sort=False)))}
        yield Figure("scaling", "Growth exponents", say("scaling_figure"),
                     {(words, name): partial(scaling, inputs, of[of["tier"] == tier]) for name, of in families.items()
                      for words, tier in tiers.items()}, ("tier", "family"))


def _parts(inputs: Inputs) -> dict[str, pd.DataFrame]:
    """Problems that count, those of an origin, and of a family, which is shown whole."""
    cells = inputs.cells[inputs.cells["set"] != PATHOLOGICAL]
    counted = cells[cells["counts"].astype(bool)]
    found = {"all": counted} if len(counted) else {}
    for column, of, names in (("origin", counted, ORIGINS), ("family", cells[~cells["fill"].astype(bool)], {})):
        found |= {names.get(key, key): part for key, part in of.groupby(column, sort=False)} if of[column].nunique() > 1 else {}
    return found


def _compared(inputs: Inputs) -> dict[str, list[str]]:
    found = {"own solvers": choice.best_own(inputs), "best of each peer library": choice.best_peers(inputs)}
    return {title: solvers for title, solvers in found.items() if solvers}


def by_size(inputs: Inputs, tier: float, column: str = "time_s", cells: pd.DataFrame | None = None) -> Chart | None:
    """Own solvers on the left, peers on the right, the oracle in both; None without sizes. Other columns than the time
    are of verified answers."""
    cells = inputs.counted if cells is None else cells
    cells = _placed(inputs, cells[cells["tier"] == tier])
    if cells["size_class"].nunique() < 2:
        return None
    title = _METRICS[column].title
    y = Axis(f"median {title}, tier {power(tier)}", _METRICS[column].kind)
    known = cells if column == "time_s" else cells[cells["passes"].astype(bool) & cells[column].notna()]
    if known.empty:
        return None
    medians, all_pass = _medians(known, ["solver", "place"], column), cells.groupby(["solver", "place"])["passes"].all()
    solved = cells.drop_duplicates("problem").dropna(subset=["oracle_s"])
    oracle = _medians(solved, ["place"], "oracle_s") if len(solved) and column == "time_s" else None
    panels = []
    for title, solvers in _compared(inputs).items():
        traces = [] if oracle is None else [Trace("oracle", oracle.index, oracle, _ORACLE)]
        traces += [Trace(solver, medians[solver].index, medians[solver], inputs.styles[solver],
                         marks=all_pass[solver][medians[solver].index])
                   for solver in solvers if solver in medians.index.levels[0]]
        panels.append(Panel(Axis("rows n"), y, traces, title))
    return Chart(panels, len(panels))


def _placed(inputs: Inputs, cells: pd.DataFrame) -> pd.DataFrame:
    """Without the grids, which vary something else than the size, unless there is nothing else."""
    grids = cells["problem"].map(lambda name: bool(inputs.problems[name].get("grid"))).astype(bool)
    cells = cells[~grids] if not grids.all() else cells
    problems = cells.drop_duplicates("problem")
    mean = np.log(problems["rows"].clip(lower=1).astype(float)).groupby(problems["size_class"]).mean()
    return cells.assign(place=np.exp(cells["size_class"].map(mean)))


def _medians(cells: pd.DataFrame, keys: list[str], column: str) -> pd.Series:
    """@param cells  at least one"""
    found = cells.groupby(keys)[[column, "weight"]].apply(lambda own: weighted_median(own[column], own["weight"]))
    return found.replace(math.inf, math.nan)


def front(inputs: Inputs) -> Chart | None:
    """A panel per size class: the share right against the time; None where no class has a front. What is left of the
    line and above it would be better than every single peer. All peers with a finite median are there, in grey; those
    of the front and ours have their own markers and names."""
    found = headline(inputs)
    rows = [row for row in found.classes if any(rival.front for rival in row.rivals.values())]
    x, y = Axis(f"median fresh time, tier {power(found.tier)}", "seconds"), Axis("share right", "share", False, (0.47, 1.03))
    panels = [Panel(x, y, _front_of(inputs, found.own, row), f"{size_class(row.size_class)} rows") for row in rows]
    return Chart(panels, min(3, len(rows))) if rows else None


def _front_of(inputs: Inputs, ours: str, row: ClassRow) -> list[Trace]:
    points = {key: (entry.time_s, entry.share * entry.taken) for key, entry in row.entries.items()
              if math.isfinite(entry.time_s) and (key in inputs.peers or key == ours)}
    named = [key for key in points if key == ours or (key in row.rivals and row.rivals[key].front)]
    steps = [points[key] for key, rival in row.rivals.items() if rival.front and key != FASTEST]
    others = [points[key] for key in points if key not in named]
    return [Trace("other peers", [x for x, _ in others], [y for _, y in others], _GREY),
            Trace("front", [x for x, _ in steps], [y for _, y in steps], _STEPS, steps=True),
            *(Trace(key, [points[key][0]], [points[key][1]], replace(inputs.styles[key], dash=None, size=9), text=[key])
              for key in named)]


def profiles(inputs: Inputs, cells: pd.DataFrame) -> Chart | None:
    """A panel per tier [Dolan, Moré 2002]; problems that every solver had its turn at."""
    solvers = choice.best_own(inputs, 10) + choice.best_peers(inputs, 4)
    panels = []
    for tier in inputs.tiers:
        chosen = common(cells[(cells["tier"] == tier) & cells["solver"].isin(solvers)])
        if chosen.empty:
            continue
        times = wide(chosen, "time_s")
        weights = chosen.drop_duplicates("problem").set_index("problem")["weight"].loc[times.index].to_numpy(dtype=float)
        ratios = times.div(times.min(axis=1), axis=0).to_numpy()
        known = np.isfinite(times.to_numpy())
        traces = []
        for solver in inputs.in_order(times.columns):
            k = times.columns.get_loc(solver)
            order = np.argsort(ratios[known[:, k], k])
            share = np.cumsum(weights[known[:, k]][order]) / weights.sum()
            reached = [0, *share, share[-1] if len(share) else 0]
            traces.append(Trace(solver, [1, *ratios[known[:, k], k][order], _LARGEST_RATIO], reached,
                                replace(inputs.styles[solver], marker=""), steps=True))
        panels.append(Panel(Axis("time / fastest verified", "ratio", ends=(0.9, _LARGEST_RATIO)),
                            Axis("share of problems", "share", False, (-0.01, 1.02)), traces, f"tier {power(tier)}, {len(times)} problems"))
    return Chart(panels, len(panels)) if panels else None


def accuracy(inputs: Inputs, tier: float) -> Chart | None:
    cells = inputs.counted[(inputs.counted["tier"] == tier) & (inputs.counted["verdict"] == VERIFIED)]
    panels = []
    for column, title in (("rho", "residual ρ"), ("w_error", "error of w against proved answers")):
        found = cells.dropna(subset=[column]).groupby("solver")[column].quantile([0, 0.5, 0.99, 1]).unstack().clip(lower=_LEAST)
        found = found.loc[inputs.in_order(found.index)]
        traces = [Trace("median, least and largest", found[0.5], found.index, _MEDIAN, found[0], found[1]),
                  Trace("99 %", found[0.99], found.index, _TAIL)] if len(found) else []
        panels += [Panel(Axis(title, "residual"), NAME_AXIS, traces)] if traces else []
    return Chart(panels, len(panels)) if panels else None


def coverage(inputs: Inputs, cells: pd.DataFrame) -> Chart | None:
    """@param cells  of one tier"""
    if cells.empty:
        return None
    found = pd.crosstab(cells["solver"], outcomes(cells)).reindex(columns=_OUTCOMES, fill_value=0)
    found = found.loc[inputs.in_order(found.index), found.any()]
    return Chart([Panel(Axis("problems", log=False, ends=(0, float(found.sum(axis=1).max()))), NAME_AXIS,
                        [Trace(words, counts, found.index, Look(_OUTCOMES[words]), bar=True) for words, counts in found.items()])])


def outcomes(cells: pd.DataFrame) -> pd.Series:
    """Of _OUTCOMES: what a proof says counts more than what is claimed."""
    found = cells["verdict"].str.removeprefix("failed:").str.replace("_", " ").replace("solved", "solved its own model")
    for words, holds in (("infeasible within rounding", within_rounding(cells)),
                         ("false claim of infeasibility", cells["false_infeasible"]),
                         ("proved infeasible", cells["proved_infeasible"])):
        found = found.mask(holds.astype(bool), words)
    return found.where(found.isin(_OUTCOMES), "other failure")


def scaling(inputs: Inputs, table: pd.DataFrame) -> Chart | None:
    """Of one family with its interval; of several their median, and the least and largest."""
    if table.empty:
        return None
    alone = table["family"].nunique() == 1
    found = table.groupby("solver").agg(exponent=("exponent", "median"), low=("exponent_low" if alone else "exponent", "min"),
                                        high=("exponent_high" if alone else "exponent", "max"))
    found = found.loc[inputs.in_order(found.index)]
    return Chart([Panel(Axis("exponent p of time ~ n^p", log=False), NAME_AXIS,
                        [Trace("exponent", found["exponent"], found.index, _MEDIAN, found["low"], found["high"])])])
