"""Work over precision: what a solver's next digits cost.

A tier costs more only if it is asked of the same problems. So for every tier `strictest` there is one curve: over the
problems that the solver solves at that tier and at all looser ones, the shifted geometric mean of the time at each.
"""

import pandas as pd

from .cells import EXCLUDED, VERIFIED
from .groups import with_label
from .means import penalised, shift_of, shifted_geometric_mean
from .weighted import quantiles, weighted_median, weighted_share

COLUMNS = ["set", "solver", "strictest", "tier", "problems", "shift", "mean_s", "rho_median", "rho_max"]


def precision_table(cells: pd.DataFrame) -> pd.DataFrame:
    """A row per set, solver, curve and tier, loosest first; curves without a problem are left out."""
    rows = []
    labelled = with_label(cells)
    shifts = _shifts(labelled)
    for (label, solver), own in labelled.groupby(["set", "solver"], sort=False):
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
                rows.append({"set": label, "solver": solver, "strictest": strictest, "tier": tier,
                             "problems": len(point), "shift": shifts[label],
                             "mean_s": shifted_geometric_mean(point["time_s"], shifts[label], point["weight"]),
                             "rho_median": weighted_median(point["rho"], point["weight"]),
                             "rho_max": point["rho"].max()})
    return pd.DataFrame(rows, columns=COLUMNS)


def _shifts(labelled: pd.DataFrame) -> dict[str, float]:
    """Of every set one for all tiers, so that they compare."""
    return {label: shift_of(own) for label, own in labelled.groupby("set")}


DELIVERED = ("rho", "w_error")


def delivered_table(cells: pd.DataFrame) -> pd.DataFrame:
    """A row per set, solver and tier: what the solver takes for the tolerance it is asked for, and how exact its
    answers are by the common metrics, whether they pass or not. The time of an answer that is not verified is that of
    the solve that was judged, for nothing wrong is timed fresh."""
    rows = []
    run = with_label(cells[cells["verdict"] != EXCLUDED])
    run = run.assign(taken_s=penalised(run["fresh_s"].fillna(run["first_s"]).fillna(float("inf")), run["time_limit_s"]))
    shifts = {label: shift_of(own, "taken_s") for label, own in run.groupby("set")}
    for (label, solver, tier), own in run.groupby(["set", "solver", "tier"], sort=False):
        row = {"set": label, "solver": solver, "tier": tier, "problems": len(own),
               "verified_share": weighted_share(own["verdict"] == VERIFIED, own["weight"]), "shift": shifts[label],
               "mean_s": shifted_geometric_mean(own["taken_s"], shifts[label], own["weight"]),
               "answers": int(own["rho"].notna().sum())}
        for metric in DELIVERED:
            row |= quantiles(own[metric], f"{metric}_", own["weight"])
        rows.append(row)
    columns = ["set", "solver", "tier", "problems", "verified_share", "shift", "mean_s", "answers",
               *(name for metric in DELIVERED for name in quantiles([], f"{metric}_"))]
    return pd.DataFrame(rows, columns=columns)
