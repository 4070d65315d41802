"""The rounding floor of a problem: what rounding f to double alone can add to rho (solvers/lcp/rounding_floor.h).

Verdicts are relative to the larger of tier and floor. Files written before there were floors know none.
"""

from . import formats
from .cells import Cells

MARK = "≈"  # of answers that pass thanks to the floor only
# From this part of the strictest tier on a floor is worth showing.
_SHOWN = 0.1


def known(cells: Cells) -> bool:
    return bool(cells.results.problems["floor"].notna().any())


def above(cells: Cells, floor: float) -> bool:
    """Whether the strictest tier lies below the floor."""
    return floor > min(cells.results.tiers)


def text(cells: Cells, floor: float) -> str:
    """The floor where it comes near the strictest tier or exceeds it, else ''."""
    return formats.residual(floor) if floor > _SHOWN * min(cells.results.tiers) else ""


def title(cells: Cells, floor: float) -> str:
    tier = formats.tier(min(cells.results.tiers))
    return f"rounding floor {formats.residual(floor)}, {'above' if above(cells, floor) else 'below'} tier {tier}"


def shown(cells: Cells) -> bool:
    """Whether any problem has a floor worth showing."""
    return any(text(cells, floor) for floor in cells.results.problems["floor"])


def at_floor(cells: Cells) -> int:
    """Runs that pass their tier thanks to the floor only."""
    return int((cells.runs["at_floor"] & cells.runs["verified"]).sum())


def sentence(cells: Cells) -> str:
    """What floors do to the verdicts of this run; '' where none is known."""
    problems = cells.results.problems
    floors = problems["floor"].dropna()
    if floors.empty:
        return ""
    tier = formats.tier(min(cells.results.tiers))
    unknown = len(problems) - len(floors)
    missing = f" On {formats.plural(unknown, 'problem')} none is known (no reference answer was verified)." \
        if unknown else ""
    high = problems[problems["floor"] > min(cells.results.tiers)]
    largest = formats.residual(float(floors.max()))
    if high.empty:
        return (f"Rounding f to double can add at most {largest} to rho on any of {formats.plural(len(floors), 'problem')}: "
                f"no verdict at {tier} or above leans on it.{missing}")
    families = [family for family in cells.results.families if family in set(high["family"])]
    return (f"On {len(high)} of {len(floors)} problems ({formats.words(families)}) rounding f to double alone can add more "
            f"than {tier} to rho, at most {largest}. There a tier is judged by that floor, for all solvers alike; "
            f"{formats.plural(at_floor(cells), 'run')} passed thanks to it only (marked {MARK}).{missing}")


def largest(problems) -> str:
    """Of some rows of problems.csv; '' where none is known."""
    known_ones = problems["floor"].dropna()
    return "" if known_ones.empty else f"at most {formats.residual(float(known_ones.max()))}"
