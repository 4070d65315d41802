"""Which configuration of a solver is chosen, the same rule for every solver; and data/tuned.json, which says what was
tried with which budget, on what, and what was chosen (benchmarks/RESULTS.md).

A choice is made at each of several sizes, on the problems whose rows are nearest to it by their ratio: a campaign uses
settings by the same rule. Times are fresh ones of verified answers; what was not verified enters with its time limit.
Every size class weighs the same, within it problems as elsewhere. A configuration may replace the default only if

    its shifted geometric mean is smaller by more than MARGIN,
    the signed-rank test of the paired times of bases says so (two-sided, adjusted by Holm for all configurations of the
    solver),
    and it fails on no more problems and has no more false successes than the default.

Of those that may, the one with the least mean is chosen. Problems that a rule excludes are left out: nobody solved them.
"""

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from scipy import stats

from ..formats import short
from ..statistics.cells import BELOW_TIER, EXCLUDED, FALSE_SUCCESS, cell_table
from ..statistics.intervals import MARGIN, Bootstrap, holm
from ..statistics.model import Campaign
from ..statistics.means import penalised, shift_of, shifted_geometric_mean
from .campaign import TIER, keys_of
from .space import Configuration, Space, hash_of

SCHEMA = "lcpbench-tuned/2"
LEVEL = 0.05  # of a false alarm among all configurations of a solver
MACHINE = ("cpu", "cores", "memory_bytes", "os", "compiler", "flags", "solver_flags", "libraries")


@dataclass
class Outcome:
    """The outcome of one configuration; `ratio` is its mean over the default's, below 1 where it is faster."""

    problems: int
    verified: int
    false_successes: int
    mean_s: float
    ratio: float
    ratio_low: float
    ratio_high: float
    wilcoxon_p_holm: float
    allowed: bool  # to replace the default


def judge(cells: pd.DataFrame, keys: list[str]) -> tuple[float, list[Outcome]]:
    """@param cells  of one tier, statistics.cells.COLUMNS
    @param keys   the solver's configurations, the default first
    @returns the shift of the means [s], one for all configurations; and their outcomes
    """
    times, about, failures, false = _times(cells, keys)
    shift = shift_of(cells[cells["solver"].isin(keys)])
    shift = 0.0 if math.isnan(shift) else shift  # none was verified: all are limits
    weights, bootstrap = about["weight"].to_numpy(), Bootstrap(about.assign(problem=about.index))
    over = np.log(times.div(times[keys[0]], axis=0))
    adjusted = [math.nan, *holm([_signed_rank_test(bootstrap.base_means(times.index, over[key].to_numpy(), weights))
                                 for key in keys[1:]])]
    means, logs = times.apply(shifted_geometric_mean, shift=shift, weights=weights), np.log(times + shift)
    outcomes = []
    for key, p in zip(keys, adjusted):
        low, high = bootstrap.mean(times.index, logs[key], weights, lambda mean: np.exp(mean) - shift, logs[keys[0]])
        ratio = means[key] / means[keys[0]]
        faster = p < LEVEL and ratio < 1 / MARGIN
        no_worse = all(count[key] <= count[keys[0]] for count in (failures, false))
        outcomes.append(Outcome(len(times), len(times) - failures[key], false[key], means[key], ratio, low, high,
                                float(p), bool(faster and no_worse)))
    return shift, outcomes


def _signed_rank_test(differences: np.ndarray) -> float:
    """Wilcoxon's p-value (1945), two-sided, where they are smaller than 0; NaN where all are 0."""
    moved = differences[differences != 0]
    return min(1.0, 2 * float(stats.wilcoxon(moved, alternative="less").pvalue)) if len(moved) else math.nan


def choose(outcomes: list[Outcome]) -> int:
    allowed = [index for index, outcome in enumerate(outcomes) if outcome.allowed]
    return min(allowed, key=lambda index: outcomes[index].mean_s, default=0)


def _times(cells: pd.DataFrame, keys: list[str]) -> tuple[pd.DataFrame, pd.DataFrame, pd.Series, pd.Series]:
    """Problems x configurations, failures with their limit, on problems that all of them have; what is known of the
    problems; failures and false successes of every configuration. Of solvers that are never asked for the tier an answer
    below it is a false success here: another setting may be better."""
    own = cells[cells["solver"].isin(keys) & (cells["verdict"] != EXCLUDED)]
    own = own[own.groupby("problem")["solver"].transform("nunique") == len(keys)]
    failures, false = (holds.groupby(own["solver"]).sum().reindex(keys, fill_value=0) for holds in
                       (~np.isfinite(own["time_s"]), own["verdict"].isin((FALSE_SUCCESS, BELOW_TIER))))
    times = own.assign(time_s=penalised(own)).pivot(index="problem", columns="solver", values="time_s").reindex(columns=keys)
    about = own.drop_duplicates("problem").set_index("problem").loc[times.index, ["origin", "family", "base", "weight", "size_class"]]
    about["weight"] /= about.groupby("size_class")["weight"].transform("sum")
    return times, about, failures, false


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
    cells = cells[cells["verdict"] != EXCLUDED]
    sizes = cells["rows"].map(lambda rows: nearest(rows, asked.sizes))
    own = {solver: cells["solver"].isin(keys_of(solver, len(configurations))) for solver, configurations in tried.items()}
    environment, hash_ = info.get("environment", {}), hash_of([spaces[solver] for solver in tried])
    return {"schema": SCHEMA, "commit": environment.get("git_commit", ""), "dirty": environment.get("git_dirty", False),
            "date": date, "machine": {key: environment.get(key) for key in MACHINE}, "budget": asked.budget,
            "seed": asked.seed, "space": {"file": asked.space_file.name, "sha256": hash_},
            "tier": TIER, "passes": info.get("passes"),
            "problems": {"manifests": info["manifests"], "count": len(campaign.problems), "sizes": asked.sizes,
                         "seed": asked.problem_seed, "not_in": disjoint_from},
            "disturbed_share": short(float((cells["flagged"] > 0).mean())) if len(cells) else 0.0,
            "measured_s": {solver: short(sum(task.spent_s for task in campaign.tasks
                                             if task.solver in keys_of(solver, len(configurations))))
                           for solver, configurations in tried.items()},  # in solves
            "solvers": [_choice(cells[own[solver] & (sizes == rows)], rows, spaces[solver], configurations, say)
                        for solver, configurations in tried.items() for rows in asked.sizes
                        if (own[solver] & (sizes == rows)).any()]}


def nearest(rows: int, sizes: list[int]) -> int:
    """The size whose ratio to so many rows, or theirs to it, is least; of two the smaller one."""
    return min(sorted(sizes), key=lambda size: abs(math.log(max(rows, 1) / size)))


def _choice(cells: pd.DataFrame, rows: int, space: Space, configurations: list[Configuration],
            say: Callable[[str], None]) -> dict:
    """@param cells  of the problems that settings at `rows` are chosen on"""
    shift, outcomes = judge(cells, keys_of(space.solver, len(configurations)))
    index = choose(outcomes)
    best, chosen = outcomes[index], configurations[index]
    words = ", ".join(f"{name}={value}" for name, value in chosen.items())
    say(f"{space.solver} at {rows} rows: {len(configurations)} of {space.size} configurations, " +
        (f"chosen {words}: {best.ratio:.3f} x the default's mean ({best.ratio_low:.3f} to {best.ratio_high:.3f})"
         if index else "the default stays"))
    gain = {"ratio": best.ratio, "low": best.ratio_low, "high": best.ratio_high}
    return {"solver": space.solver, "rows": rows, "space": space.size, "configurations": len(configurations),
            "chosen": chosen, "shift_s": short(shift),
            "gain": {key: short(value) for key, value in gain.items()} if index else None,
            "tried": [{"settings": configuration, **{key: short(value) for key, value in asdict(outcome).items()}}
                      for configuration, outcome in zip(configurations, outcomes)]}
