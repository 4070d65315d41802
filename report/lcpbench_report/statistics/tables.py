"""All tables of a campaign, and their files."""

from collections import UserDict
from collections.abc import Callable, Collection
from functools import partial
from pathlib import Path

import pandas as pd

from ..files import replaced
from .cells import Measured, measured
from .class_times import class_table
from .coverage import coverage_table
from .friction import friction_table
from .latency import deadline_table, latency_by_solver_table
from .launches import Levels
from .model import Campaign
from .means import delivered_table, mean_table, scaling_table
from .origins import origin_table
from .rivals import OWN_BUILDS, Portfolios, flag_table, is_own, rival_table

FOLDER = "analysis"
# Name -> function of a campaign that has passes over sequences.
STEP_TABLES: dict[str, Callable[[Campaign], pd.DataFrame]] = {
    "latency_by_solver": latency_by_solver_table, "deadline": deadline_table,
}
TABLES = ("cells", "coverage", "scaling", "delivered", "class_times", "means", "origins", "launches",
          "rivals", "friction", "equal_flags")
MAIN = "auto"  # the solver of ours that users start with
_DIGITS = "%.9g"


class Tables(UserDict):
    """Tables by name, made of functions, each when it is first asked for: some take minutes of a large campaign."""

    def __getitem__(self, name: str) -> pd.DataFrame:
        if callable(self.data[name]):
            self.data[name] = self.data[name]()
        return self.data[name]


def makers_of(of_all: Measured, solvers: list[dict], ours: str, portfolios: Portfolios) -> dict[str, Callable[[], pd.DataFrame]]:
    """A maker for each of TABLES.

    @param solvers  the entries of campaign.json
    @param ours     the solver of the tables `rivals` and `friction`
    @param portfolios  size class -> keys of peers in their order
    """
    cells, own = without_builds(of_all.cells), {entry["key"] for entry in solvers if is_own(entry)}
    levels = Levels(of_all.launches, times=of_all.rounds)
    return dict(zip(TABLES, (
        lambda: of_all.cells, partial(coverage_table, cells), partial(scaling_table, cells), partial(delivered_table, cells),
        partial(class_table, cells, levels), partial(mean_table, cells, levels), partial(origin_table, cells, levels),
        lambda: of_all.launches,
        partial(rival_table, cells, own, ours, levels, portfolios), partial(friction_table, cells, ours, levels),
        partial(flag_table, of_all.cells, levels, portfolios))))


def without_builds(cells: pd.DataFrame) -> pd.DataFrame:
    """Of the builds of ours, that for this machine alone: the others say nothing but what flags are worth."""
    return cells[~cells["solver"].isin(OWN_BUILDS)]


def main_own(keys: Collection[str]) -> str:
    """The own solver that is compared with the peers: MAIN, or the first where that was not run; "" without any."""
    return MAIN if MAIN in keys else next(iter(keys), "")


def write_tables(campaign: Campaign, folder: Path) -> None:
    """Writes every table as <name>.csv; one without rows still has its header. Of a campaign of sequences alone the
    tables of steps are written, of one without sequences those of cells."""
    folder.mkdir(parents=True, exist_ok=True)
    if campaign.tasks or not campaign.passes:
        of_all = measured(campaign)
        ran = dict.fromkeys(of_all.cells["solver"])
        ours = main_own([key for key in ran if is_own(campaign.solvers[key])])
        found = Tables(makers_of(of_all, campaign.info["solvers"], ours, campaign.portfolio))
        for name, table in found.items():
            write_csv(table, folder / f"{name}.csv")
    if campaign.passes:
        for name, table in STEP_TABLES.items():
            write_csv(table(campaign), folder / f"{name}.csv")


def write_csv(table: pd.DataFrame, path: Path) -> None:
    """Booleans as true and false, what is not known empty, infinite as inf."""
    words = {True: "true", False: "false"}
    booleans = {name: column.map(words) for name, column in table.items()
                if len(column) and pd.api.types.infer_dtype(column) == "boolean"}
    with replaced(path) as beside:
        table.assign(**booleans).to_csv(beside, index=False, float_format=_DIGITS, lineterminator="\n")
