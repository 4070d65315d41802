"""Whether two campaigns are the same apart from times: what must not depend on when, where and in how many parts they
were run.

The plan but for the environment, what is known of the problems but for the oracle's time, and of every cell's first
round the answer and its verdict. The cells of later rounds are not compared: which ones there are depends on times.
"""

import math
from dataclasses import dataclass, field

from .load import Campaign, CellKey

ENVIRONMENT = ("started", "environment", "environment_hash")
_TIME_OF_PROBLEM = "oracle_s"
CELL_FIELDS = ("excluded", "claim", "passes", "best_tier", "at_floor", "false_success", "false_infeasible",
               "iterations", "metrics")
# Claims that depend on how fast the machine is.
_OUT_OF_TIME = ("time_limit", "killed")


@dataclass
class Part:
    """Of the plan's keys, the problems or the cells: which differ between A and B."""

    both: int = 0  # there in A and in B
    only_a: list[str] = field(default_factory=list)
    only_b: list[str] = field(default_factory=list)
    differ: list[str] = field(default_factory=list)  # a line each
    out_of_time: int = 0  # of the cells in `differ`: where a time limit ended a solve

    @property
    def same(self) -> bool:
        return not (self.only_a or self.only_b or self.differ)


def differing_plan(a: dict, b: dict) -> Part:
    """@param a, b  contents of campaign.json"""
    return _compare({k: {k: v} for k, v in a.items() if k not in ENVIRONMENT},
                    {k: {k: v} for k, v in b.items() if k not in ENVIRONMENT}, str)


def differing_problems(a: Campaign, b: Campaign) -> Part:
    known = [{name: {k: v for k, v in about.items() if k != _TIME_OF_PROBLEM} for name, about in c.problems.items()}
             for c in (a, b)]
    return _compare(*known, str)


def differing_cells(a: Campaign, b: Campaign) -> Part:
    records = [{key: {k: runs.record[k] for k in CELL_FIELDS if k in runs.record} for key, runs in c.cells.items()}
               for c in (a, b)]
    return _compare(*records, cell_name)


def cell_name(key: CellKey) -> str:
    problem, solver, tier, mode = key
    return f"solve/{problem}/{solver}/{tier:g} ({mode})"


def _compare(a: dict, b: dict, name) -> Part:
    part = Part(only_a=[name(key) for key in a if key not in b], only_b=[name(key) for key in b if key not in a])
    for key in a:
        if key not in b:
            continue
        part.both += 1
        found = _differences("", a[key], b[key])
        if found:
            part.differ.append(f"{name(key)}: " + "; ".join(found))
            part.out_of_time += any(record.get("claim") in _OUT_OF_TIME for record in (a[key], b[key]))
    return part


def _differences(path: str, a, b) -> list[str]:
    """Every place at which they differ, objects key by key. True is not 1 here."""
    if isinstance(a, dict) and isinstance(b, dict):
        found = []
        for key in [*a, *(key for key in b if key not in a)]:
            found += _differences(f"{path}.{key}" if path else str(key), a.get(key, _Missing), b.get(key, _Missing))
        return found
    same = a == b and isinstance(a, bool) == isinstance(b, bool)
    return [] if same else [f"{path} {_word(a)} | {_word(b)}"]


class _Missing:
    """The value of a key that is not there."""


def _word(value) -> str:
    if value is _Missing:
        return "missing"
    if isinstance(value, float) and math.isfinite(value):
        return repr(value)  # all digits: it may be the last one
    text = str(value)
    return text if len(text) <= 60 else text[:57] + "..."
