"""All tables of a campaign, and their files."""

from collections.abc import Callable
from pathlib import Path

import pandas as pd

from .accuracy import accuracy_table
from .coverage import coverage_table
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
    "coverage": coverage_table, "scaling": scaling_table, "precision": precision_table, "delivered": delivered_table, "accuracy": accuracy_table,
    "oracle": oracle_table,
}
_DIGITS = "%.9g"


def write_tables(cells: pd.DataFrame, folder: Path) -> None:
    """Writes every table as <name>.csv; one without rows still has its header."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, table in TABLES.items():
        write_csv(table(cells), folder / f"{name}.csv")


def write_csv(table: pd.DataFrame, path: Path) -> None:
    """Booleans as true and false, what is not known empty, infinite as inf."""
    words = {True: "true", False: "false"}
    booleans = {name: column.map(words) for name, column in table.items()
                if len(column) and all(isinstance(value, bool) for value in column)}
    table.assign(**booleans).to_csv(path, index=False, float_format=_DIGITS, lineterminator="\n")
