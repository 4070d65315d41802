"""What a solver's error does to motion: motion.csv of `lcpbench motion`, read and checked."""

from pathlib import Path

import pandas as pd

from . import csv_file

FILE = "motion.csv"
COLUMNS = {
    "scene": "text", "level": "text", "size": "integer", "seed": "integer", "solver": "text", "tolerance": "number",
    "step": "integer", "time": "number", "energy": "number?", "energy_error": "number?", "penetration": "number?",
    "joint_error": "number?", "distance": "number?", "rho": "number?", "solve_time_s": "number", "solves": "integer",
    "failed": "integer", "not_passed": "integer", "false_successes": "integer", "stopped": "text?",
}


def read(folder: Path) -> pd.DataFrame:
    """@throws ReportError as csv_file.read"""
    return csv_file.read(folder, FILE, COLUMNS, "`lcpbench motion`")


def scenes(table: pd.DataFrame | None) -> list[tuple[str, str]]:
    """(scene, level) in the order of the file; none without one."""
    return [] if table is None else list(dict.fromkeys(zip(table["scene"], table["level"])))


def of_scene(table: pd.DataFrame, scene: str, level: str) -> pd.DataFrame:
    return table[(table["scene"] == scene) & (table["level"] == level)]
