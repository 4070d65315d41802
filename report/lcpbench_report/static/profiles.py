"""Performance profiles: the share of problems solved within a factor of the best time (Dolan and Moré 2002)."""

from .. import choice
from ..inputs import Inputs
from ..style import solver_styles
from ..formats import power
from . import canvas


def profile(inputs: Inputs, tier: float):
    """Own solvers on the left, peers on the right, the others of each in grey; None where nothing was compared."""
    table = inputs.analysis.get("profiles")
    table = None if table is None else choice.counted(table, tier)
    if table is None or table["solver"].nunique() < 2:
        return None
    styles = solver_styles(inputs.solvers)
    groups = [("own solvers", choice.best_own(inputs)), ("best of each peer library", choice.best_peers(inputs))]
    groups = [(title, [s for s in solvers if s in set(table["solver"])]) for title, solvers in groups]
    groups = [group for group in groups if group[1]]
    curves = {solver: mine.sort_values("tau") for solver, mine in table.groupby("solver", sort=False)}
    width = canvas.PAGE if len(groups) > 1 else 0.62 * canvas.PAGE
    figure, axes = canvas.panels(1, len(groups), width, 3.3, sharey=True)
    for pane, (title, solvers) in zip(axes[0], groups):
        for solver, curve in curves.items():
            if solver not in solvers:
                pane.plot(curve["tau"], curve["share"], color=canvas.CONTEXT, linewidth=0.6, zorder=2)
        for index, solver in enumerate(solvers):
            curve = curves[solver]
            # Markers of different solvers at different places, so that curves on one another can be told apart.
            canvas.line(pane, curve["tau"], curve["share"], styles[solver], clip_on=False,
                        markevery=(0.03 + 0.13 * index / len(solvers), 0.13))
        canvas.log_axis(pane.xaxis, "time over the best of all, $\\tau$", canvas.power_tick)
        pane.set_xlim(1, max(curve["tau"].max() for curve in curves.values()))
        pane.set_ylim(0, 1.01)
        problems = int(table["problems"].iloc[0])
        pane.set_title(title)
        pane.set_ylabel(f"share of {problems} problems, tier {power(tier)}" if pane is axes[0][0] else "")
        canvas.legend_below(pane, canvas.handles(solvers, styles), 3)
    return figure
