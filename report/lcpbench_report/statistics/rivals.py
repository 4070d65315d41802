"""Ours against the peers, by size class: the Pareto front of peers, the portfolio, and the fastest peer of each problem.

A peer is on the front of a class if no other is both faster (weighted median, failures infinite) and right on as much of
it. What a peer does not take as it is given counts as not right here: who has the class cannot use it alone. Against
each rival stands the weighted median of the ratios of times, ours over theirs, over the problems that the rival is right
on; so the ratio says nothing of those on which it fails, and the shares right beside it, of the problems that both had a
turn at, do. Together they say who dominates whom (`relation`); a ratio whose interval contains 1 is undecided.

The fastest peer of each problem is another one from problem to problem, which no user can know beforehand: the hardest
rival there can be. `peer_faster`: the share of the problems on which it is faster than ours by more than MARGIN. Ratios to
it and to the portfolio are also given by where problems come from, and to it of sealed problems, which nothing was developed
on, and of open ones.

The portfolio is made of its codes' records (portfolio.py), in the order that campaign.json has for the size class; in
campaigns that have none a solver of that key is it. `check_share`: what checks are of its time, median.

Peers come from Debian for any x86-64, ours are compiled for the machine. At equal flags (`flag_table`) builds of ours for
less stand against them, and ours against the peers that were compiled as they are.
"""

import math
from collections.abc import Collection

import numpy as np
import pandas as pd

from .class_times import ALL, RATIO, by_solver, classes, fastest_of_each, ratio
from .groups import GROUP
from .intervals import MARGIN, Bootstrap, share_with_interval
from .launches import Levels
from .model import ORIGIN_GROUPS
from .portfolio import portfolio_rows
from .weighted import effective_number, weighted_median, weighted_share

PORTFOLIO = "peer-portfolio"  # the value of `rival` for it
FASTEST = "fastest"  # the value of `rival` for the fastest peer of each problem
# Instruction set -> ours as it is built for that, and the peers that are built for it or for more.
_LCP_CODES = ("ode-dantzig", "bullet-dantzig")
_NATIVE = tuple(f"{key}-native" for key in _LCP_CODES)
FLAGS = {"any x86-64": ("auto-baseline", _LCP_CODES), "x86-64-v3": ("auto-v3", _NATIVE),
         "the machine's": ("auto", _NATIVE)}
OWN_BUILDS = ("auto-baseline", "auto-v3")  # external programs by their origin, and ours: in no other table
LEAST_TURNS = 20  # problems of a class that a peer must have had its turn at, where budgets ended some
OPEN, SEALED = "open", "sealed"  # values of `origin`
FASTER_SHARE = [f"peer_faster{end}" for end in ("", "_low", "_high")]
Portfolios = dict[str, list[str]]
DOMINATED, SLOWER, UNDECIDED, FASTER, DOMINATES = RELATIONS = (
    "dominated by ours", "slower, more often right", "undecided", "faster, less often right", "dominates ours")
_ROUNDING = 1e-9  # of shares
COLUMNS = [*GROUP, "size_class", "origin", "own", "rival", "front", "peers", "problems", "n_eff", "own_launches", "launches",
           "own_s", "own_share", "rival_s", "rival_share", *RATIO, "relation", "check_share", *FASTER_SHARE]
FLAG_COLUMNS = [*GROUP, "size_class", "flags", "own", "rival", "problems", "n_eff", "own_s", "own_share", "rival_s",
                "rival_share", *RATIO, "relation"]


def rival_table(cells: pd.DataFrame, own: Collection[str], ours: str, levels: Levels, portfolios: Portfolios | None = None) -> pd.DataFrame:
    """A row per group, size class and rival, and for FASTEST and PORTFOLIO per origin group; `peers`: how many had a turn.
    None in classes where `ours` had no turn.

    @param own   keys of own solvers; the others are peers
    @param ours  the one that is compared
    @param portfolios  size class -> keys of solvers in their order
    """
    orders = portfolios or {}
    return pd.DataFrame([label | row for label, of_class in classes(cells) if label["size_class"] != ALL
                         for row in _rows(of_class, own, ours, label["tier"], levels, orders.get(label["size_class"], []))],
                        columns=COLUMNS)


def flag_table(cells: pd.DataFrame, levels: Levels, portfolios: Portfolios | None = None) -> pd.DataFrame:
    """A row per group, size class, entry of FLAGS and rival that there are.

    @param cells  of all solvers, OWN_BUILDS too
    """
    rows = []
    for label, of_class in classes(cells):
        solvers = by_solver(of_class)
        made, rounds = _portfolio(of_class, (portfolios or {}).get(label["size_class"], []), label["tier"], levels)
        solvers |= made
        pairs = [(flags, ours, key) for flags, (ours, keys) in FLAGS.items() for key in keys if {ours, key} <= solvers.keys()]
        bootstrap = Bootstrap(of_class) if pairs and label["size_class"] != ALL else None
        rows += [label | {"flags": flags, "own": ours, "rival": key}
                 | _compared(solvers[ours], solvers[key], label["tier"], bootstrap, levels, rounds.get(key))
                 for flags, ours, key in pairs if bootstrap]
    return pd.DataFrame(rows, columns=FLAG_COLUMNS)


def is_own(entry: dict) -> bool:
    """@param entry  of solvers in campaign.json"""
    return entry["origin"] == "own" or entry["key"] in OWN_BUILDS


def pareto_front(points: dict[str, tuple[float, float]]) -> list[str]:
    """Names of those that no other is better than in both, the fastest first; without infinite times.

    @param points  name -> time, share right
    """
    found: list[str] = []
    for name in sorted(points, key=lambda name: (points[name][0], -points[name][1])):
        time, share = points[name]
        if math.isfinite(time) and share > max((points[other][1] for other in found), default=0):
            found.append(name)
    return found


def relation(low: float, high: float, own_share: float, share: float) -> str:
    """@param low, high  interval of the ratio of times, ours over theirs"""
    if high < 1:
        return DOMINATED if own_share >= share - _ROUNDING else SLOWER
    if low > 1:
        return DOMINATES if share >= own_share - _ROUNDING else FASTER
    return UNDECIDED


def _portfolio(cells: pd.DataFrame, keys: list[str], tier: float, levels: Levels) -> tuple[dict, dict]:
    """{PORTFOLIO: its rows by problem} and {PORTFOLIO: its times by rounds}; both empty where none of its codes was run."""
    there = set(cells["solver"])
    keys = [key for key in keys if key in there]
    return tuple({PORTFOLIO: of} for of in portfolio_rows(cells, keys, tier, levels)) if keys else ({}, {})


def _rows(cells: pd.DataFrame, own: Collection[str], ours: str, tier: float, levels: Levels, order: list[str]) -> list[dict]:
    solvers = by_solver(cells)
    mine = solvers.get(ours)
    peers = cells[~cells["solver"].isin(own)]
    if mine is None or peers.empty:
        return []
    tried = {key: of for key, of in peers.groupby("solver", sort=False) if (of["excluded"] == "").any()}
    problems = cells["problem"].nunique()
    points = {key: (weighted_median(of["time_s"], of["weight"]), weighted_share(np.isfinite(of["time_s"]), of["weight"]))
              for key, of in tried.items() if len(of) >= min(LEAST_TURNS, problems)}
    front = pareto_front(points)
    rivals = {key: tried[key].set_index("problem") for key in front}
    made, rounds = _portfolio(peers, order, tier, levels)
    rivals |= made
    rivals[FASTEST] = fastest_of_each(peers)
    bootstrap, rows = Bootstrap(cells), []
    groups, sealed = mine["origin"].map(ORIGIN_GROUPS), mine["sealed"].astype(bool)
    for key, theirs in rivals.items():
        of_peer = {"own": ours, "rival": key, "front": key in front, "peers": len(tried),
                   "own_launches": levels.count(ours, mine["size_class"].iloc[0], tier),
                   "launches": rounds[key].shape[1] if key in rounds else levels.count(key, mine["size_class"].iloc[0], tier)}
        parts = {ALL: mine}
        if key in (PORTFOLIO, FASTEST):
            parts |= dict(tuple(mine.groupby(groups, sort=False)))
        if key == FASTEST and sealed.any():
            parts |= {OPEN: mine[~sealed], SEALED: mine[sealed]}
        for origin, own_part in parts.items():
            rows.append(of_peer | {"origin": origin} | _compared(own_part, theirs, tier, bootstrap, levels, rounds.get(key)))
            if key == FASTEST:
                rows[-1] |= _faster(own_part, theirs)
    return rows


def _faster(mine: pd.DataFrame, theirs: pd.DataFrame) -> dict:
    """FASTER_SHARE"""
    times = theirs["time_s"].reindex(mine.index)
    return share_with_interval(times * MARGIN < mine["time_s"], mine["weight"], mine["base"], FASTER_SHARE[0], FASTER_SHARE[0])


def _compared(mine: pd.DataFrame, theirs: pd.DataFrame, tier: float, bootstrap: Bootstrap, levels: Levels,
              rounds: pd.DataFrame | None) -> dict:
    both = mine.index.intersection(theirs.index, sort=False)
    mine, theirs = mine.loc[both], theirs.loc[both]
    weights = mine["weight"]
    row = {"problems": len(both), "n_eff": effective_number(weights, pd.factorize(mine["base"])[0])}
    for side, of in (("own", mine), ("rival", theirs)):
        row |= {f"{side}_s": weighted_median(of["time_s"], weights),
                f"{side}_share": weighted_share(np.isfinite(of["time_s"]), weights)}
    row |= ratio(mine, theirs, tier, bootstrap, levels, rounds)
    if rounds is not None:
        right = np.isfinite(theirs["time_s"])
        row["check_share"] = weighted_median((theirs["check_s"] / theirs["time_s"])[right], weights[right])
    return row | {"relation": relation(row["ratio_low"], row["ratio_high"], row["own_share"], row["rival_share"])}
