"""The portfolio of peers, a careful user's choice: in every size class the codes of others are asked in turn, and each
answer is checked, until one is verified.

It is no solver of its own but made of the records of its codes. Its time on a problem is that of all turns that it takes,
with their checks (`check_s` of problems.jsonl). A turn takes the fresh time, or that of the solve that was judged where the
answer was not timed, at most the time limit; what ran out of time is ended there. A code has no turn on what it does not
take as it is given, or is not given by a rule, also one of time: that costs nothing, and is not right.

The codes and their order are chosen on tuning problems (`report.py portfolio`), for the least shifted geometric mean, in
which failures have the time limit: the measure of means.py, so that a few large problems do not choose alone.
"""

import math
from typing import NamedTuple

import numpy as np
import pandas as pd

from .cells import ran
from .launches import Levels
from .means import shift_of, shifted_geometric_mean
from .model import OVER

MOST = 5  # codes of an order
_OF_PROBLEM = ["size_class", "origin", "base", "weight", "time_limit_s"]


class Turns(NamedTuple):
    """Problems x codes: the time of each one's turn with its check, that of the check, and whether the answer is right."""

    turn_s: pd.DataFrame
    check_s: pd.DataFrame
    right: pd.DataFrame

    def until_right(self) -> np.ndarray:
        """Whether it is the code's turn: nobody before it is right."""
        right = self.right.to_numpy()
        return (np.cumsum(right, axis=1) == right) & (self.turn_s.to_numpy() > 0)


def turns(cells: pd.DataFrame, keys: list[str]) -> Turns:
    """@param cells  of a tier and size class, a row per problem and solver"""
    own = cells[cells["solver"].isin(keys)]
    took_place = ran(own)
    # Who was stopped took all the time that there was; what a crash took is not known.
    ended = own["time_limit_s"].where(own["claim"].isin(OVER), 0.0)
    time = own["fresh_s"].fillna(own["first_s"]).fillna(ended).clip(upper=own["time_limit_s"])
    check = own["check_s"].fillna(0.0).where(took_place, 0.0)
    turn = (time + check).where(took_place, 0.0)
    problems = cells["problem"].unique()
    return Turns(*(own.assign(of=of).pivot(index="problem", columns="solver", values="of").reindex(index=problems, columns=keys)
                   .fillna(absent).astype(type(absent))
                   for of, absent in ((turn, 0.0), (check, 0.0), (np.isfinite(own["time_s"]), False))))


def portfolio_rows(cells: pd.DataFrame, keys: list[str], tier: float, levels: Levels) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Rows by problem, with the time that counts, what of it are checks, and as `solver` the code that was right; and the
    times by rounds, where all codes that had a turn have times in the round."""
    found = turns(cells, keys)
    asked = found.until_right()
    right = found.right.to_numpy().any(axis=1)
    last = found.right.to_numpy().argmax(axis=1)
    rows = cells.drop_duplicates("problem").set_index("problem")[_OF_PROBLEM].loc[found.right.index]
    rows["solver"] = np.array(keys, dtype=object)[last]
    rows["time_s"] = np.where(right, (found.turn_s.to_numpy() * asked).sum(axis=1), math.inf)
    rows["check_s"] = (found.check_s.to_numpy() * asked).sum(axis=1)
    of_codes = [levels.rounds(rows.assign(solver=key), tier) for key in keys]
    numbers = sorted(set().union(*(of.columns for of in of_codes)))
    total = np.zeros((len(rows), len(numbers)))
    for code, of in enumerate(of_codes):
        turn = of.reindex(columns=numbers).to_numpy() + found.check_s.to_numpy()[:, code, np.newaxis]
        total += np.where(asked[:, code, np.newaxis], turn, 0.0)
    return rows, pd.DataFrame(np.where(right[:, np.newaxis], total, math.nan), rows.index, numbers)


def best_order(cells: pd.DataFrame, keys: list[str]) -> list[str]:
    """Greedily: as long as that makes the mean less and there are MOST at most, the code and the place in the order that make
    it least. What is left of MOST is filled up from behind, for problems that these do not know: by the codes of other
    libraries, those that are right most often first.

    @param cells  of a tier and size class
    """
    found, about = turns(cells, keys), cells.drop_duplicates("problem")
    limits, weights = about["time_limit_s"].to_numpy(), about["weight"].to_numpy()
    shift = shift_of(cells[cells["solver"].isin(keys)])

    def mean(order: list[str]) -> float:
        part = Turns(*(of[order] for of in found))
        taken = (part.turn_s.to_numpy() * part.until_right()).sum(axis=1)
        return shifted_geometric_mean(np.where(part.right.any(axis=1), taken, np.maximum(taken, limits)), shift, weights)

    order: list[str] = []
    least = math.inf
    while len(order) < MOST and not math.isnan(shift):
        tried = [[*order[:place], key, *order[place:]] for key in keys if key not in order for place in range(len(order) + 1)]
        best = min(tried, key=mean, default=order)
        if not mean(best) < least:
            break
        order, least = best, mean(best)
    share = found.right.mul(weights, axis=0).sum()
    for key in sorted(keys, key=lambda key: (-share[key], mean([key]))):
        if len(order) < MOST and share[key] > 0 and _library(key) not in map(_library, order):
            order.append(key)
    return order


def _library(key: str) -> str:
    """Of a peer."""
    return key.split("-")[0]
