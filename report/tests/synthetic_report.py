"""Made-up folders for whole reports: campaigns with peers and pathological problems, sequences and a motion. Not
measurements."""

import json
from pathlib import Path

import pandas as pd

from lcpbench_report import motion
from lcpbench_report.inputs import Inputs, load_inputs
from .synthetic_campaign import Noise, exclude, fail, write_campaign, write_lines
from .synthetic_steps import SEQUENCES, STEPS, one_pass, write_sequences

FACTORS = {"auto": 1.0, "pgs": 3.0, "ode-dantzig": 2.0}
PEERS = ("ode-dantzig",)
SCENE, LEVEL = "disc-pile", "velocity"


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
    write_campaign(folder, FACTORS, change=spoiled, noise=Noise(passes=3), copies=2,
                   solvers={key: {"origin": "peer"} for key in PEERS})
    info = json.loads((folder / "campaign.json").read_text(encoding="utf-8"))
    for solver in info["solvers"]:
        solver["method"] = f"the method of {solver['key']} <&>"
    info["started"] = "2026-01-02T03:04:05Z"
    info["environment"] = {"cpu": "a made-up CPU", "cores": 2, "git_commit": "0123456789abcdef", "git_dirty": False,
                           "solver_flags": "-march=native", "library_threads": 1, "memory_bytes": 2**30}
    (folder / "campaign.json").write_text(json.dumps(info), encoding="utf-8")
    problems = [json.loads(line) for line in (folder / "problems.jsonl").read_text(encoding="utf-8").splitlines()]
    write_lines(folder / "problems.jsonl", [problem | ({"set": "pathological"} if problem["set"] == "engine" else {})
                                            for problem in problems])
    return folder


def write_steps(folder: Path) -> Path:
    """`auto` gains by warm starts, `pgs` misses a step of the deadline."""
    passes = []
    for name, _ in SEQUENCES:
        for solver, cold, warm in (("auto", 2e-5, 1e-5), ("pgs", 8e-5, 6e-5)):
            passes += [one_pass(name, solver, "cold", [cold] * STEPS), one_pass(name, solver, "warm", [warm] * STEPS),
                       one_pass(name, solver, "deadline-1ms", [warm] * STEPS, failed=[3] if solver == "pgs" else [])]
        passes += [one_pass(name, "ode-dantzig", mode, [3e-5] * STEPS)
                   for mode in ("cold", "warm")]
    return write_sequences(folder, passes, solvers=(("auto", "own"), ("pgs", "own"), ("ode-dantzig", "peer")))


def write_motion(folder: Path) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    rows = []
    for solver, tolerance, error in (("auto", 1e-6, 1e-9), ("pgs", 1e-3, 1e-4), ("pgs", 1e-6, 1e-7)):
        stopped = "not finite" if tolerance == 1e-3 else ""
        for step in range(50 if stopped else 100):
            rows.append({"scene": SCENE, "level": LEVEL, "size": 20, "seed": 1, "solver": solver, "tolerance": tolerance,
                         "step": step, "time": step * 1e-2, "energy": 1.0, "energy_error": error * step,
                         "penetration": error * (step % 7), "joint_error": 0.0, "distance": error, "rho": error,
                         "solve_time_s": 1e-5 * step, "solves": step, "failed": 0, "not_passed": 0, "false_successes": 0,
                         "stopped": stopped})
    pd.DataFrame(rows, columns=list(motion.COLUMNS)).to_csv(folder / motion.FILE, index=False)
    return folder


def write_pictures(folder: Path) -> Path:
    """As `make pictures` leaves them: of one family that the campaign has, and of another one."""
    folder.mkdir(parents=True, exist_ok=True)
    for family in ("piles", "rockers"):
        (folder / f"{family}.svg").write_text('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 3"/>', encoding="utf-8")
    (folder / "scenes.txt").write_text("piles     Pile. Of <discs>\nrockers   Rockers. On a floor\n", encoding="utf-8")
    return folder


def write_all(folder: Path) -> tuple[list[Path], Path]:
    """@returns the campaigns' folders and that of the motion"""
    return [write_cells(folder / "standard"), write_steps(folder / "sequences")], write_motion(folder / "motion")


def whole_inputs(folder: Path) -> Inputs:
    return load_inputs(*write_all(folder))
