"""Times, sizes and shares as text."""

import math

_UNITS = (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6), ("ns", 1e-9))
UNKNOWN = "–"
_NARROW = "\u202f"  # no-break space before a unit


def time_text(seconds: float) -> str:
    """Three significant digits in the unit that fits: 4.12 µs, 35.0 ms, 1.20 s."""
    if seconds is None or not math.isfinite(seconds):
        return UNKNOWN
    name, scale = time_unit(seconds)
    return f"{three_digits(seconds / scale)}{_NARROW}{name}"


def time_unit(seconds: float) -> tuple[str, float]:
    """(name, size [s]) of the unit in which a time is at least 1."""
    # 0.9995: what would round to 1000 of a unit is 1 of the next
    return next(((name, scale) for name, scale in _UNITS if seconds >= 0.9995 * scale), _UNITS[-1])


def three_digits(value: float) -> str:
    """As many digits after the point as make three significant ones, two at most."""
    digits = max(0, 2 - math.floor(math.log10(value) + 1e-12)) if value > 0 else 0
    return f"{value:.{min(digits, 2)}f}"


def power(value: float) -> str:
    """1e-9: a tolerance, a number of one digit."""
    mantissa, exponent = f"{value:.0e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def share_text(part: int, whole: int) -> str:
    """Per cent, rounded down: 100 % are all, and 0 % none."""
    if not whole:
        return UNKNOWN
    percent = 100 * part // whole
    return f"{'<1' if part and not percent else percent}{_NARROW}%"
