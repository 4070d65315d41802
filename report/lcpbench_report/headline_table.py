"""The headline: ours against the peers in every size class, by how much, and how much of it is right.

All of it is from the tables class_times and rivals of the statistics, at the main tier; here is chosen who stands where.
The rival by whom a class is won or lost is the portfolio of peers; in campaigns without it, the fastest peer of each
problem.
"""

from dataclasses import dataclass, field
from functools import lru_cache
from typing import NamedTuple

import pandas as pd

from . import choice
from .inputs import Inputs
from .statistics.class_times import ALL, RATIO
from .statistics.rivals import FASTER_SHARE, FASTEST, PORTFOLIO, pareto_front


class Ratio(NamedTuple):
    """A weighted median with its interval."""

    median: float
    low: float
    high: float


@dataclass(frozen=True)
class Rival:
    """A peer against ours, on the problems that both had a turn at. Ratios are our time over theirs: above 1 we lose."""

    key: str
    front: bool
    launches: int
    time_s: float
    share: float  # of it, right
    own_share: float
    relation: str  # statistics.rivals.RELATIONS
    ratios: dict[str, Ratio]  # by origin group, and ALL
    check_share: float  # of the portfolio's time
    peer_faster: Ratio  # of FASTEST: the share of the problems on which it is faster than ours

    @property
    def ratio(self) -> Ratio:
        return self.ratios[ALL]

    @property
    def is_single(self) -> bool:
        return self.key not in (PORTFOLIO, FASTEST)


@dataclass(frozen=True)
class ClassRow:
    """Ours against the peers in one size class."""

    size_class: str
    problems: int
    n_eff: float
    entries: dict[str, tuple]  # of every solver that was run on the class, see _entries
    peers: int = 0  # that had a turn
    rivals: dict[str, Rival] = field(default_factory=dict)  # the front, the fastest first; PORTFOLIO and FASTEST, where there are

    @property
    def single(self) -> Rival | None:
        """The fastest single peer of the front."""
        return next((of for of in self.rivals.values() if of.is_single), None)


@dataclass(frozen=True)
class Headline:
    tier: float
    classes: list[ClassRow]
    solvers: list[str]  # of the table by solver
    left_out: list[str]  # solvers that have a better setting, or a better relative, in the table
    own: str
    no_peer: str = ""  # why there is none to compare with; empty where there is

    @property
    def rival(self) -> str:
        """By whom classes are won and lost."""
        return PORTFOLIO if any(PORTFOLIO in row.rivals for row in self.classes) else FASTEST


def verdicts(found: Headline) -> tuple[list[ClassRow], list[ClassRow], list[ClassRow]]:
    """Size classes in which ours loses to the headline's rival, is not told apart from it, and wins."""
    rows = [(row, row.rivals[found.rival].ratio) for row in found.classes if found.rival in row.rivals]
    return ([row for row, ratio in rows if ratio.low > 1], [row for row, ratio in rows if not (ratio.low > 1 or ratio.high < 1)],
            [row for row, ratio in rows if ratio.high < 1])


def not_won(found: Headline) -> list[tuple[ClassRow, list[Rival]]]:
    """Size classes, and the rivals among the fastest single peer and the portfolio over which our win is not sure there."""
    rows = [(row, [of for of in (row.single, row.rivals.get(PORTFOLIO)) if of and not of.ratio.high < 1]) for row in found.classes]
    return [(row, rivals) for row, rivals in rows if rivals]


@lru_cache(maxsize=2)
def headline(inputs: Inputs) -> Headline:
    """By solver: the better setting of every own method, and the best of every peer library."""
    shown = choice.best_own(inputs, 20) + choice.best_peers(inputs, 20)
    tier, cells = choice.main_tier(inputs), choice.main_cells(inputs)
    rivals = choice.table(inputs, "rivals", tier)
    times = choice.table(inputs, "class_times", tier)
    classes = [_row(key, rows, rivals[rivals["size_class"] == key], cells[cells["size_class"] == key])
               for key, rows in times.groupby("size_class", sort=False) if key != ALL]
    ran = [solver for solver in shown if any(solver in row.entries for row in classes)]
    return Headline(tier, classes, ran, [key for key in inputs.keys if key not in shown], inputs.ours, _no_peer(inputs))


def _no_peer(inputs: Inputs) -> str:
    if inputs.peers:
        return ""
    missing = any(entry["origin"] != "own" and not entry["available"] for entry in inputs.solvers)
    return "no peer in this build: `make peers`" if missing else "no peer was run"


def _entries(times: pd.DataFrame) -> dict[str, tuple]:
    """Solver -> its row of class_times: `problems` that had their turn, without those that it does not take as they are
    given; `share` verified and `taken`, by weight; `time_s`, the median of the weight; `best`: on the front of all solvers,
    no other is both faster and right on as much."""
    times = times.assign(problems=times["problems"] - times["not_asked"]).rename(
        columns={"verified_share": "share", "taken_share": "taken", "median_s": "time_s"})
    front = pareto_front(dict(zip(times["solver"], zip(times["time_s"], times["share"] * times["taken"]))))
    return {of.solver: of for of in times.assign(best=times["solver"].isin(front)).itertuples(index=False)}


def _row(size_class: str, times: pd.DataFrame, rivals: pd.DataFrame, cells: pd.DataFrame) -> ClassRow:
    entries, found = _entries(times), {}
    for of in rivals.to_dict("records"):
        if of["origin"] == ALL:
            found[of["rival"]] = Rival(of["rival"], of["front"], of["launches"], of["rival_s"], of["rival_share"],
                                       of["own_share"], of["relation"], {}, of["check_share"],
                                       Ratio(*(of[name] for name in FASTER_SHARE)))
        found[of["rival"]].ratios[of["origin"]] = Ratio(*(of[name] for name in RATIO))
    largest = max(entries.values(), key=lambda entry: entry.problems)
    return ClassRow(size_class, cells["problem"].nunique(), largest.n_eff, entries,
                    int(rivals["peers"].max()) if len(rivals) else 0, found)
