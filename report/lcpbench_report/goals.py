"""How our solvers stand against the fastest right peer, and `auto` against the best of its backends, as Markdown.

A time counts where every seed of the cell is verified at the tier. Who is own and who is a peer says run.json; external
solvers are neither. Peers that nobody asked (excluded by rule) or that are wrong cannot be the fastest right one.
"""

import math
from dataclasses import dataclass

from . import formats
from .cells import SINGLE_RUN, Cell, Cells
from .errors import ReportError
from .stats import median

AUTO = "auto"
LARGEST = 1000  # rows; larger problems are another goal's
AT_MOST_OVER_BACKEND = 1.3  # auto's time over that of the best single backend, on any family


@dataclass
class Goal:
    """Peer's time over ours, on every family."""

    above: int  # applies to more rows than this
    at_least: float
    aim: float


GOALS = [Goal(50, 2.0, 5.0), Goal(0, 1.2, 3.0)]


def goal_of(n: int) -> Goal:
    return next(goal for goal in GOALS if n > goal.above)


@dataclass
class Row:
    """One family at one size. Cells are None where nobody of the kind is verified."""

    family: str
    own: Cell | None  # the fastest single backend
    auto: Cell | None
    auto_word: str  # why auto does not count, "" where it does
    peer: Cell | None

    @property
    def peer_over_auto(self) -> float:
        return _over(self.peer, self.auto)

    @property
    def peer_over_own(self) -> float:
        return _over(self.peer, self.own)

    @property
    def auto_over_own(self) -> float:
        return _over(self.auto, self.own)


def _over(slow: Cell | None, fast: Cell | None) -> float:
    """Times divided: 0 where the divisor is missing, infinite where the dividend is, NaN where both are."""
    if slow and fast:
        return slow.time_s / fast.time_s
    return math.inf if fast else 0.0 if slow else math.nan


def rows(cells: Cells, n: int, tier: float) -> list[Row]:
    found = []
    for family in cells.results.families:
        if n not in cells.sizes(family):
            continue
        at = {s: cell for s in cells.results.solvers if (cell := cells.get(family, n, s, tier))}
        auto = at.get(AUTO)
        passed = [cell for cell in at.values() if cell.passes and math.isfinite(cell.time_s)]
        word = "" if auto in passed else auto.verdict if auto else "not run"
        found.append(Row(family, _fastest(cells, passed, "own"), auto if auto in passed else None, word,
                         _fastest(cells, passed, "peer")))
    return found


def _fastest(cells: Cells, passed: list[Cell], origin: str) -> Cell | None:
    mine = [cell for cell in passed if cells.results.origin(cell.solver) == origin and cell.solver != AUTO]
    return min(mine, key=lambda cell: cell.time_s, default=None)


def as_markdown(cells: Cells, tier: float) -> str:
    if AUTO not in cells.results.solvers:
        raise ReportError("run.json", f"'{AUTO}' is not among the solvers of this build", "a run with it")
    sizes = [n for n in sorted(set(cells.results.problems["n"])) if n <= LARGEST]
    tables = {n: rows(cells, n, tier) for n in sizes}
    run = cells.results.run
    lines = [f"Goals at tier {formats.tier(tier)} ({run['cpu']}, commit {run['git_commit'][:12]}"
             f"{' with changes' if run['git_dirty'] else ''}, {run['started'][:10]}). Ratios of median solve times; "
             "a solver counts where all seeds are verified.", ""]
    lines += _overview(tables)
    lines += [_verified(cells, sizes), ""]
    for n in sizes:
        lines += _table(n, tables[n])
    return "\n".join(lines)


def _overview(tables: dict[int, list[Row]]) -> list[str]:
    lines = ["| n | families | peer / auto: median | worst | goal, aim | met by | peer / own backend: median | worst "
             "| auto / own backend: median | worst | within 1.3 |",
             "| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"]
    for n, found in tables.items():
        goal = goal_of(n)
        by_auto = _known(found, "peer_over_auto")
        by_own = _known(found, "peer_over_own")
        over = _known(found, "auto_over_own")
        met, aimed = (sum(ratio >= least for ratio in by_auto) for least in (goal.at_least, goal.aim))
        within = sum(ratio <= AT_MOST_OVER_BACKEND for ratio in over)
        lines.append(f"| {n} | {len(found)} | {_ratio(median(by_auto))} | {_ratio(min(by_auto, default=math.nan))} "
                     f"| {goal.at_least:g}, {goal.aim:g} | {met}, {aimed} "
                     f"| {_ratio(median(by_own))} | {_ratio(min(by_own, default=math.nan))} "
                     f"| {_ratio(median(over))} | {_ratio(max(over, default=math.nan))} | {within} of {len(over)} |")
    return lines + [""]


def _known(found: list[Row], name: str) -> list[float]:
    return [ratio for row in found if not math.isnan(ratio := getattr(row, name))]


def _verified(cells: Cells, sizes: list[int]) -> str:
    """Problems, not cells: what counts is that none is left."""
    runs = cells.runs[(cells.runs["solver"] == AUTO) & cells.runs["n"].isin(sizes) & (cells.runs["excluded"] == "")]
    counts = [f"{int(at['verified'].sum())} of {len(at)} at {formats.tier(tier)}"
              for tier in cells.results.tiers if len(at := runs[runs["tier"] == tier])]
    return f"Problems up to n = {LARGEST} that `{AUTO}` solves, verified: {formats.words(counts)}."


def _table(n: int, found: list[Row]) -> list[str]:
    goal = goal_of(n)
    lines = [f"n = {n} (peer / auto at least {goal.at_least:g}; **bold**: missed):", "",
             "| family | own backend | auto | peer | peer / auto | peer / own backend | auto / own backend |",
             "| --- | ---: | ---: | ---: | ---: | ---: | ---: |"]
    for row in found:
        lines.append(f"| {row.family} | {_cell(row.own)} | {_time(row.auto) if row.auto else '✗ ' + row.auto_word} "
                     f"| {_cell(row.peer)} | {_judged(row.peer_over_auto, row.peer_over_auto < goal.at_least)} "
                     f"| {_judged(row.peer_over_own, row.peer_over_own < goal.at_least)} "
                     f"| {_judged(row.auto_over_own, row.auto_over_own > AT_MOST_OVER_BACKEND)} |")
    return lines + [""]


def _cell(cell: Cell | None) -> str:
    return f"`{cell.solver}` {_time(cell)}" if cell else "none is right"


def _time(cell: Cell) -> str:
    """An asterisk where there is one measurement only."""
    return formats.seconds(cell.time_s) + ("\\*" if cell.time_source == SINGLE_RUN else "")


def _judged(ratio: float, missed: bool) -> str:
    return f"**{_ratio(ratio)}**" if missed else _ratio(ratio)


def _ratio(value: float) -> str:
    return "∞" if math.isinf(value) else formats.ratio(value)
