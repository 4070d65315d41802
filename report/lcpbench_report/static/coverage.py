"""What became of all problems: verified, falsely called solved, below the tier, failed, excluded."""

from matplotlib.patches import Patch

from .. import choice
from ..inputs import Inputs
from ..formats import power
from . import canvas

_COLUMNS = {"verified": "verified", "false success": "false_successes", "below the tier": "below_tier", "failed": "failed",
            "excluded": "excluded"}


def bars(inputs: Inputs):
    """A bar per solver, a panel per tier; false successes as numbers beside the bars; None without problems that
    count."""
    table = inputs.analysis.get("coverage")
    table = None if table is None else choice.counted(table)
    tiers = [] if table is None else [tier for tier in choice.shown_tiers(inputs) if (table["tier"] == tier).any()]
    if not tiers:
        return None
    solvers = [key for key in inputs.keys if key in set(table["solver"])]
    figure, axes = canvas.panels(1, len(tiers), canvas.PAGE, 0.155 * len(solvers) + 0.95, sharey=True)
    for pane, tier in zip(axes[0], tiers):
        mine = table[table["tier"] == tier].set_index("solver").reindex(solvers)
        left = 0.0 * mine["problems"]
        for verdict, column in _COLUMNS.items():
            share = 100 * mine[column] / mine["problems"]
            pane.barh(range(len(solvers)), share, left=left, height=0.72, color=canvas.VERDICTS[verdict], zorder=3)
            left = left + share
        for row, count in enumerate(mine["false_successes"].fillna(0)):
            if count:
                pane.text(101.5, row, f"{count:.0f}", va="center", fontsize=6, color=canvas.VERDICTS["false success"])
        pane.set_xlim(0, 100)
        pane.set_title(f"tier {power(tier)}")
        pane.set_xlabel("problems [%]")
        canvas.name_axis(pane, solvers)
    handles = [Patch(color=canvas.VERDICTS[verdict], label=verdict) for verdict in _COLUMNS]
    handles[1].set_label("false success (and how many)")
    canvas.legend_outside(figure, handles, 5)
    return figure
