"""Whether two campaigns are the same apart from times: what must not depend on when, where and in how many parts they
were run.

The plan but for the environment, what is known of the problems but for the oracle's time, and of every cell the answer
and its verdict when it was judged. Timed passes are not compared: how many there are depends on times.
"""

import math
from dataclasses import dataclass, field

import numpy as np
import pandas as pd

from .cells import KEY, cell_table
from .load import METRICS, Campaign

ENVIRONMENT = ("started", "environment", "environment_hash")
_TIME_OF_PROBLEM = "oracle_s"
CELL_FIELDS = ("excluded", "claim", "passes", "best_tier", "at_floor", "false_success", "false_infeasible",
               "proved_infeasible", "infeasible_within_rounding", "iterations", *METRICS)
_MISSING = object()  # the value of a key that is not there
# Claims that depend on how fast the machine is.
_OUT_OF_TIME = ("time_limit", "killed")


@dataclass
class Part:
    """Which of the plan's keys, the problems or the cells differ between A and B."""

    both: int = 0  # there in A and in B
    only_a: list[str] = field(default_factory=list)
    only_b: list[str] = field(default_factory=list)
    differ: list[str] = field(default_factory=list)  # a line each
    out_of_time: int = 0  # of the cells in `differ`: where a time limit ended a solve

    @property
    def same(self) -> bool:
        return not (self.only_a or self.only_b or self.differ)

    def lines(self, what: str, most: int) -> list[str]:
        """In words. @param most  differences of a kind that are listed"""
        if self.same:
            return [f"{what}: {self.both}, all the same"]
        late = f" ({self.out_of_time} of them with a solve that a time limit ended)" if self.out_of_time else ""
        found = [f"{what}: {self.both} in both, {len(self.differ)} differ{late}; {len(self.only_a)} in A only, "
                 f"{len(self.only_b)} in B only"]
        for of_kind in (self.differ, [f"A only: {name}" for name in self.only_a], [f"B only: {name}" for name in self.only_b]):
            found += [f"  {line}" for line in of_kind[:most]]
            found += [f"  ... and {len(of_kind) - most} more"] * (len(of_kind) > most)
        return found


def compare(a: Campaign, b: Campaign) -> dict[str, Part]:
    plans = [{k: {k: v} for k, v in c.info.items() if k not in ENVIRONMENT} for c in (a, b)]
    problems = [{name: {k: v for k, v in about.items() if k != _TIME_OF_PROBLEM} for name, about in c.problems.items()}
                for c in (a, b)]
    return {"keys of the plan": _compare(*plans), "problems": _compare(*problems), "cells": differing_cells(a, b)}


def differing_cells(a: Campaign, b: Campaign) -> Part:
    first, second = (pd.concat([cell_table(c), cell_table(c, True)]).set_index(KEY)[list(CELL_FIELDS)] for c in (a, b))
    part = Part(only_a=[cell_name(key) for key in first.index.difference(second.index, sort=False)],
                only_b=[cell_name(key) for key in second.index.difference(first.index, sort=False)])
    common = first.index.intersection(second.index, sort=False)
    first, second = first.loc[common], second.loc[common]
    part.both = len(common)
    other = ~((first == second) | (first.isna() & second.isna())).to_numpy()
    for index in np.flatnonzero(other.any(axis=1)):
        found = [f"{name} {_word(first.iat[index, k])} | {_word(second.iat[index, k])}"
                 for k, name in enumerate(CELL_FIELDS) if other[index, k]]
        part.differ.append(f"{cell_name(common[index])}: " + "; ".join(found))
        part.out_of_time += any(table["claim"].iat[index] in _OUT_OF_TIME for table in (first, second))
    return part


def cell_name(key: tuple) -> str:
    """@param key  the values of KEY"""
    problem, solver, tier = key
    return f"solve/{problem}/{solver}/{tier:g}"


def _compare(a: dict, b: dict) -> Part:
    both = [key for key in a if key in b]
    found = {key: _differences("", a[key], b[key]) for key in both}
    return Part(len(both), [str(key) for key in a if key not in b], [str(key) for key in b if key not in a],
                [f"{key}: " + "; ".join(places) for key, places in found.items() if places])


def _differences(path: str, a, b) -> list[str]:
    """Every place at which they differ, objects key by key. True is not 1 here."""
    if isinstance(a, dict) and isinstance(b, dict):
        return [place for key in dict.fromkeys([*a, *b]) for place in
                _differences(f"{path}.{key}" if path else str(key), a.get(key, _MISSING), b.get(key, _MISSING))]
    same = a == b and isinstance(a, bool) == isinstance(b, bool)
    return [] if same else [f"{path} {_word(a)} | {_word(b)}"]


def _word(value) -> str:
    if value is _MISSING:
        return "missing"
    if isinstance(value, float):
        return repr(value) if math.isfinite(value) else "not known"  # all digits: it may be the last one
    text = str(value)
    return text if len(text) <= 60 else text[:57] + "..."
