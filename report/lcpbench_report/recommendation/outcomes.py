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
from ..statistics.jsonl import is_there, read_lines
from ..statistics.latency import latency_table
from ..statistics.load import STREAMS_FILE, load_campaign
from ..statistics.steps import FILE as STEPS_FILE

# By feature the ends of its parts: each begins at one and ends before the next; the last one has no end.
Edges = dict[str, list[float]]
_TABLES = ("cells.csv", "cells.csv.gz")  # of the folder analysis; the second as an archive has it
_COLUMNS = ["problem", "family", "weight", "fill", "rows", "solver", "tier", "excluded", "passes", "false_success",
            "time_s"]
_STEPS_RIGHT = 0.99  # of a sequence's steps: less counts as failed
_WARM = "warm"


@dataclass
class Outcomes:
    """`table` has the columns problem, family, weight, rows, seed, solver, tier, verified, false_success, excluded and
    time_s (infinite where the answer was not verified): the fresh time, from the caller's arrays to f; of sequences the
    median latency of a step from a warm start. `features`: a row per problem, by its name."""

    table: pd.DataFrame
    features: pd.DataFrame
    own: list[str]  # keys of solvers that can be linked
    peers: list[str]
    campaigns: list[dict]  # where the numbers come from
    edges: Edges  # of the regions: the size classes


def read_outcomes(folders: Iterable[Path], features: Path) -> Outcomes:
    """The cells of campaigns' folders. The tables of `lcpbench analyse` are taken where they are newer than the streams,
    which saves a minute. Solvers of ablations and variants are left out.

    @param features  written by `lcpbench recommend --features`: JSON lines
    @throws ReportError for the first thing that does not fit
    """
    infos = [_info(folder) for folder in folders]
    origins = _origins(infos)
    cells = pd.concat([_cells(folder) for folder in folders], ignore_index=True)
    cells = cells[cells.solver.isin(origins)]
    twice = cells.duplicated(["problem", "solver", "tier"])
    if twice.any():
        raise ReportError("campaigns", f"problem {cells[twice].problem.iloc[0]!r} is in two", "every cell once")
    known = _features(features)
    problems = cells.drop_duplicates("problem").set_index("problem")
    missing = sorted(set(problems.index[~problems["fill"].astype(bool)]) - set(known.index))
    if missing:
        raise ReportError(features.name, f"no line for problem {missing[0]!r}",
                          "a line for every problem of the campaigns that is no fill-up")
    known = known.reindex(problems.index)  # of what fills up a stream no more is known
    known["rows"] = problems["rows"].astype(float)
    own = [key for key, origin in origins.items() if origin == "own"]
    return Outcomes(_outcomes(cells), known, own, [key for key in origins if key not in own],
                    [_provenance(info) for info in infos], _edges(infos))


def read_sequences(folders: Iterable[Path]) -> Outcomes | None:
    """Sequences take the place of problems; none where no campaign has passes over them."""
    rows, infos = [], []
    for folder in folders:
        if not is_there(folder / STEPS_FILE):
            continue
        campaign = load_campaign(folder)
        table = latency_table(campaign)
        table = table[(table["mode"] == _WARM) & table["solver"].isin(_origins([campaign.info]))]
        infos.append(campaign.info)
        for one in table.to_dict("records"):
            verified = not one["excluded"] and one["verified_share"] >= _STEPS_RIGHT
            rows.append({"problem": one["sequence"], "weight": 1.0, "seed": math.nan, "verified": verified,
                         "false_success": one["false_successes"] > 0, "excluded": one["excluded"] != "",
                         "time_s": one["p50"] if verified else math.inf,
                         **{key: one[key] for key in ("family", "rows", "solver", "tier")}})
    if not rows:
        return None
    found, origins = pd.DataFrame(rows), _origins(infos)
    features = found.drop_duplicates("problem").set_index("problem")[["rows"]].astype(float)
    own = [key for key, origin in origins.items() if origin == "own"]
    return Outcomes(found, features, own, [key for key in origins if key not in own],
                    [_provenance(info) for info in infos], _edges(infos))


def _origins(infos: list[dict]) -> dict[str, str]:
    """Of what the registry of a build knows by its key: no ablations, no variants."""
    return {solver["key"]: solver["origin"] for info in infos for solver in info["solvers"]
            if solver["available"] and not solver["ablation"] and not solver.get("base")}


def _edges(infos: list[dict]) -> Edges:
    """A problem without rows is in the first class."""
    return {"rows": [0, *(of["least"] for of in infos[0]["size_classes"][1:])]}


def _info(folder: Path) -> dict:
    path = folder / "campaign.json"
    if not path.is_file():
        raise ReportError(path.name, f"missing in {folder}", "the files of a campaign, benchmarks/RESULTS.md")
    try:
        info = json.loads(path.read_text("utf-8"))
        return info | {key: list(info[key]) for key in ("solvers", "manifests", "size_classes")}
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
    streams = folder / STREAMS_FILE
    for table in (folder / "analysis" / name for name in _TABLES):
        if table.is_file() and (not streams.is_file() or table.stat().st_mtime >= streams.stat().st_mtime):
            return pd.read_csv(table, usecols=_COLUMNS, low_memory=False)[_COLUMNS]
    return cell_table(load_campaign(folder))[_COLUMNS]


def _features(path: Path) -> pd.DataFrame:
    if not path.is_file():
        raise ReportError(str(path), "no such file", "what `lcpbench recommend --features` writes")
    lines = [line for _, line in read_lines(path, lambda note: None)]
    if not lines or any("problem" not in line or "rows" not in line for line in lines):
        raise ReportError(path.name, "lines without problem and rows", "what `lcpbench recommend --features` writes")
    return pd.DataFrame(lines).drop_duplicates("problem").set_index("problem").astype(float)


def _outcomes(cells: pd.DataFrame) -> pd.DataFrame:
    found = cells[["problem", "family", "weight", "rows", "solver", "tier"]].copy()
    found["weight"] = found["weight"].astype(float)
    found["verified"] = cells.passes.astype(bool)
    found["false_success"] = cells.false_success.astype(bool)
    found["excluded"] = cells.excluded.notna() & (cells.excluded != "")
    found["time_s"] = np.where(found["verified"], cells.time_s, math.inf)
    # Names end in -sSEED; grids of one property have seeds from 101 on.
    found["seed"] = found.problem.str.extract(r"-s(\d+)$", expand=False).astype(float)
    return found.reset_index(drop=True)
