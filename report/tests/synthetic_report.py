"""Made-up folders for whole reports: campaigns with peers and pathological problems, sequences and a motion. Not
measurements."""

import functools
import itertools
import math
import tempfile
from pathlib import Path

import pandas as pd

from lcpbench_report import studies
from lcpbench_report.inputs import Inputs, load_inputs
from .synthetic_campaign import TIERS, Noise, exclude, fail, write_campaign
from .synthetic_steps import SEQUENCES, STEPS, one_pass, write_sequences

SCENE, LEVEL = "disc-pile", "velocity"
SLIPPING = ("slabs", "arch")  # scenes with friction
STARTED = "2026-01-02T03:04:05Z"

# What the page and the files have, in order.
FIGURES = ["time-by-size", "metrics", "front", "profiles", "accuracy", "coverage", "pathological", "scaling", "latency",
           "deadline", "motion", "friction-motion"]

# ----- three solvers: for pages and decisions

FACTORS = {"auto": 1.0, "pgs": 3.0, "ode-dantzig": 2.0}
PEERS = ("ode-dantzig",)
_ENVIRONMENT = {"cpu": "a made-up CPU", "cores": 2, "git_commit": "0123456789abcdef", "git_dirty": False,
                "solver_flags": "-march=native", "library_threads": 1, "memory_bytes": 2**30}


def spoiled(record: dict) -> dict:
    """pgs fails the largest piles at the strictest tier, the peer claims too much there and is not given chains."""
    large = record["problem"].startswith("piles-500") and record["tier"] < 1e-8
    if large and record["solver"] != "auto":
        return fail(record, "solved" if record["solver"] in PEERS else "iteration_limit")
    if record["solver"] in PEERS and record["problem"].startswith("chains-500"):
        return exclude(record)
    return record


def write_cells(folder: Path) -> Path:
    """A campaign in which the engine's problem is a pathological one."""
    return write_campaign(folder, FACTORS, change=spoiled, noise=Noise(passes=3), copies=2, peers=PEERS,
                          solvers={key: {"method": f"the method of {key} <&>"} for key in FACTORS},
                          change_problem=lambda of: of | ({"set": "pathological"} if of["set"] == "engine" else {}),
                          info={"started": STARTED, "environment": _ENVIRONMENT})


def write_steps(folder: Path) -> Path:
    """`auto` gains by warm starts, `pgs` misses a step of the deadline."""
    passes = []
    for name, _ in SEQUENCES:
        for solver, cold, warm in (("auto", 2e-5, 1e-5), ("pgs", 8e-5, 6e-5), ("ode-dantzig", 3e-5, 3e-5)):
            passes += [one_pass(name, solver, mode, [time] * STEPS) for mode, time in (("cold", cold), ("warm", warm))]
            if solver not in PEERS:
                passes.append(one_pass(name, solver, "deadline-1ms", [warm] * STEPS, failed=[3] if solver == "pgs" else []))
    return write_sequences(folder, passes, solvers=(("auto", "own"), ("pgs", "own"), ("ode-dantzig", "peer")))


def _moved(scene: str, solver: str, tolerance: float, step: int) -> dict:
    return {"scene": scene, "level": LEVEL, "size": 20, "seed": 1, "solver": solver, "tolerance": tolerance, "step": step,
            "time": step * 1e-2, "energy": 1.0, "energy_error": 0.0, "penetration": 0.0, "joint_error": 0.0, "stopped": "",
            "solve_time_s": 1e-5 * step, "solves": step, "failed": 0, "not_passed": 0, "false_successes": 0}


def write_motion(folder: Path) -> Path:
    """Without friction."""
    folder.mkdir(parents=True, exist_ok=True)
    rows = []
    for solver, tolerance, error in (("auto", 1e-6, 1e-9), ("pgs", 1e-3, 1e-4), ("pgs", 1e-6, 1e-7)):
        stopped = "not finite, too late" if tolerance == 1e-3 else ""
        for step in range(50 if stopped else 100):
            rows.append(_moved(SCENE, solver, tolerance, step) | {
                "energy_error": error * step, "penetration": error * (step % 7), "distance": error, "rho": error, "stopped": stopped,
                "max_iterations": 0, "start": "warm"})
    pd.DataFrame(rows, columns=list(studies.MOTION_COLUMNS)).to_csv(folder / studies.MOTION_FILE, index=False)
    return folder


def write_friction_motion(folder: Path) -> Path:
    """Two scenes: exact, and ended after 10 sweeps, warm and cold, which creep by 1 and 10 mm a step."""
    folder.mkdir(parents=True, exist_ok=True)
    rows = []
    for scene, (solver, limit, start, creep) in itertools.product(SLIPPING, (("auto", 0, "warm", 0.0), ("pgs", 10, "warm", 1e-3),
                                                                             ("pgs", 10, "cold", 1e-2))):
        for step in range(20):
            rows.append(_moved(scene, solver, 1e-6, step) | {
                "joint_error": math.nan, "distance": creep * step, "rho": creep, "lost_gap": creep / 10 if step else math.nan,
                "creep": creep * step if step else math.nan, "created": 0.0, "max_iterations": limit, "start": start, "width": 1.0})
    pd.DataFrame(rows, columns=list(studies.MOTION_COLUMNS)).to_csv(folder / studies.MOTION_FILE, index=False)
    return folder


def write_pictures(folder: Path) -> Path:
    """As `make pictures` leaves them: of one family that the campaign has, and of another one."""
    folder.mkdir(parents=True, exist_ok=True)
    for family in ("piles", "rockers", "wedges"):
        (folder / f"{family}.svg").write_text('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 3"/>', encoding="utf-8")
    (folder / "scenes.txt").write_text("piles     Pile. Of <discs>\nrockers   Rockers. On a floor\nwedges    Wedges. Of discs (friction)\n", encoding="utf-8")
    return folder


def write_all(folder: Path) -> tuple[list[Path], list[Path]]:
    """@returns the campaigns' folders and those of motions"""
    return ([write_cells(folder / "standard"), write_steps(folder / "sequences")],
            [write_motion(folder / "motion"), write_friction_motion(folder / "friction-motion")])


@functools.cache
def whole_inputs() -> Inputs:
    """One for all tests: nobody changes it."""
    with tempfile.TemporaryDirectory() as folder:
        return load_inputs(*write_all(Path(folder)))


# ----- many solvers: for the headline and figures

OWN = ("auto", "dantzig", "pgs")
# One library has two methods: the second is quicker, and is not given large problems. Another has two settings: the
# default is slower.
MANY = {"auto": 1.0, "dantzig": 0.5, "pgs": 3.0, "ode-dantzig": 2.0, "ode-lemke": 0.6, "clp": 20.0, "clp-default": 40.0}
FAILING, NEXT = "dantzig", "ode-lemke"  # the fastest, but not on all problems of any size; the next one
ENVIRONMENT = {"cpu": "A Processor", "compiler": "GNU 12.2.0", "git_commit": "0123456789abcdef", "git_dirty": False,
               "os": "An OS", "flags": "-O3"}


def write_problems(folder: Path, change=None, tiers=TIERS) -> Path:
    """Every fourth problem is a pathological one, another fourth has a grid.

    @param change  of a cell's record, default: failures and exclusions of some solvers
    """
    numbers = itertools.count()

    def of_sets(problem: dict) -> dict:
        index = next(numbers)
        if problem["set"] != "main":
            return problem
        return problem | {"set": "standard" if index % 4 else "pathological",
                          "grid": "mass ratio" if index % 4 == 1 else ""}

    return write_campaign(folder, MANY, copies=2, tiers=tiers, change=change or fail_some, change_problem=of_sets,
                          peers=set(MANY) - set(OWN),
                          info={"environment": ENVIRONMENT, "started": STARTED})


def fail_some(record: dict) -> dict:
    """FAILING is wrong on one of the two problems of every family and size; large ones are not given to ode-lemke."""
    if record["solver"] == FAILING and record["problem"].endswith("-1"):
        return fail(record, "solved")
    if record["solver"] == "ode-lemke" and any(f"-{rows}-" in record["problem"] for rows in (200, 500)):
        return exclude(record)
    return record
