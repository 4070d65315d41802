"""Checks an object of a campaign's files against a table of key -> kind.

A kind is a word of _KINDS; a "?" behind it allows null.
"""

import functools
import json
import math
from pathlib import Path

import numpy as np

from ..errors import ReportError


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def _are_times(value: object) -> bool:
    return isinstance(value, list) and all(_is_number(v) and v >= 0 for v in value)


# Kind -> (test, words for the user).
_KINDS = {
    "text": (lambda v: isinstance(v, str), "a text"),
    "name": (lambda v: isinstance(v, str) and v != "", "a text that is not empty"),
    "boolean": (lambda v: isinstance(v, bool), "true or false"),
    "number": (_is_number, "a finite number"),
    "time": (lambda v: _is_number(v) and v >= 0, "a number >= 0"),
    "positive": (lambda v: _is_number(v) and v > 0, "a number > 0"),
    "count": (lambda v: _is_number(v) and v >= 0 and v == int(v), "a whole number >= 0"),
    "times": (_are_times, "a list of numbers >= 0"),
    "object": (lambda v: isinstance(v, dict), "an object"),
    "list": (lambda v: isinstance(v, list), "a list"),
}


# {record: {field: {"type": kind, ...}}}, written by `lcpbench list fields --json`; [kind] is a list of it.
_SCHEMA = json.loads((Path(__file__).parent / "result_fields.json").read_text(encoding="utf-8"))


@functools.cache
def kinds_of(record: str, keys: tuple[str, ...] | None = None) -> dict[str, str]:
    """For check_fields: the fields of a record of a campaign's lines, or these of them; of lists only that they are."""
    fields = _SCHEMA[record]
    return {key: "list" if fields[key]["type"][0] == "[" else fields[key]["type"] for key in keys or fields}


def numbers_of(record: str, key: str) -> str:
    """For check_numbers: what the numbers of a list may be."""
    return {"number": "any", "time": ">= 0", "positive": "> 0"}[_SCHEMA[record][key]["type"].strip("[]?")]


def check_fields(place: str, record: object, kinds: dict[str, str]) -> dict:
    """@param place  file and line, for messages
    @returns `record`
    @throws ReportError for the first key that is missing or does not fit
    """
    if not isinstance(record, dict):
        raise ReportError(place, f"found {str(record)[:40]!r}", "an object")
    for key, kind in kinds.items():
        fits, words = _KINDS[kind.rstrip("?")]
        optional = kind.endswith("?")
        if key not in record:
            raise ReportError(place, f"key '{key}' is missing", words)
        value = record[key]
        if not (optional and value is None) and not fits(value):
            raise ReportError(place, f"key '{key}' is {str(value)[:60]!r}", words + (" or null" if optional else ""))
    return record


def check_word(place: str, record: dict, key: str, words) -> None:
    """@throws ReportError where `record[key]` is none of `words`"""
    if record[key] not in words:
        raise ReportError(place, f"key '{key}' is {record[key]!r}", "one of " + ", ".join(map(str, words)))


# What numbers may be -> (test of an array, NaN passing, words for the user).
_RANGES = {"any": (lambda a: np.zeros(len(a), dtype=bool), "numbers or null"),
           ">= 0": (lambda a: a < 0, "numbers >= 0 or null"), "> 0": (lambda a: a <= 0, "numbers > 0 or null")}
_NUMBERS = {int, float, type(None)}


def check_numbers(place: str, record: dict, key: str, count: int, within: str = "any") -> np.ndarray:
    """The list `record[key]`, NaN where it has null.

    @param within  any, >= 0 or > 0
    @throws ReportError where it is no list of `count` finite numbers or nulls
    """
    refuse, words = _RANGES[within]
    check_fields(place, record, {key: "list"})
    values = record[key]
    if len(values) != count:
        raise ReportError(place, f"key '{key}' has {len(values)} values", f"{count}")
    if not _NUMBERS.issuperset(map(type, values)):
        wrong = next(value for value in values if type(value) not in _NUMBERS)
        raise ReportError(place, f"key '{key}' has {str(wrong)[:40]!r}", words)
    array = np.array(values, dtype=float)
    wrong = np.isinf(array) | refuse(array)
    if wrong.any():
        raise ReportError(place, f"key '{key}' has {array[wrong][0]!r}", words)
    return array


def check_places(place: str, listed: list, count: int) -> list[int]:
    """@throws ReportError where an entry of `listed` is no index below `count`, or is there twice"""
    seen = set()
    for index in listed:
        if type(index) is not int or not 0 <= index < count or index in seen:
            raise ReportError(place, f"index {index!r}", f"whole numbers from 0 to {count - 1}, each once")
        seen.add(index)
    return listed


class Tiers:
    """Finds the tier of campaign.json that a line means: files round."""

    def __init__(self, tiers: list[float]):
        self._known = {tier: tier for tier in tiers}

    def find(self, place: str, found: float) -> float:
        """@throws ReportError where there is none"""
        if found not in self._known:
            tier = next((t for t in self._known.values() if math.isclose(t, found, rel_tol=1e-6)), None)
            if tier is None:
                raise ReportError(place, f"tier is {found!r}", "a tier of campaign.json")
            self._known[found] = tier
        return self._known[found]
