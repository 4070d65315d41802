"""Reads a campaign's folder, schema "lcpbench-campaign/1", and checks it.

Nothing is repaired in silence: what does not fit raises ReportError naming file, line and key.
"""

import json
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from ..errors import ReportError
from .fields import check_fields, check_word
from .jsonl import is_there, read_lines
from .steps import FILE as STEPS_FILE
from .steps import PassKey, PassRuns, read_passes, read_sequences

SCHEMA = "lcpbench-campaign/1"
MODES = ("cold", "cold-cache", "warm")
_CAMPAIGN = {"schema": "name", "name": "text", "solvers": "list", "tiers": "list", "limits": "object"}
_SOLVER = {"key": "name", "setting": "text", "origin": "text", "uses_tolerance": "boolean", "available": "boolean"}
_LIMITS = {"time_per_row_s": "time", "least_s": "time", "most_s": "positive"}
_PROBLEM = {"problem": "name", "set": "name", "family": "name", "rows": "count", "reference": "name",
            "counts": "boolean", "oracle_s": "positive?", "floor": "time?"}
_REFERENCES = ("certified", "bounded", "none")
_CELL = {"problem": "name", "solver": "name", "tier": "positive", "round": "count", "mode": "name", "excluded": "text"}
# What a cell that was run has besides.
_RUN = {"claim": "name", "passes": "boolean", "best_tier": "number?", "at_floor": "boolean", "false_success": "boolean",
        "false_infeasible": "boolean", "iterations": "number?", "reason": "text", "metrics": "object",
        "time_limit_s": "positive", "setup_s": "times", "solve_s": "times", "convert_s": "times?",
        "peak_bytes": "time?"}
# What runners write since they observe the machine and the first solve; absent in older folders.
_OBSERVED = {"first_s": "time?", "factor_s": "time?", "factor_of_s": "time?", "allocations": "object?",
             "disturbance": "object?", "proved_infeasible": "boolean"}

# (problem, solver, tier, mode)
CellKey = tuple[str, str, float, str]


@dataclass
class CellRuns:
    """One cell: its verdict is that of round 0, its repetitions are those of all rounds."""

    record: dict = field(default_factory=dict)  # the line of round 0
    rounds: dict[int, list[float]] = field(default_factory=dict)  # round -> solve times [s]
    passed: dict[int, bool] = field(default_factory=dict)  # round -> whether it passed
    disturbed: set[int] = field(default_factory=set)  # rounds that the machine disturbed, also when run again
    environments: dict[int, str] = field(default_factory=dict)  # round -> hash of campaign.json's environment
    setup_s: list[float] = field(default_factory=list)
    convert_s: list[float] = field(default_factory=list)

    @property
    def changed(self) -> int:
        """Rounds with another verdict than round 0."""
        return sum(passed != self.passed[0] for passed in self.passed.values())

    def times(self) -> list[list[float]]:
        """Solve times [s], a list for every round with the verdict of round 0: the others did something else. Rounds
        that the machine disturbed are left out where there are others."""
        same = [index for index in sorted(self.rounds)
                if self.rounds[index] and self.passed[index] == self.passed[0]]
        calm = [index for index in same if index not in self.disturbed]
        return [self.rounds[index] for index in calm or same]


@dataclass
class Campaign:
    """One campaign's folder, checked."""

    info: dict  # campaign.json
    problems: dict[str, dict]
    cells: dict[CellKey, CellRuns]
    notes: list[str]  # what was passed over
    sequences: dict[str, dict] = field(default_factory=dict)  # of campaign.json, by name
    passes: dict[PassKey, PassRuns] = field(default_factory=dict)  # over the sequences

    def time_limit(self, rows: int) -> float:
        """Of one solve of a problem with so many rows [s]."""
        limits = self.info["limits"]
        return min(max(limits["time_per_row_s"] * rows, limits["least_s"]), limits["most_s"])

    def repetitions(self, problem: str, solver: str, tier: float, mode: str = "cold") -> list[list[float]]:
        """Solve times [s] of a cell, a list for every round; empty where there is no such cell."""
        runs = self.cells.get((problem, solver, tier, mode))
        return runs.times() if runs else []


def load_campaign(folder: Path) -> Campaign:
    """A campaign of sequences alone need not have the files of problems and cells.

    @throws ReportError for the first thing that does not fit
    """
    if not folder.is_dir():
        raise ReportError(str(folder), "no such folder", "a campaign's folder")
    notes: list[str] = []
    info = _read_info(folder / "campaign.json")
    problems: dict[str, dict] = {}
    cells: dict[CellKey, CellRuns] = {}
    has_cells = any(is_there(folder / name) for name in ("problems.jsonl", "cells.jsonl"))
    if has_cells or not is_there(folder / STEPS_FILE):
        problems = _read_problems(folder / "problems.jsonl", notes.append)
        cells = _read_cells(folder / "cells.jsonl", info, problems, notes.append)
    sequences = read_sequences(info, "campaign.json")
    passes = read_passes(folder / STEPS_FILE, info, sequences, notes.append)
    return Campaign(info, problems, cells, notes, sequences, passes)


def _read_info(path: Path) -> dict:
    if not path.is_file():
        raise ReportError(path.name, f"missing in {path.parent}", "the files of a campaign, benchmarks/RESULTS.md")
    try:
        info = json.loads(path.read_bytes().decode("utf-8"))
    except ValueError as error:
        raise ReportError(path.name, str(error), "JSON") from error
    if not isinstance(info, dict) or info.get("schema") != SCHEMA:
        found = info.get("schema") if isinstance(info, dict) else info
        raise ReportError(path.name, f"schema is {str(found)[:60]!r}", f"{SCHEMA!r}")
    check_fields(path.name, info, _CAMPAIGN)
    check_fields(f"{path.name}: limits", info["limits"], _LIMITS)
    for index, solver in enumerate(info["solvers"]):
        check_fields(f"{path.name}: solvers[{index}]", solver, _SOLVER)
    keys = [solver["key"] for solver in info["solvers"]]
    for key in keys:
        if keys.count(key) > 1:
            raise ReportError(path.name, f"solver {key!r} is there {keys.count(key)} times", "every key once")
    for tier in info["tiers"]:
        check_fields(f"{path.name}: tiers", {"tier": tier}, {"tier": "positive"})
    return info


def _read_problems(path: Path, note: Callable[[str], None]) -> dict[str, dict]:
    problems: dict[str, dict] = {}
    for number, line in read_lines(path, note):
        place = f"{path.name}:{number}"
        record = check_fields(place, line, _PROBLEM)
        check_word(place, record, "reference", _REFERENCES)
        if record["problem"] in problems:
            raise ReportError(place, f"problem {record['problem']!r} is there twice", "a line per problem")
        problems[record["problem"]] = record
    return problems


def _read_cells(path: Path, info: dict, problems: dict[str, dict], note: Callable[[str], None]):
    solvers = [solver["key"] for solver in info["solvers"] if solver["available"]]
    cells: dict[CellKey, CellRuns] = {}
    for number, line in read_lines(path, note):
        place = f"{path.name}:{number}"
        record = check_fields(place, line, _CELL)
        check_word(place, record, "mode", MODES)
        if record["problem"] not in problems:
            raise ReportError(place, f"problem is {record['problem']!r}", "a problem of problems.jsonl")
        if record["solver"] not in solvers:
            raise ReportError(place, f"solver is {record['solver']!r}", "an available solver of campaign.json")
        tier = next((t for t in info["tiers"] if math.isclose(t, record["tier"], rel_tol=1e-6)), None)
        if tier is None:
            raise ReportError(place, f"tier is {record['tier']!r}", "a tier of campaign.json")
        if not record["excluded"]:
            _check_run(place, record)
        _add(place, cells.setdefault((record["problem"], record["solver"], tier, record["mode"]), CellRuns()), record)
    for key, runs in cells.items():
        if not runs.record:
            raise ReportError(path.name, f"cell {', '.join(map(str, key))} has no round 0", "a line for every round")
    return cells


def _check_run(place: str, record: dict) -> None:
    check_fields(place, record, _RUN)
    check_fields(place, record, {key: kind for key, kind in _OBSERVED.items() if key in record})
    check_fields(f"{place}: metrics", record["metrics"], dict.fromkeys(record["metrics"], "number?"))
    # Ratios and logarithms of what counts; what failed at once may well have taken no time.
    if record["passes"] and not (record["solve_s"] and min(record["solve_s"]) > 0):
        raise ReportError(place, f"key 'solve_s' is {record['solve_s']}", "numbers > 0 where a solve passes")


def _add(place: str, runs: CellRuns, record: dict) -> None:
    """A later round of a cell may come before round 0: processes that share a folder end as they like."""
    index = int(record["round"])
    if index in runs.rounds:
        raise ReportError(place, f"round {index} of this cell is there twice", "a line per cell and round")
    runs.rounds[index] = [] if record["excluded"] else record["solve_s"]
    runs.passed[index] = not record["excluded"] and record["passes"]
    if index == 0:
        runs.record = record
    if record["excluded"]:
        return
    if (record.get("disturbance") or {}).get("disturbed"):
        runs.disturbed.add(index)
    runs.environments[index] = str(record.get("environment", ""))
    runs.setup_s += record["setup_s"]
    runs.convert_s += record["convert_s"] or []
