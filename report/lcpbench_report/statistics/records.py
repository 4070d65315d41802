"""Compact records of a campaign, records.jsonl: a line per solver, size class and tier instead of streams.jsonl.

A line begins as those of streams.jsonl do (solver, size_class, tier, first, count: the problems first .. first + count - 1
of the class) and goes on with

    kinds     what is not a number of a cell, each combination once: claim, excluded, the flags of exceptions that hold,
              timed (launches), changed (verified by itself, and not in a launch), late (verified, but over the time limit)
    kind      a character per problem: '0' is kinds[0], '1' the next one, and on as in Unicode
    time      per problem the median of its fresh times, or of what has none the time of the solve that was judged
    again     the same with another b
    rho, w_error  per problem; where there are friction or bounded rows also model_rho and the parts of the error
    peak_bytes, launches  of the class: what launches.py has of it; all launches together are number 0

Of solvers that took part in rounds quantiles of launches are not stored, and after all these lines a line follows for each
with all times (apart, because they are another kind of text: xz makes a fifth less of it). It begins as that one does and
goes on with

    numbers   of the launches that took part
    fresh     of each problem in turn a character for each of them: ' ' without a time, else U+0023 + c; the time is that
              of the problem times e^level 1.02^k, with k = c / 2 for even c and -(c + 1) / 2 for odd ones

Times t are whole numbers k >= 0, t = 1 ns 1.005^k, and -1 is infinite. Residuals are rounded up to one of ten preferred
numbers in a decade (ISO 3, R10), so that what is within a tier stays so: k is the k-th one from 1e-40 on, and 0 is 0; parts
of the error, whose shares are told, to one of eighty. null is not known. Numbers of launches have four digits; what is left out there is infinite.
"""

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd

from ..errors import ReportError
from ..formats import short
from .cells import CHANGED, Measured
from .fields import check_fields
from .jsonl import read_lines
from .launches import KEY, MEDIANS, QUANTILES, TOGETHER, flagged, launch_rows
from .model import ERROR_PARTS, FLAGS, Campaign, Task
from .streams import judged

FILE = "records.jsonl"
_UNIT, _STEP = 1e-9, math.log(1.005)
SINGLE_STEP = math.log(1.02)  # of times of single solves, which differ by more from launch to launch
_RESIDUALS = np.array([0.0, *(float(f"{of}e{power}") for power in range(-40, 308)
                             for of in (1, 1.25, 1.6, 2, 2.5, 3.15, 4, 5, 6.3, 8))])
_OF_PARTS = np.concatenate([[0.0], 10.0 ** (np.arange(-3200, 24640) / 80)])
_LAWS = ("model_rho", *ERROR_PARTS)
_FIRST = ord("0")  # the character of kinds[0]
# Member of `kinds` -> its value where it is left out, and what it has to be.
_KIND = {"claim": ("solved", "text"), "excluded": ("", "text"), **{flag: (flag == "passes", "boolean") for flag in FLAGS},
         "timed": (0, "count"), "changed": (False, "boolean"),
         "late": (False, "boolean")}
_LINE = {"solver": "name", "size_class": "name", "tier": "positive", "first": "count", "count": "count", "kinds": "list",
         "kind": "text", "time": "list", "again": "list", "rho": "list", "w_error": "list", "peak_bytes": "nonnegative?",
         "launches": "list"}
_OF_EVERY = (*KEY, "first", "count")
_OF_TIMES = {"numbers": "list", "fresh": "text"}
_LAUNCH = {"launch": "count", "level": "number"}
_NONE, _FIRST_STEP = " ", 0x23  # of `fresh`


def lines(campaign: Campaign, measured: Measured) -> Iterator[dict]:
    """@param measured  the campaign's cells"""
    place = {name: number for names in campaign.classes.values() for number, name in enumerate(names)}
    cells = measured.cells.assign(place=measured.cells["problem"].map(place), changed=measured.cells["verdict"] == CHANGED)
    # As it was judged by itself: the reader takes both away.
    cells["passes"] = cells["passes"].astype(bool) | cells["changed"] | cells["late"].astype(bool)
    timed = cells["passes"] & (cells["timed"] > 0)
    cells["time"] = times_to_steps(cells["fresh_s"].where(timed, cells["first_s"]))
    cells["again"] = times_to_steps(cells["again_s"])
    for name in ("rho", "w_error", *_LAWS):
        cells[name] = residuals_to_codes(cells[name], _grid(name))
    launches = {key: of.to_dict("records") for key, of in measured.launches.drop(columns="flagged").groupby(KEY, sort=False)}
    in_rounds = {key for key, of in measured.rounds.items() if len(of.columns)}
    for key, own in cells.groupby(KEY, sort=False):
        own = own.sort_values("place")
        times = measured.times[key] if key in in_rounds else None
        left_out = {*KEY, *(QUANTILES if times is not None else ())}
        rows = [{name: _short(name, value) for name, value in row.items() if name not in left_out and value != math.inf
                 and not (name in (MEDIANS if row["launch"] != TOGETHER else ("began_s",)))} for row in launches[key]]
        levels = {row["launch"]: row["level"] for row in rows}
        parts = np.split(np.arange(len(own)), np.flatnonzero(np.diff(own["place"]) != 1) + 1)
        for number, part in enumerate(parts):
            cells = own.iloc[part]
            line = dict(zip(KEY, key)) | _cells(cells) | {"launches": [] if number else rows}
            yield line
            if times is not None:
                yield {name: line[name] for name in _OF_EVERY} | _fresh(cells, times, levels)


def _cells(own: pd.DataFrame) -> dict:
    kinds: dict[tuple, int] = {}
    text = "".join(chr(_FIRST + kinds.setdefault(of, len(kinds))) for of in zip(*(own[name].tolist() for name in _KIND)))
    peak = own["peak_bytes"].max()
    return {"first": int(own["place"].iloc[0]), "count": len(own),
            "kinds": [{name: value for (name, (usual, _)), value in zip(_KIND.items(), of) if value != usual} for of in kinds],
            "kind": text, **{name: own[name].tolist() for name in ("time", "again", "rho", "w_error")},
            **{name: own[name].tolist() for name in _LAWS if own[name].notna().any()},
            "peak_bytes": None if math.isnan(peak) else int(peak)}


def _short(name: str, value: object) -> object:
    return round(value, 1) if name == "began_s" and math.isfinite(value) else short(value)


def _fresh(cells: pd.DataFrame, times: pd.DataFrame, levels: dict[int, float]) -> dict:
    """Members `numbers` and `fresh`, of verified cells."""
    medians = _times(np.array(cells["time"], dtype=float))
    with np.errstate(divide="ignore", invalid="ignore"):
        logs = np.log(times.loc[cells["problem"]].to_numpy() / medians[:, np.newaxis])
    steps = (logs - [levels.get(number, 0.0) for number in times.columns]) / SINGLE_STEP
    known = np.isfinite(steps) & cells["passes"].to_numpy(dtype=bool)[:, np.newaxis]
    whole = np.rint(np.where(known, steps, 0)).astype(int)
    codes = np.where(whole >= 0, 2 * whole, -2 * whole - 1) + _FIRST_STEP
    return {"numbers": list(map(int, times.columns)),
            "fresh": "".join(chr(code) if there else _NONE for code, there in zip(codes.ravel().tolist(), known.ravel().tolist()))}


def has_times(line: dict) -> bool:
    """It is a line of times of launches."""
    return "fresh" in line


def _times_of_launches(place: str, record: dict, medians: np.ndarray, levels: dict[int, float]) -> pd.DataFrame:
    """@param medians  of the record's problems"""
    check_fields(place, record, _OF_TIMES)
    numbers, count = record["numbers"], len(medians) * len(record["numbers"])
    codes = np.array([ord(letter) for letter in record["fresh"]], dtype=int) - _FIRST_STEP
    if len(codes) != count or not all(type(number) is int for number in numbers):
        raise ReportError(place, f"keys 'numbers' and 'fresh' have {len(numbers)} and {len(codes)}", f"{count} characters")
    steps = np.where(codes < 0, math.nan, np.where(codes % 2, -(codes + 1) // 2, codes // 2)).reshape(len(medians), len(numbers))
    shifts = np.array([levels.get(number, 0.0) for number in numbers])
    return pd.DataFrame(medians[:, np.newaxis] * np.exp(SINGLE_STEP * steps + shifts), columns=numbers)


def times_to_steps(times: pd.Series) -> np.ndarray:
    """None where there is none."""
    with np.errstate(divide="ignore", invalid="ignore"):
        steps = np.maximum(np.rint(np.log(times.to_numpy(dtype=float) / _UNIT) / _STEP), 0)
    return _whole(np.where(np.isposinf(steps), -1, steps))


def _grid(name: str) -> np.ndarray:
    return _OF_PARTS if name in ERROR_PARTS else _RESIDUALS


def residuals_to_codes(values: pd.Series, grid: np.ndarray = _RESIDUALS) -> np.ndarray:
    """None where it is not finite."""
    given = values.to_numpy(dtype=float)
    return _whole(np.where(np.isfinite(given), np.searchsorted(grid[:-1], given), math.nan))


def rounded_up(residual: float) -> float:
    return float(_RESIDUALS[np.searchsorted(_RESIDUALS[:-1], residual)])


def _whole(codes: np.ndarray) -> np.ndarray:
    found = np.full(len(codes), None, dtype=object)
    found[~np.isnan(codes)] = codes[~np.isnan(codes)].astype(int).tolist()
    return found


def read_records(path: Path, campaign: Campaign) -> list[Task]:
    """@throws ReportError for the first thing that does not fit"""
    tasks: dict[tuple, Task] = {}
    by_key: dict[tuple, list[Task]] = {}
    for place, line in read_lines(path, campaign.notes.append):
        timed = isinstance(line, dict) and has_times(line)
        record = check_fields(place, line, {name: _LINE[name] for name in _OF_EVERY} if timed else _LINE)
        key, first, count = campaign.run_of(place, record)
        task = tasks.get((*key, first))
        if timed:
            if task is None or len(task.at) != count or task.times is not None:
                raise ReportError(place, "times of launches", "one such line, after another one of these problems")
            levels = {row["launch"]: row["level"] for row in by_key[key][0].launches}
            task.times = _times_of_launches(place, record, task.columns["fresh_s"], levels)
            continue
        if task is not None:
            raise ReportError(place, "these problems are there twice", "a line per solver, size class and tier")
        tasks[*key, first] = Task(*key, np.arange(first, first + count), _columns(place, record, count),
                                  [_launch(f"{place}: launches", row) for row in record["launches"]])
        by_key.setdefault(key, []).append(tasks[*key, first])
    for of_key in by_key.values():
        _complete(of_key, campaign)
    return list(tasks.values())


def _complete(tasks: list[Task], campaign: Campaign) -> None:
    """What is not stored of launches: flags, and quantiles where the times of all of them are known.

    @param tasks  of a solver, size class and tier; the first one has the launches
    """
    rows = tasks[0].launches
    off = flagged(np.array([row["level"] for row in rows[1:]]))
    for row, bad in zip(rows[1:], off):
        row["flagged"] = bool(bad)
    for task in tasks:
        flags = [row["launch"] for row in rows if row["flagged"]]
        task.columns["flagged"] = (np.zeros(len(task.at), dtype=int) if task.times is None else
                                   task.times[task.times.columns.intersection(flags)].notna().sum(axis=1).to_numpy())
    if tasks[0].times is None:
        return
    names = campaign.classes[tasks[0].size_class]
    columns = {name: np.concatenate([task.columns[name] for task in tasks])
               for name in ("passes", "changed", "claim", "false_success", "excluded")}
    of, weights, passes = judged(columns, [campaign.problems[names[number]] for task in tasks for number in task.at])
    times = pd.concat([task.times for task in tasks]).reindex(columns=[row["launch"] for row in rows[1:]])
    found = launch_rows(list(times.columns), times.to_numpy().T[:, of], np.array([row["level"] for row in rows[1:]]), off,
                        passes[of], weights[of], {}, {})
    for row, new in zip(rows, found):
        row |= {name: new[name] for name in QUANTILES}


def _columns(place: str, record: dict, count: int) -> dict[str, np.ndarray]:
    """Columns of the table of cells, by name, and "changed"."""
    kinds = [check_fields(f"{place}: kinds", kind, {}) for kind in record["kinds"]]
    kinds = [check_fields(f"{place}: kinds", {name: kind.get(name, usual) for name, (usual, _) in _KIND.items()},
                          {name: of for name, (_, of) in _KIND.items()}) for kind in kinds]
    which = np.array([ord(letter) - _FIRST for letter in record["kind"]], dtype=int)
    if len(which) != count or not ((0 <= which) & (which < len(kinds))).all():
        raise ReportError(place, f"key 'kind' is {record['kind'][:40]!r}", f"{count} characters, one of 'kinds' each")
    columns = {name: np.array([kind[name] for kind in kinds], dtype=object if of == "text" else None)[which]
               for name, (_, of) in _KIND.items()}
    columns["peak_bytes"] = np.full(count, math.nan if record["peak_bytes"] is None else float(record["peak_bytes"]))
    steps, again, rho, w_error = (_numbers(place, record, key, count) for key in ("time", "again", "rho", "w_error"))
    timed = columns["passes"] & (columns["timed"] > 0)
    columns |= {"fresh_s": np.where(timed, _times(steps), math.nan), "first_s": np.where(timed, math.nan, _times(steps)),
                "again_s": _times(again), "rho": _residuals(rho), "w_error": _residuals(w_error)}
    columns |= {name: _residuals(_numbers(place, record, name, count), _grid(name)) for name in _LAWS if name in record}
    return columns


def _numbers(place: str, record: dict, key: str, count: int) -> np.ndarray:
    values = record[key]
    if len(values) != count or not {int, type(None)}.issuperset(map(type, values)):
        raise ReportError(place, f"key '{key}' is {str(values)[:40]}", f"{count} whole numbers or null")
    return np.array(values, dtype=float)


def _times(steps: np.ndarray) -> np.ndarray:
    return np.where(steps < 0, math.inf, _UNIT * np.exp(_STEP * steps))


def _residuals(codes: np.ndarray, grid: np.ndarray = _RESIDUALS) -> np.ndarray:
    return np.where(np.isnan(codes), math.nan, grid[np.nan_to_num(codes).astype(int).clip(0, len(grid) - 1)])


def _launch(place: str, row: object) -> dict:
    check_fields(place, row, _LAUNCH)
    absent = math.inf if row["launch"] == TOGETHER else math.nan
    kinds = dict.fromkeys(QUANTILES, math.inf) | dict.fromkeys(MEDIANS, absent) | {"began_s": math.nan}
    check_fields(place, row, {name: "nonnegative?" for name in kinds if name in row})
    found = {name: row.get(name, usual) for name, usual in kinds.items()}
    return {name: row[name] for name in _LAUNCH} | {"flagged": False} | {
        name: math.nan if of is None else of for name, of in found.items()}
