"""motion.csv of `lcpbench motion`, what a solver's error does to motion, read and checked column by column."""

from pathlib import Path

import pandas as pd

from .errors import ReportError
from .statistics.jsonl import is_there, packed

MOTION_FILE = "motion.csv"
MOTION_COLUMNS = {
    "scene": "text", "level": "text", "size": "integer", "seed": "integer", "solver": "text", "tolerance": "number",
    "step": "integer", "time": "number", "energy": "number?", "energy_error": "number?", "penetration": "number?",
    "joint_error": "number?", "distance": "number?", "rho": "number?", "solve_time_s": "number", "solves": "integer",
    "failed": "integer", "not_passed": "integer", "false_successes": "integer", "stopped": "text?",
    "lost_gap": "number?", "creep": "number?", "created": "number?", "max_iterations": "integer", "start": "text",
    "width": "number?",
}
DRIVER = "driver"  # a column that is made here: how the command names solver, max_iterations and start
# Kind of a column -> what a cell of it looks like, and is in words; "?" marks those that may be empty: "" or NaN after
# reading.
_NUMBER = r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?"
_KINDS = {"text": (r".+", "a word"), "text?": (r".*", "anything"), "integer": (r"[+-]?\d+", "a whole number"),
          "number": (_NUMBER, "a number"), "number?": (rf"({_NUMBER}|[+-]?(inf|nan))?", "a number, inf, nan or nothing")}


def read_motion(*folders: Path) -> pd.DataFrame:
    """MOTION_COLUMNS and DRIVER, of all folders.

    @throws ReportError as _read, and for a scene that is in two of them
    """
    tables: list[pd.DataFrame] = []
    for folder in folders:
        table = _read(folder, MOTION_FILE, MOTION_COLUMNS, "`lcpbench motion`")
        known = {scene for other in tables for scene in other["scene"]}
        if both := known & set(table["scene"]):
            raise ReportError(str(folder), f"scene {min(both)!r} is in another folder too", "studies of different scenes")
        limits = table["max_iterations"].map(lambda limit: f"@{limit}" if limit else "")
        tables.append(table.assign(**{DRIVER: table["solver"] + limits + table["start"].map(lambda start: "@cold" * (start == "cold"))}))
    return pd.concat(tables, ignore_index=True)


def _read(folder: Path, file: str, columns: dict[str, str], writer: str) -> pd.DataFrame:
    """The columns; others are dropped. A file that ends in .xz stands for one that is not there.

    @param columns  name -> kind
    @param writer   what writes such a folder
    @throws ReportError where there is none, or naming line and column of the first cell that does not fit
    """
    path = folder / file
    if not is_there(path):
        raise ReportError(str(folder), f"has no {file}", f"a folder written by {writer}")
    try:
        raw = pd.read_csv(path if path.is_file() else packed(path), dtype=str, keep_default_na=False)
    except (pd.errors.ParserError, pd.errors.EmptyDataError, UnicodeDecodeError) as error:
        raise ReportError(path.name, str(error), "comma-separated rows under a header") from error
    for column in columns:
        if column not in raw.columns:
            raise ReportError(path.name, f"column '{column}' is missing", "columns " + ", ".join(columns))
    if raw.empty:
        raise ReportError(path.name, "no rows", "at least one row under the header")
    return pd.DataFrame({column: _column(path.name, column, kind, raw[column]) for column, kind in columns.items()})


def _column(file: str, column: str, kind: str, cells: pd.Series) -> pd.Series:
    pattern, words = _KINDS[kind]
    cells = cells.str.strip()
    wrong = ~cells.str.fullmatch(pattern)
    if wrong.any():
        raise ReportError(file, f"line {wrong.idxmax() + 2}, column '{column}' is {cells[wrong.idxmax()]!r}", words)
    return cells if kind.startswith("text") else cells.replace("", "nan").astype(int if kind == "integer" else float)
