"""Makes the regions of data/recommendation.json of what solvers did."""

import math
from dataclasses import dataclass

import pandas as pd

from . import lists
from .outcomes import Outcomes
from .regions import Edges, bounds, region_of

_LEAST_FAMILIES = 3  # a region with problems of fewer ones takes the list of all problems of its size
_PEERS = 2  # of a list


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
                      most: int = lists.MOST) -> Candidates:
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
        weights = lists.family_weights(table.families[solved], table.weights[solved])
        found.solvers[number] = lists.choose(ratios_of(table, solved, columns), weights, false, most)
    return found


def ratios_of(table: TierTable, problems: pd.Index, solvers: list[str]) -> pd.DataFrame:
    """Of every problem and solver the time over the best of these solvers."""
    times = table.times.loc[problems, solvers]
    return lists.ratios(times, times.min(axis=1))


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
                "solvers": lists.record(ratios_of(table, of_region, columns), table.verified.loc[of_region],
                                        lists.family_weights(table.families[of_region], table.weights[of_region])),
            })
    return regions
