"""Reads Google Benchmark's JSON (timing.json) into one record per timed cell."""

import math
import statistics
from dataclasses import dataclass

from .errors import ReportError

_SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
# What the library appends to a name: key:value parts (min_time:0.1, repeats:5, iterations:1) and these words.
_NAME_SUFFIXES = {"real_time", "process_time", "manual_time"}
_EXPECTED = "solve/<family>/<n>/<solver>/<tier> or setup/<family>/<n>/<solver>"


@dataclass
class TimedCell:
    """All repetitions of one benchmark."""

    kind: str  # "solve" or "setup"
    family: str
    n: int
    solver: str
    tier: float | None  # None for set-up
    seed: int | None  # from an optional counter `seed`; None means the campaign's first
    seconds: list[float]  # wall clock, one per repetition (or the library's own median where only that was kept)
    error: str  # why the cell was not timed; "" where it was

    @property
    def median(self) -> float:
        return statistics.median(self.seconds) if self.seconds and not self.error else math.nan

    @property
    def spread(self) -> float:
        """(max - min) / median of the repetitions; NaN with fewer than two."""
        return (max(self.seconds) - min(self.seconds)) / self.median if len(self.seconds) > 1 else math.nan


def read_timing(content: dict, families: list[str], solvers: list[str], tiers: list[float]) -> list[TimedCell]:
    """@throws ReportError for a name, unit or time that does not fit"""
    entries = content.get("benchmarks")
    if not isinstance(entries, list):
        raise ReportError("timing.json", "key 'benchmarks' is missing", "Google Benchmark's JSON")
    cells: dict[tuple, TimedCell] = {}
    medians: dict[tuple, float] = {}
    for entry in entries:
        name = entry.get("run_name", entry.get("name")) if isinstance(entry, dict) else None
        if not isinstance(name, str):
            raise ReportError("timing.json", "an entry of 'benchmarks' has no 'name'", _EXPECTED)
        key = _parse_name(name, families, solvers, tiers)
        seed = entry.get("seed")
        cell = cells.setdefault(key, TimedCell(*key, None if seed is None else int(seed), [], ""))
        if entry.get("error_occurred") or entry.get("skipped"):
            cell.error = str(entry.get("error_message") or entry.get("skip_message") or "no reason given")
        elif entry.get("run_type") == "aggregate":
            if entry.get("aggregate_name") == "median":
                medians[key] = _seconds(name, entry)
        else:
            cell.seconds.append(_seconds(name, entry))
    for key, median in medians.items():
        if not cells[key].seconds:
            cells[key].seconds.append(median)
    return list(cells.values())


def _parse_name(name: str, families: list[str], solvers: list[str], tiers: list[float]) -> tuple:
    parts = [part for part in name.split("/") if ":" not in part and part not in _NAME_SUFFIXES]
    fail = lambda what: ReportError("timing.json", f"benchmark '{name}' {what}", _EXPECTED)  # noqa: E731
    if (parts[0], len(parts)) not in (("solve", 5), ("setup", 4)):
        raise fail("has an unknown form")
    kind, family, n, solver = parts[:4]
    if family not in families:
        raise fail(f"names the unknown family '{family}'")
    if solver not in solvers:
        raise fail(f"names the unknown solver '{solver}'")
    if not n.isdigit():
        raise fail(f"has '{n}' for n")
    if kind == "setup":
        return kind, family, int(n), solver, None
    try:
        value = float(parts[4])
    except ValueError:
        raise fail(f"has '{parts[4]}' for a tier") from None
    tier = next((t for t in tiers if math.isclose(t, value, rel_tol=1e-6)), None)
    if tier is None:
        raise fail(f"names the unknown tier '{parts[4]}'")
    return kind, family, int(n), solver, tier


def _seconds(name: str, entry: dict) -> float:
    unit = entry.get("time_unit", "ns")
    if unit not in _SECONDS:
        raise ReportError("timing.json", f"benchmark '{name}' has time_unit {unit!r}", ", ".join(_SECONDS))
    time = entry.get("real_time")
    if isinstance(time, bool) or not isinstance(time, (int, float)) or not math.isfinite(time) or time < 0:
        raise ReportError("timing.json", f"benchmark '{name}' has real_time {time!r}", "a number >= 0")
    return time * _SECONDS[unit]
