"""What is compared with what: cells of one tier; and problems that count, never with those that do not."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd

# The value of a table's column `set` for all problems that count, whatever their own set.
COUNTED = "counted"
GROUP = ["set", "tier"]


@dataclass
class Group:
    """The cells of one tier, on the problems that count or on those of one set that does not."""

    label: dict  # GROUP -> value
    cells: pd.DataFrame

    @property
    def counts(self) -> bool:
        return self.label["set"] == COUNTED

    @property
    def solvers(self) -> list[str]:
        """In the order in which they appear."""
        return list(dict.fromkeys(self.cells["solver"]))

    def wide(self, column: str) -> pd.DataFrame:
        """Problems x solvers; NaN where there is no such cell."""
        table = self.cells.pivot(index="problem", columns="solver", values=column)
        return table.reindex(index=list(dict.fromkeys(self.cells["problem"])), columns=self.solvers)

    @property
    def weights(self) -> np.ndarray:
        """Of the problems, in the order of `wide`."""
        return self.cells.drop_duplicates("problem")["weight"].to_numpy(dtype=float)

    def common(self) -> "Group":
        """The problems on which every solver of the group has a cell. Of a campaign that was stopped half way the
        others would count as failures of those who never had their turn."""
        present = self.cells.groupby("problem")["solver"].transform("nunique")
        return Group(self.label, self.cells[present == self.cells["solver"].nunique()])


def with_label(cells: pd.DataFrame) -> pd.DataFrame:
    """A copy in which the set of every problem that counts is COUNTED."""
    return cells.assign(set=np.where(cells["counts"].astype(bool), COUNTED, cells["set"]))


def groups(cells: pd.DataFrame, counted_only: bool = False) -> Iterator[Group]:
    """Loosest tier first."""
    labelled = with_label(cells)
    if counted_only:
        labelled = labelled[labelled["set"] == COUNTED]
    keys = labelled[GROUP].drop_duplicates().sort_values(GROUP, ascending=[True, False])
    for key in keys.itertuples(index=False):
        yield Group(dict(zip(GROUP, key)), labelled[(labelled["set"] == key.set) & (labelled["tier"] == key.tier)])
