"""Problems with friction, sliding or bounded rows: who is right, and what errors are made of [docs/friction.md section 4].

They count in no other table: most solvers do not take such rows. What a solver does not take is in no share here either.
An answer of another law is right where it obeys Coulomb's law; where it solves its own model alone it is neither right nor a
false success.
"""

import numpy as np
import pandas as pd

from .cells import CAUSES, FALSE_SUCCESS, NOT_ASKED, VERIFIED
from .class_times import RATIO, by_solver, ratio
from .coverage import OF_CAUSES
from .groups import GROUP, groups
from .intervals import Bootstrap
from .launches import Levels
from .model import ERROR_PARTS, INFEASIBLE, TASK_BUDGET
from .weighted import weighted_median, weighted_share

COLUMNS = [*GROUP, "solver", "problems", "taken", "solvable", "right", "right_share", "lawful_share", "false_successes", *OF_CAUSES,
           "false_infeasible", "median_s", *RATIO, "wrong", "rho", "model_rho", *(f"{part}_share" for part in ERROR_PARTS)]


def with_friction(cells: pd.DataFrame) -> pd.DataFrame:
    return cells[(cells["friction"] > 0) | (cells["bounded"] > 0)]


def friction_table(cells: pd.DataFrame, ours: str = "", levels: Levels = Levels()) -> pd.DataFrame:
    """A row per set, tier and solver. `taken`: problems that it takes, also those that a rule excludes because it was out
    of time at a looser tier, which are not right (what had no turn is left out); `solvable`: of these, those that are not known to have no solution; of
    them `right` (verified), its share of the weight (`lawful_share`: of what obeys the solver's own law) and the median
    time, in which what is not verified is infinite. RATIO: the time of `ours` over its, where it is verified. `wrong`: the
    others of them; of these the medians of rho and model_rho, and of each part of the error the mean share of the sum of
    squares."""
    rows = []
    for label, of_group in groups(with_friction(cells[cells["excluded"] != TASK_BUDGET])):
        asked, bootstrap = by_solver(of_group), Bootstrap(of_group)
        for solver, own in of_group.groupby("solver", sort=False):
            rows.append(label | {"solver": solver} | _measures(own, label["tier"]))
            if solver != ours and {solver, ours} <= asked.keys():
                rows[-1] |= ratio(asked[ours], asked[solver], label["tier"], bootstrap, levels)
    return pd.DataFrame(rows, columns=COLUMNS)


def _measures(own: pd.DataFrame, tier: float) -> dict:
    taken = own[own["verdict"] != NOT_ASKED]
    solvable = taken[taken["reference_status"] != INFEASIBLE]
    right = solvable["verdict"] == VERIFIED
    answers = solvable[~right]
    with np.errstate(over="ignore"):  # what is infinite has no shares
        squares = np.square(answers[list(ERROR_PARTS)].to_numpy(dtype=float))
    sums = squares.sum(axis=1, keepdims=True)
    shares = squares[np.isfinite(sums[:, 0]) & (sums[:, 0] > 0)]
    shares = (shares / shares.sum(axis=1, keepdims=True)).mean(axis=0) if len(shares) else np.full(len(ERROR_PARTS), np.nan)
    return {"problems": len(own), "taken": len(taken), "solvable": len(solvable), "right": int(right.sum()),
            "right_share": weighted_share(right, solvable["weight"]),
            "lawful_share": weighted_share(right | (solvable["model_rho"] <= tier), solvable["weight"]),
            "false_successes": int((taken["verdict"] == FALSE_SUCCESS).sum()),
            **{name: int((taken["cause"] == cause).sum()) for name, cause in zip(OF_CAUSES, CAUSES)},
            "false_infeasible": int(taken["false_infeasible"].astype(bool).sum()),
            "median_s": weighted_median(solvable["time_s"], solvable["weight"]), "wrong": len(answers),
            "rho": _median(answers["rho"]), "model_rho": _median(answers["model_rho"]),
            **{f"{part}_share": share for part, share in zip(ERROR_PARTS, shares)}}


def _median(values: pd.Series) -> float:
    known = values.dropna()
    return float(np.median(known)) if len(known) else np.nan


def refusers(cells: pd.DataFrame) -> list[str]:
    """Solvers that take none of these problems, in the order of the cells."""
    asked = with_friction(cells).groupby("solver", sort=False)["verdict"].agg(lambda verdicts: (verdicts != NOT_ASKED).any())
    return [solver for solver, holds in asked.items() if not holds]
