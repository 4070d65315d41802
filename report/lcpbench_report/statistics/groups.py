"""What is compared with what: cells of one tier; and problems that count, never with those that do not."""

from collections.abc import Iterator

import numpy as np
import pandas as pd

# The value of a table's column `set` for all problems that count, whatever their own set.
COUNTED = "counted"
GROUP = ["set", "tier"]
Part = tuple[dict, pd.DataFrame]  # values of a table's first columns, and the cells that they are of


def with_label(cells: pd.DataFrame) -> pd.DataFrame:
    """A copy in which the set of every problem that counts is COUNTED."""
    return cells.assign(set=np.where(cells["counts"].astype(bool), COUNTED, cells["set"]))


def groups(cells: pd.DataFrame, counted_only: bool = False) -> Iterator[Part]:
    """The cells of every tier, loosest first, on the problems that count or on those of one set that does not."""
    parts = dict(tuple(with_label(cells).groupby(GROUP, sort=False)))
    for key in sorted(parts, key=lambda key: (key[0], -key[1])):
        if key[0] == COUNTED or not counted_only:
            yield dict(zip(GROUP, key)), parts[key]


def common(cells: pd.DataFrame) -> pd.DataFrame:
    """The cells of a group on the problems that every solver of it has. Of a campaign that was stopped half way the
    others would count as failures of those who never had their turn."""
    present = cells.groupby("problem")["solver"].transform("nunique")
    return cells[present == cells["solver"].nunique()]


def wide(cells: pd.DataFrame, column: str) -> pd.DataFrame:
    """Problems x solvers, in the order in which they appear; NaN where there is no such cell."""
    table = cells.pivot(index="problem", columns="solver", values=column)
    return table.reindex(index=cells["problem"].unique(), columns=cells["solver"].unique())
