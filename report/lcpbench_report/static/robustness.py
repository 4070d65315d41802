"""Where solvers break: every field is a bar of what became of the problems of one kind."""

import re

import pandas as pd
from matplotlib.patches import Patch

from .. import choice
from ..inputs import Inputs
from ..statistics.cells import BELOW_TIER, EXCLUDED, FALSE_SUCCESS, VERIFIED
from ..formats import power
from . import canvas

# family-n40-s1-mass-ratio-1e+08: the change of a problem is what it is meant to break.
_CHANGE = re.compile(r"-n\d+-s\d+-(?P<change>[a-z-]+?)-[-+.\de]+$")


_WORDS = {VERIFIED: "verified", FALSE_SUCCESS: "false success", BELOW_TIER: "below the tier", EXCLUDED: "excluded"}


def kind_of(problem: str, family: str) -> str:
    """The change that a problem has, else its family."""
    found = _CHANGE.search(problem)
    return found["change"] if found else family


def pathological(inputs: Inputs):
    """Solvers x kinds of pathological problems; None without any."""
    cells = _cells(inputs)
    cells = cells[cells["set"] == choice.PATHOLOGICAL]
    kinds = [kind_of(problem, family) for problem, family in zip(cells["problem"], cells["family"])]
    return _map(inputs, cells, kinds)


def grids(inputs: Inputs):
    """Solvers x grids of the standard problems, each of which varies one property; None without any."""
    cells = _cells(inputs)
    kinds = cells["problem"].map(lambda name: inputs.problems[name].get("grid") or "").astype(str)
    chosen = (kinds != "") & (cells["set"] != choice.PATHOLOGICAL)
    return _map(inputs, cells[chosen], list(kinds[chosen]))


def _cells(inputs: Inputs) -> pd.DataFrame:
    cells = inputs.cells
    return cells[cells["tier"] == choice.main_tier(inputs)]


def _map(inputs: Inputs, cells: pd.DataFrame, kinds: list[str]):
    if not len(cells):
        return None
    verdicts = cells["verdict"].map(lambda verdict: _WORDS.get(verdict, "failed"))
    verdicts[cells["proved_infeasible"].astype(bool)] = "proved infeasible"
    counts = pd.crosstab([cells["solver"], pd.Series(kinds, index=cells.index, name="kind")], verdicts)
    of_problem = dict(zip(cells["problem"], kinds))
    names = list(dict.fromkeys(of_problem[name] for name in inputs.problems if name in of_problem))
    solvers = [key for key in inputs.keys if key in set(cells["solver"])]
    width = min(1.55 + 0.42 * len(names), canvas.PAGE)
    figure, axes = canvas.panels(1, 1, max(width, canvas.COLUMN), 0.155 * len(solvers) + 1.6)
    pane = axes[0][0]
    for (solver, kind), found in counts.iterrows():
        row, left = solvers.index(solver), names.index(kind) - 0.46
        for verdict, colour in canvas.VERDICTS.items():
            share = 0.92 * found.get(verdict, 0) / found.sum()
            if share:
                pane.barh(row, share, left=left, height=0.8, color=colour, zorder=3)
            left += share
    canvas.name_axis(pane, solvers)
    problems = pd.Series(kinds).groupby(kinds).size() // len(solvers)
    pane.set_xticks(range(len(names)), [f"{name} ({problems[name]})" for name in names], rotation=40, ha="left",
                    rotation_mode="anchor")
    pane.tick_params(top=True, bottom=False, labeltop=True, labelbottom=False, length=0, pad=2)
    pane.set_xlim(-0.5, len(names) - 0.5)
    pane.grid(False)
    for side in pane.spines.values():
        side.set_visible(False)
    pane.set_xlabel(f"kind of problem (number of problems), tier {power(choice.main_tier(inputs))}")
    shown = [verdict for verdict in canvas.VERDICTS if verdict in counts.columns]
    canvas.legend_outside(figure, [Patch(color=canvas.VERDICTS[verdict], label=verdict) for verdict in shown],
                          6 if len(names) > 7 else 2)
    return figure
