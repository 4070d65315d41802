"""data/tuned.json: what was tried with which budget, on what, and what was chosen (benchmarks/RESULTS.md)."""

import hashlib
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from ..statistics.cells import cell_table
from ..statistics.jsonl import text_of
from ..statistics.load import Campaign
from . import choice
from .campaign import TIER, keys_of
from .space import Configuration, Space

SCHEMA = "lcpbench-tuned/1"
_MACHINE = ("cpu", "cores", "memory_bytes", "os", "compiler", "flags", "solver_flags", "libraries")
_DIGITS = 4  # of times and ratios: more is noise


@dataclass
class Asked:
    """What the user asked for."""

    budget: int
    seed: int
    space_file: Path
    sizes: list[int]
    problem_seed: int


def describe(campaign: Campaign, spaces: dict[str, Space], tried: dict[str, list[Configuration]], asked: Asked,
             disjoint_from: list[str], date: str, say: Callable[[str], None] = lambda line: None) -> dict:
    """@param tried  solver -> its configurations, the default first; of solvers of `spaces` alone"""
    info, cells = campaign.info, cell_table(campaign)
    environment = info.get("environment", {})
    spent = _spent(campaign)
    return {"schema": SCHEMA, "commit": environment.get("git_commit", ""), "dirty": environment.get("git_dirty", False),
            "date": date, "machine": {key: environment.get(key) for key in _MACHINE}, "budget": asked.budget,
            "seed": asked.seed, "space": {"file": asked.space_file.name, "sha256": file_hash(asked.space_file)},
            "tier": TIER, "passes": info.get("passes"),
            "problems": {"manifests": info["manifests"], "count": len(campaign.problems), "sizes": asked.sizes,
                         "seed": asked.problem_seed, "not_in": disjoint_from},
            "disturbed_share": _number(float((cells["disturbed"] > 0).mean())) if len(cells) else 0.0,
            "solvers": [_solver(cells, spaces[solver], configurations, spent, say)
                        for solver, configurations in tried.items()]}


def file_hash(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def write(path: Path, record: dict) -> None:
    path.write_text(text_of(record) + "\n", encoding="utf-8")


def _solver(cells: pd.DataFrame, space: Space, configurations: list[Configuration], spent: dict[str, float],
            say: Callable[[str], None]) -> dict:
    keys = keys_of(space.solver, len(configurations))
    outcomes = choice.judge(cells, keys)
    index = choice.choose(outcomes)
    best = outcomes[index]
    say(f"{space.solver}: {len(configurations)} of {space.size} configurations, " +
        (f"chosen {_words(configurations[index])}: {best.ratio:.3f} x the default's mean "
         f"({best.ratio_low:.3f} to {best.ratio_high:.3f})" if index else "the default stays"))
    return {"solver": space.solver, "space": space.size, "configurations": len(configurations),
            "chosen": configurations[index], "shift_s": _number(best.shift_s),
            "gain": {"ratio": _number(best.ratio), "low": _number(best.ratio_low), "high": _number(best.ratio_high)}
            if index else None,
            "measured_s": _number(sum(spent.get(key, 0.0) for key in keys)),
            "tried": [{"settings": configuration, **_outcome(outcome)}
                      for configuration, outcome in zip(configurations, outcomes)]}


def _outcome(outcome: choice.Outcome) -> dict:
    return {"problems": outcome.problems, "verified": outcome.verified, "false_successes": outcome.false_successes,
            **{key: _number(getattr(outcome, key))
               for key in ("mean_s", "ratio", "ratio_low", "ratio_high", "wilcoxon_p_holm")},
            "allowed": outcome.allowed}


def _spent(campaign: Campaign) -> dict[str, float]:
    """Solver -> seconds in solves, those of the problems that were judged and of the timed passes."""
    spent: dict[str, float] = {}
    for task in campaign.tasks:
        times = [one.times[key] for of_kind in task.passes.values() for one in of_kind.values() for key in one.times]
        spent[task.solver] = spent.get(task.solver, 0.0) + float(sum(map(np.nansum, [*times, task.judged.get("first_s", 0.0)])))
    return spent


def _number(value: float) -> float | None:
    return float(f"{value:.{_DIGITS}g}") if math.isfinite(value) else None


def _words(configuration: Configuration) -> str:
    return ", ".join(f"{name}={value}" for name, value in configuration.items())
