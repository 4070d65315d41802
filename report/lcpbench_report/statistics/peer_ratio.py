"""The ratio to the peers: what an own solver takes over what the fastest peer takes, problem by problem.

    r_p = fresh time of the own solver on p / least fresh time of a peer that is verified on p

and the median of the problems' weight, by size class and over all, with a bootstrap interval over families and bases.
Where the own solver is not verified r_p is infinite; where no peer is, there is no r_p (`no_peer` counts them). Peers
are all keys of other projects: one that was not asked for the tier and is right all the same is a rival. The fastest peer
is another one from problem to problem, which no user can know beforehand; so beside it stands the ratio to the best
single peer: of those that are right on RIGHT of the class's weight the one with the least median. The ratio over all classes depends on how many problems each has.
"""

import math
from collections.abc import Collection

import numpy as np
import pandas as pd

from .class_times import classes, p99
from .groups import GROUP
from .intervals import Bootstrap, share_interval
from .weighted import weighted_median, weighted_share

RIGHT = 0.99
LEAST_TURNS = 20  # problems of a class that a solver must have had its turn at to be called the best
_RATIO = ["ratio", "ratio_low", "ratio_high"]
COLUMNS = [*GROUP, "size_class", "solver", "problems", "weight", "verified_share", "verified_low", "verified_high",
           "median_s", "p99_s", "no_peer", *_RATIO, "peer", "peer_share", "peer_low", "peer_high", "peer_median_s",
           "peer_p99_s", *(f"peer_{name}" for name in _RATIO)]


def peer_ratio_table(cells: pd.DataFrame, own: Collection[str]) -> pd.DataFrame:
    """A row per group, size class (and `all`) and own solver; problems that count only. `peer` is empty where none is
    right often enough.

    @param own  keys of own solvers; the others are peers
    """
    rows = []
    for label, of_class in classes(cells):
        rows += [label | row for row in _rows(of_class, own)]
    return pd.DataFrame(rows, columns=COLUMNS)


def _rows(cells: pd.DataFrame, own: Collection[str]) -> list[dict]:
    bootstrap = Bootstrap(cells)
    problems = cells.drop_duplicates("problem").set_index("problem")["weight"]
    times = cells.pivot(index="problem", columns="solver", values="time_s").reindex(problems.index)
    mine = [key for key in dict.fromkeys(cells["solver"]) if key in own]
    peers = times[[key for key in dict.fromkeys(cells["solver"]) if key not in own]]  # NaN: had no turn
    fastest = peers.min(axis=1).fillna(math.inf) if len(peers.columns) else pd.Series(math.inf, index=times.index)
    by_solver = dict(tuple(cells.groupby("solver", sort=False)))
    best = _best(peers, problems)
    beside = {"peer": best}
    if best:
        turns = peers[best].dropna()
        weights = problems[turns.index]
        beside |= {"peer_median_s": weighted_median(turns, weights), "peer_p99_s": p99(by_solver[best])}
        beside |= _share(turns, weights, "peer_share", "peer")
    rows = []
    for solver in mine:
        taken = times[solver].dropna()  # problems on which it has a cell
        weights = problems[taken.index]
        row = {"solver": solver, "problems": len(taken), "weight": weights.sum(), "p99_s": p99(by_solver[solver]),
               "median_s": weighted_median(taken, weights), "no_peer": int((~np.isfinite(fastest[taken.index])).sum())}
        row |= _share(taken, weights, "verified_share", "verified") | beside
        row |= _ratio(taken, fastest[taken.index], weights, bootstrap, "")
        if best:
            row |= _ratio(taken, peers.loc[taken.index, best], weights, bootstrap, "peer_")
        rows.append(row)
    return rows


def _best(peers: pd.DataFrame, weights: pd.Series) -> str:
    medians = {}
    for key in peers:
        turns = peers[key].dropna()
        own = weights[turns.index]
        if len(turns) >= min(LEAST_TURNS, len(peers)) and weighted_share(np.isfinite(turns), own) >= RIGHT:
            medians[key] = weighted_median(turns, own)
    return min(medians, key=medians.get, default="")


def _share(times: pd.Series, weights: pd.Series, name: str, prefix: str) -> dict:
    share = weighted_share(np.isfinite(times), weights)
    low, high = share_interval(share, weights.sum())
    return {name: share, f"{prefix}_low": low, f"{prefix}_high": high}


def _ratio(taken: pd.Series, peer: pd.Series, weights: pd.Series, bootstrap: Bootstrap, prefix: str) -> dict:
    solved = peer.index[np.isfinite(peer)]
    ratios = taken[solved] / peer[solved]
    low, high = bootstrap.median(solved, ratios, weights[solved])
    return dict(zip((prefix + name for name in _RATIO), (weighted_median(ratios, weights[solved]), low, high)))
