"""Reads a campaign's folder, schema "lcpbench-campaign/2", and checks it.

Nothing is repaired in silence: what does not fit raises ReportError naming file, line and key.
"""

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..errors import ReportError
from .fields import check_fields, check_numbers, check_places, check_record, check_tier, check_word
from .jsonl import is_there, read_lines, read_object
from .steps import FILE as STEPS_FILE
from .steps import PassKey, PassRuns, read_passes, read_sequences

SCHEMA = "lcpbench-campaign/2"
PROBLEMS_FILE, STREAMS_FILE = "problems.jsonl", "streams.jsonl"
# What a solver takes for the tier: its method has no tolerance; the tier's is passed on; the library's own one.
DEFAULT = "default"
TOLERANCES = ("direct", "follows", DEFAULT)
ABLATIONS = ("", "no-self-check", "checked", "baseline")
KINDS = JUDGE, FRESH, PARTS, AGAIN = ("judge", "fresh", "parts", "again")
TASK_BUDGET = "task budget"  # the rule that excludes what had no turn
_CAMPAIGN = {"schema": "name", "name": "text", "solvers": "list", "tiers": "list", "limits": "object",
             "size_classes": "list"}
_SOLVER = {"key": "name", "setting": "text", "origin": "text", "uses_tolerance": "boolean", "available": "boolean",
           "tolerance": "name", "ablation": "text"}
_LIMITS = {"time_per_row_s": "nonnegative", "least_s": "nonnegative", "most_s": "positive"}
_SIZE_CLASS = {"key": "name", "least": "count", "most": "count?", "stream": "count"}
_REFERENCES = ("certified", "bounded", "none")
# Origins of problems -> in words.
ORIGINS = {"placed": "own scenes", "motion": "own motions", "recorded": "engines", "literature": "literature"}
# The parts of the headline, which every resample has as much of: where problems come from.
ORIGIN_GROUPS = {"placed": "own scenes", "motion": "own scenes", "recorded": "engines", "literature": "literature"}
LITERATURE = "literature"  # counts in nothing, also in campaigns that were stored when it did
METRICS = ("rho", "backward_error", "w_error", "f_error")
# Arrays of a judge line, a number for every problem that had its turn.
JUDGED = (*METRICS, "best_tier", "iterations", "first_s", "factor_share")
# Arrays that a judge line has only where problems have friction or bounded rows: parts of the error, and more.
ERROR_PARTS = ("penetration", "adhesion", "separation", "cone", "dissipation", "joints", "beyond_bounds")
LAWS = ("model_rho", *ERROR_PARTS, "friction_power", "created", "energy")
INFEASIBLE = "infeasible"
# What problems of stored campaigns lack -> what it was.
_LATER = {"friction": 0, "bounded": 0, "reference_status": ""}
OUT = "excluded"  # the claim of a problem of a task that a rule excludes: its `reason`
PART_TIMES = ("problem_s", "prepare_s", "convert_s", "solve_s")


@dataclass
class TimedPass:
    """One timed pass over a task; arrays have an entry for each of its problems, NaN where there is none."""

    times: dict[str, np.ndarray]  # name of the array -> [s]
    failed: list[int]  # problems whose answer changed, and is not verified
    disturbed: bool = False  # by the machine, also when run again


@dataclass
class Task:
    """A solver on consecutive problems of a size class at a tier."""

    solver: str
    size_class: str
    tier: float
    first: int  # index of its first problem within the class's order
    count: int
    excluded: str = ""  # the rule, where it was not run
    attempted: int = 0  # so many of its problems had their turn
    judged: dict[str, np.ndarray] = field(default_factory=dict)  # JUDGED, some LAWS -> of the attempted ones, NaN: not known
    exceptions: list[dict] = field(default_factory=list)  # what is not plainly solved and verified, by `at`
    peak_bytes: float = math.nan
    passes: dict[str, dict[int, TimedPass]] = field(default_factory=dict)  # kind -> number of the launch -> pass
    # A compact record (records.py) has these instead of what is above: columns of the table of cells, and what
    # launches.py makes of its class.
    columns: dict[str, np.ndarray] = field(default_factory=dict)
    launches: list[dict] = field(default_factory=list)


@dataclass
class Campaign:
    """One campaign's folder, checked."""

    info: dict  # campaign.json
    problems: dict[str, dict]
    tasks: list[Task]
    notes: list[str]  # what was passed over
    sequences: dict[str, dict] = field(default_factory=dict)  # of campaign.json, by name
    passes: dict[PassKey, PassRuns] = field(default_factory=dict)  # over the sequences

    @property
    def solvers(self) -> dict[str, dict]:
        return {solver["key"]: solver for solver in self.info["solvers"]}

    @property
    def classes(self) -> dict[str, list[str]]:
        """Size class -> its problems, in the order that tasks refer to."""
        found: dict[str, list[str]] = {of["key"]: [] for of in self.info["size_classes"]}
        for name, about in self.problems.items():
            found[about["size_class"]].append(name)
        return found

    def time_limit(self, rows):
        """The limit of one solve of a problem with so many rows, or of an array of them [s]."""
        limits = self.info["limits"]
        if "launches" in self.info:  # of its size class, by the most rows of that
            most = np.array([one["most"] or np.inf for one in self.info["size_classes"]])
            rows = most[np.searchsorted(most, rows)]
        return np.minimum(np.maximum(limits["time_per_row_s"] * rows, limits["least_s"]), limits["most_s"])


def load_campaign(folder: Path) -> Campaign:
    """A campaign of sequences alone need not have the files of problems and streams.

    @throws ReportError for the first thing that does not fit
    """
    if not folder.is_dir():
        raise ReportError(str(folder), "no such folder", "a campaign's folder")
    notes: list[str] = []
    campaign = Campaign(_read_info(folder / "campaign.json"), {}, [], notes)
    has_problems = any(is_there(folder / name) for name in (PROBLEMS_FILE, STREAMS_FILE))
    if has_problems or not is_there(folder / STEPS_FILE):
        campaign.problems = _read_problems(folder / PROBLEMS_FILE, campaign.info, notes.append)
        from . import records  # which is made of this module

        read, file = (records.read_records, records.FILE) if is_there(folder / records.FILE) else (_read_tasks, STREAMS_FILE)
        campaign.tasks = read(folder / file, campaign, notes.append)
    campaign.sequences = read_sequences(campaign.info, "campaign.json")
    campaign.passes = read_passes(folder / STEPS_FILE, campaign.info, campaign.sequences, notes.append)
    return campaign


def _read_info(path: Path) -> dict:
    info = read_object(path, SCHEMA)
    check_fields(path.name, info, _CAMPAIGN)
    check_fields(f"{path.name}: limits", info["limits"], _LIMITS)
    for index, solver in enumerate(info["solvers"]):
        place = f"{path.name}: solvers[{index}]"
        check_fields(place, solver, _SOLVER)
        check_word(place, solver, "tolerance", TOLERANCES)
        check_word(place, solver, "ablation", ABLATIONS)
        if solver["ablation"]:
            check_fields(place, solver, {"base": "name"})
    for index, size_class in enumerate(info["size_classes"]):
        check_fields(f"{path.name}: size_classes[{index}]", size_class, _SIZE_CLASS)
    for what in ("solvers", "size_classes"):
        key, count = max(Counter(entry["key"] for entry in info[what]).items(), key=lambda item: item[1], default=("", 0))
        if count > 1:
            raise ReportError(path.name, f"{what}: {key!r} is there {count} times", "every key once")
    for tier in info["tiers"]:
        check_fields(f"{path.name}: tiers", {"tier": tier}, {"tier": "positive"})
    return info


def _read_problems(path: Path, info: dict, note: Callable[[str], None]) -> dict[str, dict]:
    problems: dict[str, dict] = {}
    classes = {of["key"]: of for of in info["size_classes"]}
    for number, line in read_lines(path, note):
        place = f"{path.name}:{number}"
        record = check_record(place, line, "problem")
        for key, words in (("reference", _REFERENCES), ("origin", ORIGINS), ("size_class", classes)):
            check_word(place, record, key, words)
        own = classes[record["size_class"]]
        if not own["least"] <= record["rows"] <= (math.inf if own["most"] is None else own["most"]):
            raise ReportError(place, f"key 'rows' is {record['rows']}", f"a number of size class {own['key']}")
        if record["problem"] in problems:
            raise ReportError(place, f"problem {record['problem']!r} is there twice", "a line per problem")
        problems[record["problem"]] = _LATER | record | {"counts": record["counts"] and record["origin"] != LITERATURE}
    return problems


def _read_tasks(path: Path, campaign: Campaign, note: Callable[[str], None]) -> list[Task]:
    """Passes of a task may come before its judge line: processes that share a folder end as they like."""
    solvers = {key: "" for key, solver in campaign.solvers.items() if solver["available"]}
    sizes = {key: len(problems) for key, problems in campaign.classes.items()}
    tasks: dict[tuple, Task] = {}
    judged: dict[tuple, set[int]] = {}
    passes: dict[tuple, list[tuple[str, dict]]] = {}
    for number, line in read_lines(path, note):
        place = f"{path.name}:{number}"
        record = check_record(place, line, "line")
        for field_, words in (("kind", KINDS), ("solver", solvers), ("size_class", sizes)):
            check_word(place, record, field_, words)
        tier = check_tier(place, campaign.info["tiers"], record["tier"])
        first, count = int(record["first"]), int(record["count"])
        if not 1 <= count <= sizes[record["size_class"]] - first:
            raise ReportError(place, f"keys 'first' and 'count' are {first} and {count}",
                              f"some of the {sizes[record['size_class']]} problems of this size class")
        key = (record["solver"], record["size_class"], tier, first, count)
        if record["kind"] != JUDGE:
            passes.setdefault(key, []).append((place, record))
            continue
        seen = judged.setdefault(key[:3], set())
        if not seen.isdisjoint(range(first, first + count)):
            raise ReportError(place, "a problem of this task is judged twice", "a judge line per task")
        seen.update(range(first, first + count))
        tasks[key] = _judged(place, record, Task(*key))
    for key, lines in passes.items():
        if key not in tasks:
            raise ReportError(lines[0][0], "the task has no judge line", "one for every task")
        for place, record in lines:
            _add_pass(place, record, tasks[key])
    return list(tasks.values())


def _judged(place: str, record: dict, task: Task) -> Task:
    if record["pass"] != 0:
        raise ReportError(place, f"key 'pass' is {record['pass']}", "0 where the kind is judge")
    task.excluded = record["excluded"]
    if task.excluded:
        return task
    check_record(place, record, "judge", "attempted", "peak_bytes", "exceptions")
    task.attempted = int(record["attempted"])
    if task.attempted > task.count:
        raise ReportError(place, f"key 'attempted' is {task.attempted}", f"{task.count}, the key 'count', at most")
    for key in (*JUDGED, *(key for key in LAWS if key in record)):
        task.judged[key] = check_numbers(place, record, "judge", key, task.attempted)
    there = f"{place}: exceptions"
    check_places(there, [check_fields(there, one, {"at": "count"})["at"] for one in record["exceptions"]], task.attempted)
    for one in record["exceptions"]:
        check_record(f"{there} at {one['at']}", one, "exception", *(("claim", "passes", "reason") * (one.get("claim") == OUT)))
    task.exceptions = record["exceptions"]
    task.peak_bytes = math.nan if record["peak_bytes"] is None else float(record["peak_bytes"])
    # It may be the only time of a problem: ratios and logarithms are made of it.
    plain = np.ones(task.attempted, dtype=bool)
    plain[[one["at"] for one in task.exceptions if not one["passes"]]] = False
    if not (task.judged["first_s"][plain] > 0).all():
        raise ReportError(place, "key 'first_s' has none", "a number > 0 where a solve passes")
    return task


def _add_pass(place: str, record: dict, task: Task) -> None:
    kind, number = record["kind"], int(record["pass"])
    if number < 1:
        raise ReportError(place, f"key 'pass' is {number}", f"1 or more where the kind is {kind}")
    of_kind = task.passes.setdefault(kind, {})
    if number in of_kind:
        raise ReportError(place, f"pass {number} of this kind and task is there twice", "a line per task and pass")
    if task.excluded:
        raise ReportError(place, f"the task is excluded: {task.excluded}", "no pass of it")
    times = {key: check_numbers(place, record, kind, key, task.count)
             for key in (PART_TIMES if kind == PARTS else (f"{kind}_s",))}
    if kind == PARTS:
        of_kind[number] = TimedPass(times, [])
        return
    check_record(place, record, kind, "failed")
    failed = check_places(f"{place}: failed", record["failed"], task.count)
    disturbed = False
    if kind == FRESH:
        check_record(place, record, kind, "disturbance")
        if record["disturbance"] is not None:
            disturbed = check_record(f"{place}: disturbance", record["disturbance"], "disturbance", "disturbed")["disturbed"]
    of_kind[number] = TimedPass(times, failed, disturbed)
