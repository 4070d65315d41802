"""Made-up passes over sequences. Not measurements."""

import json
from pathlib import Path

from .synthetic_campaign import campaign_info, solver_entry, write_lines

STEPS = 101  # so that percentiles are order statistics
TIERS = (1e-3, 1e-6)
SEQUENCES = (("pile-12", 12), ("chain-12", 12), ("pile-40", 40))
DEADLINE = 1e-3


def write_sequences(folder: Path, passes: list[dict], solvers=(("quick", "own"), ("peer", "peer"))) -> Path:
    """Fills `folder`, without files of problems and cells, and returns it."""
    folder.mkdir(parents=True, exist_ok=True)
    info = campaign_info(list(TIERS), 1, [solver_entry(key, origin=origin) for key, origin in solvers]) | {
        "sequences": [{"sequence": name, "set": "motions", "family": name.split("-")[0], "rows": rows,
                       "most_rows": rows, "steps": STEPS} for name, rows in SEQUENCES],
        "deadlines_s": [DEADLINE], "pass_budget_s": 20}
    (folder / "campaign.json").write_text(json.dumps(info), encoding="utf-8")
    write_lines(folder / "steps.jsonl", passes)
    return folder


def one_pass(sequence: str, solver: str, mode: str, latency_s: list[float], tier: float = 1e-6, index: int = 0,
             failed=(), late=(), rho=None, judged=None, preempted=()) -> dict:
    """A line of steps.jsonl. Steps beyond those that have a time were not reached."""
    reached = len(latency_s)
    rho = [tier / 2] * reached if rho is None else rho
    missed = sorted({*failed, *late, *range(reached, STEPS)})
    return {"sequence": sequence, "solver": solver, "tier": tier, "mode": mode,
            "deadline_s": DEADLINE if mode.startswith("deadline") else None, "round": index, "excluded": "",
            "outcome": "completed" if reached == STEPS else "budget", "detail": "", "steps": STEPS, "reached": reached,
            "claims": {"solved": reached} if reached else {},
            "verdicts": [{"tier": judge, "passed": STEPS - len(missed), "failed": len(missed), "false_successes": 0,
                          "failed_steps": missed} for judge in judged or [tier]],
            "late": list(late), "preempted": list(preempted), "latency_s": latency_s,
            "iterations": [3] * reached,
            "rho": [None if k in late else value for k, value in enumerate(rho)],
            "backward_error": [None] * reached, "w_error": [None if k in late else 2e-9 for k in range(reached)],
            "environment": "0"}


def exclude(record: dict, rule: str = "rows > 30") -> dict:
    return {key: record[key] for key in ("sequence", "solver", "tier", "mode", "deadline_s", "round")} | {
        "excluded": rule}
