"""What a solver's error does to motion: what motion.csv of `lcpbench motion` holds, and its summary."""

import math
from pathlib import Path

import pandas as pd

from . import formats
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


def scenes(table: pd.DataFrame) -> list[tuple[str, str]]:
    """(scene, level) in the order of the file."""
    return list(dict.fromkeys(zip(table["scene"], table["level"])))


def of_scene(table: pd.DataFrame, scene: str, level: str) -> pd.DataFrame:
    return table[(table["scene"] == scene) & (table["level"] == level)]


def summary(table: pd.DataFrame, solvers: list[str]) -> list[dict]:
    """One row per solver and tolerance of one scene: worst values, and counts at the end."""
    rows = []
    for solver in solvers:
        mine = table[table["solver"] == solver]
        for tolerance in sorted(set(mine["tolerance"]), reverse=True):
            run = mine[mine["tolerance"] == tolerance]
            last = run.iloc[-1]
            rows.append({
                "solver": solver, "first": not rows or rows[-1]["solver"] != solver,
                "tolerance": formats.power(tolerance), "time": f"{last['time']:.3g}",
                "energy": _number(run["energy_error"].max()), "penetration": _number(run["penetration"].max()),
                "joint": _number(run["joint_error"].max()), "distance": _number(run["distance"].max()),
                "per_step": formats.seconds(last["solve_time_s"] / max(1, last["step"])),
                "solves": int(last["solves"]), "failed": int(last["failed"]), "not_passed": int(last["not_passed"]),
                "false": int(last["false_successes"]), "stopped": last["stopped"],
            })
    return rows


def _number(value: float) -> str:
    if not math.isfinite(value):
        return formats.DASH
    return "0" if value == 0 else f"{value:.1e}"
