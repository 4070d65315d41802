"""Numbers as text."""

import math
from collections.abc import Iterable

import numpy as np

DASH = "–"
_UNITS = (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6), ("ns", 1e-9))
_NARROW = "\u202f"  # no-break space before a unit
_PERCENT = f"{_NARROW}%"


def seconds(value: float) -> str:
    """Three significant digits in the unit that fits: 4.12 µs, 35.0 ms, 1.20 s."""
    if value is None or not math.isfinite(value):
        return "∞" if value == math.inf else DASH
    name, scale = time_unit(value)
    value /= scale
    digits = max(0, 2 - math.floor(math.log10(value) + 1e-12)) if value > 0 else 0
    return f"{value:.{min(digits, 2)}f}{_NARROW}{name}"


def time_unit(value: float) -> tuple[str, float]:
    """(name, size [s]) of the unit in which a time is at least 1."""
    # 0.9995: what would round to 1000 of a unit is 1 of the next
    return next(((name, scale) for name, scale in _UNITS if value >= 0.9995 * scale), _UNITS[-1])


def residual(value: float) -> str:
    """1.2e-9, the exponent as in power(); infinity and NaN by name."""
    if value is None or math.isnan(value):
        return DASH
    if math.isinf(value):
        return "∞"
    if value == 0:
        return "0"
    return power(value, 1)


def power(value: float, digits: int = 0) -> str:
    """1e-9: a tier, a number of one digit; or of more behind the point."""
    mantissa, exponent = f"{value:.{digits}e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def percent(value: float) -> str:
    if value is None or not math.isfinite(value):
        return DASH
    digits = 0 if value == 0 or value >= 0.00995 else 1 if value >= 0.00095 else 2
    return f"{100 * value:.{digits}f}{_PERCENT}"


def share_of(value: float) -> str:
    """Per cent of a share, rounded down: 100 % are all, and 0 % none."""
    found = 100 if value >= 1 else min(math.floor(100 * value + 1e-9), 99)
    return f"{'<1' if value and not found else found}{_NARROW}%"


def times(value: float) -> str:
    """A ratio that may be below 1: 140, 8.34, 0.60, 0.012"""
    if not math.isfinite(value):
        return "∞" if value > 0 else DASH
    if value == 0 or value >= 9.995:
        return f"{value:.0f}"
    return f"{value:.{max(2, 1 - math.floor(math.log10(value) + 1e-12))}f}"


def with_interval(value: float, low: float, high: float) -> str:
    """0.60 (0.55–0.64)"""
    if math.isnan(value):
        return DASH
    return times(value) + ("" if math.isnan(low) else f" ({times(low)}–{times(high)})")


def signed_percent(value: float) -> str:
    """+12 %"""
    return f"{value:+.0%}".replace("%", _PERCENT)


def share_interval(value: float, low: float, high: float) -> str:
    """12 % (9–15 %)"""
    return percent(value) + ("" if math.isnan(low) else f" ({percent(low).removesuffix(_PERCENT)}–{percent(high)})")


def size_class(key: str) -> str:
    """4-6 -> 4–6, 1001-1e4 -> 1001–10⁴"""
    powers = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")
    return "–".join("10" + end[2:].translate(powers) if end.startswith("1e") else end for end in key.split("-"))


def plural(count: int, word: str, words: str = "") -> str:
    return f"{count} {word if count == 1 else words or word + 's'}"


def words(items: Iterable[str]) -> str:
    """'a, b and c'"""
    items = list(items)
    return items[0] if len(items) == 1 else ", ".join(items[:-1]) + " and " + items[-1] if items else ""


def short(value: object) -> object:
    """As JSON has it: a number with four digits, null where it is not finite; anything else as it is."""
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    if isinstance(value, (int, np.integer)):
        return int(value)
    return value if not isinstance(value, float) else float(f"{value:.4g}") if math.isfinite(value) else None
