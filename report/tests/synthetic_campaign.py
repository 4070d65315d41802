"""Made-up campaigns, seeded: difficulty per problem, noise per round and repetition. Not measurements."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

TIERS = (1e-3, 1e-6, 1e-9)
SIZES = (10, 20, 50, 100, 200, 500)
FAMILIES = ("piles", "chains")
COPIES = 4  # problems of one family and size
ORACLE_PER_ROW = 1e-7  # [s]
EXPONENT = 1.5  # of the time over the rows
TIME_LIMIT = 10.0


@dataclass
class Noise:
    """Standard deviations of logarithms, and how often a cell is measured."""

    repetition: float = 0.05
    round: float = 0.0
    rounds: int = 1
    repetitions: int = 30


def repetitions(rng, median: float, noise: Noise) -> list[list[float]]:
    """Times of one cell, a list for every round."""
    levels = rng.normal(0, noise.round, (noise.rounds, 1)) if noise.round else np.zeros((noise.rounds, 1))
    logs = levels + rng.normal(0, noise.repetition, (noise.rounds, noise.repetitions))
    return (median * np.exp(logs)).tolist()


def median_times(rng, factors: dict[str, float], problems: int = 100, noise: Noise | None = None) -> pd.DataFrame:
    """Problems x solvers: the medians of what `repetitions` gives, drawn at once. A problem's difficulty is spread
    over some decades."""
    noise = noise or Noise()
    difficulty = rng.normal(0, 2, (problems, 1))
    shape = (problems, len(factors), noise.rounds)
    logs = rng.normal(0, noise.round, (*shape, 1)) if noise.round else np.zeros((*shape, 1))
    logs = logs + rng.normal(0, noise.repetition, (*shape, noise.repetitions))
    medians = np.median(logs.reshape(problems, len(factors), -1), axis=2)
    return pd.DataFrame(1e-3 * np.exp(difficulty + medians) * np.array(list(factors.values())), columns=list(factors))


def cells_of(times: pd.DataFrame, tier: float = 1e-6, **columns) -> pd.DataFrame:
    """What the tables need of a table of cells, from problems x solvers (inf: failed, NaN: no such cell)."""
    rows = []
    for problem, row in times.iterrows():
        for solver, time in row.dropna().items():
            solved = bool(np.isfinite(time))
            rows.append({"set": "main", "counts": True, "mode": "cold", "tier": tier, "problem": problem,
                         "family": "piles", "rows": 10, "reference": "certified", "solver": solver, "time_s": time,
                         "time_limit_s": TIME_LIMIT, "oracle_s": 1e-3, "oracle_ratio": time / 1e-3,
                         "verdict": "verified" if solved else "failed:time_limit", "passes": solved,
                         "at_floor": False, "false_infeasible": False,
                         "claim": "solved" if solved else "time_limit", "rho": tier / 2} | columns)
    return pd.DataFrame(rows)


def write_campaign(folder: Path, factors: dict[str, float], seed: int = 1, tiers=TIERS, noise: Noise | None = None,
                   copies: int = COPIES, change=lambda record: record, run: int = 0) -> Path:
    """Fills `folder` and returns it. Besides `copies` problems for every family and size there is an engine's problem,
    which does not count.

    @param factors  time of every solver over that of the first
    @param change   what becomes of a cell's record before it is written
    @param run      of the same campaign: the problems are as difficult, the noise is another
    """
    rng, noise = np.random.default_rng([seed, run]), noise or Noise(repetitions=5, rounds=2)
    folder.mkdir(parents=True, exist_ok=True)
    info = {"schema": "lcpbench-campaign/1", "name": "synthetic", "manifests": [], "tiers": list(tiers), "seed": seed,
            "rounds": noise.rounds, "size_limits": [], "environment": {}, "environment_hash": "0",
            "limits": {"time_per_row_s": 0.01, "least_s": 1.0, "most_s": TIME_LIMIT, "memory_bytes": 2**30},
            "solvers": [_solver(key, True) for key in factors] + [_solver("absent", False)]}
    problems = [_problem(f"{family}-{rows}-{copy}", "main", family, rows)
                for family in FAMILIES for rows in SIZES for copy in range(copies)]
    problems.append(_problem("ragdoll", "engine", "ragdolls", 40) | {"counts": False, "reference": "none"})
    cells = []
    difficulties = np.exp(np.random.default_rng(seed).normal(0, 0.1, len(problems)))
    for problem, difficulty in zip(problems, difficulties):
        for solver, factor in factors.items():
            for tier in tiers:
                median = factor * difficulty * 1e-7 * problem["rows"] ** EXPONENT * (1 - np.log10(tier))
                for index, times in enumerate(repetitions(rng, median, noise)):
                    cells.append(change(_cell(problem["problem"], solver, tier, index, times)))
    (folder / "campaign.json").write_text(json.dumps(info), encoding="utf-8")
    write_lines(folder / "problems.jsonl", problems)
    write_lines(folder / "cells.jsonl", cells)
    return folder


def write_lines(path: Path, records: list[dict]) -> None:
    path.write_text("".join(json.dumps(record) + "\n" for record in records), encoding="utf-8")


def fail(record: dict, claim: str = "iteration_limit") -> dict:
    """The same cell, not verified; one that claims to have solved it is a false success."""
    return record | {"passes": False, "claim": claim, "false_success": claim == "solved", "best_tier": None,
                     "metrics": record["metrics"] | {"rho": 1.0}, "reason": "rho too large"}


def exclude(record: dict, rule: str = "rows > 100") -> dict:
    return {key: record[key] for key in ("problem", "solver", "tier", "round", "mode")} | {"excluded": rule}


def _solver(key: str, available: bool) -> dict:
    return {"key": key, "setting": "tuned", "origin": "own", "uses_tolerance": True, "available": available,
            "licence": "", "library_version": ""}


def _problem(name: str, chosen_set: str, family: str, rows: int) -> dict:
    return {"problem": name, "set": chosen_set, "family": family, "grid": "", "rows": rows, "bilateral": 0,
            "redundancy": 0, "condition": None, "mass_ratio": 1, "fraction_active": 0.5, "reference": "certified",
            "counts": True, "oracle_s": ORACLE_PER_ROW * rows, "floor": None}


def _cell(problem: str, solver: str, tier: float, index: int, times: list[float]) -> dict:
    return {"problem": problem, "solver": solver, "tier": tier, "round": index, "mode": "cold", "excluded": "",
            "claim": "solved", "passes": True, "best_tier": tier, "at_floor": False, "false_success": False,
            "false_infeasible": False, "iterations": 7, "reason": "", "detail": "",
            "metrics": {"rho": tier / 3, "backward_error": tier / 2, "gap_rel": None, "w_error": tier, "f_error": None},
            "time_limit_s": TIME_LIMIT, "setup_s": [1e-6, 3e-6], "solve_s": times, "convert_s": None,
            "peak_bytes": None, "environment": "0"}
