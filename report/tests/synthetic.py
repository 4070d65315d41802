"""A made-up results folder, seeded, with every kind of outcome that the report must show. Not measurements."""

import csv
import json
import math
import random
from pathlib import Path

from lcpbench_report import motion
from lcpbench_report.load import ACCURACY_COLUMNS, PROBLEM_COLUMNS

FAMILIES = ("discs-in-v", "disc-pile", "disc-track", "boxes-and-discs", "rockers")
SIZES = (10, 30, 100, 300, 1000, 3000)
SEEDS = (1, 2, 3)
TIERS = (1e-3, 1e-6, 1e-9)
# key -> time at n = 1 [s], exponent, factor per tier
OWN = {"dantzig": (3e-8, 2.6, 1.0), "auto": (2e-8, 2.4, 1.0), "pgs": (6e-7, 1.6, 3.5), "ipopt-qp": (4e-5, 1.5, 1.3),
       "ipopt-ncp": (9e-5, 1.6, 1.5), "ipm": (5e-6, 1.25, 1.2)}
PEERS = {"bullet-dantzig": (4e-8, 2.6, 1.0), "bullet-dantzig-cfm": (4e-8, 2.6, 1.0), "clp": (1e-6, 2.0, 1.2),
         "clp-default": (1e-6, 2.1, 1.1)}
EXTERNAL = {"mine": (1e-4, 1.1, 1.0)}
SOLVERS = OWN | PEERS | EXTERNAL
MISSING = ("petsc-rsls", "tao-tron")
DIRECT = ("dantzig", "auto", "bullet-dantzig", "bullet-dantzig-cfm")
_LIBRARIES = {"bullet": "Bullet", "clp": "Clp", "petsc": "PETSc", "tao": "PETSc"}
_SVG = """<?xml version="1.0"?><svg xmlns="http://www.w3.org/2000/svg" width="200" height="150" viewBox="0 0 200 150">
<style>.body {{ fill: #dde6ee; stroke: #445; }}</style>
<defs><marker id="tip" markerWidth="6" markerHeight="6" refX="3" refY="3" orient="auto">
<path d="M0 0L6 3L0 6Z"/></marker></defs>
<path d="M10 20L100 140L190 20" fill="none" stroke="#445"/><circle class="body" cx="100" cy="{0}" r="28"/>
<line x1="100" y1="100" x2="100" y2="60" stroke="#b33" marker-end="url(#tip)"/></svg>"""


def write_results(folder: Path, seed: int = 7, families=FAMILIES, sizes=SIZES, seeds=SEEDS) -> Path:
    """Fills `folder` and returns it."""
    rng = random.Random(seed)
    folder.mkdir(parents=True, exist_ok=True)
    problems, accuracy, benchmarks = [], [], []
    for f, family in enumerate(families):
        (folder / f"{family}.svg").write_text(_SVG.format(60 + 8 * f), encoding="utf-8")
        for n in sizes:
            for s in seeds:
                problems.append(_problem(rng, f, family, n, s))
                for solver in SOLVERS:
                    rows = [_run(rng, f, problems[-1], solver, tier) for tier in TIERS]
                    accuracy += rows
                    if s == seeds[0]:
                        benchmarks += _benchmarks(rng, rows)
    _write_csv(folder / "problems.csv", PROBLEM_COLUMNS, problems)
    _write_csv(folder / "accuracy.csv", ACCURACY_COLUMNS, accuracy)
    (folder / "timing.json").write_text(json.dumps({"context": {}, "benchmarks": benchmarks}), encoding="utf-8")
    (folder / "run.json").write_text(json.dumps(_run_json(families)), encoding="utf-8")
    return folder


def _run_json(families) -> dict:
    return {
        "schema": "lcpbench-run/1", "suite": "synthetic", "started": "2024-01-02T03:04:05Z", "wall_s": 1234.5,
        "git_commit": "0123456789abcdef0123456789abcdef01234567", "git_dirty": True, "compiler": "GNU 12.2.0",
        "flags": "-O3 -DNDEBUG -march=native", "build_type": "Release", "cpu": "Made-up CPU @ 3.0 GHz", "cores": 2,
        "memory_bytes": 8 * 2**30, "os": "Debian 12",
        "libraries": {"Eigen": "3.4.0", "Ipopt": "3.11.9", "CHOLMOD": "3.0.14"},
        "tiers": list(TIERS), "time_limit_s": 20.0, "repetitions": 5, "min_time_s": 0.1, "seed": 1,
        # An external solver comes last in the registry; here it does not, so that the order must be made.
        "solvers": [_solver_json(key) for key in (*EXTERNAL, *OWN, *PEERS, *MISSING)],
        "scenes": [{"key": key, "title": key.replace("-", " ").capitalize(), "purpose": f"What {key} tells apart.",
                    "picture": f"{key}.svg"} for key in families],
        "metrics": [{"key": "rho", "formula": "|min(D^1/2 f, D^-1/2 w)|_2 / |D^-1/2 b|_2"},
                    {"key": "backward_error", "formula": "max |min(A_ii f_i, w_i)| / (|A||f| + |b|)_i"}],
    }


def _solver_json(key) -> dict:
    origin = "own" if key in OWN else "external" if key in EXTERNAL else "peer"
    return {"key": key, "method": f"method of {key}", "source": _LIBRARIES.get(key.split("-")[0], f"source of {key}"),
            "available": key not in MISSING, "uses_tolerance": key not in DIRECT, "origin": origin,
            "licence": f"licence of {key}", "library_version": "" if origin == "own" or key in MISSING else "1.2.3"}


def _problem(rng, f, family, n, seed) -> dict:
    return {"problem": f"{family}-n{n}-s{seed}", "family": family, "n": n, "seed": seed, "bodies": n // 2 + 2,
            "movable": n // 2, "nnz_a": min(n * n, 7 * n), "rank_a": n - (f * n) // 10 if n <= 1000 else "",
            "separating": round(rng.uniform(0.1, 0.5), 3), "active": n // 2, "independent": n // 2 - (f * n) // 20,
            "oracle_contact_s": f"{2e-7 * n:.6e}", "oracle_body_s": f"{1e-6 * n**0.9:.6e}" if f else "",
            "floor": f"{floor_of(f, n):.6e}" if n > 10 else "", "floor_solver": "auto" if n > 10 else ""}


def floor_of(f, n) -> float:
    """Of the last family it comes near the strictest tier at n = 1000 and exceeds it at n = 3000."""
    return {1000: 3e-10, 3000: 4e-9}.get(n, 1e-15 * n) if f == len(FAMILIES) - 1 else 1e-15 * n


def _run(rng, f, problem, solver, tier) -> dict:
    n = problem["n"]
    time0, exponent, per_tier = SOLVERS[solver]
    digits = -math.log10(tier)
    row = {key: problem[key] for key in ("problem", "family", "n", "seed")}
    row |= {column: "" for column in ACCURACY_COLUMNS if column not in row}
    row |= {"solver": solver, "tier": f"{tier:.0e}", "claim": "solved", "false_success": "false",
            "false_infeasible": "false", "iterations": n}
    if solver == "dantzig" and n > 1000:
        empty = dict.fromkeys(("iterations", "false_success", "false_infeasible", "claim"), "")
        return row | empty | {"excluded": "dense, n > 1000"}
    judged = min(TIERS) if solver in DIRECT else tier
    rho = judged * 10 ** rng.uniform(-3, -0.2)
    if solver in DIRECT:
        rho = 10 ** rng.uniform(-16, -13)
    if solver == "pgs" and (tier < 1e-6 and n > 10 or tier < 1e-3 and n > 300 + 100 * f):
        row |= {"claim": "iteration_limit", "detail": "10000 sweeps"}
        rho = tier * 10 ** rng.uniform(0.5, 2)
    if solver == "ipopt-ncp" and rng.random() < 0.12:
        row |= {"claim": "numerical_failure", "detail": "Restoration_Failed (2)"}
        rho = 10 ** rng.uniform(-3, 2) if rng.random() < 0.8 else math.inf
    if solver == "ipopt-qp" and tier == 1e-9 and f == 4 and n in (300, 1000):
        rho = 3.1e-9
    # Above the strictest tier and below the floor.
    at_floor = solver == "ipm" and tier == 1e-9 and floor_of(f, n) > tier
    if at_floor:
        rho = 2.5e-9
    passes = rho <= max(tier, floor_of(f, n))
    row |= {"passes": str(passes).lower(), "false_success": str(row["claim"] == "solved" and not passes).lower(),
            "best_tier": next((f"{t:.0e}" for t in sorted(TIERS) if rho <= max(t, floor_of(f, n))), ""),
            "at_floor": str(at_floor).lower(), "rho": f"{rho:.6e}",
            "backward_error": f"{10 * rho:.6e}", "setup_s": f"{2e-7 * n**1.1 * (1 + len(solver)):.6e}",
            "solve_s": f"{time0 * n**exponent * per_tier ** (digits / 3) * (1 + 0.3 * f) * rng.uniform(1, 1.4):.6e}"}
    if solver in PEERS:
        row["convert_s"] = f"{1e-9 * n**2:.6e}"
    if not passes:
        row["reason"] = f"rho {rho:.1e} > {tier:.0e}"
    return row


def _benchmarks(rng, rows) -> list[dict]:
    found = []
    for row in rows:
        if row["solver"] in DIRECT and float(row["tier"]) != min(TIERS):
            continue  # one run stands for every tier
        name = f"solve/{row['family']}/{row['n']}/{row['solver']}/{float(row['tier']):.0e}"
        name += "/min_time:0.100/repeats:5/real_time" if row["solver"] in OWN else "/iterations:1/repeats:5/manual_time"
        if row["excluded"] or row["passes"] == "false":
            found.append({"name": name, "run_name": name, "run_type": "iteration", "error_occurred": True,
                          "error_message": row["excluded"] or row["reason"]})
            continue
        for repetition in range(5):
            found.append({"name": name, "run_name": name, "run_type": "iteration", "repetition_index": repetition,
                          "real_time": float(row["solve_s"]) * rng.uniform(0.8, 0.9) * 1e6, "time_unit": "us"})
    if not rows[0]["excluded"]:
        name = f"setup/{rows[0]['family']}/{rows[0]['n']}/{rows[0]['solver']}/min_time:0.100/repeats:5/manual_time"
        found.append({"name": name, "run_name": name, "run_type": "iteration",
                      "real_time": float(rows[0]["setup_s"]) * 1e9, "time_unit": "ns"})
    return found


def write_motion(folder: Path, scenes=(("disc-pile", "velocity"), ("disc-track", "acceleration"))) -> None:
    """Adds motion.csv: errors of each solver proportional to its tolerance; pgs stops early at the loosest."""
    rows = []
    for scene, level in scenes:
        for solver in OWN:
            for tier in TIERS if solver != "dantzig" else TIERS[-1:]:
                for step in range(0, 101, 10):
                    stops = solver == "pgs" and tier == TIERS[0] and step == 50
                    error = tier * step if solver != "dantzig" else 0.0
                    rows.append({"scene": scene, "level": level, "size": 20, "seed": 1, "solver": solver,
                                 "tolerance": f"{tier:g}", "step": step, "time": step * 1e-3, "energy": -error,
                                 "energy_error": error, "penetration": error / 10, "joint_error": 0,
                                 "distance": 2 * error, "rho": tier / 2, "solve_time_s": step * 1e-4, "solves": step,
                                 "failed": 0, "not_passed": 0, "false_successes": 1 if stops else 0,
                                 "stopped": "not finite" if stops else ""})
                    if stops:
                        break
    _write_csv(folder / motion.FILE, motion.COLUMNS, rows)


def _write_csv(path: Path, columns, rows) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(columns))
        writer.writeheader()
        writer.writerows(rows)
