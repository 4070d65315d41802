"""Made-up campaigns, seeded: difficulty per problem, noise per pass. Not measurements."""

import itertools
import json
from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from lcpbench_report.statistics.launches import COLUMNS
from lcpbench_report.statistics.model import FLAGS, JUDGED, LAWS

TIERS = (1e-3, 1e-6, 1e-9)
SIZES = (10, 20, 50, 100, 200, 500)
CLASSES = (("1", 1, 1, 1000), ("2-3", 2, 3, 1000), ("4-6", 4, 6, 1000), ("7-12", 7, 12, 1000), ("13-30", 13, 30, 1000),
           ("31-100", 31, 100, 256), ("101-300", 101, 300, 64), ("301-1000", 301, 1000, 64),
           ("1001-1e4", 1001, 10_000, 0), ("1e4-1e5", 10_001, 100_000, 0), ("1e5-1e6", 100_001, None, 0))
FAMILIES = ("piles", "chains")
COPIES = 4  # problems of one family and size
ORACLE_PER_ROW = 1e-7  # [s]
EXPONENT = 1.5  # of the time over the rows
TIME_LIMIT = 10.0
BEGAN = 1.7e9  # the first round, seconds since 1970
FIRST, AGAIN = 3.0, 0.5  # times of the solve that is judged, and of another b, over the fresh one
PARTS = {"problem_s": 0.25, "prepare_s": 0.5, "convert_s": 0.0, "solve_s": 0.25}  # of the fresh time


@dataclass
class Noise:
    """Standard deviations of logarithms: of a problem in a pass, of a whole pass over a problem's task; and how many
    passes there are."""

    problem: float = 0.05
    level: float = 0.0
    passes: int = 5


def size_class(rows: int) -> str:
    return next(key for key, least, most, _ in CLASSES if least <= rows and (most is None or rows <= most))


def times_of_passes(rng, median: float, noise: Noise) -> list[float]:
    """The times of one cell, whose passes have levels of their own."""
    logs = rng.normal(0, noise.problem, noise.passes) + rng.normal(0, noise.level, noise.passes)
    return (median * np.exp(logs)).tolist()


def median_times(rng, factors: dict[str, float], problems: int = 100, noise: Noise | None = None) -> pd.DataFrame:
    """Problems x solvers: the medians of what `times_of_passes` gives, drawn at once. A problem's difficulty is spread
    over some decades."""
    noise = noise or Noise()
    difficulty = rng.normal(0, 2, (problems, 1))
    logs = rng.normal(0, np.hypot(noise.problem, noise.level), (problems, len(factors), noise.passes))
    return pd.DataFrame(1e-3 * np.exp(difficulty + np.median(logs, axis=2)) * np.array(list(factors.values())),
                        columns=list(factors))


def launches_of(levels, solver: str = "a", flagged=()) -> pd.DataFrame:
    return pd.DataFrame([{"solver": solver, "size_class": "7-12", "tier": 1e-6, "launch": k + 1, "level": level,
                          "flagged": k in flagged} for k, level in enumerate(levels)], columns=COLUMNS)


def cells_of(times: pd.DataFrame, tier: float = 1e-6, **columns) -> pd.DataFrame:
    """What the tables need of a table of cells, from problems x solvers (inf: failed, NaN: no such cell). Every problem
    is a base of its own."""
    cells = times.rename_axis(index="problem", columns="solver").stack().rename("time_s").reset_index()
    time, solved = cells["time_s"], np.isfinite(cells["time_s"])
    known = time.where(solved)
    return cells.assign(**{
        "set": "main", "counts": True, "tier": tier, "base": cells["problem"].astype(str), "weight": 1.0,
        "origin": "placed", "fill": False, "family": "piles", "rows": 10, "size_class": "7-12", "reference": "certified",
        "asked": True, "fresh_s": known, "first_s": known, "again_s": known, **dict.fromkeys(PARTS, np.nan),
        "time_limit_s": TIME_LIMIT, "check_s": 0.0, "sealed": False, "oracle_s": 1e-3, "oracle_ratio": time / 1e-3, "excluded": "", "passes": solved,
        "at_floor": False, "below_floor": False, "false_success": False, "false_infeasible": False, "rho": tier / 2,
        "verdict": np.where(solved, "verified", "out of time"), "cause": "", "late": False,
        "claim": np.where(solved, "solved", "time_limit")} | columns)


def write_campaign(folder: Path, factors: dict[str, float], seed: int = 1, tiers=TIERS, noise: Noise | None = None,
                   copies: int = COPIES, change: Callable[[dict], dict] = lambda record: record, run: int = 0,
                   solvers: dict[str, dict] | None = None, peers: Collection[str] = (),
                   change_problem: Callable[[dict], dict] = lambda record: record, info: dict | None = None) -> Path:
    """Fills `folder` and returns it. Besides `copies` problems for every family and size there is an engine's problem,
    which does not count.

    @param factors  time of every solver over that of the first
    @param change   what becomes of a cell's record (_cell) before it is put into its task's lines: fail, exclude, ...
    @param run      of the same campaign: the problems are as difficult, the noise is another
    @param solvers  what the entries of solvers in campaign.json have besides: {"slow": {"base": "quick"}}
    @param peers    solvers of other projects
    @param change_problem  what becomes of a problem's record
    @param info  what campaign.json has besides
    """
    noise = noise or Noise()
    folder.mkdir(parents=True, exist_ok=True)
    entries = [solver_entry(key, origin="peer" if key in peers else "own") | (solvers or {}).get(key, {}) for key in factors]
    described = campaign_info(list(tiers), seed, [*entries, solver_entry("absent", False)], noise.passes) | (info or {})
    (folder / "campaign.json").write_text(json.dumps(described), encoding="utf-8")
    problems = [_problem(f"{family}-{rows}-{copy}", "main", family, rows)
                for family in FAMILIES for rows in SIZES for copy in range(copies)]
    problems.append(_problem("ragdoll", "engine", "ragdolls", 40) | {"counts": False, "reference": "none"})
    difficulties = dict(zip((problem["problem"] for problem in problems),
                            np.exp(np.random.default_rng(seed).normal(0, 0.1, len(problems)))))
    problems = [change_problem(problem) for problem in problems]
    rng = np.random.default_rng([seed, run])
    cells = []
    for problem in problems:
        for solver, factor in factors.items():
            for tier in tiers:
                median = factor * difficulties[problem["problem"]] * 1e-7 * problem["rows"] ** EXPONENT
                median *= 1 - np.log10(tier)
                cells.append(change(_cell(problem["problem"], solver, tier, times_of_passes(rng, median, noise))))
    write_lines(folder / "problems.jsonl", problems)
    write_lines(folder / "streams.jsonl", stream_lines(problems, cells))
    return folder


def campaign_info(tiers: list[float], seed: int, solvers: list[dict], passes: int = 5) -> dict:
    """What campaign.json holds."""
    return {"schema": "lcpbench-campaign/2", "name": "synthetic", "manifests": [], "tiers": tiers, "seed": seed,
            "passes": passes, "size_limits": [], "environment": {}, "environment_hash": "0",
            "budgets_s": {"judge": 1.0, "timed": 1.0, "parts": 1.0, "again": 1.0},
            "limits": {"time_per_row_s": 0.01, "least_s": 1.0, "most_s": TIME_LIMIT, "memory_bytes": 2**30},
            "size_classes": [dict(zip(("key", "least", "most", "stream"), of)) for of in CLASSES], "solvers": solvers}


def stream_lines(problems: list[dict], cells: list[dict]) -> list[dict]:
    """The lines of streams.jsonl. A task ends where a rule begins or ends to exclude the solver, and where a problem of
    the class has no cell; classes without a stream have tasks of single problems."""
    numbers = {key: itertools.count() for key, *_ in CLASSES}
    order = {problem["problem"]: (problem["size_class"], next(numbers[problem["size_class"]])) for problem in problems}
    streams = {key: stream for key, *_, stream in CLASSES}
    by_task: dict[tuple, list[dict]] = {}
    for cell in sorted(cells, key=lambda cell: order[cell["problem"]][1]):
        size, number = order[cell["problem"]]
        run = by_task.setdefault((cell["solver"], size, cell["tier"]), [])
        run.append(cell | {"number": number})
    lines = []
    for (solver, size, tier), run in by_task.items():
        task: list[dict] = []
        for cell in run:
            if task and (not streams[size] or cell["excluded"] != task[-1]["excluded"]
                         or cell["number"] != task[-1]["number"] + 1):
                lines += _task_lines(solver, size, tier, task)
                task = []
            task.append(cell)
        lines += _task_lines(solver, size, tier, task)
    return lines


def write_lines(path: Path, records: list[dict]) -> None:
    path.write_text("".join(json.dumps(record) + "\n" for record in records), encoding="utf-8")


def fail(record: dict, claim: str = "iteration_limit") -> dict:
    """The same cell, not verified; one that claims to have solved it is a false success."""
    return record | {"passes": False, "claim": claim, "false_success": claim == "solved", "best_tier": None, "rho": 1.0,
                     "reason": "rho too large", "fresh_s": [None] * len(record["fresh_s"])}


def exclude(record: dict, rule: str = "rows > 100") -> dict:
    return record | {"excluded": rule}


def only(solver: str | None, part: str, change: Callable[[dict], dict]) -> Callable[[dict], dict]:
    """`change` for the cells of a solver (None: of all) whose problem's name holds `part`, the others as they are."""
    return lambda record: change(record) if solver in (None, record["solver"]) and part in record["problem"] else record


def slower(record: dict, factor: float) -> dict:
    """The same cell, and every pass takes so many times as long."""
    return record | {"fresh_s": [None if time is None else factor * time for time in record["fresh_s"]],
                     "first_s": factor * record["first_s"]}


def _task_lines(solver: str, size: str, tier: float, task: list[dict]) -> list[dict]:
    common = {"solver": solver, "size_class": size, "tier": tier, "first": task[0]["number"], "count": len(task),
              "excluded": task[0]["excluded"], "environment": "0"}
    judge = common | {"kind": "judge", "pass": 0}
    if task[0]["excluded"]:
        return [judge]
    judge |= {"attempted": len(task), **{key: [cell[key] for cell in task] for key in JUDGED},
              **{key: [cell.get(key) for cell in task] for key in LAWS if any(key in cell for cell in task)},
              "exceptions": [{"at": at} | {key: cell[key] for key in ("claim", *FLAGS, "reason", "detail")}
                             for at, cell in enumerate(task) if not _is_plain(cell)],
              "peak_bytes": None}
    lines = [judge]
    for index in range(max(len(cell["fresh_s"]) for cell in task)):
        lines.append(common | {"kind": "fresh", "pass": index + 1, "fresh_s": [c["fresh_s"][index] for c in task],
                               "failed": [], "began_s": BEGAN + 60 * index,
                               "disturbance": {"probe_s": 1e-3, "cpu_share": 1.0, "switches": 0, "reruns": 0, "disturbed": False}})
    lines.append(common | {"kind": "parts", "pass": 1} | {
        key: [None if c["fresh_s"][0] is None else share * c["fresh_s"][0] for c in task]
        for key, share in PARTS.items()})
    lines.append(common | {"kind": "again", "pass": 1, "failed": [],
                           "again_s": [None if c["fresh_s"][0] is None else AGAIN * c["fresh_s"][0] for c in task]})
    return lines


def _is_plain(cell: dict) -> bool:
    return cell["claim"] == "solved" and cell["passes"] and not any(cell[flag] for flag in FLAGS[1:])


def solver_entry(key: str, available: bool = True, origin: str = "own") -> dict:
    return {"key": key, "setting": "tuned", "origin": origin, "uses_tolerance": True, "available": available,
            "tolerance": "follows", "shifted": False, "base": "", "settings": {}, "licence": "", "library_version": ""}


def _problem(name: str, chosen_set: str, family: str, rows: int) -> dict:
    return {"problem": name, "set": chosen_set, "family": family, "grid": "", "base": name, "weight": 1.0,
            "origin": "placed", "fill": False, "size_class": size_class(rows), "rows": rows, "bilateral": 0,
            "friction": 0, "bounded": 0, "redundancy": 0, "condition": None, "mass_ratio": 1, "fraction_active": 0.5, "reference": "certified",
            "reference_status": "", "counts": True, "oracle_s": ORACLE_PER_ROW * rows, "check_s": None, "floor": None}


def _cell(problem: str, solver: str, tier: float, times: list[float]) -> dict:
    """What is known of one cell: the members of a judge line's arrays and of its exceptions, and a time for every
    pass."""
    return {"problem": problem, "solver": solver, "tier": tier, "excluded": "", "claim": "solved",
            **{flag: flag == "passes" for flag in FLAGS}, "reason": "", "detail": "",
            "rho": tier / 3, "backward_error": tier / 2, "w_error": tier,
            "f_error": None, "best_tier": tier, "iterations": 7, "first_s": FIRST * times[0],
            "factor_share": 0.5, "fresh_s": times}
