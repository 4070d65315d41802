"""What a solver's error does to motion: motion.csv of `lcpbench motion`, read and checked."""

from pathlib import Path

import pandas as pd

from .errors import ReportError
from .statistics.jsonl import is_there, packed

FILE = "motion.csv"
# Column -> kind, of which "?" marks those that may be empty: "" or NaN after reading.
COLUMNS = {
    "scene": "text", "level": "text", "size": "integer", "seed": "integer", "solver": "text", "tolerance": "number",
    "step": "integer", "time": "number", "energy": "number?", "energy_error": "number?", "penetration": "number?",
    "joint_error": "number?", "distance": "number?", "rho": "number?", "solve_time_s": "number", "solves": "integer",
    "failed": "integer", "not_passed": "integer", "false_successes": "integer", "stopped": "text?",
}
# Kind -> what a cell of it looks like, and is in words.
_NUMBER = r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?"
_KINDS = {"text": (r".+", "a word"), "text?": (r".*", "anything"), "integer": (r"[+-]?\d+", "a whole number"),
          "number": (_NUMBER, "a number"), "number?": (rf"({_NUMBER}|[+-]?(inf|nan))?", "a number, inf, nan or nothing")}


def read(folder: Path) -> pd.DataFrame:
    """The columns; others are dropped. A file that ends in .xz stands for one that is not there.

    @throws ReportError where there is none, or naming line and column of the first cell that does not fit
    """
    path = folder / FILE
    if not is_there(path):
        raise ReportError(str(folder), f"has no {FILE}", "a folder written by `lcpbench motion`")
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


def scenes(table: pd.DataFrame | None) -> list[tuple[str, str]]:
    """(scene, level) in the order of the file; none without one."""
    return [] if table is None else list(dict.fromkeys(zip(table["scene"], table["level"])))


def of_scene(table: pd.DataFrame, scene: str, level: str) -> pd.DataFrame:
    return table[(table["scene"] == scene) & (table["level"] == level)]


def _column(file: str, column: str, kind: str, cells: pd.Series) -> pd.Series:
    pattern, words = _KINDS[kind]
    cells = cells.str.strip()
    wrong = ~cells.str.fullmatch(pattern)
    if wrong.any():
        raise ReportError(file, f"line {wrong.idxmax() + 2}, column '{column}' is {cells[wrong.idxmax()]!r}", words)
    return cells if kind.startswith("text") else cells.replace("", "nan").astype(int if kind == "integer" else float)
