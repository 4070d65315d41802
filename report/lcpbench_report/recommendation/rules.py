"""Makes the regions of data/recommendation.json of what solvers did, each with its short list: the few solvers of which
one is nearly the best on as many problems as possible.
"""

import itertools
import math
from dataclasses import dataclass

import numpy as np
import pandas as pd

from .outcomes import Edges, Outcomes

NEAR = 1.1  # of the best: what counts when a list is made
WITHIN = 1.3  # of the best: what a recommendation must keep
MOST = 5  # solvers of a list
_WORST = 1e3  # a slower or failed answer is no worse than that
_LOG_WEIGHT = 0.1  # of the logarithm of the ratio, where a problem is not near
_LEAST_FAMILIES = 3  # a region with problems of fewer ones takes the list of all problems of its size
_PEERS = 2  # of a list


# ----- parts of the space of features

def bounds(edges: Edges) -> list[dict[str, tuple[float, float]]]:
    """Of every region, in the order of region_of."""
    parts = [[(low, high) for low, high in zip(ends, [*ends[1:], math.inf])] for ends in edges.values()]
    return [dict(zip(edges, chosen)) for chosen in itertools.product(*parts)]


def region_of(features: pd.DataFrame, edges: Edges) -> pd.Series:
    """The number of every problem's region. A feature that is not known counts as the smallest, as the first region
    that excludes nothing does for `lcpbench recommend`."""
    number = np.zeros(len(features), dtype=int)
    for name, ends in edges.items():
        values = features[name].fillna(ends[0]).clip(lower=ends[0])
        number = number * len(ends) + np.searchsorted(ends, values, side="right") - 1
    return pd.Series(number, index=features.index)


# ----- short lists

def family_weights(families: pd.Series, weights: pd.Series) -> np.ndarray:
    """Of every problem, so that all families weigh the same, with what its problems weigh within each."""
    return (weights / weights.groupby(families).transform("sum")).to_numpy()


def ratios(times: pd.DataFrame, best: pd.Series) -> pd.DataFrame:
    """Of every problem (row) and solver (column) the time over the best one; 1e3 where it is more or failed."""
    return times.div(best, axis=0).clip(upper=_WORST).fillna(_WORST)


def choose(of_region: pd.DataFrame, weights: np.ndarray, false_success: set[str], most: int = MOST) -> list[str]:
    """Greedily: the solver that adds most. A problem counts 1 where the best of the list is within NEAR of the best,
    and loses a tenth of the logarithm of the ratio, so that the rest is as little off as possible; what failed is a
    thousand times slower, so a solver that fails is backed up by another. One that ever claimed a success falsely
    is not taken, and none that adds nothing.

    @param of_region  ratios, a row per problem, a column per solver
    """
    columns = [key for key in of_region.columns if key not in false_success]
    if not columns:
        return []
    values = of_region[columns].to_numpy()
    current = np.full(len(values), _WORST)
    chosen: list[str] = []
    score = -np.inf
    while len(chosen) < most:
        merged = np.minimum(current[:, None], values)
        gains = (weights[:, None] * ((merged <= NEAR) - _LOG_WEIGHT * np.log(merged))).sum(axis=0)
        index = int(gains.argmax())
        if chosen and gains[index] <= score + 1e-12:
            break
        score = gains[index]
        chosen.append(columns[index])
        current = merged[:, index]
    return chosen


def record_of(of_region: pd.DataFrame, verified: pd.DataFrame, weights: np.ndarray) -> list[dict]:
    """How every solver did, best first: shares of the problems, families weighing the same, on which it was verified,
    and within WITHIN of the best."""
    total = weights.sum()
    rows = [{"solver": key, "verified": round(float((weights * verified[key]).sum() / total), 4),
             "within": round(float((weights * (of_region[key] <= WITHIN)).sum() / total), 4)}
            for key in of_region.columns]
    return sorted(rows, key=lambda row: (-row["within"], -row["verified"], row["solver"]))


# ----- regions

@dataclass
class TierTable:
    """All problems at one tier: a row per problem, a column per solver."""

    tier: float
    families: pd.Series
    seeds: pd.Series
    weights: pd.Series
    # [s], infinite where the answer was not verified; not a number where there was no cell.
    times: pd.DataFrame
    verified: pd.DataFrame
    false_success: pd.DataFrame


def tier_tables(outcomes: Outcomes) -> list[TierTable]:
    """Loosest tier first."""
    made = []
    for tier in sorted(outcomes.table.tier.unique(), reverse=True):
        cells = outcomes.table[outcomes.table.tier == tier]
        wide = {name: cells.pivot(index="problem", columns="solver", values=name)
                for name in ("time_s", "verified", "false_success")}
        of_problem = cells.drop_duplicates("problem").set_index("problem").reindex(wide["verified"].index)
        made.append(TierTable(float(tier), of_problem.family, of_problem.seed, of_problem.weight, wide["time_s"],
                              wide["verified"].eq(True), wide["false_success"].eq(True)))
    return made


@dataclass
class Candidates:
    """A list for every region, by its number, of one tier."""

    solvers: dict[int, list[str]]
    training: dict[int, pd.Index]  # problems that a list was made of


def choose_candidates(table: TierTable, numbers: pd.Series, sizes: pd.Series, solvers: list[str], training: pd.Index,
                      most: int = MOST) -> Candidates:
    """A list for every region that any problem lies in, made of the problems of `training` alone. One that has training
    problems of fewer than three families takes what all training problems of its part of the sizes say, and where there
    are none of those all.

    @param numbers  of every problem its region
    @param sizes    of every problem its part of the sizes
    """
    found = Candidates({}, {})
    columns = [key for key in solvers if key in table.verified]
    for number in sorted(set(numbers[table.verified.index])):
        size = sizes[numbers == number].iloc[0]
        for chosen in (training[(numbers[training] == number).to_numpy()],
                       training[(sizes[training] == size).to_numpy()], training):
            found.training[number] = chosen
            if table.families[chosen].nunique() >= _LEAST_FAMILIES:
                break
        chosen = found.training[number]
        solved = chosen[table.verified.loc[chosen, columns].any(axis=1).to_numpy()]
        false = {key for key in columns if table.false_success.loc[chosen, key].any()}
        weights = family_weights(table.families[solved], table.weights[solved])
        found.solvers[number] = choose(ratios_of(table, solved, columns), weights, false, most)
    return found


def ratios_of(table: TierTable, problems: pd.Index, solvers: list[str]) -> pd.DataFrame:
    """Of every problem and solver the time over the best of these solvers."""
    times = table.times.loc[problems, solvers]
    return ratios(times, times.min(axis=1))


def partition(outcomes: Outcomes, edges: Edges) -> tuple[pd.Series, pd.Series]:
    """Of every problem its region, and its part of the sizes."""
    return region_of(outcomes.features, edges), region_of(outcomes.features, {"rows": edges["rows"]})


def make_regions(outcomes: Outcomes, leave_out: frozenset[str] = frozenset()) -> list[dict]:
    """The member `regions` (benchmarks/RESULTS.md), of all families but some."""
    edges = outcomes.edges
    numbers, sizes = partition(outcomes, edges)
    regions = []
    for table in tier_tables(outcomes):
        problems = table.verified.index
        columns = [key for key in outcomes.own if key in table.verified]
        training = problems[~table.families.isin(leave_out).to_numpy()]
        own = choose_candidates(table, numbers, sizes, outcomes.own, training)
        peers = choose_candidates(table, numbers, sizes, outcomes.peers, training, _PEERS) if outcomes.peers else None
        for number, where in enumerate(bounds(edges)):
            if number not in own.solvers:
                continue
            of_region = own.training[number]
            regions.append({
                "tier": table.tier,
                "where": {name: [low, None if math.isinf(high) else high] for name, (low, high) in where.items()},
                "problems": len(of_region),
                "families": int(table.families[of_region].nunique()),
                "candidates": own.solvers[number],
                "peers": peers.solvers[number] if peers else [],
                "solvers": record_of(ratios_of(table, of_region, columns), table.verified.loc[of_region],
                                        family_weights(table.families[of_region], table.weights[of_region])),
            })
    return regions
