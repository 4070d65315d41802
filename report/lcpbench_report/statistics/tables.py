"""All tables of a campaign, and their files."""

from collections import UserDict
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pandas as pd

from ..files import replaced
from .cells import cell_table
from .class_times import ablation_table, class_table, peer_ratio_table
from .coverage import coverage_table
from .latency import deadline_table, latency_by_solver_table
from .load import Campaign
from .means import delivered_table, mean_table
from .origins import origin_table, rank_table
from .pairwise import pairwise_table
from .scaling import scaling_table

FOLDER = "analysis"
# Name -> function of the table of cells.
_OF_CELLS: dict[str, Callable[[pd.DataFrame], pd.DataFrame]] = {
    "cells": lambda cells: cells, "class_times": class_table, "pairwise": pairwise_table, "means": mean_table,
    "coverage": coverage_table, "scaling": scaling_table, "delivered": delivered_table, "origins": origin_table,
    "rank_correlation": rank_table,
}
# Name -> function of a campaign that has passes over sequences.
STEP_TABLES: dict[str, Callable[[Campaign], pd.DataFrame]] = {
    "latency_by_solver": latency_by_solver_table, "deadline": deadline_table,
}
TABLES = (*_OF_CELLS, "peer_ratio", "ablation")
_DIGITS = "%.9g"


class Tables(UserDict):
    """Tables by name, made of functions, each when it is first asked for: some take minutes of a large campaign."""

    def __getitem__(self, name: str) -> pd.DataFrame:
        if callable(self.data[name]):
            self.data[name] = self.data[name]()
        return self.data[name]


def makers_of(cells: pd.DataFrame, ablated: pd.DataFrame,
              solvers: list[dict]) -> dict[str, Callable[[], pd.DataFrame]]:
    """A maker for each of TABLES; the arguments are those of class_times.ablation_table."""
    own = {entry["key"] for entry in solvers if entry["origin"] == "own"}
    return {name: partial(table, cells) for name, table in _OF_CELLS.items()} | {
        "peer_ratio": partial(peer_ratio_table, cells, own),
        "ablation": partial(ablation_table, cells, ablated, solvers)}


def write_tables(campaign: Campaign, folder: Path) -> None:
    """Writes every table as <name>.csv; one without rows still has its header. Of a campaign of sequences alone the
    tables of steps are written, of one without sequences those of cells."""
    folder.mkdir(parents=True, exist_ok=True)
    if campaign.tasks or not campaign.passes:
        found = Tables(makers_of(cell_table(campaign), cell_table(campaign, True), campaign.info["solvers"]))
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
