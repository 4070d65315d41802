"""Curves that users ask authors of engines for: the files of `solver_curves` (make solver-curves), read and checked."""

from pathlib import Path

import pandas as pd

from . import csv_file
from .errors import ReportError
from .statistics.jsonl import is_there

MASS_RATIO, REGULARIZATION, SWEEPS, PRECISION = "mass-ratio", "regularization", "sweeps", "precision"
# Curve -> columns of its file, <curve>.csv.
CURVES = {
    MASS_RATIO: {"scene": "text", "rows": "integer", "mass_ratio": "number", "budget_s": "number", "solver": "text",
                 "origin": "text", "asked": "number", "rho": "number?", "seconds": "number?", "status": "text"},
    REGULARIZATION: {"scene": "text", "rows": "integer", "solver": "text", "origin": "text",
                     "regularization": "number?", "rho": "number?", "violation": "number?", "seconds": "number",
                     "status": "text"},
    SWEEPS: {"scene": "text", "rows": "integer", "step_s": "number", "solver": "text", "sweeps": "number?",
             "rho": "number?", "penetration": "number", "joint_error": "number", "seconds_per_step": "number",
             "steps": "integer", "stopped": "text?"},
    PRECISION: {"scene": "text", "rows": "integer", "method": "text", "precision": "text", "sweeps": "number?",
                "mass_ratio": "number", "rho": "number?", "seconds": "number"},
}


def file_of(curve: str) -> str:
    return f"{curve}.csv"


def read(folder: Path) -> dict[str, pd.DataFrame]:
    """Those that the folder has, by name.

    @throws ReportError as csv_file.read, and where there is none at all
    """
    found = {curve: csv_file.read(folder, file_of(curve), columns, "`make solver-curves`")
             for curve, columns in CURVES.items() if is_there(folder / file_of(curve))}
    if not found:
        raise ReportError(str(folder), f"has none of {', '.join(map(file_of, CURVES))}",
                          "a folder written by `make solver-curves`")
    return found
