"""Reads streams.jsonl, and makes of its lines what a compact record has: columns of the table of cells, and launches."""

import math
from pathlib import Path

import numpy as np
import pandas as pd

from ..errors import ReportError
from .fields import check_fields, check_numbers, check_places, check_record, check_word
from .jsonl import read_lines
from .launches import MEDIANS, flagged, launch_rows, levels_of, without
from .model import (AGAIN, FLAGS, FRESH, JUDGE, JUDGED, KINDS, LAWS, OUT, PART_TIMES, PARTS, TASK_BUDGET, UNSUPPORTED, Campaign,
                    Task)


class _Run:
    """A solver on a size class at a tier, whose lines come part by part. Arrays have an entry for each problem of the
    class, NaN where there is none."""

    def __init__(self, problems: int):
        self.rules: dict[tuple[int, int], str] = {}  # first and count of a part -> the rule that excludes it, or ""
        self.columns: dict[str, np.ndarray] = {key: np.full(problems, math.nan) for key in (*JUDGED, *LAWS, "peak_bytes")}
        self.columns |= {key: np.zeros(problems, dtype=bool) for key in FLAGS}
        self.columns |= {key: np.full(problems, "", dtype=object) for key in ("excluded", "claim")}
        self.details: dict[int, str] = {}
        self.seen: set[tuple] = set()  # kind and number of a pass, and its part
        self.times: dict[str, dict[int, np.ndarray]] = {key: {} for key in ("fresh_s", *PART_TIMES, "again_s")}  # by number
        self.began: dict[int, float] = {}  # number of a launch -> seconds since 1970
        self.failed = {kind: np.zeros(problems, dtype=bool) for kind in (FRESH, AGAIN)}  # the answer changed in a pass

    def of_passes(self, key: str, at: np.ndarray) -> np.ndarray:
        """Passes x problems."""
        found = self.times[key]
        return np.array([found[number][at] for number in sorted(found)]).reshape(len(found), len(at))


def read_streams(path: Path, campaign: Campaign) -> list[Task]:
    """Passes may come before the judge line of their problems: processes that share a folder end as they like.

    @throws ReportError for the first thing that does not fit
    """
    runs: dict[tuple, _Run] = {}
    passes: list[tuple[str, dict, tuple, tuple[int, int]]] = []
    for place, line in read_lines(path, campaign.notes.append):
        record = check_record(place, line, "line")
        check_word(place, record, "kind", KINDS)
        key, first, count = campaign.run_of(place, record)
        if record["kind"] != JUDGE:
            passes.append((place, record, key, (first, count)))
            continue
        run = runs.setdefault(key, _Run(len(campaign.classes[key[1]])))
        if any(begin < first + count and first < begin + others for begin, others in run.rules):
            raise ReportError(place, "a problem of this task is judged twice", "a judge line per task")
        _judge(place, record, run, first, count)
    for place, record, key, part in passes:
        if key not in runs or part not in runs[key].rules:
            raise ReportError(place, "the task has no judge line", "one for every task")
        _add_pass(place, record, runs[key], part)
    return [_task(key, run, [campaign.problems[name] for name in campaign.classes[key[1]]]) for key, run in runs.items()]


def _judge(place: str, record: dict, run: _Run, first: int, count: int) -> None:
    if record["pass"] != 0:
        raise ReportError(place, f"key 'pass' is {record['pass']}", "0 where the kind is judge")
    columns, rule = run.columns, record["excluded"]
    run.rules[first, count] = rule
    if rule:
        columns["excluded"][first:first + count] = rule
        return
    check_record(place, record, "judge", "attempted", "peak_bytes", "exceptions")
    attempted = int(record["attempted"])
    if attempted > count:
        raise ReportError(place, f"key 'attempted' is {attempted}", f"{count}, the key 'count', at most")
    had_turn = slice(first, first + attempted)
    for key in (*JUDGED, *(key for key in LAWS if key in record)):
        columns[key][had_turn] = check_numbers(place, record, "judge", key, attempted)
    columns["peak_bytes"][first:first + count] = math.nan if record["peak_bytes"] is None else record["peak_bytes"]
    columns["excluded"][had_turn.stop:first + count] = TASK_BUDGET
    columns["claim"][had_turn], columns["passes"][had_turn] = "solved", True
    _except(f"{place}: exceptions", record["exceptions"], run, first, attempted)
    # It may be the only time of a problem: ratios and logarithms are made of it.
    if not (columns["first_s"][had_turn][columns["passes"][had_turn]] > 0).all():
        raise ReportError(place, "key 'first_s' has none", "a number > 0 where a solve passes")


def _except(place: str, exceptions: list, run: _Run, first: int, attempted: int) -> None:
    """What is not plainly solved and verified."""
    check_places(place, [check_fields(place, one, {"at": "count"})["at"] for one in exceptions], attempted)
    for one in exceptions:
        at, out = first + one["at"], one.get("claim") == OUT
        check_record(f"{place} at {one['at']}", one, "exception", *(("claim", "passes", "reason") * out))
        for key in ("claim", *FLAGS):
            run.columns[key][at] = False if out else one.get(key, False)
        if out:
            run.columns["excluded"][at], run.columns["claim"][at] = one["reason"], ""
        run.details[at] = one.get("detail", "")


def _add_pass(place: str, record: dict, run: _Run, part: tuple[int, int]) -> None:
    kind, number, (first, count) = record["kind"], int(record["pass"]), part
    if number < 1:
        raise ReportError(place, f"key 'pass' is {number}", f"1 or more where the kind is {kind}")
    if (kind, number, part) in run.seen:
        raise ReportError(place, f"pass {number} of this kind and task is there twice", "a line per task and pass")
    run.seen.add((kind, number, part))
    if run.rules[part]:
        raise ReportError(place, f"the task is excluded: {run.rules[part]}", "no pass of it")
    problems = len(run.columns["claim"])
    for key in PART_TIMES if kind == PARTS else (f"{kind}_s",):
        times = run.times[key].setdefault(number, np.full(problems, math.nan))
        times[first:first + count] = check_numbers(place, record, kind, key, count)
    if kind == PARTS:
        return
    check_record(place, record, kind, "failed")
    failed = check_places(f"{place}: failed", record["failed"], count)
    run.failed[kind][first + np.array(failed, dtype=int)] = True
    if kind == FRESH:
        check_record(place, record, kind, "disturbance", "began_s")
        if record["disturbance"] is not None:
            check_record(f"{place}: disturbance", record["disturbance"], "disturbance", "disturbed")
        run.began.setdefault(number, record["began_s"])


def _task(key: tuple[str, str, float], run: _Run, problems: list[dict]) -> Task:
    """@param problems  of the class"""
    at = np.concatenate([np.arange(first, first + count) for first, count in run.rules])
    columns = {name: values[at] for name, values in run.columns.items()}
    numbers, fresh = sorted(run.began), run.of_passes("fresh_s", at)
    columns |= {"timed": (~np.isnan(fresh)).sum(axis=0), "changed": run.failed[FRESH][at],
                **{name: median_of_passes(run.of_passes(name, at)) for name in (*PART_TIMES, "again_s")}}
    columns["again_s"][run.failed[AGAIN][at]] = math.inf
    of, weights, passes = judged(columns, [problems[number] for number in at])
    levels = levels_of(np.where(passes, fresh, math.nan)[:, of], median_of_passes(fresh)[of], weights[of])
    off = flagged(levels)
    columns |= {"fresh_s": median_of_passes(without(fresh, off)), "flagged": (~np.isnan(fresh[off])).sum(axis=0)}
    launches = launch_rows(numbers, fresh[:, of], levels, off, passes[of], weights[of],
                           {name: columns[name][of] for name in MEDIANS}, run.began)
    spent = sum(np.nansum(times) for of_key in run.times.values() for times in of_key.values())
    times = pd.DataFrame(fresh.T, columns=numbers)
    return Task(*key, at, columns, launches, times, float(np.nansum(columns["first_s"]) + spent), run.details)


def judged(columns: dict[str, np.ndarray], problems: list[dict]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of cells of a solver on a size class: whether it was given the problem and that counts (all of a class that has none),
    the weight, and whether it is verified.

    @param columns   of the table of cells, and "changed"
    @param problems  of every cell
    """
    passes = columns["passes"] & ~columns["changed"]
    unasked = (columns["claim"] == UNSUPPORTED) & ~passes & ~columns["false_success"]
    counts, weights = (np.array([problem[name] for problem in problems]) for name in ("counts", "weight"))
    return ((columns["excluded"] == "") & ~unasked & (counts.astype(bool) if counts.any() else True), weights.astype(float), passes)


def median_of_passes(times: np.ndarray) -> np.ndarray:
    """@param times  passes x cells, NaN: none
    @returns of every cell the median of what it has, NaN without any
    """
    if not len(times):
        return np.full(times.shape[1], math.nan)
    ordered, known, cells = np.sort(times, axis=0), (~np.isnan(times)).sum(axis=0), np.arange(times.shape[1])
    return (ordered[np.maximum(known - 1, 0) // 2, cells] + ordered[np.minimum(known // 2, len(times) - 1), cells]) / 2
