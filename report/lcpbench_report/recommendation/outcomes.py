"""What the solvers of campaigns did: a row per problem, solver and tier, with the times that an engine would see."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from ..errors import ReportError
from ..statistics.cells import cell_table
from ..statistics.jsonl import is_there, read_lines
from ..statistics.latency import latency_table
from ..statistics.load import load_campaign
from ..statistics.steps import FILE as STEPS_FILE

# By feature the ends of its parts: each begins at one and ends before the next; the last one has no end.
Edges = dict[str, list[float]]
_COLUMNS = ["problem", "family", "weight", "rows", "solver", "tier", "verified", "false_success", "time_s"]
_STEPS_RIGHT = 0.99  # of a sequence's steps: less counts as failed


@dataclass
class Outcomes:
    """`table` has _COLUMNS, the problem's seed and its source, where that is not this project: the engine that met it, or the
    family of what others published; time_s (infinite where the answer was not verified) is the fresh time,
    from the caller's arrays to f; of sequences the median latency of a step from a warm start. `features`: a row per
    problem, by its name."""

    table: pd.DataFrame
    features: pd.DataFrame
    own: list[str]  # keys of solvers that can be linked
    peers: list[str]
    campaigns: list[dict]  # where the numbers come from
    edges: Edges  # of the regions: the size classes


def read_outcomes(folders: Iterable[Path], features: Path) -> Outcomes:
    """The cells of campaigns' folders. Solvers of ablations and variants are left out.

    @param features  written by `lcpbench recommend --features`: JSON lines
    @throws ReportError for the first thing that does not fit
    """
    campaigns = [load_campaign(folder) for folder in folders]
    infos = [campaign.info for campaign in campaigns]
    cells = pd.concat([cell_table(campaign) for campaign in campaigns], ignore_index=True)
    cells = cells[cells["solver"].isin(_origins(infos))].rename(columns={"passes": "verified"})
    twice = cells.duplicated(["problem", "solver", "tier"])
    if twice.any():
        raise ReportError("campaigns", f"problem {cells[twice]['problem'].iloc[0]!r} is in two", "every cell once")
    known = _features(features)
    problems = cells.drop_duplicates("problem").set_index("problem")
    missing = sorted(set(problems.index[~problems["fill"].astype(bool)]) - set(known.index))
    if missing:
        raise ReportError(features.name, f"no line for problem {missing[0]!r}",
                          "a line for every problem of the campaigns that is no fill-up")
    known = known.reindex(problems.index)  # of what fills up a stream no more is known
    known["rows"] = problems["rows"].astype(float)
    # Names end in -sSEED; grids of one property have seeds from 101 on.
    seeds = cells["problem"].str.extract(r"-s(\d+)$", expand=False).astype(float)
    return _outcomes(cells[_COLUMNS].assign(seed=seeds, source=_sources(cells)).reset_index(drop=True), known, infos)


def read_sequences(folders: Iterable[Path]) -> Outcomes | None:
    """Sequences take the place of problems; none where no campaign has passes over them."""
    tables, infos = [], []
    for folder in folders:
        if is_there(folder / STEPS_FILE):
            campaign = load_campaign(folder)
            table = latency_table(campaign)
            tables.append(table[(table["mode"] == "warm") & table["solver"].isin(_origins([campaign.info]))])
            infos.append(campaign.info)
    if not any(map(len, tables)):
        return None
    table = pd.concat(tables, ignore_index=True).rename(columns={"sequence": "problem"})
    verified = (table["excluded"] == "") & (table["verified_share"] >= _STEPS_RIGHT)
    found = table.assign(weight=1.0, verified=verified, false_success=table["false_successes"] > 0,
                         time_s=table["p50"].where(verified, math.inf))
    features = found.drop_duplicates("problem").set_index("problem")[["rows"]].astype(float)
    return _outcomes(found[_COLUMNS].assign(seed=math.nan, source=None), features, infos)


def _sources(cells: pd.DataFrame) -> pd.Series:
    """An engine's families are "engine scene"."""
    families = cells["family"].where(cells["origin"] != "recorded", cells["family"].str.split().str[0])
    return families.where(cells["origin"].isin(("recorded", "literature")), None)


def _outcomes(table: pd.DataFrame, features: pd.DataFrame, infos: list[dict]) -> Outcomes:
    origins = _origins(infos)
    own = [key for key, origin in origins.items() if origin == "own"]
    # A problem without rows is in the first class.
    edges = {"rows": [0, *(of["least"] for of in infos[0]["size_classes"][1:])]}
    return Outcomes(table, features, own, [key for key in origins if key not in own], [*map(_provenance, infos)], edges)


def _origins(infos: list[dict]) -> dict[str, str]:
    """Of what the registry of a build knows by its key: no ablations, no variants."""
    return {solver["key"]: solver["origin"] for info in infos for solver in info["solvers"]
            if solver["available"] and not solver["ablation"] and not solver.get("base")}


def _provenance(info: dict) -> dict:
    environment = info.get("environment", {})
    return {"name": info["name"], "commit": environment.get("git_commit", ""), "dirty": environment.get("git_dirty"),
            "started": info.get("started"),
            **{key: environment.get(key, "") for key in ("cpu", "compiler", "flags", "solver_flags")},
            "libraries": environment.get("libraries", {}), "environment_hash": info.get("environment_hash"),
            "manifests": info.get("manifests", [])}


def _features(path: Path) -> pd.DataFrame:
    if not path.is_file():
        raise ReportError(str(path), "no such file", "what `lcpbench recommend --features` writes")
    lines = [line for _, line in read_lines(path, lambda note: None)]
    if not lines or any("problem" not in line or "rows" not in line for line in lines):
        raise ReportError(path.name, "lines without problem and rows", "what `lcpbench recommend --features` writes")
    return pd.DataFrame(lines).drop_duplicates("problem").set_index("problem").astype(float)
