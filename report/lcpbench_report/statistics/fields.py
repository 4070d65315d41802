"""Checks an object of a campaign's files against a table of key -> kind.

A kind is a word of _KINDS; a "?" behind it allows null.
"""

import json
import math
from pathlib import Path

import numpy as np

from ..errors import ReportError


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


# Kind -> (test, words for the user).
_KINDS = {
    "text": (lambda v: isinstance(v, str), "a text"),
    "name": (lambda v: isinstance(v, str) and v != "", "a text that is not empty"),
    "boolean": (lambda v: isinstance(v, bool), "true or false"),
    "number": (_is_number, "a finite number"),
    "nonnegative": (lambda v: _is_number(v) and v >= 0, "a number >= 0"),
    "positive": (lambda v: _is_number(v) and v > 0, "a number > 0"),
    "count": (lambda v: _is_number(v) and v >= 0 and v == int(v), "a whole number >= 0"),
    "object": (lambda v: isinstance(v, dict), "an object"),
    "list": (lambda v: isinstance(v, list), "a list"),
}


# {record: {field: {"type": kind, ...}}}, which is part of the command, too; [kind] is a list of it.
_SCHEMA = json.loads((Path(__file__).parent / "result_fields.json").read_text(encoding="utf-8"))
# Record -> field -> kind; of lists only that they are.
_KINDS_OF = {record: {key: "list" if field["type"][0] == "[" else field["type"] for key, field in fields.items()}
             for record, fields in _SCHEMA.items()}
_OPTIONAL = {record: {key for key, field in fields.items() if field.get("optional")} for record, fields in _SCHEMA.items()}


def check_record(place: str, value: object, record: str, *keys: str) -> dict:
    """As check_fields, for a record of a campaign's lines: all its fields, but optional ones that it lacks, or these."""
    kinds = _KINDS_OF[record]
    lacks = _OPTIONAL[record].difference(value) if isinstance(value, dict) else ()
    return check_fields(place, value, {key: kinds[key] for key in keys or kinds if key not in lacks})


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


# Type of a list's numbers -> (test of an array, NaN passing, that finds what does not fit, words for the user).
_RANGES = {"number": (lambda a: np.zeros(len(a), dtype=bool), "numbers or null"),
           "nonnegative": (lambda a: a < 0, "numbers >= 0 or null"), "positive": (lambda a: a <= 0, "numbers > 0 or null")}
_NUMBERS = {int, float, type(None)}


def check_numbers(place: str, value: dict, record: str, key: str, count: int) -> np.ndarray:
    """The list `value[key]` of a record of a campaign's lines, NaN where it has null.

    @throws ReportError where it is no list of `count` finite numbers or nulls, as the schema has them
    """
    refuse, words = _RANGES[_SCHEMA[record][key]["type"].strip("[]?")]
    values = check_fields(place, value, {key: "list"})[key]
    if len(values) != count:
        raise ReportError(place, f"key '{key}' has {len(values)} values", f"{count}")
    fit = _NUMBERS.issuperset(map(type, values))
    wrong = [] if fit else [value for value in values if type(value) not in _NUMBERS]
    array = np.array([] if wrong else values, dtype=float)
    wrong += array[np.isinf(array) | refuse(array)].tolist()
    if wrong:
        raise ReportError(place, f"key '{key}' has {str(wrong[0])[:40]!r}", words)
    return array


def check_places(place: str, listed: list, count: int) -> list[int]:
    """@throws ReportError where an entry of `listed` is no index below `count`, or is there twice"""
    seen = set()
    for index in listed:
        if type(index) is not int or not 0 <= index < count or index in seen:
            raise ReportError(place, f"index {index!r}", f"whole numbers from 0 to {count - 1}, each once")
        seen.add(index)
    return listed


def check_tier(place: str, tiers: list[float], found: float) -> float:
    """The tier of campaign.json that a line means: files round.
    @throws ReportError where there is none
    """
    for tier in tiers:
        if math.isclose(tier, found, rel_tol=1e-6):
            return tier
    raise ReportError(place, f"tier is {found!r}", "a tier of campaign.json")
