"""What a solver's error does to motion: what motion.csv of `lcpbench motion` holds."""

from pathlib import Path

import pandas as pd

from .csv_table import read_table
from .statistics.jsonl import is_there

FILE = "motion.csv"
# Kinds as in csv_table.py.
COLUMNS = {
    "scene": "text", "level": "text", "size": "integer", "seed": "integer", "solver": "text", "tolerance": "number",
    "step": "integer", "time": "number", "energy": "number?", "energy_error": "number?", "penetration": "number?",
    "joint_error": "number?", "distance": "number?", "rho": "number?", "solve_time_s": "number", "solves": "integer",
    "failed": "integer", "not_passed": "integer", "false_successes": "integer", "stopped": "text?",
}


def read(folder: Path) -> pd.DataFrame:
    """@throws ReportError for the first thing that does not fit"""
    return read_table(folder / FILE, COLUMNS)


def is_present(folder: Path) -> bool:
    return is_there(folder / FILE)


def scenes(table: pd.DataFrame | None) -> list[tuple[str, str]]:
    """(scene, level) in the order of the file; none without one."""
    return [] if table is None else list(dict.fromkeys(zip(table["scene"], table["level"])))


def of_scene(table: pd.DataFrame, scene: str, level: str) -> pd.DataFrame:
    return table[(table["scene"] == scene) & (table["level"] == level)]
