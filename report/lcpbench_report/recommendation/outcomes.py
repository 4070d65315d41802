"""What the solvers of campaigns did: a row per problem, solver and tier, with the times that an engine would see."""

import json
import math
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from ..errors import ReportError
from ..statistics.cells import cell_table
from ..statistics.jsonl import read_lines
from ..statistics.load import load_campaign

_TABLES = ("cells.csv", "cells.csv.gz")  # of the folder analysis; the second as an archive has it
_COLUMNS = ["problem", "family", "rows", "solver", "tier", "mode", "excluded", "passes", "false_success", "time_s",
            "setup_s", "convert_s"]
_MODE = "cold"
# How a solver is timed: a new one with its set-up, and one that is set up already. One that an engine keeps from step
# to step lies between them: its set-up finds workspace and what is known of the structure.
MEASURES = ("latency_s", "solve_s")


@dataclass
class Outcomes:
    """`table` has the columns problem, family, rows, seed, solver, tier, verified, false_success, excluded, and
    of MEASURES (infinite where the answer was not verified); `features` a row per problem, by its name."""

    table: pd.DataFrame
    features: pd.DataFrame
    own: list[str]  # keys of solvers that can be linked
    peers: list[str]
    campaigns: list[dict]  # where the numbers come from


def read_outcomes(folders: Iterable[Path], features: Path) -> Outcomes:
    """The cells of campaigns' folders. The tables of `lcpbench analyse` are taken where they are newer than the cells,
    which saves a minute.

    A latency is set-up and solve; of solvers in processes of their own solve and conversion.

    @param features  written by `lcpbench recommend --features`: JSON lines
    @throws ReportError for the first thing that does not fit
    """
    tables, campaigns = [], []
    origins: dict[str, str] = {}
    for folder in folders:
        info = _info(folder)
        origins |= {solver["key"]: solver["origin"] for solver in info["solvers"] if solver["available"]}
        campaigns.append(_provenance(info))
        tables.append(_cells(folder))
    cells = pd.concat(tables, ignore_index=True)
    cells = cells[(cells["mode"] == _MODE) & cells.solver.isin(origins)]
    twice = cells.duplicated(["problem", "solver", "tier"])
    if twice.any():
        raise ReportError("campaigns", f"problem {cells[twice].problem.iloc[0]!r} is in two", "every cell once")
    known = _features(features)
    missing = sorted(set(cells.problem) - set(known.index))
    if missing:
        raise ReportError(features.name, f"no line for problem {missing[0]!r}",
                          "a line for every problem of the campaigns")
    own = [key for key, origin in origins.items() if origin == "own"]
    return Outcomes(_outcomes(cells, set(own)), known, own, [key for key in origins if key not in own], campaigns)


def _info(folder: Path) -> dict:
    path = folder / "campaign.json"
    if not path.is_file():
        raise ReportError(path.name, f"missing in {folder}", "the files of a campaign, benchmarks/RESULTS.md")
    try:
        info = json.loads(path.read_text("utf-8"))
        return info | {"solvers": list(info["solvers"]), "manifests": list(info["manifests"])}
    except (ValueError, KeyError, TypeError) as error:
        raise ReportError(str(path), str(error), "a campaign's description, benchmarks/RESULTS.md") from error


def _provenance(info: dict) -> dict:
    environment = info.get("environment", {})
    return {"name": info["name"], "commit": environment.get("git_commit", ""), "dirty": environment.get("git_dirty"),
            "started": info.get("started"), "cpu": environment.get("cpu", ""),
            "compiler": environment.get("compiler", ""), "flags": environment.get("flags", ""),
            "solver_flags": environment.get("solver_flags", ""), "libraries": environment.get("libraries", {}),
            "environment_hash": info.get("environment_hash"), "manifests": info["manifests"]}


def _cells(folder: Path) -> pd.DataFrame:
    cells = folder / "cells.jsonl"
    for table in (folder / "analysis" / name for name in _TABLES):
        if table.is_file() and (not cells.is_file() or table.stat().st_mtime >= cells.stat().st_mtime):
            return pd.read_csv(table, usecols=_COLUMNS, low_memory=False)
    return cell_table(load_campaign(folder))[_COLUMNS]


def _features(path: Path) -> pd.DataFrame:
    if not path.is_file():
        raise ReportError(str(path), "no such file", "what `lcpbench recommend --features` writes")
    lines = [line for _, line in read_lines(path, lambda note: None)]
    if not lines or any("problem" not in line or "rows" not in line for line in lines):
        raise ReportError(path.name, "lines without problem and rows", "what `lcpbench recommend --features` writes")
    return pd.DataFrame(lines).drop_duplicates("problem").set_index("problem").astype(float)


def _outcomes(cells: pd.DataFrame, own: set[str]) -> pd.DataFrame:
    beside = np.where(cells.solver.isin(own), cells.setup_s, cells.convert_s.fillna(0))
    verified = cells.passes.astype(bool)
    found = cells[["problem", "family", "rows", "solver", "tier"]].copy()
    found["verified"] = verified
    found["false_success"] = cells.false_success.astype(bool)
    found["excluded"] = cells.excluded.notna() & (cells.excluded != "")
    found["latency_s"] = np.where(verified, cells.time_s + beside, math.inf)
    found["solve_s"] = np.where(verified, cells.time_s, math.inf)
    # Names end in -sSEED; grids of one property have seeds from 101 on.
    found["seed"] = found.problem.str.extract(r"-s(\d+)$", expand=False).astype(float)
    return found.reset_index(drop=True)
