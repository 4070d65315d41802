"""One row per cell (problem x solver x tier): its verdict, its times, and the time that counts.

The time that counts, `time_s`, is the fresh time where the answer was verified, else inf: from the caller's arrays to
f, the median over the launches. Where a verified problem was not timed, for the task's budget was spent, it is the time
of the solve that was judged.
"""

import math
from typing import NamedTuple

import numpy as np
import pandas as pd

from .launches import COLUMNS as LAUNCH_COLUMNS
from .launches import KEY as KEY_OF_LAUNCHES
from .model import DEFAULT, FLAGS, JUDGED, LAWS, METRICS, NOT_ASKED, PART_TIMES, UNSUPPORTED, Campaign, Task

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
_TIMES = ("fresh_s", *PART_TIMES, "again_s")
COLUMNS = [*_ABOUT, "solver", "tier", "verdict", "asked", "excluded", "claim", *FLAGS, "best_tier", "iterations",
           *METRICS, *LAWS, "timed", "disturbed", *_TIMES, "first_s", "factor_share", "time_s", "time_limit_s",
           "oracle_s", "oracle_ratio", "peak_bytes"]
# Kind of array -> columns of tasks.
_KINDS = {bool: (*FLAGS, "changed"), object: ("excluded", "claim"), int: ("timed", "disturbed"),
          float: (*JUDGED, *LAWS, "peak_bytes", *_TIMES)}


class Measured(NamedTuple):
    cells: pd.DataFrame  # COLUMNS
    launches: pd.DataFrame  # launches.COLUMNS


def cell_table(campaign: Campaign) -> pd.DataFrame:
    return measured(campaign).cells


def measured(campaign: Campaign) -> Measured:
    """A row per cell, and one per solver, size class, tier and launch, times in seconds.

    Whole columns at a time: a campaign has a million cells."""
    solvers = campaign.solvers
    tasks = campaign.tasks
    counts = [len(task.at) for task in tasks]
    columns = _about(campaign, tasks)
    columns["solver"] = np.repeat(np.array([task.solver for task in tasks], dtype=object), counts)
    columns["tier"] = np.repeat(np.array([task.tier for task in tasks], dtype=float), counts)
    columns["asked"] = np.repeat([solvers[task.solver]["tolerance"] != DEFAULT for task in tasks], counts).astype(bool)
    columns["time_limit_s"] = campaign.time_limit(columns["rows"])
    for kind, names in _KINDS.items():
        columns |= {name: np.concatenate([np.empty(0, kind), *(task.columns.get(name, np.full(len(task.at), math.nan))
                                                               for task in tasks)]) for name in names}
    lost = columns.pop("changed") & columns["passes"]
    columns["passes"] &= ~lost
    # Where a solver passes the problem at the tier, no rounding floor of the problem is in the way.
    cells = pd.DataFrame({key: columns[key] for key in ("problem", "tier", "passes")})
    columns["below_floor"] &= ~cells.groupby(["problem", "tier"])["passes"].transform("any").to_numpy(dtype=bool)
    columns["verdict"] = _verdicts(columns)
    columns["verdict"][lost] = CHANGED
    columns["time_s"] = np.where(columns["passes"], np.where(np.isnan(columns["fresh_s"]), columns["first_s"],
                                                             columns["fresh_s"]), math.inf)
    columns["oracle_ratio"] = columns["time_s"] / columns["oracle_s"]
    launches = [dict(zip(KEY_OF_LAUNCHES, (task.solver, task.size_class, task.tier))) | row
                for task in tasks for row in task.launches]
    return Measured(pd.DataFrame(columns, columns=COLUMNS), pd.DataFrame(launches, columns=LAUNCH_COLUMNS))


def _about(campaign: Campaign, tasks: list[Task]) -> dict[str, np.ndarray]:
    """What is known of the problems, by row."""
    numbers = {name: index for index, name in enumerate(campaign.problems)}
    by_class = {key: np.array([numbers[name] for name in names], dtype=int) for key, names in campaign.classes.items()}
    rows = [by_class[task.size_class][task.at] for task in tasks]
    order = np.concatenate(rows) if rows else np.empty(0, dtype=int)
    records = list(campaign.problems.values())
    columns = {}
    for key in _ABOUT:
        values = [record[key] for record in records]
        texts = bool(values) and isinstance(values[0], str)
        columns[key] = np.array(values, dtype=object if texts else float if key == "weight" else None)[order]
    columns["oracle_s"] = np.array([record["oracle_s"] for record in records], dtype=float)[order]
    return columns


def _verdicts(columns: dict[str, np.ndarray]) -> np.ndarray:
    failed = np.array([FAILED + claim for claim in columns["claim"]], dtype=object)
    return np.select([columns["excluded"] != "", columns["passes"], columns["false_success"],
                      columns["claim"] == UNSUPPORTED],
                     [EXCLUDED, VERIFIED, np.where(columns["asked"], FALSE_SUCCESS, BELOW_TIER), NOT_ASKED], failed)


def within_rounding(cells: pd.DataFrame) -> pd.Series:
    """Called infeasible by a ray that holds within rounding only, and no solution is known."""
    return cells["infeasible_within_rounding"].astype(bool) & ~cells["false_infeasible"].astype(bool)
