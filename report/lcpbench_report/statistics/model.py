"""A campaign in memory, whether its folder has streams or compact records: columns of the table of cells."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import pandas as pd

from ..errors import ReportError
from .fields import check_tier, check_word

PROBLEMS_FILE, STREAMS_FILE = "problems.jsonl", "streams.jsonl"
# What a solver takes for the tier: its method has no tolerance; the tier's is passed on; the library's own one.
DEFAULT = "default"
TOLERANCES = ("direct", "follows", DEFAULT)
KINDS = JUDGE, FRESH, PARTS, AGAIN = ("judge", "fresh", "parts", "again")
OUT_OF_TIME_RULE = "out of time"  # how rules begin that exclude what was out of time at a looser tier
OVER = ("time_limit", "killed")  # claims of what was ended at the time limit
TASK_BUDGET = "task budget"  # the rule that excludes what had no turn
# Origins of problems -> in words.
ORIGINS = {"placed": "own scenes", "motion": "own motions", "recorded": "engines", "literature": "literature"}
# The parts of the headline, which every resample has as much of: where problems come from.
ORIGIN_GROUPS = {"placed": "own scenes", "motion": "own scenes", "recorded": "engines", "literature": "literature"}
LITERATURE = "literature"
METRICS = ("rho", "backward_error", "w_error", "f_error")
# Arrays of a judge line, a number for every problem that had its turn.
JUDGED = (*METRICS, "best_tier", "iterations", "first_s", "factor_share")
# Arrays that a judge line has only where problems have friction or bounded rows: parts of the error, and more.
ERROR_PARTS = ("penetration", "adhesion", "separation", "cone", "dissipation", "joints", "beyond_bounds")
LAWS = ("model_rho", *ERROR_PARTS, "friction_power", "created", "energy")
INFEASIBLE = "infeasible"
OUT = "excluded"  # the claim of a problem of a task that a rule excludes: its `reason`
PART_TIMES = ("problem_s", "prepare_s", "convert_s", "solve_s")
FLAGS = ("passes", "at_floor", "below_floor", "false_success", "false_infeasible", "proved_infeasible",
         "infeasible_within_rounding")

# The solver does not take a problem as it is given (without J, with bilateral rows), and says so by this claim: no
# failure. A sequence that has such a step is not asked of it as a whole.
NOT_ASKED, UNSUPPORTED = "not asked", "unsupported"

# (sequence, solver, tier asked for, mode)
PassKey = tuple[str, str, float, str]


@dataclass
class Round:
    """One pass over a sequence. Arrays have an entry per step; what was not reached is NaN."""

    verified: dict[float, np.ndarray]  # by judged tier
    false_successes: dict[float, int]
    late: np.ndarray
    preempted: np.ndarray  # the solver lost the processor to something else
    unsupported: bool  # some step
    latency_s: np.ndarray  # what each step takes: one interval from the caller's arrays to f
    rho: np.ndarray  # NaN: none, for it came late or is not finite
    w_error: np.ndarray


@dataclass
class PassRuns:
    """One cell of the sequences, in all its rounds."""

    deadline_s: float | None
    excluded: str = ""
    rounds: dict[int, Round] = field(default_factory=dict)


@dataclass
class Task:
    """A solver on problems of a size class at a tier. What columns lack is not known."""

    solver: str
    size_class: str
    tier: float
    at: np.ndarray  # of its problems the numbers within the class's order
    # Columns of the table of cells; here a late answer still "passes". "changed": the answer of a launch is not verified.
    columns: dict[str, np.ndarray] = field(default_factory=dict)
    launches: list[dict] = field(default_factory=list)  # rows of launches.launch_rows, in one task of a class
    times: pd.DataFrame | None = None  # of every launch: `at` x numbers of launches; None: records of what took part in no rounds
    spent_s: float = 0.0  # in all its solves
    details: dict[int, str] = field(default_factory=dict)  # of streams, by such numbers: why it is not plainly verified


@dataclass
class Campaign:
    """One campaign's folder, checked."""

    info: dict  # campaign.json
    problems: dict[str, dict] = field(default_factory=dict)
    tasks: list[Task] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)  # what was passed over
    sequences: dict[str, dict] = field(default_factory=dict)  # of campaign.json, by name
    passes: dict[PassKey, PassRuns] = field(default_factory=dict)  # over the sequences

    @property
    def solvers(self) -> dict[str, dict]:
        return {solver["key"]: solver for solver in self.info["solvers"]}

    @property
    def portfolio(self) -> dict[str, list[str]]:
        """Size class -> keys of peers, in the order in which a portfolio asks them."""
        return self.info.get("portfolio", {})

    @property
    def first_round(self) -> int:
        """The first launches of a class are of all solvers, which takes minutes; those after it go by rounds. Where there are
        no others, they are the rounds."""
        others = self.info.get("launches", {}).get("others", 0)
        return others + 1 if others < self.info.get("passes", 0) else 1

    @cached_property
    def available(self) -> list[str]:
        """Keys of the solvers that were in the build."""
        return [solver["key"] for solver in self.info["solvers"] if solver["available"]]

    @cached_property
    def classes(self) -> dict[str, list[str]]:
        """Size class -> its problems, in the order that tasks refer to."""
        found: dict[str, list[str]] = {of["key"]: [] for of in self.info["size_classes"]}
        for name, about in self.problems.items():
            found[about["size_class"]].append(name)
        return found

    def time_limit(self, rows):
        """The limit of one solve of a problem with so many rows, or of an array of them [s]: by the most rows of its size class."""
        limits = self.info["limits"]
        most = np.array([one["most"] or np.inf for one in self.info["size_classes"]])
        by_rows = limits["time_per_row_s"] * most[np.searchsorted(most, rows)]
        return np.minimum(np.maximum(by_rows, limits["least_s"]), limits["most_s"])

    def run_of(self, place: str, record: dict) -> tuple[tuple[str, str, float], int, int]:
        """Solver, size class and tier of a line; the first of its problems in the class, and how many they are.

        @throws ReportError where the campaign has none such
        """
        check_word(place, record, "solver", self.available)
        check_word(place, record, "size_class", self.classes)
        first, count, whole = int(record["first"]), int(record["count"]), len(self.classes[record["size_class"]])
        tier = check_tier(place, self.info["tiers"], record["tier"])
        if not 1 <= count <= whole - first:
            raise ReportError(place, f"keys 'first' and 'count' are {first} and {count}",
                              f"some of the {whole} problems of this size class")
        return (record["solver"], record["size_class"], tier), first, count
