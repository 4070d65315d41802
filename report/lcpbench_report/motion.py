"""What a solver's error does to motion: motion.csv of `lcpbench motion`, read and checked."""

import math
from pathlib import Path

import pandas as pd

from .errors import ReportError
from .statistics.jsonl import is_there, packed

FILE = "motion.csv"
# Column -> kind.
COLUMNS = {
    "scene": "text", "level": "text", "size": "integer", "seed": "integer", "solver": "text", "tolerance": "number",
    "step": "integer", "time": "number", "energy": "number?", "energy_error": "number?", "penetration": "number?",
    "joint_error": "number?", "distance": "number?", "rho": "number?", "solve_time_s": "number", "solves": "integer",
    "failed": "integer", "not_passed": "integer", "false_successes": "integer", "stopped": "text?",
}
# Kind -> what a cell of it is, in words. A "?" marks kinds that may be empty: "" or NaN after reading.
_WORDS = {"text": "a word", "text?": "anything", "integer": "a whole number", "number": "a number",
          "number?": "a number, inf, nan or nothing"}


def read(folder: Path) -> pd.DataFrame:
    """The columns; others are dropped. A file that ends in .xz stands for one that is not there.

    @throws ReportError naming line and column of the first cell that does not fit
    """
    path = folder / FILE
    try:
        raw = pd.read_csv(path if path.is_file() else packed(path), dtype=str, keep_default_na=False)
    except (pd.errors.ParserError, pd.errors.EmptyDataError, UnicodeDecodeError) as error:
        raise ReportError(path.name, str(error), "comma-separated rows under a header") from error
    for column in COLUMNS:
        if column not in raw.columns:
            raise ReportError(path.name, f"column '{column}' is missing", "columns " + ", ".join(COLUMNS))
    if raw.empty:
        raise ReportError(path.name, "no rows", "at least one row under the header")
    return pd.DataFrame({column: _column(path.name, column, kind, raw[column]) for column, kind in COLUMNS.items()})


def is_present(folder: Path) -> bool:
    return is_there(folder / FILE)


def scenes(table: pd.DataFrame | None) -> list[tuple[str, str]]:
    """(scene, level) in the order of the file; none without one."""
    return [] if table is None else list(dict.fromkeys(zip(table["scene"], table["level"])))


def of_scene(table: pd.DataFrame, scene: str, level: str) -> pd.DataFrame:
    return table[(table["scene"] == scene) & (table["level"] == level)]


def _column(file: str, column: str, kind: str, cells: pd.Series) -> list:
    values = []
    for index, cell in enumerate(cells):
        value = _parse(cell.strip() if isinstance(cell, str) else "", kind)
        if value is None:
            raise ReportError(file, f"line {index + 2}, column '{column}' is {cell!r}", _WORDS[kind])
        values.append(value)
    return values


def _parse(cell: str, kind: str) -> object:
    """None when the cell does not fit."""
    if kind == "text?":
        return cell
    if kind == "text":
        return cell or None
    if kind == "number?" and not cell:
        return math.nan
    try:
        value = int(cell) if kind == "integer" else float(cell)
    except ValueError:
        return None
    return None if kind == "number" and not math.isfinite(value) else value
