"""How long the steps of a motion take, how much a warm start gains, and what a deadline leaves of the answers.

What an engine waits for is a step's latency, one interval from its arrays to the forces, of every solver: the median
says what a frame costs, the 99th percentile and the maximum which frames are dropped. They are of single solves: of all
steps in all rounds. A step whose answer is not verified, or that was not reached, for the pass ended before, has an
infinite latency. `preempted` counts the solves in which the thread lost the processor, which is known of own solvers
only; they count like others. Quantiles interpolate linearly between order statistics (Hyndman & Fan 1996, definition 7).
"""

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy import stats

from .intervals import CONFIDENCE, RESAMPLES, SEED, share_interval
from .model import Campaign, PassRuns, Round
from .weighted import effective_number

ALL = "all"  # the value of the column `size` for sequences of all sizes
_LEVELS = {"p50": 0.5, "p99": 0.99, "max": 1.0}
_VERIFIED = ["verified", "verified_share"]
SOLVER_COLUMNS = ["solver", "tier", "mode", "size", "sequences", "excluded", "steps", *_VERIFIED, "false_successes",
                  *_LEVELS, "preempted", "warm_gain", "warm_gain_low", "warm_gain_high"]
DEADLINE_COLUMNS = ["solver", "deadline_s", "size", "sequences", "steps", "in_time", "in_time_share", "tier",
                    *_VERIFIED, "verified_low", "verified_high", "rho_p50", "rho_p99", "rho_max",
                    "w_error_p99", "w_error_max"]


@dataclass
class JudgedPass:
    """A pass at one of the tiers that it was judged at."""

    sequence: dict  # as in campaign.json
    solver: str
    tier: float
    mode: str
    runs: PassRuns

    @property
    def rounds(self) -> list[Round]:
        return [self.runs.rounds[index] for index in sorted(self.runs.rounds)]

    def latency(self) -> np.ndarray:
        """The median of every step over the rounds [s]."""
        return np.median([_or_infinite(r.latency_s) for r in self.rounds], axis=0)

    def solves(self) -> np.ndarray:
        """The latencies of all rounds, one behind the other; infinite where the answer is not verified."""
        return np.concatenate([np.where(r.verified[self.tier], _or_infinite(r.latency_s), math.inf) for r in self.rounds])

    def verified(self) -> np.ndarray:
        """By step. With a deadline the answer depends on the time that it had: all rounds, one behind the other."""
        if self.runs.deadline_s is None:
            return self.rounds[0].verified[self.tier]
        return np.concatenate([r.verified[self.tier] for r in self.rounds])


def latency_by_solver_table(campaign: Campaign) -> pd.DataFrame:
    """A row per solver, mode, tier and size: the steps of all sequences of that size together. `warm_gain` (mode warm):
    the median over steps of the cold latency by the warm one, both verified, and its bootstrap interval over
    sequences."""
    rows = []
    passes = list(_judged(campaign))  # with a deadline at the tier asked for alone
    cold = {(one.sequence["sequence"], one.solver, one.tier): one for one in passes if one.mode == "cold"}
    for (solver, mode, tier), size, chosen in _parts(passes, lambda one: (one.solver, one.mode, one.tier)):
        run = [one for one in chosen if not one.runs.excluded]
        row = {"solver": solver, "tier": tier, "mode": mode, "size": size, "sequences": len(run),
               "excluded": len(chosen) - len(run)}
        if run:
            row |= _of_passes(run)
        if mode == "warm":
            row |= _warm_gain([ratios for one in run for ratios in _cold_over_warm(one, cold)])
        rows.append(row)
    return pd.DataFrame(rows, columns=SOLVER_COLUMNS)


def deadline_table(campaign: Campaign) -> pd.DataFrame:
    """A row per solver, deadline, size and tier that answers are judged at; all rounds. `in_time`: steps whose answer
    came by the deadline; errors are of these answers, infinite where an answer is not finite."""
    passes = [one for one in _judged(campaign) if one.runs.deadline_s is not None and not one.runs.excluded]
    rows = []
    for (solver, deadline), size, chosen in _parts(passes, lambda one: (one.solver, one.runs.deadline_s)):
        rounds = [r for one in chosen for r in one.rounds]
        in_time = [~r.late & ~np.isnan(r.latency_s) for r in rounds]
        answered, steps = int(sum(map(np.sum, in_time))), sum(map(len, in_time))
        shared = {"solver": solver, "deadline_s": deadline, "size": size, "sequences": len(chosen), "steps": steps,
                  "in_time": answered, "in_time_share": answered / steps}
        rho = np.concatenate([_or_infinite(r.rho)[there] for r, there in zip(rounds, in_time)])
        w_error = np.concatenate([r.w_error[there] for r, there in zip(rounds, in_time)])
        shared |= _quantiles(rho, _LEVELS, "rho_")
        shared |= _quantiles(w_error[~np.isnan(w_error)], {"p99": 0.99, "max": 1.0}, "w_error_")
        alike = effective_number([one.sequence["steps"] for one in chosen], np.arange(len(chosen)))
        for tier in sorted(rounds[0].verified, reverse=True):
            verified = int(sum(r.verified[tier].sum() for r in rounds))
            low, high = share_interval(verified / steps, alike)
            rows.append(shared | {"tier": tier, "verified": verified, "verified_share": verified / steps,
                                  "verified_low": low, "verified_high": high})
    return pd.DataFrame(rows, columns=DEADLINE_COLUMNS)


def _judged(campaign: Campaign) -> Iterator[JudgedPass]:
    for (sequence, solver, tier, mode), runs in campaign.passes.items():
        tiers = [tier]
        if runs.deadline_s is None and not runs.excluded:
            tiers = sorted(runs.rounds[0].verified, reverse=True)
        for judged in tiers:
            yield JudgedPass(campaign.sequences[sequence], solver, judged, mode, runs)


def _of_passes(passes: list[JudgedPass]) -> dict:
    verified = np.concatenate([one.verified() for one in passes])
    wrong = sum(r.false_successes[one.tier] for one in passes
                for r in (one.rounds[:1] if one.runs.deadline_s is None else one.rounds))
    return {"steps": len(verified), "verified": int(verified.sum()), "verified_share": float(verified.mean()),
            "false_successes": wrong, **_quantiles(np.concatenate([one.solves() for one in passes]), _LEVELS),
            "preempted": sum(int(r.preempted.sum()) for one in passes for r in one.rounds)}


def _or_infinite(values: np.ndarray) -> np.ndarray:
    return np.nan_to_num(values, nan=math.inf, posinf=math.inf)


def _quantiles(values: np.ndarray, levels: dict[str, float], prefix: str = "") -> dict[str, float]:
    """Infinite where the upper of the two order statistics is; NaN without any value."""
    if not len(values):
        return {prefix + name: math.nan for name in levels}
    ordered, found = np.sort(values), {}
    for name, level in levels.items():
        part, place = math.modf(level * (len(ordered) - 1))
        low, high = ordered[int(place)], ordered[int(place) + (part > 0)]
        found[prefix + name] = float(low if low == high else low + part * (high - low))
    return found


def _cold_over_warm(warm: JudgedPass, cold: dict) -> Iterator[np.ndarray]:
    other = cold.get((warm.sequence["sequence"], warm.solver, warm.tier))
    if other and not other.runs.excluded and (both := warm.verified() & other.verified()).any():
        yield other.latency()[both] / warm.latency()[both]


def _warm_gain(ratios: list[np.ndarray]) -> dict[str, float]:
    """The gain over the steps of all sequences; the bootstrap draws sequences, because the steps of one are alike."""
    if not ratios:
        return {}
    gain = {"warm_gain": float(np.median(np.concatenate(ratios)))}
    if len(ratios) < 2:
        return gain

    values = np.concatenate(ratios)
    order = np.argsort(values, kind="stable")
    sequence = np.repeat(np.arange(len(ratios)), [len(one) for one in ratios])[order]

    def medians(drawn: np.ndarray, axis: int) -> np.ndarray:
        """Of the steps of the sequences that are drawn, a row each: steps count as often as their sequence is drawn."""
        times = np.apply_along_axis(np.bincount, axis, drawn, minlength=len(ratios))
        ends = np.cumsum(times[:, sequence], axis=1)
        middles = [np.argmax(ends > (ends[:, -1:] - lower) // 2, axis=1) for lower in (1, 0)]
        return values[order][middles].mean(axis=0)

    interval = stats.bootstrap((np.arange(len(ratios)),), medians, n_resamples=RESAMPLES, batch=100,
                               confidence_level=CONFIDENCE, method="percentile", vectorized=True,
                               random_state=np.random.default_rng(SEED)).confidence_interval
    return gain | {"warm_gain_low": float(interval.low), "warm_gain_high": float(interval.high)}


def _parts(passes: Iterable[JudgedPass], key: Callable) -> Iterator[tuple[tuple, str, list[JudgedPass]]]:
    """By key, in order, and by size, and of all sizes; what is last of a key, a number, comes largest first (tiers)."""
    found: dict[tuple, list[JudgedPass]] = {}
    for one in passes:
        found.setdefault(key(one), []).append(one)
    for of_key, own in sorted(found.items(), key=lambda item: (*item[0][:-1], -item[0][-1])):
        for size in sorted({one.sequence["rows"] for one in own}):
            yield of_key, str(size), [one for one in own if one.sequence["rows"] == size]
        yield of_key, ALL, own
