"""Two campaigns compared (statistics/changes.py), in the words of comparison.md.j2."""

import pandas as pd

from . import formats
from .sentences import render
from .statistics import pairwise
from .statistics.cells import FALSE_SUCCESS
from .statistics.changes import ALL, REACH, Changes, Part, cell_name
from .statistics.groups import COUNTED
from .statistics.intervals import MARGIN
from .statistics.model import Campaign
from .table import Table, code

_SHOWN = 20  # rows of a table
_ENVIRONMENT = ("version", "git_commit", "git_dirty", "compiler", "flags", "solver_flags", "build_type", "cpu",
                "instruction_sets", "cores", "os", "kernel", "hypervisor", "library_threads", "libraries")


def changes_text(old_name: str, old: Campaign, new_name: str, new: Campaign, changes: Changes) -> str:
    gained = [[_name(row), _verdict(row, "old")] for _, row in changes.gained.iterrows()]
    only = [[code(solver), name, len(own)] for name, table in changes.only.items()
            for solver, own in table.groupby("solver", sort=False)]
    return render("comparison.md.j2", "changes", title=f"{old.info['name']}: {new_name} against {old_name}", changes=changes,
                  environment=_environment(old, new), wrong=_wrong(changes), gained=_table(["cell", "before"], gained),
                  speeds={"Slower": _speeds(changes.slower), "Faster": _speeds(changes.faster)},
                  only=_table(["solver", "only in", "cells"], only),
                  comparisons=changes.speeds["p"].notna().sum(), level=pairwise.LEVEL, margin=MARGIN - 1)


def moved_text(table: pd.DataFrame, alone: list[str], most: int) -> str:
    """@param most  values that agree and are listed; all that do not are"""
    shown = table.index[~table["agrees"]].union(table.index[table["agrees"]][:most])
    rows = [[formats.power(of.tier), formats.size_class(of.size_class), code(of.what), _value(of, "old"), _value(of, "new"),
             f"{100 * of.moved:+.1f} %", "yes" if of.agrees else "**no**"] for of in table.loc[shown].itertuples()]
    near = table["moved"].abs() <= REACH
    return render("comparison.md.j2", "moved", values=len(table), near=near.sum(), inside=(table["agrees"] & ~near).sum(),
                  beyond=(~table["agrees"]).sum(), reach=REACH, alone=alone, more=len(table) - len(shown),
                  table=Table(["tier", "rows", "median, or ratio", "old", "new", "moved", "agrees"], rows, "lllrrrl"))


def same_text(parts: dict[str, Part], most: int) -> str:
    """@param most  differences of a kind that are listed"""
    return render("comparison.md.j2", "same", parts=parts, most=most)


def _table(head: list[str], rows: list[list]) -> str:
    """What is left out is counted."""
    return Table(head, rows, "l" * len(head)).markdown(_SHOWN) if rows else ""


def _environment(old: Campaign, new: Campaign) -> str:
    """Only what differs; versions of libraries one by one."""
    a, b = ({f"{key}.{name}" if name else key: value for key in _ENVIRONMENT if key in of
             for name, value in (of[key] if isinstance(of[key], dict) else {"": of[key]}).items()}
            for of in (campaign.info.get("environment", {}) for campaign in (old, new)))
    return _table(["environment", "old", "new"], [[name, a.get(name, ""), b.get(name, "")] for name in
                                                  dict.fromkeys([*a, *b]) if a.get(name) != b.get(name)])


def _wrong(changes: Changes) -> str:
    wrong = changes.cells.loc[changes.lost.index.union(changes.false_successes.index)]
    first = wrong["verdict_new"] == FALSE_SUCCESS
    return _table(["cell", "before", "now", "time before", "limit"],
                  [[_name(row), _verdict(row, "old"), _verdict(row, "new"), formats.seconds(row["time_s_old"]),
                    formats.seconds(row["time_limit_s_new"])] for _, row in pd.concat([wrong[first], wrong[~first]]).iterrows()])


def _speeds(table: pd.DataFrame) -> str:
    return _table(["solver", "rows", "family", "set that does not count", "tier", "problems", "new / old", "p"],
                  [[code(row.solver), *("all" if part == ALL else code(part) for part in (row.size_class, row.family)),
                    row.set if row.set != COUNTED else "", formats.power(row.tier), row.problems,
                    f"{row.ratio:.3f} [{row.ratio_low:.3f}, {row.ratio_high:.3f}]", f"{row.p:.1g}"]
                   for row in table.itertuples()])


def _name(row) -> str:
    return code(cell_name((row["problem"], row["solver"], row["tier"])))


def _verdict(row, when: str) -> str:
    """With the rule by which a cell was excluded."""
    rule = row[f"excluded_{when}"]
    return row[f"verdict_{when}"].replace("_", " ").replace(":", ": ") + (f": {rule}" if rule else "")


def _value(of, side: str) -> str:
    words = formats.times if "/" in of.what else formats.seconds
    value, low, high = (getattr(of, side + end) for end in ("", "_low", "_high"))
    return f"{words(value)} ({words(low)}–{words(high)})"
