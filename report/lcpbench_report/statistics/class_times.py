"""What a user pays, by size class: every solver's fresh time, and how much it solves. Problems that count only.

Medians are of the class's weight, failures infinite: failing on the hard ones cannot lower them. Problems of a class take
very different times, so that intervals of medians are wide (launches, families, bases: launches.Levels, intervals.
Bootstrap); a median of ratios, problem by problem, is sharper: what is common to both times cancels. Where both solvers
have launches in the same rounds (launches.py), the ratio of a problem is the median of those of its rounds, the level of a
round is the weighted median over problems of log(ratio in the round / ratio of the problem), and resamples draw rounds
instead of the launches of either side: what is common to a round cancels too. Where the first
solver of a ratio is not verified it is infinite; where the second is not, the problem has none.

What a solver does not take as it is given is in none of its medians and shares here.
"""

import math
from collections.abc import Iterator

import numpy as np
import pandas as pd

from .cells import NOT_ASKED
from .coverage import OF_CAUSES, coverage
from .groups import GROUP, Part, groups
from .intervals import Bootstrap
from .launches import LEAST_ROUNDS, MEDIANS, Levels, levels_of
from .model import TASK_BUDGET
from .weighted import weighted_median

ALL = "all"  # the value of `size_class` for all problems
LEAST_FOR_P99 = 1000  # problems of a class
ROUNDS = "rounds"  # of all solvers alike: names their draws
_ENDS = ("", "_low", "_high")
_SHARES = [f"{share}{end}" for share in ("taken_share", "attempted_share", "verified_share", "verified_of_attempted") for end in _ENDS]
RATIO = [f"ratio{end}" for end in _ENDS]
COLUMNS = [*GROUP, "size_class", "solver", "asked", "problems", "weight", "n_eff", "launches", "not_asked", "attempted",
           "verified", "false_successes", *OF_CAUSES, "below_tier", "out_of_time", *_SHARES, "median_s", "median_low", "median_high", "p99_s", *MEDIANS]


def classes(cells: pd.DataFrame) -> Iterator[Part]:
    """Label and cells of every group of problems that count, by size class, and of all together: smallest class first,
    `all` last. Problems that had no turn within a task's budget are left out: their order is drawn by lot, so that the
    others are a fair sample, and a solver that takes long is not thereby wrong."""
    for label, cells in groups(cells, counted_only=True):
        cells = cells[cells["excluded"] != TASK_BUDGET]
        for size_class in cells.groupby("size_class")["rows"].min().sort_values().index:
            yield {**label, "size_class": size_class}, cells[cells["size_class"] == size_class]
        yield {**label, "size_class": ALL}, cells


def by_solver(cells: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Rows by problem, of those that the solver was asked."""
    cells = cells[cells["verdict"] != NOT_ASKED]
    return {solver: own.set_index("problem") for solver, own in cells.groupby("solver", sort=False)}


def fastest_of_each(cells: pd.DataFrame) -> pd.DataFrame:
    """The rows with the least time of every problem, by problem: inf where nobody is verified."""
    return cells.sort_values("time_s", kind="stable").drop_duplicates("problem").set_index("problem")


def ratio(first: pd.DataFrame, second: pd.DataFrame, tier: float, bootstrap: Bootstrap, levels: Levels,
          of_rounds: pd.DataFrame | None = None) -> dict:
    """RATIO: weighted median of the ratios of times by problem, with its interval, where the second is verified.

    @param first, second  rows by problem, with columns solver, size_class, weight and time_s; the second may be of several
                          solvers
    @param of_rounds  times of the second, where they are not those of its solvers
    """
    both = first.index.intersection(second.index[np.isfinite(second["time_s"])], sort=False)
    first, second = first.loc[both], second.loc[both]
    ratios, weights = first["time_s"] / second["time_s"], first["weight"]
    theirs = levels.rounds(second, tier) if of_rounds is None else of_rounds.loc[both]
    rounds = _rounds(first, levels.rounds(first, tier) / theirs)
    if rounds is not None:
        medians = rounds.median(axis=1)
        ratios = ratios.where(medians.isna() | np.isinf(ratios), medians)
        shift = levels.spread(levels_of(rounds.to_numpy().T, medians.to_numpy(), weights.to_numpy()), ROUNDS)
    else:
        over, under = (levels.shift(side["solver"].to_numpy(), side["size_class"], tier, weights) for side in (first, second))
        shift = over - under
    return dict(zip(RATIO, (weighted_median(ratios, weights), *bootstrap.median(both, ratios, weights, shift))))


def _rounds(first: pd.DataFrame, ratios: pd.DataFrame) -> pd.DataFrame | None:
    """Ratios of times, problems x rounds, NaN where a side has no time, or the first is not verified; of rounds in which most
    of the weight has both. None with fewer than LEAST_ROUNDS of these."""
    found = ratios.where(np.isfinite(first["time_s"]), axis=0)
    known = found.notna().mul(first["weight"], axis=0).sum()
    found = found.loc[:, known > first["weight"].where(np.isfinite(first["time_s"])).sum() / 2]
    return found if found.shape[1] >= LEAST_ROUNDS else None


def class_table(cells: pd.DataFrame, levels: Levels) -> pd.DataFrame:
    """A row per group, size class (and `all`) and solver. `p99_s` is of single solves of all launches; the medians of the
    second measure (`again_s`), of the solve that was judged and of the parts are of verified answers that were timed."""
    rows = []
    for label, of_class in classes(cells):
        bootstrap = Bootstrap(of_class)
        rows += [label | {"solver": solver} | _row(own.set_index("problem"), bootstrap, levels, (solver, label["size_class"], label["tier"]))
                 for solver, own in of_class.groupby("solver", sort=False)]
    return pd.DataFrame(rows, columns=COLUMNS)


def _row(cells: pd.DataFrame, bootstrap: Bootstrap, levels: Levels, key: tuple[str, str, float]) -> dict:
    """@param key  solver, size class and tier"""
    counts, solver, tier = coverage(cells), key[0], key[2]
    cells = cells[cells["verdict"] != NOT_ASKED]
    low, high = bootstrap.median(cells.index, cells["time_s"], cells["weight"],
                                 levels.shift(solver, cells["size_class"], tier, cells["weight"]))
    return counts | {"launches": levels.count(*key), "median_s": weighted_median(cells["time_s"], cells["weight"]),
                     "median_low": low, "median_high": high,
                     "p99_s": levels.together(*key, "p99_s") if len(cells) >= LEAST_FOR_P99 else math.nan,
                     **{name: levels.together(*key, name) for name in MEDIANS}}
