"""Share right against median time, a panel per size class: the Pareto front of single peers, the portfolio, and ours.

What is left of the front's line and above it would be better than every single peer. All peers with a finite median are
there, in grey; those of the front and ours have their own markers and names.
"""

import math

from ..headline_table import ClassRow, Headline
from ..formats import power, size_class
from ..inputs import Inputs
from ..statistics.rivals import FASTEST, PORTFOLIO
from . import canvas

_COLUMNS = 3
_LEAST = 47  # per cent: the median of who is right on less than half is infinite


def by_class(inputs: Inputs, found: Headline):
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
