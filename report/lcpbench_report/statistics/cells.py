"""One row per cell (problem x solver x tier): its verdict, its times, and the time that counts.

The time that counts, `time_s`, is the fresh time where the answer was verified, else inf: from the caller's arrays to
f, the median over the launches. Where a verified problem was not timed, for the task's budget was spent, it is the time
of the solve that was judged.

One rule of time for all: an answer is right only if the solve that was judged, and the fresh time, took no longer than the
limit of the size class. OUT_OF_TIME are those that took longer (`late`), that were ended there, and that a rule excludes
because the solver was out of time at a looser tier.

False successes have a cause: the solver shifts the diagonal on purpose (campaign.json, `shifted`); refused by the backward
error alone, rho being within the tier (`eta`); rho within NEAR times the tier (`near`): another measure, or a tolerance of
its own, was reached; or further off (`far`). Those that are far, of solvers that are not shifted, are what sentences call
false.
"""

import math
from typing import NamedTuple

import numpy as np
import pandas as pd

from .launches import COLUMNS as LAUNCH_COLUMNS
from .launches import KEY as KEY_OF_LAUNCHES
from .model import (DEFAULT, FLAGS, JUDGED, LAWS, METRICS, NOT_ASKED, OUT_OF_TIME_RULE, OVER, PART_TIMES, UNSUPPORTED, Campaign,
                    Task)

VERIFIED = "verified"
FALSE_SUCCESS = "false success"
# For a solver that was not asked for this tier's tolerance: it takes its library's own one.
BELOW_TIER = "below the tier"
EXCLUDED = "excluded"
OUT_OF_TIME = "out of time"
CAUSES = SHIFTED, ETA, CLOSE, FAR = ("shifted", "eta", "near", "far")
NEAR = 10  # tiers
FAILED = "failed:"  # and the solver's claim
CHANGED = FAILED + "changed"  # verified by itself, and not in a timed pass
KEY = ["problem", "solver", "tier"]

_ABOUT = ("set", "counts", "base", "weight", "origin", "fill", "family", "problem", "rows", "friction", "bounded",
          "size_class", "reference", "reference_status", "sealed")
_TIMES = ("fresh_s", *PART_TIMES, "again_s")
COLUMNS = [*_ABOUT, "solver", "tier", "verdict", "cause", "asked", "excluded", "claim", *FLAGS, "best_tier", "iterations",
           *METRICS, *LAWS, "timed", "flagged", *_TIMES, "first_s", "factor_share", "late", "time_s", "time_limit_s",
           "oracle_s", "oracle_ratio", "check_s", "peak_bytes"]
# Kind of array -> columns of tasks.
_KINDS = {bool: (*FLAGS, "changed", "late"), object: ("excluded", "claim"), int: ("timed", "flagged"),
          float: (*JUDGED, *LAWS, "peak_bytes", *_TIMES)}
_ROUNDED = 1.0025  # of times: compact records have steps of half a per cent
_ABSENT = {bool: False, object: "", int: 0, float: math.nan}


class Measured(NamedTuple):
    cells: pd.DataFrame  # COLUMNS
    launches: pd.DataFrame  # launches.COLUMNS
    # Solver, size class and tier -> problems x numbers of launches: fresh times, NaN where there is none.
    times: dict[tuple[str, str, float], pd.DataFrame]
    first_round: int = 1  # the launch from which on those of a number are a round (Campaign.first_round)

    @property
    def rounds(self) -> dict[tuple[str, str, float], pd.DataFrame]:
        """Of `times` what is of rounds."""
        return {key: of.loc[:, of.columns >= self.first_round] for key, of in self.times.items()}


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
        columns |= {name: np.concatenate([np.empty(0, kind), *(task.columns.get(name, np.full(len(task.at), _ABSENT[kind]))
                                                               for task in tasks)]) for name in names}
    taken = np.fmax(columns["first_s"], columns["fresh_s"])
    over = columns["late"] | (taken > _ROUNDED * columns["time_limit_s"])
    columns["late"] = columns["passes"] & over
    lost = columns.pop("changed") & columns["passes"] & ~columns["late"]
    columns["passes"] &= ~lost & ~columns["late"]
    # Where a solver passes the problem at the tier, no rounding floor of the problem is in the way.
    cells = pd.DataFrame({key: columns[key] for key in ("problem", "tier", "passes")})
    columns["below_floor"] &= ~cells.groupby(["problem", "tier"])["passes"].transform("any").to_numpy(dtype=bool)
    columns["verdict"] = _verdicts(columns, over)
    columns["verdict"][lost] = CHANGED
    shifted = np.repeat(np.array([solvers[task.solver]["shifted"] for task in tasks], dtype=bool), counts)
    columns["cause"] = _causes(columns, shifted)
    columns["time_s"] = np.where(columns["passes"], np.where(np.isnan(columns["fresh_s"]), columns["first_s"],
                                                             columns["fresh_s"]), math.inf)
    columns["oracle_ratio"] = columns["time_s"] / columns["oracle_s"]
    launches = [dict(zip(KEY_OF_LAUNCHES, (task.solver, task.size_class, task.tier))) | row
                for task in tasks for row in task.launches]
    times: dict[tuple, list[pd.DataFrame]] = {}
    for task in tasks:
        if task.times is not None:
            names = np.array(campaign.classes[task.size_class], dtype=object)
            times.setdefault((task.solver, task.size_class, task.tier), []).append(task.times.set_axis(names[task.at]))
    return Measured(pd.DataFrame(columns, columns=COLUMNS), pd.DataFrame(launches, columns=LAUNCH_COLUMNS),
                    {key: pd.concat(parts) for key, parts in times.items()}, campaign.first_round)


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
    columns |= {key: np.array([record[key] for record in records], dtype=float)[order] for key in ("oracle_s", "check_s")}
    return columns


def _verdicts(columns: dict[str, np.ndarray], late: np.ndarray) -> np.ndarray:
    """@param late  what took longer than the limit, right or not"""
    failed = np.array([FAILED + claim for claim in columns["claim"]], dtype=object)
    by_rule = np.array([rule.startswith(OUT_OF_TIME_RULE) for rule in columns["excluded"]], dtype=bool)
    over = late | by_rule | (np.isin(columns["claim"], OVER) & ~columns["passes"])
    return np.select([(columns["excluded"] != "") & ~by_rule, columns["passes"], columns["false_success"] & ~by_rule, over,
                      columns["claim"] == UNSUPPORTED],
                     [EXCLUDED, VERIFIED, np.where(columns["asked"], FALSE_SUCCESS, BELOW_TIER), OUT_OF_TIME, NOT_ASKED], failed)


def _causes(columns: dict[str, np.ndarray], shifted: np.ndarray) -> np.ndarray:
    """Of FALSE_SUCCESS one of CAUSES, else "". An answer of another model is measured by that, if it is better there."""
    with np.errstate(over="ignore"):  # forces of 1e300 are far off, and 1e-5 / 1e-6 is above 10
        off = np.round(np.fmin(columns["rho"], columns["model_rho"]) / columns["tier"], 9)
    found = np.select([shifted, off <= 1, off <= NEAR], [SHIFTED, ETA, CLOSE], FAR)
    return np.where(columns["verdict"] == FALSE_SUCCESS, found, "").astype(object)


def ran(cells: pd.DataFrame) -> pd.Series:
    """What took place: neither excluded by a rule, also by one of time, nor not asked."""
    return (cells["excluded"] == "") & (cells["verdict"] != NOT_ASKED)


def within_rounding(cells: pd.DataFrame) -> pd.Series:
    """Called infeasible by a ray that holds within rounding only, and no solution is known."""
    return cells["infeasible_within_rounding"].astype(bool) & ~cells["false_infeasible"].astype(bool)
