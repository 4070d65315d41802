"""Charts of sequences and motions: latency of a step, what a deadline leaves, and what errors do over time."""

from collections.abc import Iterable
from functools import partial

import numpy as np
import pandas as pd

from .. import choice
from ..formats import power
from ..inputs import Inputs
from ..sentences import say
from ..statistics.latency import ALL
from ..studies import DRIVER
from ..style import OWN_COLOURS, Look
from .campaign import NAME_AXIS
from .chart import Axis, Chart, Figure, Panel, Trace

_LEAST = 1e-17  # less, and nothing at all, stands there
_LEAST_SHARE = 1e-5
_MOST_POINTS = 120  # of a curve: more are not seen
_COLOURS = (*OWN_COLOURS, "#661100", "#999933", "#332288", "#777777")
_DASHES = ("-", (0, (4, 1.5)), (0, (1.5, 1.5)), (0, (6, 1.5, 1.2, 1.5)))
_LEVELS = {"p50": ("median", "o"), "p99": ("99 %", "D"), "max": ("largest", "|")}
_OF_MOTION = {"energy_error": "energy error / largest kinetic energy", "penetration": "deepest penetration so far [m]"}
_OF_FRICTION = {"creep": "creep so far [m]", "lost_gap": "largest lost gap so far [m]"}


def figures(inputs: Inputs) -> Iterable[Figure]:
    """Those that the inputs have something for, in the page's order."""
    if "latency_by_solver" in inputs.analysis:
        sizes = sorted(set(inputs.analysis["latency_by_solver"]["size"].astype(str)),
                       key=lambda size: 0 if size == ALL else int(size))
        for name, title, make in (("latency", "Latency of a step, cold and warm", latency),
                                  ("deadline", "What a deadline leaves", deadline)):
            yield Figure(name, title, say(f"{name}_figure"), {(size,): partial(make, inputs, size) for size in sizes}, ("rows",))
    for name, title, table, measures in (("motion", "Errors over time", inputs.motion, _OF_MOTION),
                                         ("friction-motion", "What an error of friction does to motion",
                                          inputs.friction_motion, _OF_FRICTION)):
        if table is not None:
            yield Figure(name, title, say(f"{name.replace('-', '_')}_figure", least=_LEAST),
                         {(f"{scene}, {level} level",): partial(over_time, table, run, measures)
                          for (scene, level), run in table.groupby(["scene", "level"], sort=False)}, ("scene",))


def latency(inputs: Inputs, size: str) -> Chart | None:
    traces = []
    for mode, colour in (("warm", OWN_COLOURS[0]), ("cold", OWN_COLOURS[1])):
        table = choice.passes(inputs, choice.main_tier(inputs), mode, size)
        table = table.set_index("solver").loc[inputs.in_order(table["solver"])]
        traces += [Trace(f"{words}, {mode}", found, found.index, Look(colour, marker, None, mode == "warm"))
                   for level, (words, marker) in _LEVELS.items() if len(found := table[level][np.isfinite(table[level].astype(float))])]
    return Chart([Panel(Axis("latency of a step", "seconds"), NAME_AXIS, traces)]) if traces else None


def deadline(inputs: Inputs, size: str) -> Chart | None:
    table = inputs.analysis["deadline"]
    table = table[table["size"].astype(str) == size]
    if table.empty:
        return None
    missed = table[table["tier"] == choice.nearest(table["tier"])].sort_values("deadline_s").assign(
        missed=lambda rows: (1 - rows["verified_share"]).clip(lower=_LEAST_SHARE))
    traces = [Trace(solver, own["deadline_s"], own["missed"], inputs.styles[solver])
              for solver in inputs.in_order(missed["solver"]) if len(own := missed[missed["solver"] == solver])]
    return Chart([Panel(Axis("deadline of a step", "seconds"), Axis("share of steps missed: late, or not verified", "share"), traces)])


def over_time(table: pd.DataFrame, chosen: pd.DataFrame, measures: dict[str, str]) -> Chart:
    """A panel per measure, a line per driver and tolerance of the whole table, whose looks are those of all scenes."""
    drivers, tolerances = ([*dict.fromkeys(table[DRIVER])], sorted(set(table["tolerance"]), reverse=True))
    panels = []
    for column, words in measures.items():
        traces = []
        for (driver, tolerance), run in chosen[chosen[column].notna()].groupby([DRIVER, "tolerance"], sort=False):
            run = run.assign(shown=(run[column].cummax() if "so far" in words else run[column]).clip(lower=_LEAST))
            run = run.iloc[np.unique(np.linspace(0, len(run) - 1, min(len(run), _MOST_POINTS)).astype(int))]
            look = Look(_COLOURS[drivers.index(driver) % len(_COLOURS)], dash=_DASHES[tolerances.index(tolerance) % len(_DASHES)])
            traces.append(Trace(f"{driver} at {power(tolerance)}", run["time"], run["shown"], look))
        panels.append(Panel(Axis("time [s]", log=False), Axis(words, "residual"), traces))
    return Chart(panels, len(panels))
