"""How far values moved between two runs, as Markdown."""

import pandas as pd

from . import formats
from .statistics.moved import REACH
from .table import Table, code

_WORDS = {True: "yes", False: "**no**"}


def lines(table: pd.DataFrame, alone: list[str], most: int) -> list[str]:
    """@param most  values that agree and are listed; all that do not are"""
    near = table["moved"].abs() <= REACH
    beyond = int((~table["agrees"]).sum())
    shown = table[~table["agrees"]].index.union(table.index[table["agrees"]][:most])
    rows = [[formats.power(of.tier), formats.size_class(of.size_class), code(of.what), *(_value(of, side) for side in ("old", "new")),
             f"{100 * of.moved:+.1f} %", _WORDS[bool(of.agrees)]] for of in table.loc[shown].itertuples()]
    return [f"{len(table)} values: {int(near.sum())} moved by at most {100 * REACH:.0f} %, {int((table['agrees'] & ~near).sum())} "
            f"by more and lie in the other run's interval, {beyond} are beyond both.", "",
            Table(["tier", "rows", "median, or ratio", "old", "new", "moved", "agrees"], rows, "lllrrrl").markdown(),
            *[f"{len(table) - len(shown)} more agree."] * (len(shown) < len(table)), *alone]


def _value(of, side: str) -> str:
    words = formats.times if "/" in of.what else formats.seconds
    value, low, high = (getattr(of, side + end) for end in ("", "_low", "_high"))
    return f"{words(value)} ({words(low)}–{words(high)})"
