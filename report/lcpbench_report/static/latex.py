"""LaTeX by hand: escaped text, numbers, and booktabs tables."""

import math
from collections.abc import Iterable

DASH = "--"
_SPECIAL = {"\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_", "{": r"\{",
            "}": r"\}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "<": r"\textless{}",
            ">": r"\textgreater{}", "µ": r"\textmu{}", "–": "--", "\u202f": r"\,"}


def escape(text: str) -> str:
    """Text that LaTeX sets as it is."""
    return "".join(_SPECIAL.get(character, character) for character in str(text))


def key(solver: str) -> str:
    return rf"\texttt{{{escape(solver)}}}"


def number(value: float) -> str:
    """Three significant digits: 0.123, 45.6, 789; very small and large ones as powers of ten."""
    if value is None or math.isnan(value):
        return DASH
    if math.isinf(value):
        return r"$\infty$"
    if value and not 0.01 <= abs(value) < 1e5:
        return scientific(value)
    digits = max(0, 2 - math.floor(math.log10(abs(value)) + 1e-12)) if value else 0
    return f"{value:.{digits}f}" if value >= 0 else f"${value:.{digits}f}$"


def scientific(value: float, digits: int = 1) -> str:
    if value is None or math.isnan(value):
        return DASH
    if math.isinf(value):
        return r"$\infty$"
    if value == 0:
        return "0"
    mantissa, exponent = f"{value:.{digits}e}".split("e")
    return rf"${mantissa}\cdot 10^{{{int(exponent)}}}$"


def power(value: float) -> str:
    """A tier: 10^{-6}, in mathematics."""
    mantissa, exponent = f"{value:.0e}".split("e")
    return (rf"10^{{{int(exponent)}}}" if mantissa == "1" else rf"{mantissa}\cdot 10^{{{int(exponent)}}}")


def count(value: float) -> str:
    return DASH if value is None or math.isnan(value) else f"{value:.0f}"


def percent(part: float, whole: float) -> str:
    """Rounded down to a tenth, so that 100 are all."""
    return share(part / whole) if whole and not math.isnan(part) else DASH


def share(value: float) -> str:
    """The same of a share."""
    return DASH if math.isnan(value) else "100" if value >= 1 else f"{min(math.floor(1000 * value + 1e-9), 999) / 10:.1f}"


def tabular(align: str, header: Iterable[str], rows: Iterable[Iterable[str]], size: str = "small") -> str:
    """A booktabs table without caption or number: \\input stands within the author's own table environment.

    @param header  finished lines, \\cmidrule among them; those of cells end with \\\\
    @param rows    cells, escaped
    """
    lines = [rf"\begin{{{size}}}", r"\setlength{\tabcolsep}{3pt}", rf"\begin{{tabular}}{{@{{}}{align}@{{}}}}",
             r"\toprule", *header, r"\midrule"]
    lines += [" & ".join(row) + r" \\" for row in rows]
    lines += [r"\bottomrule", r"\end{tabular}", rf"\end{{{size}}}"]
    return "\n".join(lines) + "\n"


def spanning(titles: list[str], columns: int, first: int = 2) -> list[str]:
    """Two header lines: titles over `columns` columns each, with rules below; one column stands before them."""
    cells = [rf"\multicolumn{{{columns}}}{{c}}{{{title}}}" for title in titles]
    rules = [rf"\cmidrule(lr){{{first + k * columns}-{first + (k + 1) * columns - 1}}}" for k in range(len(titles))]
    return [" & " + " & ".join(cells) + r" \\", " ".join(rules)]
