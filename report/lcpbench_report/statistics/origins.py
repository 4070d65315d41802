"""Whether it matters where problems come from: own scenes and motions, recordings of engines, literature.

A solver's *loss* on a problem is the logarithm of its time over that of the fastest verified solver there; what is not
verified loses LARGEST_LOSS, as does what is slower than that. Its mean by weight over the problems of an origin ranks
the solvers there, and Spearman's rank correlation (1904) tells how alike two rankings are: 1 the same, -1 reversed. Its
interval is by the bootstrap of intervals.py: families and bases of both origins are drawn anew. Only size classes that
both origins have problems of are looked at, each with its weight in the first: which sizes an origin has is not what is
asked.
"""

import itertools
import math

import numpy as np
import pandas as pd
from scipy import stats

from .cells import NOT_ASKED, VERIFIED
from .class_times import RATIO, fastest_of_each, ratio
from .groups import COUNTED, GROUP, groups
from .intervals import Bootstrap, interval_of, share_with_interval
from .launches import Levels
from .model import LITERATURE, ORIGINS, TASK_BUDGET

COLUMNS = [*GROUP, "origin", "solver", "problems", "weight", "verified_share", "verified_low", "verified_high", *RATIO]
RANK_COLUMNS = [*GROUP, "origin", "other", "problems", "other_problems", "solvers", "correlation", "correlation_low",
                "correlation_high"]
LARGEST_LOSS = math.log(1000)
LEAST_PROBLEMS = 10  # of an origin, in the classes in common, that solvers are ranked on
LEAST_SOLVERS = 3


def origin_table(cells: pd.DataFrame, levels: Levels = Levels()) -> pd.DataFrame:
    """A row per group, origin and solver: the share verified, and the weighted median of its time over that of the
    fastest verified solver of each problem, over the problems that anyone solved; inf where it fails on half. Of sets
    that do not count only literature; problems that had no turn within a task's budget are left out."""
    rows = []
    for label, turns, fastest in _turns(cells):
        for origin, own in _by_origin(turns):
            if label["set"] != COUNTED and origin != LITERATURE:
                continue
            bootstrap = Bootstrap(own)
            rows += [label | {"origin": origin, "solver": solver, "problems": len(mine), "weight": mine["weight"].sum()}
                     | ratio(mine.set_index("problem"), fastest, label["tier"], bootstrap, levels)
                     | share_with_interval(mine["verdict"] == VERIFIED, mine["weight"], mine["base"], "verified_share", "verified")
                     for solver, mine in own.groupby("solver", sort=False)]
    return pd.DataFrame(rows, columns=COLUMNS)


def rank_table(cells: pd.DataFrame) -> pd.DataFrame:
    """A row per group and pair of origins that have size classes in common: Spearman's correlation of the rankings of
    the solvers that had a turn on LEAST_PROBLEMS problems of either or more."""
    rows = []
    for label, turns, fastest in _turns(cells[cells["counts"].astype(bool)]):
        turns = turns.assign(fastest_s=turns["problem"].map(fastest["time_s"]))
        for (first, own), (second, other) in itertools.combinations(_by_origin(turns), 2):
            common = set(own["size_class"]) & set(other["size_class"])
            own, other = (some[some["size_class"].isin(common)] for some in (own, other))
            # As much of every class in both.
            wanted = own.drop_duplicates("problem").groupby("size_class")["weight"].sum()
            there = other.drop_duplicates("problem").groupby("size_class")["weight"].sum()
            other = other.assign(weight=other["weight"] * other["size_class"].map(wanted / there))
            enough = [set(counts.index[counts >= LEAST_PROBLEMS]) for counts in
                      (some["solver"].value_counts() for some in (own, other))]
            solvers = [solver for solver in own["solver"].unique() if all(solver in some for some in enough)]
            if len(solvers) < LEAST_SOLVERS:
                continue
            found, drawn = zip(*(_losses(some, solvers) for some in (own, other)))
            low, high = interval_of(_spearman(*drawn))
            rows.append(label | {"origin": first, "other": second, "problems": own["problem"].nunique(),
                                 "other_problems": other["problem"].nunique(), "solvers": len(solvers),
                                 "correlation": float(_spearman(*found)[0]), "correlation_low": low,
                                 "correlation_high": high})
    return pd.DataFrame(rows, columns=RANK_COLUMNS)


def _turns(cells: pd.DataFrame):
    """Label and cells of every group, and those of the fastest solver of each problem."""
    for label, of_group in groups(cells):
        turns = of_group[(of_group["excluded"] != TASK_BUDGET) & (of_group["verdict"] != NOT_ASKED)]
        yield label, turns, fastest_of_each(turns)


def _by_origin(cells: pd.DataFrame) -> list[tuple[str, pd.DataFrame]]:
    parts = dict(tuple(cells.groupby("origin", sort=False)))
    return [(origin, parts[origin]) for origin in ORIGINS if origin in parts]


def _losses(cells: pd.DataFrame, solvers: list[str]) -> tuple[np.ndarray, np.ndarray]:
    """Mean loss of every solver: solvers x 1, and solvers x resamples."""
    bootstrap, found, drawn = Bootstrap(cells), [], []
    cells = cells[np.isfinite(cells["fastest_s"])]
    for solver in solvers:
        mine = cells[cells["solver"] == solver]
        loss = np.minimum(np.log(mine["time_s"] / mine["fastest_s"]), LARGEST_LOSS)
        found.append([np.average(loss, weights=mine["weight"]) if len(mine) else math.nan])
        drawn.append(bootstrap.means(mine["problem"], loss, mine["weight"]))
    return np.array(found), np.array(drawn)


def _spearman(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """The correlation over the columns that are known in both; equal losses share a rank."""
    known = ~(np.isnan(first).any(axis=0) | np.isnan(second).any(axis=0))
    ranks = [stats.rankdata(losses[:, known], axis=0) for losses in (first, second)]
    one, two = (each - each.mean(axis=0) for each in ranks)
    with np.errstate(invalid="ignore"):
        found = (one * two).sum(axis=0) / np.sqrt((one ** 2).sum(axis=0) * (two ** 2).sum(axis=0))
    return found if found.size else np.array([math.nan])
