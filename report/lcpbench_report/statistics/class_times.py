"""What a user pays, by size class: every solver's fresh time, how much it solves, and who is as good as the best; what
ours take over the peers; and what ablations change. Problems that count only.

Medians are of the class's weight, failures infinite: failing on the hard ones cannot lower them. Problems of a class take
very different times, so that intervals of medians are wide (intervals.Bootstrap: families, then bases); a median of
ratios, problem by problem, is sharper: what is common to both times cancels. Where the first solver of a ratio is not
verified it is infinite; where the second is not, the problem has none.

Peers are all keys of other projects: one that was not asked for the tier and is right all the same is a rival. The
fastest peer of a problem is another one from problem to problem, which no user can know beforehand; so beside it stands
the ratio to the best single peer: of those that are right on RIGHT of the class's weight the one with the least median.
The ratio over all classes depends on how many problems each has.

What a solver does not take as it is given is in none of its medians and shares; who does not take RIGHT of a class is not
called the best of it.
"""

import math
from collections.abc import Collection, Iterator

import numpy as np
import pandas as pd

from .cells import NOT_ASKED, VERIFIED
from .coverage import coverage
from .groups import GROUP, Part, groups
from .intervals import Bootstrap
from .load import PART_TIMES, TASK_BUDGET
from .weighted import weighted_median, weighted_quantile, weighted_share

ALL = "all"  # the value of `size_class` for all problems
LEAST_FOR_P99 = 1000  # problems of a class
RIGHT = 0.99
LEAST_TURNS = 20  # problems of a class that a solver must have had its turn at to be called the best
_ENDS = ("", "_low", "_high")
_SHARES = [f"{share}{end}" for share in ("taken_share", "attempted_share", "verified_share", "verified_of_attempted") for end in _ENDS]
_MEDIANS = ["again_s", "first_s", *PART_TIMES]
_RATIO, _PEER_RATIO = ([f"{name}{end}" for end in _ENDS] for name in ("ratio", "peer_ratio"))
COLUMNS = [*GROUP, "size_class", "solver", "asked", "problems", "weight", "not_asked", "attempted", "verified", "false_successes",
           "below_tier", *_SHARES, "median_s", "median_low", "median_high", "p99_s", *_MEDIANS]
PEER_COLUMNS = [*GROUP, "size_class", "solver", "no_peer", *_RATIO, "peer", *_PEER_RATIO]
_COUNTS = ["verified_share", "false_successes", "below_tier"]
ABLATION_COLUMNS = [*GROUP, "size_class", "solver", "ablation", "base", "problems", "both", *_RATIO, *_COUNTS,
                    *(f"base_{count}" for count in _COUNTS)]


def classes(cells: pd.DataFrame) -> Iterator[Part]:
    """Label and cells of every group of problems that count, by size class, and of all together: smallest class first,
    `all` last. Problems that had no turn within a task's budget are left out: their order is drawn by lot, so that the
    others are a fair sample, and a solver that takes long is not thereby wrong."""
    for label, cells in groups(cells, counted_only=True):
        cells = cells[cells["excluded"] != TASK_BUDGET]
        for size_class in cells.groupby("size_class")["rows"].min().sort_values().index:
            yield {**label, "size_class": size_class}, cells[cells["size_class"] == size_class]
        yield {**label, "size_class": ALL}, cells


def _by_solver(cells: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Rows by problem, of those that the solver was asked."""
    cells = cells[cells["verdict"] != NOT_ASKED]
    return {solver: own.set_index("problem") for solver, own in cells.groupby("solver", sort=False)}


def _ratio(names: list[str], first: pd.Series, second: pd.Series, weights: pd.Series, bootstrap: Bootstrap) -> dict:
    """Weighted median of the ratios of times by problem, with its interval, where the second is finite."""
    solved = second.index[np.isfinite(second)]
    ratios = first[solved] / second[solved]
    return dict(zip(names, (weighted_median(ratios, weights[solved]),
                            *bootstrap.median(solved, ratios, weights[solved]))))


def p99(cells: pd.DataFrame) -> float:
    """The 99 % quantile of the fresh times of one solver's verified answers; NaN where the class has too few problems."""
    if len(cells) < LEAST_FOR_P99:
        return math.nan
    timed = cells[(cells["verdict"] == VERIFIED) & cells["fresh_s"].notna()]
    return weighted_quantile(timed["fresh_s"], timed["weight"], 0.99)


def class_table(cells: pd.DataFrame) -> pd.DataFrame:
    """A row per group, size class (and `all`) and solver. `p99_s` and the medians of the second measure (`again_s`), of
    the solve that was judged and of the parts are of verified answers that were timed."""
    rows = []
    for label, of_class in classes(cells):
        bootstrap = Bootstrap(of_class)
        rows += [label | {"solver": solver} | _row(own.set_index("problem"), bootstrap)
                 for solver, own in of_class.groupby("solver", sort=False)]
    return pd.DataFrame(rows, columns=COLUMNS)


def _row(cells: pd.DataFrame, bootstrap: Bootstrap) -> dict:
    counts = coverage(cells)
    cells = cells[cells["verdict"] != NOT_ASKED]
    low, high = bootstrap.median(cells.index, cells["time_s"], cells["weight"])
    verified = cells[cells["verdict"] == VERIFIED]
    row = counts | {"median_s": weighted_median(cells["time_s"], cells["weight"]), "median_low": low,
                             "median_high": high, "p99_s": p99(cells)}
    for key in _MEDIANS:
        known = verified[verified[key].notna()]
        row[key] = weighted_median(known[key], known["weight"])
    return row


def peer_ratio_table(cells: pd.DataFrame, own: Collection[str]) -> pd.DataFrame:
    """A row per group, size class (and `all`) and own solver: `ratio` to the fastest verified peer of each problem (where
    there is none: `no_peer`), and `peer_ratio` to the best single one, `peer`, which is empty where none is right often
    enough.

    @param own  keys of own solvers; the others are peers
    """
    return pd.DataFrame([label | row for label, of_class in classes(cells) for row in _peer_rows(of_class, own)],
                        columns=PEER_COLUMNS)


def _peer_rows(cells: pd.DataFrame, own: Collection[str]) -> list[dict]:
    bootstrap, solvers = Bootstrap(cells), _by_solver(cells)
    problems = cells.drop_duplicates("problem").set_index("problem")["weight"]
    times = pd.DataFrame({key: found["time_s"] for key, found in solvers.items()}, problems.index)  # NaN: had no turn
    peers = times[[key for key in solvers if key not in own]]
    fastest = peers.min(axis=1).fillna(math.inf)
    best = _best(peers[[key for key in peers if _takes_the_class(cells[cells["solver"] == key])]], problems)
    rows = []
    for solver in (key for key in solvers if key in own):
        taken = times[solver].dropna()  # problems on which it has a cell
        weights = problems[taken.index]
        row = {"solver": solver, "no_peer": int((~np.isfinite(fastest[taken.index])).sum()), "peer": best}
        row |= _ratio(_RATIO, taken, fastest[taken.index], weights, bootstrap)
        if best:
            row |= _ratio(_PEER_RATIO, taken, peers.loc[taken.index, best], weights, bootstrap)
        rows.append(row)
    return rows


def _takes_the_class(cells: pd.DataFrame) -> bool:
    """Whether one solver takes so much of the class as it is given that it may be called the best of it."""
    return weighted_share(cells["verdict"] != NOT_ASKED, cells["weight"]) >= RIGHT


def _best(peers: pd.DataFrame, weights: pd.Series) -> str:
    medians = {}
    for key in peers:
        turns = peers[key].dropna()
        own = weights[turns.index]
        if len(turns) >= min(LEAST_TURNS, len(peers)) and weighted_share(np.isfinite(turns), own) >= RIGHT:
            medians[key] = weighted_median(turns, own)
    return min(medians, key=medians.get, default="")


def ablation_table(cells: pd.DataFrame, ablated: pd.DataFrame, solvers: list[dict]) -> pd.DataFrame:
    """What single means are worth: solvers without their self-check, peers with a check and one more solve with a shifted
    diagonal, own solvers built for the baseline instruction set, each against the solver that it is a version of. They
    stand in no other table. A row per group, size class (and `all`) and solver of an ablation, over the problems that
    both have a cell on; `ratio`: of fresh times where both are verified.

    @param cells    of cells.cell_table
    @param ablated  the same of ablations
    @param solvers  the entries of campaign.json
    """
    versions = {entry["key"]: entry for entry in solvers if entry["ablation"]}
    bases = {entry["base"] for entry in versions.values()}
    rows = []
    for label, of_class in classes(pd.concat([cells[cells["solver"].isin(bases)], ablated], ignore_index=True)):
        bootstrap, found = Bootstrap(of_class), _by_solver(of_class)
        for key, entry in versions.items():
            if key not in found or entry["base"] not in found:
                continue
            shared = found[key].index.intersection(found[entry["base"]].index, sort=False)
            if not len(shared):
                continue
            own, base = found[key].loc[shared], found[entry["base"]].loc[shared]
            both = own.index[np.isfinite(own["time_s"]) & np.isfinite(base["time_s"])]
            counts, of_base = coverage(own), coverage(base)
            rows.append(label | {"solver": key, "ablation": entry["ablation"], "base": entry["base"],
                                 "problems": len(shared), "both": len(both)}
                        | _ratio(_RATIO, own["time_s"], base.loc[both, "time_s"], own["weight"], bootstrap)
                        | {count: counts[count] for count in _COUNTS}
                        | {f"base_{count}": of_base[count] for count in _COUNTS})
    return pd.DataFrame(rows, columns=ABLATION_COLUMNS)
