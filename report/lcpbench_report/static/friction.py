"""Problems and motions with friction: performance profiles, and what an error of friction does over time."""

from collections.abc import Iterator
from functools import partial

import numpy as np
import pandas as pd

from .. import choice
from ..formats import power
from ..inputs import Inputs
from ..sentences import say
from ..statistics.groups import common, wide
from ..studies import DRIVER
from . import canvas
from .curves import Figure

_LARGEST_RATIO = 1000
_LEAST = 1e-16  # m; less, and nothing at all, stands there
_LEFT = {"creep": "creep so far [m]", "lost_gap": "largest lost gap so far [m]"}
_COLOURS = ("#0072B2", "#CC79A7", "#009E73", "#56B4E9", "#E69F00", "#D55E00", "#661100", "#999933", "#332288", "#777777")


def figures(inputs: Inputs) -> Iterator[Figure]:
    """Those that the inputs have something for."""
    if inputs.friction is not None:
        yield Figure("friction-profiles", "Performance profiles with friction", say("profiles_figure"),
                     partial(profiles, inputs.friction))
    if inputs.friction_motion is not None:
        yield Figure("friction-motion", "What an error of friction does to motion",
                     say("friction_motion_figure", least=_LEAST), partial(motion, inputs.friction_motion))


def profiles(inputs: Inputs):
    """A panel per tier [Dolan, Moré 2002]; problems that every solver had its turn at."""
    solvers = choice.best_own(inputs, 10) + choice.best_peers(inputs, 4)
    tiers = choice.shown_tiers(inputs)
    figure, panes = canvas.panels(len(tiers), canvas.PAGE, 3, sharey=True)
    for pane, tier in zip(panes, tiers):
        cells = common(inputs.cells[(inputs.cells["tier"] == tier) & inputs.cells["solver"].isin(solvers)])
        times = wide(cells, "time_s")
        weights = cells.drop_duplicates("problem").set_index("problem")["weight"].loc[times.index].to_numpy(dtype=float)
        ratios = times.div(times.min(axis=1), axis=0)
        for solver in times.columns:
            known = np.isfinite(times[solver].to_numpy())
            order = np.argsort(ratios[solver].to_numpy()[known])
            share = np.cumsum(weights[known][order]) / weights.sum()
            x = [1, *ratios[solver].to_numpy()[known][order], _LARGEST_RATIO]
            pane.step(x, [0, *share, share[-1] if len(share) else 0], where="post",
                      **canvas.line(inputs.styles[solver]) | {"marker": "none"})
        canvas.log_axis(pane.xaxis, "time / fastest verified")
        pane.set_xlim(0.9, _LARGEST_RATIO)
        pane.set_ylim(-0.01, 1.02)
        pane.set_title(f"tier {power(tier)}, {len(times)} problems")
    panes[0].set_ylabel("share of problems")
    canvas.legend_outside(figure, [canvas.handle(solver, inputs.styles[solver], marker="none") for solver in solvers], 5)
    return figure


def motion(table: pd.DataFrame):
    """A column per scene, a row per measure, a line per driver and tolerance."""
    scenes = list(dict.fromkeys(table["scene"]))
    labels = table[DRIVER] + " at " + table["tolerance"].map(power)
    looks = {label: {"color": _COLOURS[index % len(_COLOURS)], "linestyle": ("-", (0, (4, 1.5)))[index // len(_COLOURS) % 2]}
             for index, label in enumerate(dict.fromkeys(labels))}
    figure, axes = canvas.plt.subplots(len(_LEFT), len(scenes), figsize=(canvas.PAGE, 4.4), squeeze=False, layout="constrained",
                                       sharex="col", sharey=True)
    for line, (column, words) in zip(axes, _LEFT.items()):
        for pane, scene in zip(line, scenes):
            of_scene = table[table["scene"] == scene]
            for label, run in of_scene.groupby(labels, sort=False):
                shown = run[run[column].notna()]
                pane.plot(shown["time"], shown[column].cummax().clip(lower=_LEAST), **looks[label])
            canvas.log_axis(pane.yaxis, words if pane is line[0] else "", decades=6)
            if pane in axes[0]:
                pane.set_title(scene)
            if pane in axes[-1]:
                pane.set_xlabel("time [s]")
    canvas.legend_outside(figure, [canvas.Line2D([], [], label=label, **look) for label, look in looks.items()], 4)
    return figure
