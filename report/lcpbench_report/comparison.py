"""Two campaigns compared (statistics/changes.py), in the words of comparison.md.j2."""

import pandas as pd

from . import formats
from .sentences import render
from .statistics.changes import REACH, Comparison
from .table import Table, code


def text(title: str, found: Comparison, most: int) -> str:
    """@param most  of a kind that are listed; values that do not agree are listed all the same"""
    near = found.values["moved"].abs() <= REACH
    only = found.only.groupby(["side", "solver"], sort=False).size()
    listed = {f"{len(found.lost)} verified before and not now:": _cells(found.lost),
              f"{len(found.gained)} verified now and not before:": _cells(found.gained),
              f"{len(found.false_successes)} new false successes:": _cells(found.false_successes),
              f"{len(found.only)} cells that only one has:": _table(["only in", "solver", "cells"], [
                  [side, code(solver), count] for (side, solver), count in only.items()]),
              f"{len(found.plan)} differences of plan, builds and machine:": _table(["key", "old", "new"], found.plan),
              f"{len(found.problems)} differences of problems:": _table(["key", "old", "new"], found.problems)}
    return render("comparison.md.j2", title=title, found=found, listed=listed, most=most, reach=REACH,
                  values=values_table(found.values), near=near.sum(), inside=(found.values["agrees"] & ~near).sum(),
                  beyond=(~found.values["agrees"]).sum())


def _table(columns: list[str], rows: list) -> Table:
    return Table(columns, rows, "l" * len(columns))


def _cells(cells: pd.DataFrame) -> Table:
    """How their verdicts changed."""
    return _table(["problem", "solver", "tier", "before", "now"],
                  [[code(of["problem"]), code(of["solver"]), formats.power(of["tier"]), _verdict(of, "old"), _verdict(of, "new")]
                   for of in cells.to_dict("records")])


def _verdict(of: dict, side: str) -> str:
    """With the rule by which a cell was excluded."""
    rule = of[f"excluded_{side}"]
    return of[f"verdict_{side}"].replace("_", " ").replace(":", ": ") + (f": {rule}" if rule else "")


def values_table(table: pd.DataFrame) -> Table:
    """@param table  rows of Comparison.values"""
    return Table(["tier", "rows", "median, or ratio", "old", "new", "moved", "agrees"],
                 [[formats.power(of.tier), formats.size_class(of.size_class), code(of.what), _value(of, "old"), _value(of, "new"),
                   f"{100 * of.moved:+.1f} %", "yes" if of.agrees else "**no**"] for of in table.itertuples()], "lllrrrl")


def _value(of, side: str) -> str:
    words = formats.times if "/" in of.what else formats.seconds
    value, low, high = (getattr(of, side + end) for end in ("", "_low", "_high"))
    return f"{words(value)} ({words(low)}–{words(high)})"
