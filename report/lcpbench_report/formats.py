"""Numbers as text."""

import math
import re

from markupsafe import Markup, escape

DASH = "–"


def seconds(value: float) -> str:
    """Three significant digits in the unit that fits: 4.12 µs, 35.0 ms, 1.20 s."""
    if value is None or not math.isfinite(value):
        return DASH
    for unit, scale in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6), ("ns", 1e-9)):
        # 0.9995: a value that would round to 1000 of a unit is shown as 1 of the next
        if value >= 0.9995 * scale or unit == "ns":
            return f"{_three_digits(value / scale)}\u202f{unit}"
    return DASH


def _three_digits(value: float) -> str:
    digits = max(0, 2 - math.floor(math.log10(value) + 1e-12)) if value > 0 else 0
    return f"{value:.{min(digits, 2)}f}"


def residual(value: float) -> str:
    """1.2e-9, the exponent as in tier(); infinity and NaN by name."""
    if value is None or math.isnan(value):
        return DASH
    if math.isinf(value):
        return "∞"
    if value == 0:
        return "0"
    mantissa, exponent = f"{value:.1e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def tier(value: float) -> str:
    """1e-9"""
    mantissa, exponent = f"{value:.0e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def ratio(value: float) -> str:
    """1.23, 45, 6789"""
    if value is None or not math.isfinite(value):
        return DASH
    return f"{value:.2f}" if value < 10 else f"{value:.0f}" if value < 1e5 else tier(value)


def percent(value: float) -> str:
    if value is None or not math.isfinite(value):
        return DASH
    digits = 0 if value == 0 or value >= 0.00995 else 1 if value >= 0.00095 else 2
    return f"{100 * value:.{digits}f}\u202f%"


def span(values: list, form=str) -> str:
    """'10–3000', or the one value."""
    low, high = form(min(values)), form(max(values))
    return low if low == high else f"{low}–{high}"


def plural(count: int, word: str, words: str = "") -> str:
    return f"{count} {word if count == 1 else words or word + 's'}"


def words(items: list[str]) -> str:
    """'a, b and c'"""
    return items[0] if len(items) == 1 else ", ".join(items[:-1]) + " and " + items[-1] if items else ""


def status(key: str) -> str:
    """iteration_limit -> iteration limit"""
    return key.replace("_", " ")


def formula(text: str) -> Markup:
    """A formula in plain characters with its exponents and indices raised and lowered: D^-1/2, f_i, |b|_inf.

    Indices are single characters, ii and inf: what is longer is a name (backward_error) and stays.
    """
    html = str(escape(text))
    html = re.sub(r"\^(-?\d+(?:/\d+)?)", r"<sup>\1</sup>", html)
    html = re.sub(r"_(inf|ii|[A-Za-z0-9])(?![A-Za-z0-9_])", r"<sub>\1</sub>", html)
    for plain, sign in (("&gt;=", "≥"), ("&lt;=", "≤"), ("<sub>inf</sub>", "<sub>∞</sub>"), ("<sup>-", "<sup>−"),
                        (" - ", " − "), ("(0, -", "(0, −"), ("sqrt(", "√(")):
        html = html.replace(plain, sign)
    return Markup(html)


def bytes_(value: float) -> str:
    return f"{value / 2**30:.1f}\u202fGiB"


def decade(value: float) -> str:
    """A power of ten of seconds as an axis label: 10 µs."""
    units = (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6))
    unit, scale = next(((name, size) for name, size in units if value >= 0.999 * size), ("ns", 1e-9))
    return f"{value / scale:.0f} {unit}"
