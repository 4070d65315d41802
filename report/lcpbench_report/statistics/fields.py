"""Checks an object of a campaign's files against a table of key -> kind.

A kind is a word of _KINDS; a "?" behind it allows null.
"""

import math

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
