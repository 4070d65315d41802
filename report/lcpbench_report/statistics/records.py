"""Compact records of a campaign, records.jsonl: a line per solver, size class and tier instead of streams.jsonl.

A line begins as those of streams.jsonl do (solver, size_class, tier, first, count: the problems first .. first + count - 1
of the class) and goes on with

    kinds     what is not a number of a cell, each combination once: claim, excluded, the flags of exceptions that hold,
              timed and disturbed (launches), changed (verified by itself, and not in a launch)
    kind      a character per problem: '0' is kinds[0], '1' the next one, and on as in Unicode
    time      per problem the median of its fresh times, or of what has none the time of the solve that was judged
    again     the same with another b
    rho, w_error  per problem; where there are friction or bounded rows also model_rho and the parts of the error
    peak_bytes, launches  of the class: what launches.py has of it; all launches together are number 0

Times t are whole numbers k >= 0, t = 1 ns 1.005^k, and -1 is infinite; residuals have two digits, m 10^e as 100 e + m with
10 <= m < 100, and 0; null is not known. Numbers of launches have four digits; what is left out there is infinite.
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
from .launches import KEY, MEDIANS, OF_LAUNCH, TOGETHER
from .model import ERROR_PARTS, FLAGS, Campaign, Task

FILE = "records.jsonl"
_UNIT, _STEP = 1e-9, math.log(1.005)
_LAWS = ("model_rho", *ERROR_PARTS)
_FIRST = ord("0")  # the character of kinds[0]
# Member of `kinds` -> its value where it is left out, and what it has to be.
_KIND = {"claim": ("solved", "text"), "excluded": ("", "text"), **{flag: (flag == "passes", "boolean") for flag in FLAGS},
         "timed": (0, "count"), "disturbed": (0, "count"), "changed": (False, "boolean")}
_LINE = {"solver": "name", "size_class": "name", "tier": "positive", "first": "count", "count": "count", "kinds": "list",
         "kind": "text", "time": "list", "again": "list", "rho": "list", "w_error": "list", "peak_bytes": "nonnegative?",
         "launches": "list"}
_LAUNCH = {"launch": "count", "level": "number", "disturbed": "boolean"}
_QUANTILES = [key for key in OF_LAUNCH if key.endswith("_s")]


def lines(campaign: Campaign, measured: Measured) -> Iterator[dict]:
    """@param measured  the campaign's cells"""
    place = {name: number for names in campaign.classes.values() for number, name in enumerate(names)}
    cells = measured.cells.assign(place=measured.cells["problem"].map(place), changed=measured.cells["verdict"] == CHANGED)
    cells["passes"] = cells["passes"].astype(bool) | cells["changed"]  # as it was judged by itself: the reader takes it away
    timed = cells["passes"] & (cells["timed"] > 0)
    cells["time"] = times_to_steps(cells["fresh_s"].where(timed, cells["first_s"]))
    cells["again"] = times_to_steps(cells["again_s"])
    for name in ("rho", "w_error", *_LAWS):
        cells[name] = residuals_to_codes(cells[name])
    launches = dict(tuple(measured.launches.groupby(KEY, sort=False)))
    for key, own in cells.groupby(KEY, sort=False):
        own = own.sort_values("place")
        rows = [{name: value for name, value in row.items() if name not in KEY} for row in launches[key].to_dict("records")]
        parts = np.split(np.arange(len(own)), np.flatnonzero(np.diff(own["place"]) != 1) + 1)
        for number, part in enumerate(parts):
            yield dict(zip(KEY, key)) | _cells(own.iloc[part]) | {"launches": [] if number else list(map(_short, rows))}


def _cells(own: pd.DataFrame) -> dict:
    kinds: dict[tuple, int] = {}
    text = "".join(chr(_FIRST + kinds.setdefault(of, len(kinds))) for of in zip(*(own[name].tolist() for name in _KIND)))
    peak = own["peak_bytes"].max()
    return {"first": int(own["place"].iloc[0]), "count": len(own),
            "kinds": [{name: value for (name, (usual, _)), value in zip(_KIND.items(), of) if value != usual} for of in kinds],
            "kind": text, **{name: own[name].tolist() for name in ("time", "again", "rho", "w_error")},
            **{name: own[name].tolist() for name in _LAWS if own[name].notna().any()},
            "peak_bytes": None if math.isnan(peak) else int(peak)}


def _short(row: dict) -> dict:
    return {name: short(value) for name, value in row.items()
            if value != math.inf and (row["launch"] == TOGETHER or name not in MEDIANS)}


def times_to_steps(times: pd.Series) -> np.ndarray:
    """None where there is none."""
    with np.errstate(divide="ignore", invalid="ignore"):
        steps = np.maximum(np.rint(np.log(times.to_numpy(dtype=float) / _UNIT) / _STEP), 0)
    return _whole(np.where(np.isposinf(steps), -1, steps))


def residuals_to_codes(values: pd.Series) -> np.ndarray:
    given = values.to_numpy(dtype=float)
    known = np.isfinite(given) & (given > 0)
    power = np.floor(np.log10(given, where=known, out=np.zeros(len(given)))) - 1
    digits = np.rint(given / 10.0 ** power)
    power, digits = np.where(digits >= 100, power + 1, power), np.where(digits >= 100, 10, digits)
    return _whole(np.where(known, 100 * power + digits, np.where(given == 0, 0, math.nan)))


def _whole(codes: np.ndarray) -> np.ndarray:
    found = np.full(len(codes), None, dtype=object)
    found[~np.isnan(codes)] = codes[~np.isnan(codes)].astype(int).tolist()
    return found


def read_records(path: Path, campaign: Campaign) -> list[Task]:
    """@throws ReportError for the first thing that does not fit"""
    tasks, seen = [], set()
    for place, line in read_lines(path, campaign.notes.append):
        record = check_fields(place, line, _LINE)
        key, first, count = campaign.run_of(place, record)
        if (*key, first) in seen:
            raise ReportError(place, "these problems are there twice", "a line per solver, size class and tier")
        seen.add((*key, first))
        tasks.append(Task(*key, np.arange(first, first + count), _columns(place, record, count),
                          [_launch(f"{place}: launches", row) for row in record["launches"]]))
    return tasks


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
    columns |= {name: _residuals(_numbers(place, record, name, count)) for name in _LAWS if name in record}
    return columns


def _numbers(place: str, record: dict, key: str, count: int) -> np.ndarray:
    values = record[key]
    if len(values) != count or not {int, type(None)}.issuperset(map(type, values)):
        raise ReportError(place, f"key '{key}' is {str(values)[:40]}", f"{count} whole numbers or null")
    return np.array(values, dtype=float)


def _times(steps: np.ndarray) -> np.ndarray:
    return np.where(steps < 0, math.inf, _UNIT * np.exp(_STEP * steps))


def _residuals(codes: np.ndarray) -> np.ndarray:
    digits = codes % 100
    return digits * 10.0 ** ((codes - digits) / 100)


def _launch(place: str, row: object) -> dict:
    check_fields(place, row, _LAUNCH)
    absent = math.inf if row["launch"] == TOGETHER else math.nan
    kinds = dict.fromkeys(_QUANTILES, math.inf) | dict.fromkeys(MEDIANS, absent)
    check_fields(place, row, {name: "nonnegative?" for name in kinds if name in row})
    found = {name: row.get(name, usual) for name, usual in kinds.items()}
    return {name: row[name] for name in _LAUNCH} | {name: math.nan if of is None else of for name, of in found.items()}
