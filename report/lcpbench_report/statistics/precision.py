"""Work over precision: what a solver's next digits cost.

A tier costs more only if it is asked of the same problems. So for every tier `strictest` there is one curve: over the
problems that the solver solves at that tier and at all looser ones, the shifted geometric mean of the time at each.
"""

import pandas as pd

from .cells import EXCLUDED, VERIFIED, quantiles
from .groups import with_label
from .means import SHIFTS, shifted_geometric_mean

COLUMNS = ["set", "mode", "solver", "strictest", "tier", "problems", "shift", "mean_s", "rho_median", "rho_max"]


def precision_table(cells: pd.DataFrame) -> pd.DataFrame:
    """A row per set, mode, solver, curve and tier, loosest first; curves without a problem are left out."""
    rows = []
    labelled = with_label(cells)
    for (label, mode, solver), own in labelled.groupby(["set", "mode", "solver"], sort=False):
        tiers = sorted(own["tier"].unique(), reverse=True)
        solved = own[own["verdict"] == VERIFIED]
        problems = set(solved["problem"])
        for depth, strictest in enumerate(tiers, start=1):
            problems &= set(solved.loc[solved["tier"] == strictest, "problem"])
            if not problems:
                break
            curve = solved[solved["problem"].isin(problems)]
            for tier in tiers[:depth]:
                point = curve[curve["tier"] == tier]
                rows.append({"set": label, "mode": mode, "solver": solver, "strictest": strictest, "tier": tier,
                             "problems": len(point), "shift": SHIFTS["s"],
                             "mean_s": shifted_geometric_mean(point["time_s"], SHIFTS["s"]),
                             "rho_median": point["rho"].median(), "rho_max": point["rho"].max()})
    return pd.DataFrame(rows, columns=COLUMNS)


DELIVERED = ("rho", "w_error")


def delivered_table(cells: pd.DataFrame) -> pd.DataFrame:
    """A row per set, mode, solver and tier: what the solver takes for the tolerance it is asked for, and how exact its
    answers are by the common metrics, whether they pass or not."""
    rows = []
    run = with_label(cells[cells["verdict"] != EXCLUDED])
    for (label, mode, solver, tier), own in run.groupby(["set", "mode", "solver", "tier"], sort=False):
        row = {"set": label, "mode": mode, "solver": solver, "tier": tier, "problems": len(own),
               "verified_share": float((own["verdict"] == VERIFIED).mean()), "shift": SHIFTS["s"],
               "mean_s": shifted_geometric_mean(own["solve_median"].fillna(own["time_limit_s"]), SHIFTS["s"]),
               "answers": int(own["rho"].notna().sum())}
        for metric in DELIVERED:
            row |= quantiles(own[metric], f"{metric}_")
        rows.append(row)
    columns = ["set", "mode", "solver", "tier", "problems", "verified_share", "shift", "mean_s", "answers",
               *(name for metric in DELIVERED for name in quantiles([], f"{metric}_"))]
    return pd.DataFrame(rows, columns=columns)
