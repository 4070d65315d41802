"""All tables of a campaign, and their files."""

from collections.abc import Callable
from pathlib import Path

import pandas as pd

from .accuracy import accuracy_table
from .cells import cell_table
from .coverage import coverage_table
from .latency import deadline_table, latency_by_solver_table, latency_table
from .load import Campaign
from .means import mean_table
from .oracle import oracle_table
from .pairwise import pairwise_table
from .precision import delivered_table, precision_table
from .profiles import profile_table
from .scaling import scaling_table

FOLDER = "analysis"
# Name -> function of the table of cells.
TABLES: dict[str, Callable[[pd.DataFrame], pd.DataFrame]] = {
    "cells": lambda cells: cells, "profiles": profile_table, "pairwise": pairwise_table, "means": mean_table,
    "coverage": coverage_table, "scaling": scaling_table, "precision": precision_table, "delivered": delivered_table,
    "accuracy": accuracy_table, "oracle": oracle_table,
}
# Name -> function of a campaign that has passes over sequences.
STEP_TABLES: dict[str, Callable[[Campaign], pd.DataFrame]] = {
    "latency": latency_table, "latency_by_solver": latency_by_solver_table, "deadline": deadline_table,
}
_DIGITS = "%.9g"


def write_tables(campaign: Campaign, folder: Path) -> None:
    """Writes every table as <name>.csv; one without rows still has its header. Of a campaign of sequences alone the
    tables of steps are written, of one without sequences those of cells."""
    folder.mkdir(parents=True, exist_ok=True)
    if campaign.cells or not campaign.passes:
        cells = cell_table(campaign)
        for name, table in TABLES.items():
            write_csv(table(cells), folder / f"{name}.csv")
    if campaign.passes:
        for name, table in STEP_TABLES.items():
            write_csv(table(campaign), folder / f"{name}.csv")


def write_csv(table: pd.DataFrame, path: Path) -> None:
    """Booleans as true and false, what is not known empty, infinite as inf."""
    words = {True: "true", False: "false"}
    booleans = {name: column.map(words) for name, column in table.items()
                if len(column) and all(isinstance(value, bool) for value in column)}
    table.assign(**booleans).to_csv(path, index=False, float_format=_DIGITS, lineterminator="\n")
