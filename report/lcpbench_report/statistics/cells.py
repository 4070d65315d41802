"""One row per cell (problem x solver x tier x mode): its verdict, its times, and the time that counts.

The time that counts, `time_s`, is the median of the solve's repetitions where the answer was verified, else inf.
"""

import math

import numpy as np
import pandas as pd
from scipy import stats

from .load import Campaign, CellRuns

VERIFIED = "verified"
FALSE_SUCCESS = "false success"
EXCLUDED = "excluded"
FAILED = "failed:"  # and the solver's claim
# Of answers; every one a column, empty where it is not known.
METRICS = ("rho", "backward_error", "gap_rel", "w_error", "f_error")
KEY = ["problem", "solver", "tier", "mode"]
_LEVELS = {"min": 0, "p25": 0.25, "median": 0.5, "p75": 0.75, "p90": 0.9, "p99": 0.99, "max": 1}
_CONFIDENCE = 0.95
LEAST_ROUNDS = 3  # for an interval of what differs between rounds

COLUMNS = ["set", "counts", "family", "problem", "rows", "reference", "solver", "tier", "mode", "verdict", "excluded",
           "claim", "passes", "at_floor", "false_success", "false_infeasible", "proved_infeasible", "best_tier", "iterations", *METRICS,
           "rounds", "rounds_changed", "rounds_disturbed", "repetitions", "setup_s", "convert_s", "first_s",
           "factor_share", "allocations_first", "allocations_later", *(f"solve_{level}" for level in _LEVELS),
           "solve_low", "solve_high", "time_s", "time_limit_s", "oracle_s", "oracle_ratio", "peak_bytes"]


def cell_table(campaign: Campaign) -> pd.DataFrame:
    """A row per cell, in the order of the file; columns COLUMNS. Times in seconds."""
    rows = [_row(campaign, *key, runs) for key, runs in campaign.cells.items()]
    return pd.DataFrame(rows, columns=COLUMNS)


def quantiles(values, prefix: str = "") -> dict[str, float]:
    """Smallest, quartiles, 90 and 99 per cent, largest of the values that are not NaN (linear interpolation between
    order statistics: Hyndman & Fan 1996, definition 7); NaN without any."""
    known = np.asarray(values, dtype=float)
    known = known[~np.isnan(known)]
    found = np.quantile(known, list(_LEVELS.values())) if len(known) else [math.nan] * len(_LEVELS)
    return dict(zip((prefix + name for name in _LEVELS), map(float, found)))


def median_interval(values) -> tuple[float, float]:
    """Confidence interval (95 %) of the median that holds for every distribution: the order statistics k and n + 1 - k
    with k the 2.5 % quantile of the binomial distribution (n, 1/2) (Conover 1999, section 3.2).

    With fewer than six values they are the smallest and the largest, and the confidence is less: 1 - 2^(1-n).
    """
    known = np.sort(np.asarray(values, dtype=float))
    if not len(known):
        return math.nan, math.nan
    k = max(int(stats.binom.ppf((1 - _CONFIDENCE) / 2, len(known), 0.5)), 1)
    return float(known[k - 1]), float(known[len(known) - k])


def time_interval(rounds: list[list[float]]) -> tuple[float, float]:
    """Confidence interval (95 %) of a cell's time. With LEAST_ROUNDS rounds or more Student's interval of the logarithms
    of their medians: what differs between rounds (clock rate, memory layout, neighbours) is common to all repetitions
    of one (Kalibera & Jones 2013). It is widened to the median of all repetitions where that lies outside. With fewer
    rounds the interval of the median of the repetitions, which says nothing about other rounds.

    @param rounds  times, a list for every round
    """
    times = [time for of_round in rounds for time in of_round]
    if len(rounds) < LEAST_ROUNDS:
        return median_interval(times)
    logs = np.log([np.median(of_round) for of_round in rounds])
    half = stats.t.ppf((1 + _CONFIDENCE) / 2, len(logs) - 1) * logs.std(ddof=1) / math.sqrt(len(logs))
    median = float(np.median(times))
    return min(math.exp(logs.mean() - half), median), max(math.exp(logs.mean() + half), median)


def verdict_of(record: dict) -> str:
    if record["excluded"]:
        return EXCLUDED
    if record["passes"]:
        return VERIFIED
    return FALSE_SUCCESS if record["false_success"] else FAILED + record["claim"]


def _row(campaign: Campaign, problem: str, solver: str, tier: float, mode: str, runs: CellRuns) -> dict:
    about, record = campaign.problems[problem], runs.record
    row = {key: about[key] for key in ("set", "counts", "family", "rows", "reference")}
    row |= {"problem": problem, "solver": solver, "tier": tier, "mode": mode, "verdict": verdict_of(record),
            "excluded": record["excluded"], "oracle_s": _number(about["oracle_s"]), "rounds": len(runs.rounds)}
    if record["excluded"]:
        limit = campaign.time_limit(about["rows"])
        return row | {"claim": "", "passes": False, "at_floor": False, "false_success": False,
                      "false_infeasible": False, "proved_infeasible": False, "rounds_changed": 0, "rounds_disturbed": 0, "repetitions": 0,
                      "time_s": math.inf, "time_limit_s": limit, "oracle_ratio": math.inf if about["oracle_s"] else math.nan}
    times = [time for round_times in runs.times() for time in round_times]
    low, high = time_interval(runs.times())
    row |= {key: record[key] for key in ("claim", "passes", "at_floor", "false_success", "false_infeasible")}
    row["proved_infeasible"] = record.get("proved_infeasible", False)  # older folders do not say
    row |= {key: _number(record[key]) for key in ("best_tier", "iterations", "peak_bytes")}
    row |= {metric: _number(record["metrics"].get(metric)) for metric in METRICS}
    row |= {"rounds_changed": runs.changed, "rounds_disturbed": len(runs.disturbed), "repetitions": len(times), "setup_s": _median(runs.setup_s),
            "convert_s": _median(runs.convert_s), "solve_low": low, "solve_high": high,
            "time_limit_s": record["time_limit_s"]} | quantiles(times, "solve_")
    allocations = record.get("allocations") or {}
    row |= {f"allocations_{which}": _number(allocations.get(which)) for which in ("first", "later")}
    row["first_s"] = _number(record.get("first_s"))
    row["factor_share"] = _number(record.get("factor_s")) / (record.get("factor_of_s") or math.nan)
    row["time_s"] = row["solve_median"] if record["passes"] else math.inf
    row["oracle_ratio"] = row["time_s"] / row["oracle_s"]
    return row


def _number(value: float | None) -> float:
    return math.nan if value is None else float(value)


def _median(values: list[float]) -> float:
    return float(np.median(values)) if values else math.nan
