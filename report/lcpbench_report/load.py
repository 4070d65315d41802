"""Reads a results folder and checks it against benchmarks/RESULTS.md, schema version 1.

Nothing is repaired in silence: a value that does not fit raises ReportError naming file, line and column.
"""

import json
import math
from dataclasses import dataclass, field
from pathlib import Path

import pandas as pd

from . import motion
from .errors import ReportError
from .timing import TimedCell, read_timing

SCHEMA = "lcpbench-run/1"

# Column -> kind. "text?" and "number?" may be empty ("not known", NaN after loading); a kind with "*" may be empty in
# rows of excluded cells, where nothing was run.
PROBLEM_COLUMNS = {
    "problem": "text", "family": "text", "n": "count", "seed": "integer", "bodies": "number?", "movable": "number?",
    "nnz_a": "number?", "rank_a": "number?", "separating": "number?", "active": "number?", "independent": "number?",
    "oracle_contact_s": "number?", "oracle_body_s": "number?", "floor": "number?", "floor_solver": "text?",
}
ACCURACY_COLUMNS = {
    "problem": "text", "family": "text", "n": "count", "seed": "integer", "solver": "text", "tier": "number",
    "claim": "text*", "passes": "boolean*", "best_tier": "number?", "at_floor": "boolean*", "false_success": "boolean*",
    "false_infeasible": "boolean*", "iterations": "number?", "setup_s": "number?", "convert_s": "number?",
    "solve_s": "number?", "rho": "number?", "backward_error": "number?", "natural_residual": "number?",
    "natural_residual_siconos": "number?", "fischer_burmeister": "number?", "primal_infeasibility": "number?",
    "dual_infeasibility": "number?", "complementarity": "number?", "gap": "number?", "gap_rel": "number?",
    "energy_bound": "number?", "energy_shift": "number?", "w_error": "number?", "answer_floor": "number?",
    "excluded": "text?", "detail": "text?", "reason": "text?",
}
# Columns that older files of this schema do not have, and the cell that stands for them there.
ADDED_COLUMNS = {"floor": "", "floor_solver": "", "at_floor": "false", "answer_floor": ""}
# Key -> type; what the page cannot do without.
RUN_KEYS = {
    "schema": str, "suite": str, "started": str, "wall_s": (int, float, type(None)), "git_commit": str,
    "git_dirty": bool, "compiler": str, "flags": str, "build_type": str, "cpu": str, "cores": int,
    "memory_bytes": (int, float), "os": str, "libraries": dict,
    "tiers": list, "time_limit_s": (int, float, type(None)), "repetitions": int,
    "min_time_s": (int, float), "seed": (int, type(None)), "solvers": list, "scenes": list, "metrics": list,
}
SOLVER_KEYS = {"key": str, "method": str, "source": str, "available": bool, "uses_tolerance": bool, "origin": str,
               "licence": str, "library_version": str}
ORIGINS = ("own", "peer", "external")
SCENE_KEYS = {"key": str, "title": str, "purpose": str, "picture": (str, type(None))}
METRIC_KEYS = {"key": str, "formula": str}


@dataclass
class Results:
    """One results folder, checked."""

    run: dict
    problems: pd.DataFrame
    accuracy: pd.DataFrame
    timing: list[TimedCell]
    pictures: dict[str, str] = field(default_factory=dict)  # family -> SVG text
    motion: pd.DataFrame | None = None  # motion.csv, where there is one

    @property
    def tiers(self) -> list[float]:
        """Loosest first."""
        return sorted(self.run["tiers"], reverse=True)

    @property
    def solvers(self) -> list[str]:
        """Those of this build: own ones, peers, external ones, each in the registry's order."""
        return [s["key"] for s in sorted(self.run["solvers"], key=lambda s: ORIGINS.index(s["origin"]))
                if s["available"]]

    @property
    def missing(self) -> list[str]:
        """Those that are not in the build; they have no results."""
        return [solver["key"] for solver in self.run["solvers"] if not solver["available"]]

    def origin(self, solver: str) -> str:
        return next(s["origin"] for s in self.run["solvers"] if s["key"] == solver)

    @property
    def families(self) -> list[str]:
        """In the order of the scenes; families without a scene entry (stored problems) after them."""
        scenes = [scene["key"] for scene in self.run["scenes"]]
        present = list(dict.fromkeys(self.problems["family"]))
        return [key for key in scenes if key in present] + [key for key in present if key not in scenes]

    def direct(self, solver: str) -> bool:
        """A direct method: one run stands for every tier."""
        return any(s["key"] == solver and not s["uses_tolerance"] for s in self.run["solvers"])


def load_results(folder: Path) -> Results:
    """@throws ReportError for the first thing that does not fit"""
    if not folder.is_dir():
        raise ReportError(str(folder), "no such folder", "a folder written by `lcpbench run`")
    run = _read_run(folder)
    problems = _read_table(folder, "problems.csv", PROBLEM_COLUMNS)
    accuracy = _read_table(folder, "accuracy.csv", ACCURACY_COLUMNS)
    _check_keys(run, problems, accuracy)
    accuracy["tier"] = [match_tier(tier, run["tiers"]) for tier in accuracy["tier"]]
    results = Results(run, problems, accuracy, [], _read_pictures(folder, run))
    results.timing = read_timing(_read_json(folder, "timing.json"), results.families, results.solvers, run["tiers"])
    if motion.is_present(folder):
        results.motion = _read_table(folder, motion.FILE, motion.COLUMNS)
        motion.check(results.motion, results.solvers)
    return results


def match_tier(value: float, tiers: list[float]) -> float | None:
    """The tier of the run that `value` was printed from."""
    return next((tier for tier in tiers if math.isclose(value, tier, rel_tol=1e-6)), None)


def _read_text(folder: Path, name: str) -> str:
    path = folder / name
    if not path.is_file():
        raise ReportError(name, f"missing in {folder}", "the files listed in benchmarks/RESULTS.md")
    try:
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise ReportError(name, f"byte {error.start} is not text", "UTF-8") from error


def _read_json(folder: Path, name: str) -> dict:
    try:
        content = json.loads(_read_text(folder, name))
    except json.JSONDecodeError as error:
        raise ReportError(name, f"line {error.lineno}: {error.msg}", "JSON") from error
    if not isinstance(content, dict):
        raise ReportError(name, f"the top level is a {type(content).__name__}", "an object")
    return content


def _read_run(folder: Path) -> dict:
    run = _read_json(folder, "run.json")
    if run.get("schema") != SCHEMA:
        raise ReportError("run.json", f"schema is {run.get('schema')!r}", f"{SCHEMA!r}")
    _check_object("run.json", "", run, RUN_KEYS)
    for name, keys in (("solvers", SOLVER_KEYS), ("scenes", SCENE_KEYS), ("metrics", METRIC_KEYS)):
        for index, entry in enumerate(run[name]):
            _check_object("run.json", f"{name}[{index}].", entry, keys)
    for index, solver in enumerate(run["solvers"]):
        if solver["origin"] not in ORIGINS:
            raise ReportError("run.json", f"key 'solvers[{index}].origin' is {solver['origin']!r}", ", ".join(ORIGINS))
    for name in ("tiers", "solvers"):
        if not run[name]:
            raise ReportError("run.json", f"key '{name}' is empty", "at least one entry")
    for tier in run["tiers"]:
        if not isinstance(tier, (int, float)) or not 0 < tier < 1:
            raise ReportError("run.json", f"key 'tiers' holds {tier!r}", "numbers between 0 and 1")
    return run


def _check_object(file: str, where: str, entry: object, keys: dict) -> None:
    if not isinstance(entry, dict):
        raise ReportError(file, f"{where.rstrip('.')} is {entry!r}", "an object")
    for key, kind in keys.items():
        kinds = kind if isinstance(kind, tuple) else (kind,)
        expected = " or ".join("null" if k is type(None) else k.__name__ for k in kinds)
        if key not in entry:
            raise ReportError(file, f"key '{where}{key}' is missing", expected)
        value = entry[key]
        if not isinstance(value, kinds) or (isinstance(value, bool) and bool not in kinds):
            raise ReportError(file, f"key '{where}{key}' is {value!r}", expected)


def _read_table(folder: Path, name: str, columns: dict[str, str]) -> pd.DataFrame:
    _read_text(folder, name)  # one message for a missing or binary file
    try:
        raw = pd.read_csv(folder / name, dtype=str, keep_default_na=False)
    except (pd.errors.ParserError, pd.errors.EmptyDataError) as error:
        raise ReportError(name, str(error), "comma-separated rows under a header") from error
    for column in columns:
        if column not in raw.columns and column in ADDED_COLUMNS:
            raw[column] = ADDED_COLUMNS[column]
        if column not in raw.columns:
            raise ReportError(name, f"column '{column}' is missing", "columns " + ", ".join(columns))
    if raw.empty:
        raise ReportError(name, "no rows", "at least one row under the header")
    excluded = raw["excluded"] != "" if "excluded" in raw else pd.Series(False, index=raw.index)
    return pd.DataFrame({column: _convert(name, column, kind, raw[column], excluded)
                         for column, kind in columns.items()})


def _convert(file: str, column: str, kind: str, cells: pd.Series, excluded: pd.Series) -> list:
    values = []
    optional, kind = kind.endswith("*"), kind.rstrip("*")
    for index, (cell, left_out) in enumerate(zip(cells, excluded)):
        cell = cell.strip() if isinstance(cell, str) else ""
        if optional and left_out and not cell:
            values.append({"boolean": False, "text": ""}[kind])
            continue
        value = _parse(cell, kind)
        if value is None:
            words = {"text": "a word", "count": "a whole number >= 1", "integer": "a whole number",
                     "number": "a number", "number?": "a number, inf, nan or nothing", "boolean": "true or false"}
            raise ReportError(file, f"line {index + 2}, column '{column}' is {cell!r}", words[kind])
        values.append(value)
    return values


def _parse(cell: str, kind: str) -> object:
    """None when the cell does not fit."""
    if kind == "text?":
        return cell
    if kind == "text":
        return cell or None
    if kind == "boolean":
        return {"true": True, "false": False}.get(cell)
    if kind == "number?" and not cell:
        return math.nan
    try:
        if kind in ("count", "integer"):
            value = int(cell)
            return value if kind == "integer" or value >= 1 else None
        value = float(cell)
    except ValueError:
        return None
    return None if kind == "number" and not math.isfinite(value) else value


def _check_keys(run: dict, problems: pd.DataFrame, accuracy: pd.DataFrame) -> None:
    """Every row of accuracy.csv must refer to something known, once."""
    _check_unique("problems.csv", problems, ["problem"])
    _check_unique("accuracy.csv", accuracy, ["problem", "solver", "tier"])
    known = {row.problem: row._asdict() for row in problems.itertuples(index=False)}
    solvers = {solver["key"] for solver in run["solvers"] if solver["available"]}
    for index, row in enumerate(accuracy[["problem", "family", "n", "seed", "solver", "tier"]].itertuples(index=False)):
        where = f"line {index + 2}"
        if row.problem not in known:
            raise ReportError("accuracy.csv", f"{where}, column 'problem' is {row.problem!r}", "a row of problems.csv")
        if row.solver not in solvers:
            raise ReportError("accuracy.csv", f"{where}, column 'solver' is {row.solver!r}",
                              "an available solver of run.json")
        if match_tier(row.tier, run["tiers"]) is None:
            raise ReportError("accuracy.csv", f"{where}, column 'tier' is {row.tier!r}", "a tier of run.json")
        for column in ("family", "n", "seed"):
            value, expected = getattr(row, column), known[row.problem][column]
            if value != expected:
                raise ReportError("accuracy.csv", f"{where}, column '{column}' is {value!r}",
                                  f"{expected!r} as in problems.csv")


def _check_unique(file: str, table: pd.DataFrame, columns: list[str]) -> None:
    repeated = table.duplicated(columns)
    if repeated.any():
        index = int(repeated.to_numpy().argmax())
        values = ", ".join(str(table.iloc[index][column]) for column in columns)
        raise ReportError(file, f"line {index + 2} repeats {values}", f"one row per {' x '.join(columns)}")


def _read_pictures(folder: Path, run: dict) -> dict[str, str]:
    return {scene["key"]: _read_text(folder, scene["picture"]) for scene in run["scenes"] if scene["picture"]}
