"""One row per cell (problem x solver x tier): its verdict, its times, and the time that counts.

The time that counts, `time_s`, is the fresh time where the answer was verified, else inf: from the caller's arrays to
f, the median over the launches. Where a verified problem was not timed, for the task's budget was spent, it is the time
of the solve that was judged.
"""

import math
from typing import NamedTuple

import numpy as np
import pandas as pd

from .launches import launch_table
from .load import AGAIN, DEFAULT, FRESH, JUDGED, LAWS, METRICS, OUT, PART_TIMES, PARTS, TASK_BUDGET, Campaign, Task
from .steps import NOT_ASKED, UNSUPPORTED

VERIFIED = "verified"
FALSE_SUCCESS = "false success"
# For a solver that was not asked for this tier's tolerance: it takes its library's own one.
BELOW_TIER = "below the tier"
EXCLUDED = "excluded"
NOT_RUN = (EXCLUDED, NOT_ASKED)
FAILED = "failed:"  # and the solver's claim
CHANGED = FAILED + "changed"  # verified by itself, and not in a timed pass
KEY = ["problem", "solver", "tier"]

_ABOUT = ("set", "counts", "base", "weight", "origin", "fill", "family", "problem", "rows", "friction", "bounded",
          "size_class", "reference", "reference_status")
FLAGS = ("passes", "at_floor", "below_floor", "false_success", "false_infeasible", "proved_infeasible",
          "infeasible_within_rounding")
_TIMES = ("fresh_s", *PART_TIMES, "again_s")
COLUMNS = [*_ABOUT, "solver", "tier", "verdict", "asked", "excluded", "claim", *FLAGS, "best_tier", "iterations",
           *METRICS, *LAWS, "timed", "disturbed", *_TIMES, "first_s", "factor_share", "time_s", "time_limit_s",
           "oracle_s", "oracle_ratio", "peak_bytes"]


class Measured(NamedTuple):
    cells: pd.DataFrame  # COLUMNS
    launches: pd.DataFrame  # launches.COLUMNS


def cell_table(campaign: Campaign, of_ablations: bool = False) -> pd.DataFrame:
    return measured(campaign, of_ablations).cells


def measured(campaign: Campaign, of_ablations: bool = False) -> Measured:
    """A row per cell, and one per solver, size class, tier and launch, times in seconds; without the solvers of
    ablations, or of those alone.

    Whole columns at a time: a campaign has a million cells."""
    solvers = campaign.solvers
    tasks = [task for task in campaign.tasks if bool(solvers[task.solver]["ablation"]) == of_ablations]
    counts = [task.count for task in tasks]
    ends = np.cumsum([0, *counts])
    places = [slice(low, high) for low, high in zip(ends, ends[1:])]
    columns = _about(campaign, tasks)
    columns["solver"] = np.repeat(np.array([task.solver for task in tasks], dtype=object), counts)
    columns["tier"] = np.repeat(np.array([task.tier for task in tasks], dtype=float), counts)
    columns["asked"] = np.repeat([solvers[task.solver]["tolerance"] != DEFAULT for task in tasks], counts).astype(bool)
    columns["peak_bytes"] = np.repeat(np.array([task.peak_bytes for task in tasks]), counts)
    columns |= _judged(tasks, places, ends[-1])
    fresh, disturbed = _passes(tasks, places, ends[-1], FRESH, "fresh_s")
    columns |= _timed(tasks, places, fresh, disturbed)
    columns["time_limit_s"] = campaign.time_limit(columns["rows"])
    lost = np.zeros(ends[-1], dtype=bool)
    for task, place in zip(tasks, places):
        for name, values in task.columns.items():
            (lost if name == CHANGED else columns[name])[place] = values
        for one in task.passes.get(FRESH, {}).values():
            lost[place.start + np.array(one.failed, dtype=int)] = True
    lost &= columns["passes"]
    columns["passes"] &= ~lost
    columns["below_floor"] &= ~_passed_by_any(columns)
    columns["verdict"] = _verdicts(columns)
    columns["verdict"][lost] = CHANGED
    columns["time_s"] = np.where(columns["passes"], np.where(np.isnan(columns["fresh_s"]), columns["first_s"],
                                                             columns["fresh_s"]), math.inf)
    columns["oracle_ratio"] = columns["time_s"] / columns["oracle_s"]
    columns["given"] = ~np.isin(columns["verdict"], NOT_RUN)
    return Measured(pd.DataFrame(columns, columns=COLUMNS), launch_table(columns, fresh, disturbed, tasks, places))


def _passed_by_any(columns: dict[str, np.ndarray]) -> np.ndarray:
    """Whether a solver passes the cell's problem at its tier: then no rounding floor of the problem is in the way."""
    cells = pd.DataFrame({key: columns[key] for key in ("problem", "tier", "passes")})
    return cells.groupby(["problem", "tier"])["passes"].transform("any").to_numpy(dtype=bool)


def _about(campaign: Campaign, tasks: list[Task]) -> dict[str, np.ndarray]:
    """What is known of the problems, by row."""
    numbers = {name: index for index, name in enumerate(campaign.problems)}
    by_class = {key: np.array([numbers[name] for name in names], dtype=int) for key, names in campaign.classes.items()}
    rows = [by_class[task.size_class][task.first:task.first + task.count] for task in tasks]
    order = np.concatenate(rows) if rows else np.empty(0, dtype=int)
    records = list(campaign.problems.values())
    columns = {}
    for key in _ABOUT:
        values = [record[key] for record in records]
        texts = bool(values) and isinstance(values[0], str)
        columns[key] = np.array(values, dtype=object if texts else float if key == "weight" else None)[order]
    columns["oracle_s"] = np.array([record["oracle_s"] for record in records], dtype=float)[order]
    return columns


def _judged(tasks: list[Task], places: list[slice], total: int) -> dict[str, np.ndarray]:
    columns: dict[str, np.ndarray] = {key: np.full(total, math.nan) for key in (*JUDGED, *LAWS)}
    columns |= {key: np.zeros(total, dtype=bool) for key in FLAGS}
    columns |= {key: np.full(total, "", dtype=object) for key in ("excluded", "claim")}
    for task, place in zip(tasks, places):
        if task.columns:
            continue
        run = slice(place.start, place.start + task.attempted)
        columns["excluded"][run.stop:place.stop] = task.excluded or TASK_BUDGET
        columns["claim"][run] = "solved"
        columns["passes"][run] = True
        for key, values in task.judged.items():
            columns[key][run] = values
        out, other = ([one for one in task.exceptions if (one["claim"] == OUT) == is_out] for is_out in (True, False))
        at = [place.start + one["at"] for one in other]
        for key in ("claim", *FLAGS) if other else ():
            columns[key][at] = [one.get(key, False) for one in other]
        for one in out:
            row = place.start + one["at"]
            columns["excluded"][row], columns["claim"][row], columns["passes"][row] = one["reason"], "", False
    return columns


def _timed(tasks: list[Task], places: list[slice], fresh: np.ndarray, disturbed: np.ndarray) -> dict[str, np.ndarray]:
    known = ~np.isnan(fresh)
    columns = {"timed": known.sum(axis=0), "disturbed": (known & disturbed).sum(axis=0)}
    # Launches that the machine disturbed are left out where there are others.
    calm = known & ~disturbed
    columns["fresh_s"] = median_of_passes(np.where(calm | ~calm.any(axis=0), fresh, math.nan))
    total = fresh.shape[1]
    for key in PART_TIMES:
        columns[key] = median_of_passes(_passes(tasks, places, total, PARTS, key)[0])
    columns["again_s"] = median_of_passes(_passes(tasks, places, total, AGAIN, "again_s")[0])
    for task, place in zip(tasks, places):
        for one in task.passes.get(AGAIN, {}).values():
            columns["again_s"][place.start + np.array(one.failed, dtype=int)] = math.inf
    return columns


def _passes(tasks: list[Task], places: list[slice], total: int, kind: str, key: str) -> tuple[np.ndarray, np.ndarray]:
    """Launches, by their numbers, x rows: times, and whether the machine disturbed the launch."""
    numbers = {number: index for index, number in enumerate(sorted({n for task in tasks for n in task.passes.get(kind, ())}))}
    times, disturbed = np.full((len(numbers), total), math.nan), np.zeros((len(numbers), total), dtype=bool)
    for task, place in zip(tasks, places):
        for number, one in task.passes.get(kind, {}).items():
            times[numbers[number], place] = one.times[key]
            disturbed[numbers[number], place] = one.disturbed
    return times, disturbed


def _verdicts(columns: dict[str, np.ndarray]) -> np.ndarray:
    failed = np.array([FAILED + claim for claim in columns["claim"]], dtype=object)
    return np.select([columns["excluded"] != "", columns["passes"], columns["false_success"],
                      columns["claim"] == UNSUPPORTED],
                     [EXCLUDED, VERIFIED, np.where(columns["asked"], FALSE_SUCCESS, BELOW_TIER), NOT_ASKED], failed)


def within_rounding(cells: pd.DataFrame) -> pd.Series:
    """Called infeasible by a ray that holds within rounding only, and no solution is known."""
    return cells["infeasible_within_rounding"].astype(bool) & ~cells["false_infeasible"].astype(bool)


def median_of_passes(times: np.ndarray) -> np.ndarray:
    """@param times  passes x cells, NaN: none
    @returns of every cell the median of what it has, NaN without any
    """
    if not len(times):
        return np.full(times.shape[1], math.nan)
    ordered, known, cells = np.sort(times, axis=0), (~np.isnan(times)).sum(axis=0), np.arange(times.shape[1])
    return (ordered[np.maximum(known - 1, 0) // 2, cells] + ordered[np.minimum(known // 2, len(times) - 1), cells]) / 2
