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


def bounds(edges: Edges) -> list[dict[str, tuple[float, float]]]:
    """Of every region, in the order of region_of."""
    parts = [[*zip(ends, [*ends[1:], math.inf])] for ends in edges.values()]
    return [dict(zip(edges, chosen)) for chosen in itertools.product(*parts)]


def region_of(features: pd.DataFrame, edges: Edges) -> pd.Series:
    """The number of every problem's region. A feature that is not known counts as the smallest, as the first region
    that excludes nothing does for `lcpbench recommend`."""
    number = np.zeros(len(features), dtype=int)
    for name, ends in edges.items():
        values = features[name].fillna(ends[0]).clip(lower=ends[0])
        number = number * len(ends) + np.searchsorted(ends, values, side="right") - 1
    return pd.Series(number, index=features.index)


def family_weights(families: pd.Series, weights: pd.Series) -> np.ndarray:
    """Of every problem, so that all families weigh the same, with what its problems weigh within each."""
    return (weights / weights.groupby(families).transform("sum")).to_numpy()


def choose(of_region: pd.DataFrame, weights: np.ndarray, false_success: set[str], most: int = MOST) -> list[str]:
    """Greedily: the solver that adds most. A problem counts 1 where the best of the list is within NEAR of the best,
    and loses a tenth of the logarithm of the ratio, so that the rest is as little off as possible; what failed is a
    thousand times slower, so a solver that fails is backed up by another. One that ever claimed a success falsely
    is not taken, and none that adds nothing.

    @param of_region  ratios, a row per problem, a column per solver
    """
    values = of_region[[key for key in of_region.columns if key not in false_success]]
    current, score, chosen = np.full((len(values), 1), _WORST), -math.inf, []
    while len(chosen) < most and len(values.columns):
        merged = np.minimum(current, values.to_numpy())
        gains = (weights[:, None] * ((merged <= NEAR) - _LOG_WEIGHT * np.log(merged))).sum(axis=0)
        index = int(gains.argmax())
        if chosen and gains[index] <= score + 1e-12:
            break
        score, current = gains[index], merged[:, [index]]
        chosen.append(values.columns[index])
    return chosen


@dataclass
class TierTable:
    """All problems at one tier: a row per problem, a column per solver."""

    tier: float
    families: pd.Series
    seeds: pd.Series
    sources: pd.Series  # None: of this project
    weights: pd.Series
    # [s], infinite where the answer was not verified; not a number where there was no cell.
    times: pd.DataFrame
    verified: pd.DataFrame
    false_success: pd.DataFrame

    def ratios(self, problems: pd.Index, solvers: list[str]) -> pd.DataFrame:
        """The time over the best of these solvers; _WORST where it is more or failed."""
        times = self.times.loc[problems, solvers]
        return times.div(times.min(axis=1), axis=0).clip(upper=_WORST).fillna(_WORST)

    def family_weights(self, problems: pd.Index) -> np.ndarray:
        return family_weights(self.families[problems], self.weights[problems])


def tier_tables(outcomes: Outcomes) -> list[TierTable]:
    """Loosest tier first."""
    made = []
    for tier, cells in sorted(outcomes.table.groupby("tier"), key=lambda part: -part[0]):
        times, verified, false = (cells.pivot(index="problem", columns="solver", values=name)
                                  for name in ("time_s", "verified", "false_success"))
        of_problem = cells.drop_duplicates("problem").set_index("problem").reindex(verified.index)
        made.append(TierTable(float(tier), of_problem["family"], of_problem["seed"],
                              of_problem["source"], of_problem["weight"], times,
                              verified.eq(True), false.eq(True)))
    return made


def choose_candidates(table: TierTable, numbers: pd.Series, sizes: pd.Series, solvers: list[str], training: pd.Index,
                      most: int = MOST) -> dict[int, tuple[list[str], pd.Index]]:
    """For every region that any problem lies in its list, made of problems of `training` alone, and which these are. A
    region that has training problems of fewer than three families takes what all training problems of its part of the
    sizes say, and where there are none of those all.

    @param numbers  of every problem its region
    @param sizes    of every problem its part of the sizes
    """
    found = {}
    columns = [key for key in solvers if key in table.verified]
    for number in sorted(set(numbers[table.verified.index])):
        size = sizes[numbers == number].iloc[0]
        for chosen in (training[(numbers[training] == number).to_numpy()],
                       training[(sizes[training] == size).to_numpy()], training):
            if table.families[chosen].nunique() >= _LEAST_FAMILIES:
                break
        solved = chosen[table.verified.loc[chosen, columns].any(axis=1).to_numpy()]
        false = {key for key in columns if table.false_success.loc[chosen, key].any()}
        found[number] = choose(table.ratios(solved, columns), table.family_weights(solved), false, most), chosen
    return found


def partition(outcomes: Outcomes, edges: Edges) -> tuple[pd.Series, pd.Series]:
    """Of every problem its region, and its part of the sizes."""
    return region_of(outcomes.features, edges), region_of(outcomes.features, {"rows": edges["rows"]})


def make_regions(outcomes: Outcomes, leave_out: frozenset[str] = frozenset()) -> list[dict]:
    """The member `regions` (benchmarks/RESULTS.md), of all families but some."""
    edges = outcomes.edges
    numbers, sizes = partition(outcomes, edges)
    regions = []
    for table in tier_tables(outcomes):
        training = table.families.index[~table.families.isin(leave_out).to_numpy()]
        own = choose_candidates(table, numbers, sizes, outcomes.own, training)
        peers = choose_candidates(table, numbers, sizes, outcomes.peers, training, _PEERS) if outcomes.peers else {}
        for number, where in enumerate(bounds(edges)):
            if number in own:
                candidates, problems = own[number]
                regions.append({
                    "tier": table.tier,
                    "where": {name: [low, None if math.isinf(high) else high] for name, (low, high) in where.items()},
                    "problems": len(problems), "families": int(table.families[problems].nunique()),
                    "candidates": candidates, "peers": peers[number][0] if peers else [],
                    "solvers": _record(table, problems, [key for key in outcomes.own if key in table.verified])})
    return regions


def _record(table: TierTable, problems: pd.Index, solvers: list[str]) -> list[dict]:
    """How every solver did, best first: shares of the problems, families weighing the same, on which it was verified,
    and within WITHIN of the best."""
    weights, near = table.family_weights(problems), table.ratios(problems, solvers) <= WITHIN
    rows = [{"solver": key, "verified": round(float((weights * table.verified.loc[problems, key]).sum() / weights.sum()), 4),
             "within": round(float((weights * near[key]).sum() / weights.sum()), 4)} for key in solvers]
    return sorted(rows, key=lambda row: (-row["within"], -row["verified"], row["solver"]))
