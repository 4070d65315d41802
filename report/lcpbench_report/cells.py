"""Joins accuracy and timing: who was verified where, and which time counts.

Two levels. A *run* is a problem x solver x tier (a row of accuracy.csv). A *cell* is a family x n x solver x tier: its
runs differ in the seed alone. timing.json knows cells only; its time belongs to the timed seed (a counter `seed` where
there is one, else the campaign's first seed).

The time of a cell is the median of Google Benchmark's repetitions; where there is none, the median of the verified
runs' single measurements, marked as such. A direct method's time at a tier that was not timed is that of the strictest
tier that was: the same run. Only verified answers have a time.
"""

import math
from dataclasses import dataclass

import pandas as pd

from . import formats
from .load import Results
from .stats import median
from .timing import TimedCell

BENCHMARK = "benchmark"
SINGLE_RUN = "single run"


@dataclass
class Cell:
    """One family x n x solver x tier."""

    family: str
    n: int
    solver: str
    tier: float
    runs: int  # attempted, that is without excluded ones
    verified: int
    excluded: str  # the rule, "" where the cell was run
    failure: str  # one or two words for the worst run, "" where all were verified
    reason: str  # a line for the worst run
    rho: float  # largest of the runs where all are verified, else the smallest of those that are not
    time_s: float  # NaN where nothing was verified
    time_source: str  # BENCHMARK, SINGLE_RUN or ""

    @property
    def passes(self) -> bool:
        return self.runs > 0 and self.verified == self.runs and not self.excluded


class Cells:
    """All runs and cells of a results folder."""

    def __init__(self, results: Results):
        self.results = results
        self._timed = {(t.kind, t.family, t.n, t.solver, t.tier): t for t in results.timing}
        self._timed_seed = {key: _timed_seed(set(seeds), results.run["seed"])
                            for key, seeds in results.problems.groupby(["family", "n"])["seed"]}
        self.runs = self._make_runs()
        self._cells = {key: self._make_cell(key, group) for key, group in
                       self.runs.groupby(["family", "n", "solver", "tier"], sort=False)}

    def all(self) -> list[Cell]:
        return list(self._cells.values())

    def get(self, family: str, n: int, solver: str, tier: float) -> Cell | None:
        """None where accuracy.csv has no such row: the solver is not in the build, say."""
        return self._cells.get((family, n, solver, tier))

    def strictest(self, family: str, n: int, solver: str) -> Cell | None:
        """The cell of the strictest tier that every seed passes; else the cell of the loosest tier."""
        cells = [self.get(family, n, solver, tier) for tier in reversed(self.results.tiers)]
        cells = [cell for cell in cells if cell]
        return next((cell for cell in cells if cell.passes), cells[-1] if cells else None)

    def was_run(self, solver: str) -> bool:
        """False where every cell is absent or excluded: a solver that is not in the build, say."""
        return bool(((self.runs["solver"] == solver) & (self.runs["excluded"] == "")).any())

    def sizes(self, family: str) -> list[int]:
        problems = self.results.problems
        return sorted(set(problems.loc[problems["family"] == family, "n"]))

    def setup_time(self, family: str, n: int, solver: str) -> float:
        """Median set-up time [s]: of the repetitions, else of the single runs that ended with a verified answer."""
        timed = self._timed.get(("setup", family, n, solver, None))
        if timed and math.isfinite(timed.median):
            return timed.median
        runs = self.runs
        mask = (runs["family"] == family) & (runs["n"] == n) & (runs["solver"] == solver) & runs["verified"]
        return median(runs.loc[mask, "setup_s"])

    def problem_times(self, tier: float) -> tuple[pd.DataFrame, int]:
        """Times per problem x solver at a tier for comparison, +inf where not verified or excluded.

        Within one problem all times come from one source: from the repetitions if every verified solver has them, else
        from the single runs. Solvers that were not run at all have no column.
        @returns the table and the number of problems that were compared by repetitions
        """
        runs = self.runs[self.runs["tier"] == tier]
        solvers = [s for s in self.results.solvers if self.was_run(s)]
        rows, by_benchmark = {}, 0
        for problem, group in runs.groupby("problem", sort=False):
            good = group[group["verified"]]
            column = "bench_s" if len(good) and good["bench_s"].notna().all() else "solve_s"
            by_benchmark += column == "bench_s"
            rows[problem] = dict(zip(good["solver"], good[column]))
        table = pd.DataFrame.from_dict(rows, orient="index", columns=None)
        return table.reindex(index=list(rows), columns=solvers).astype(float).fillna(math.inf), by_benchmark

    def disagreements(self) -> list[str]:
        """Cells where the timing pass and the accuracy pass judged differently: '<cell>: <message>'."""
        found = []
        for timed in self.results.timing:
            cell = self.get(timed.family, timed.n, timed.solver, timed.tier) if timed.kind == "solve" else None
            name = f"{timed.family}, n = {timed.n}, {timed.solver}"
            if cell and timed.error and cell.passes:
                found.append(f"{name}, {formats.tier(timed.tier)}: {timed.error}")
            elif cell and not timed.error and not cell.verified:
                found.append(f"{name}, {formats.tier(timed.tier)}: timed, but not verified in the accuracy pass")
        return found

    def _timing_of(self, family: str, n: int, solver: str, tier: float) -> TimedCell | None:
        tiers = [tier]
        if self.results.direct(solver):
            tiers += sorted(t for t in self.results.tiers if t < tier)
        timed = (self._timed.get(("solve", family, n, solver, t)) for t in tiers)
        return next((t for t in timed if t and math.isfinite(t.median)), None)

    def _make_runs(self) -> pd.DataFrame:
        runs = self.results.accuracy.copy()
        runs["verified"] = runs["passes"] & (runs["excluded"] == "")
        runs["bench_s"] = [self._bench_time(row) for row in runs.itertuples(index=False)]
        return runs

    def _bench_time(self, row) -> float:
        timed = self._timing_of(row.family, row.n, row.solver, row.tier) if row.verified else None
        if timed is None:
            return math.nan
        seed = self._timed_seed[row.family, row.n] if timed.seed is None else timed.seed
        return timed.median if row.seed == seed else math.nan

    def _make_cell(self, key: tuple, group: pd.DataFrame) -> Cell:
        tried, good = group[group["excluded"] == ""], group[group["verified"]]
        excluded = "" if len(tried) else group.iloc[0]["excluded"]
        bad = tried[~tried["verified"]].sort_values("false_success", ascending=False, kind="stable")
        failure = failure_word(bad.iloc[0]) if len(bad) else "excluded" if excluded else ""
        reason = excluded or (failure_line(bad.iloc[0]) if len(bad) else "")
        rho = bad["rho"].min() if len(bad) else good["rho"].max()
        bench = good["bench_s"].dropna()
        times, source = (bench, BENCHMARK) if len(bench) else (good["solve_s"].dropna(), SINGLE_RUN)
        return Cell(*key, len(tried), len(good), excluded, failure, reason, float(rho),
                    median(times), source if len(times) else "")


def _timed_seed(seeds: set[int], first: int | None) -> int:
    return first if first in seeds else min(seeds)


def failure_word(run) -> str:
    """Why a run does not count, in one or two words."""
    if run["false_success"]:
        return "false success"
    if run["false_infeasible"]:
        return "false infeasible"
    return formats.status(run["claim"])


def failure_line(run) -> str:
    """The verifier's reason and the solver's own words."""
    return "; ".join(part for part in (run["reason"], run["detail"]) if part) or formats.status(run["claim"])
