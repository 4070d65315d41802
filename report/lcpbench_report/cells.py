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
_OUT_OF_TIME = "out of time"  # how that rule of benchmarks/suite.cc begins


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
    convert_s: float  # what a solve converts besides, median; NaN where the solver does not say
    at_floor: int = 0  # verified runs that pass only because the problem's rounding floor lies above the tier

    @property
    def passes(self) -> bool:
        return self.runs > 0 and self.verified == self.runs and not self.excluded

    @property
    def verdict(self) -> str:
        """verified, excluded, or why not, in one or two words. Who ran out of time at a looser tier was not tried at
        this one, and is not spared the word."""
        if self.excluded:
            return formats.status("time_limit") if self.excluded.startswith(_OUT_OF_TIME) else "excluded"
        return "verified" if self.passes else self.failure


class Cells:
    """All runs and cells of a results folder."""

    def __init__(self, results: Results):
        self.results = results
        self._timed = {(t.kind, t.family, t.n, t.solver, t.tier): t for t in results.timing}
        self._timed_seed = {key: _timed_seed(set(seeds), results.run["seed"])
                            for key, seeds in results.problems.groupby(["family", "n"])["seed"]}
        self._sizes = {family: sorted(set(map(int, sizes)))
                       for family, sizes in results.problems.groupby("family")["n"]}
        self._oracle = {family: self._make_oracle_times(family) for family in results.families}
        self.runs = self._make_runs()
        groups: dict[tuple, list[dict]] = {}
        for run in self.runs.to_dict("records"):
            groups.setdefault((run["family"], run["n"], run["solver"], run["tier"]), []).append(run)
        self._cells = {key: self._make_cell(key, group) for key, group in groups.items()}
        self._floors = {(str(family), int(n)): float(floor)
                        for (family, n), floor in results.problems.groupby(["family", "n"])["floor"].max().items()}
        self._run_solvers = {cell.solver for cell in self._cells.values() if cell.runs}
        self._setups = self.runs[self.runs["verified"]].groupby(["family", "n", "solver"])["setup_s"].median().to_dict()
        self._problem_times: dict[float, tuple[pd.DataFrame, int]] = {}

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
        return solver in self._run_solvers

    def sizes(self, family: str) -> list[int]:
        return self._sizes.get(family, [])

    def floor(self, family: str, n: int) -> float:
        """Largest rounding floor of the seeds; NaN where none is known."""
        return self._floors.get((family, n), math.nan)

    def setup_time(self, family: str, n: int, solver: str) -> float:
        """Median set-up time [s]: of the repetitions, else of the single runs that ended with a verified answer."""
        timed = self._timed.get(("setup", family, n, solver, None))
        if timed and math.isfinite(timed.median):
            return timed.median
        return self._setups.get((family, n, solver), math.nan)

    def oracle_times(self, family: str) -> list[tuple[int, float]]:
        """(n, seconds) of oracle-chol: contact or body space, the faster one, the median of the seeds."""
        return self._oracle.get(family, [])

    def problem_times(self, tier: float) -> tuple[pd.DataFrame, int]:
        """Times per problem x solver at a tier for comparison, +inf where not verified or excluded.

        Within one problem all times come from one source: from the repetitions if every verified solver has them, else
        from the single runs. Solvers that were not run at all have no column.
        @returns the table and the number of problems that were compared by repetitions
        """
        if tier not in self._problem_times:
            self._problem_times[tier] = self._make_problem_times(tier)
        return self._problem_times[tier]

    def _make_problem_times(self, tier: float) -> tuple[pd.DataFrame, int]:
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
            # A long solve is not repeated: its one run is its time.
            limit = self.results.run.get("repeat_below_s", math.inf)
            long = row.verified and row.solve_s > limit and row.seed == self._timed_seed[row.family, row.n]
            return row.solve_s if long else math.nan
        seed = self._timed_seed[row.family, row.n] if timed.seed is None else timed.seed
        return timed.median if row.seed == seed else math.nan

    def _make_oracle_times(self, family: str) -> list[tuple[int, float]]:
        problems = self.results.problems
        mine = problems[problems["family"] == family]
        best = mine[["oracle_contact_s", "oracle_body_s"]].min(axis=1)
        known = best.groupby(mine["n"]).median().dropna()
        return [(int(n), float(t)) for n, t in known.items()]

    def _make_cell(self, key: tuple, group: list[dict]) -> Cell:
        tried = [run for run in group if not run["excluded"]]
        good = [run for run in tried if run["verified"]]
        bad = sorted((run for run in tried if not run["verified"]), key=lambda run: not run["false_success"])
        excluded = "" if tried else group[0]["excluded"]
        failure = failure_word(bad[0]) if bad else "excluded" if excluded else ""
        reason = excluded or (failure_line(bad[0]) if bad else "")
        rho = min(_known(bad, "rho"), default=math.nan) if bad else max(_known(good, "rho"), default=math.nan)
        bench = _known(good, "bench_s")
        times, source = (bench, BENCHMARK) if bench else (_known(good, "solve_s"), SINGLE_RUN)
        return Cell(*key, len(tried), len(good), excluded, failure, reason, rho,
                    median(times), source if times else "", median(_known(good, "convert_s")),
                    sum(run["at_floor"] for run in good))


def _known(runs: list[dict], column: str) -> list[float]:
    return [float(run[column]) for run in runs if not math.isnan(run[column])]


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
