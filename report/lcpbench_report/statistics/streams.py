"""Reads streams.jsonl, and makes of its lines what a compact record has: columns of the table of cells, and launches."""

import math
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..errors import ReportError
from .fields import check_fields, check_numbers, check_places, check_record, check_word
from .jsonl import read_lines
from .launches import launch_rows
from .model import (AGAIN, FLAGS, FRESH, JUDGE, JUDGED, KINDS, LAWS, OUT, PART_TIMES, PARTS, TASK_BUDGET, UNSUPPORTED, Campaign,
                    Task)


@dataclass
class _Pass:
    """Arrays have an entry for each problem, NaN where there is none."""

    times: dict[str, np.ndarray]  # name of the array -> [s]
    failed: list[int]  # problems whose answer changed, and is not verified
    disturbed: bool = False  # by the machine, also when run again


@dataclass
class _Part:
    """Consecutive problems of a task, as they were run."""

    first: int
    count: int
    excluded: str = ""  # the rule, where it was not run
    attempted: int = 0  # so many of its problems had their turn
    judged: dict[str, np.ndarray] = field(default_factory=dict)  # JUDGED, some LAWS -> of the attempted ones
    exceptions: list[dict] = field(default_factory=list)  # what is not plainly solved and verified, by `at`
    peak_bytes: float = math.nan
    passes: dict[str, dict[int, _Pass]] = field(default_factory=dict)  # kind -> number of the launch -> pass


def read_streams(path: Path, campaign: Campaign) -> list[Task]:
    """Passes may come before the judge line of their problems: processes that share a folder end as they like.

    @throws ReportError for the first thing that does not fit
    """
    classes = {key: [campaign.problems[name] for name in names] for key, names in campaign.classes.items()}
    seen: dict[tuple, set[int]] = {}
    tasks: dict[tuple, dict[tuple[int, int], _Part]] = {}
    passes: list[tuple[str, dict, tuple, tuple[int, int]]] = []
    for place, line in read_lines(path, campaign.notes.append):
        record = check_record(place, line, "line")
        check_word(place, record, "kind", KINDS)
        key, first, count = campaign.run_of(place, record)
        if record["kind"] != JUDGE:
            passes.append((place, record, key, (first, count)))
            continue
        if not seen.setdefault(key, set()).isdisjoint(range(first, first + count)):
            raise ReportError(place, "a problem of this task is judged twice", "a judge line per task")
        seen[key].update(range(first, first + count))
        tasks.setdefault(key, {})[first, count] = _judged(place, record, _Part(first, count))
    for place, record, key, part in passes:
        if part not in tasks.get(key, {}):
            raise ReportError(place, "the task has no judge line", "one for every task")
        _add_pass(place, record, tasks[key][part])
    return [_task(Task(*key, np.concatenate([np.arange(of.first, of.first + of.count) for of in parts.values()])),
                  list(parts.values()), classes[key[1]]) for key, parts in tasks.items()]


def _judged(place: str, record: dict, part: _Part) -> _Part:
    if record["pass"] != 0:
        raise ReportError(place, f"key 'pass' is {record['pass']}", "0 where the kind is judge")
    part.excluded = record["excluded"]
    if part.excluded:
        return part
    check_record(place, record, "judge", "attempted", "peak_bytes", "exceptions")
    part.attempted = int(record["attempted"])
    if part.attempted > part.count:
        raise ReportError(place, f"key 'attempted' is {part.attempted}", f"{part.count}, the key 'count', at most")
    for key in (*JUDGED, *(key for key in LAWS if key in record)):
        part.judged[key] = check_numbers(place, record, "judge", key, part.attempted)
    there = f"{place}: exceptions"
    check_places(there, [check_fields(there, one, {"at": "count"})["at"] for one in record["exceptions"]], part.attempted)
    for one in record["exceptions"]:
        check_record(f"{there} at {one['at']}", one, "exception", *(("claim", "passes", "reason") * (one.get("claim") == OUT)))
    part.exceptions = record["exceptions"]
    part.peak_bytes = math.nan if record["peak_bytes"] is None else float(record["peak_bytes"])
    # It may be the only time of a problem: ratios and logarithms are made of it.
    plain = np.ones(part.attempted, dtype=bool)
    plain[[one["at"] for one in part.exceptions if not one["passes"]]] = False
    if not (part.judged["first_s"][plain] > 0).all():
        raise ReportError(place, "key 'first_s' has none", "a number > 0 where a solve passes")
    return part


def _add_pass(place: str, record: dict, part: _Part) -> None:
    kind, number = record["kind"], int(record["pass"])
    if number < 1:
        raise ReportError(place, f"key 'pass' is {number}", f"1 or more where the kind is {kind}")
    of_kind = part.passes.setdefault(kind, {})
    if number in of_kind:
        raise ReportError(place, f"pass {number} of this kind and task is there twice", "a line per task and pass")
    if part.excluded:
        raise ReportError(place, f"the task is excluded: {part.excluded}", "no pass of it")
    times = {key: check_numbers(place, record, kind, key, part.count)
             for key in (PART_TIMES if kind == PARTS else (f"{kind}_s",))}
    if kind == PARTS:
        of_kind[number] = _Pass(times, [])
        return
    check_record(place, record, kind, "failed")
    failed = check_places(f"{place}: failed", record["failed"], part.count)
    disturbed = False
    if kind == FRESH:
        check_record(place, record, kind, "disturbance")
        if record["disturbance"] is not None:
            disturbed = check_record(f"{place}: disturbance", record["disturbance"], "disturbance", "disturbed")["disturbed"]
    of_kind[number] = _Pass(times, failed, disturbed)


def _task(task: Task, parts: list[_Part], problems: list[dict]) -> Task:
    """@param problems  of the class"""
    ends = np.cumsum([0, *(part.count for part in parts)])
    placed = [(part, slice(low, high)) for part, low, high in zip(parts, ends, ends[1:])]
    columns = _verdicts(placed, ends[-1])
    fresh, disturbed = _times(placed, ends[-1], FRESH, "fresh_s")
    known = ~np.isnan(fresh)
    # Launches that the machine disturbed are left out where there are others.
    calm = known & ~disturbed
    columns |= {"timed": known.sum(axis=0), "disturbed": (known & disturbed).sum(axis=0),
                "fresh_s": median_of_passes(np.where(calm | ~calm.any(axis=0), fresh, math.nan)),
                **{key: median_of_passes(_times(placed, ends[-1], PARTS, key)[0]) for key in PART_TIMES},
                "again_s": median_of_passes(_times(placed, ends[-1], AGAIN, "again_s")[0]),
                "changed": _failed(placed, ends[-1], FRESH)}
    columns["again_s"][_failed(placed, ends[-1], AGAIN)] = math.inf
    passes = columns["passes"] & ~columns["changed"]
    unasked = (columns["claim"] == UNSUPPORTED) & ~passes & ~columns["false_success"]
    counts, weights = (np.array([problems[at][key] for at in task.at]) for key in ("counts", "weight"))
    of = (columns["excluded"] == "") & ~unasked & (counts.astype(bool) if counts.any() else True)
    task.launches = launch_rows(_numbers(parts, FRESH), fresh[:, of], disturbed[:, of], passes[of], weights[of].astype(float),
                                {key: columns[key][of] for key in ("fresh_s", "first_s", "again_s", *PART_TIMES)})
    task.spent_s = float(sum(np.nansum(times) for part in parts for times in (part.judged.get("first_s", 0.0), *(
        times for of_kind in part.passes.values() for one in of_kind.values() for times in one.times.values()))))
    task.details = {place.start + one["at"]: one.get("detail", "") for part, place in placed for one in part.exceptions}
    task.columns = columns
    return task


def _verdicts(placed: list[tuple[_Part, slice]], total: int) -> dict[str, np.ndarray]:
    columns: dict[str, np.ndarray] = {key: np.full(total, math.nan) for key in (*JUDGED, *LAWS, "peak_bytes")}
    columns |= {key: np.zeros(total, dtype=bool) for key in FLAGS}
    columns |= {key: np.full(total, "", dtype=object) for key in ("excluded", "claim")}
    for part, place in placed:
        run = slice(place.start, place.start + part.attempted)
        columns["peak_bytes"][place] = part.peak_bytes
        columns["excluded"][run.stop:place.stop] = part.excluded or TASK_BUDGET
        columns["claim"][run], columns["passes"][run] = "solved", True
        for key, values in part.judged.items():
            columns[key][run] = values
        for one in part.exceptions:
            row, out = place.start + one["at"], one["claim"] == OUT
            for key in ("claim", *FLAGS):
                columns[key][row] = False if out else one.get(key, False)
            if out:
                columns["excluded"][row], columns["claim"][row] = one["reason"], ""
    return columns


def _numbers(parts: list[_Part], kind: str) -> list[int]:
    """Of launches."""
    return sorted({number for part in parts for number in part.passes.get(kind, ())})


def _times(placed: list[tuple[_Part, slice]], total: int, kind: str, key: str) -> tuple[np.ndarray, np.ndarray]:
    """Launches x problems: times, and whether the machine disturbed the launch."""
    numbers = {number: index for index, number in enumerate(_numbers([part for part, _ in placed], kind))}
    times, disturbed = np.full((len(numbers), total), math.nan), np.zeros((len(numbers), total), dtype=bool)
    for part, place in placed:
        for number, one in part.passes.get(kind, {}).items():
            times[numbers[number], place], disturbed[numbers[number], place] = one.times[key], one.disturbed
    return times, disturbed


def _failed(placed: list[tuple[_Part, slice]], total: int, kind: str) -> np.ndarray:
    """Whether the answer changed in a launch."""
    found = np.zeros(total, dtype=bool)
    for part, place in placed:
        for one in part.passes.get(kind, {}).values():
            found[place.start + np.array(one.failed, dtype=int)] = True
    return found


def median_of_passes(times: np.ndarray) -> np.ndarray:
    """@param times  passes x cells, NaN: none
    @returns of every cell the median of what it has, NaN without any
    """
    if not len(times):
        return np.full(times.shape[1], math.nan)
    ordered, known, cells = np.sort(times, axis=0), (~np.isnan(times)).sum(axis=0), np.arange(times.shape[1])
    return (ordered[np.maximum(known - 1, 0) // 2, cells] + ordered[np.minimum(known // 2, len(times) - 1), cells]) / 2
