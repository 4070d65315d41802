"""What the numbers cannot carry: facts of these results, which limitations.md.j2 states. What does not hold is left out."""

import math

import pandas as pd

from . import formats
from .inputs import Inputs
from .sentences import lines
from .statistics.cells import CHANGED, NOT_ASKED, VERIFIED
from .statistics.launches import KEY, TOGETHER
from .statistics.model import ORIGINS, TASK_BUDGET

# A solver is called out as built for looser tiers when it verifies less than this part of what it does at the loosest.
_TIER_DROP = 0.75


def limitations(inputs: Inputs) -> list[tuple[str, str]]:
    """[(subject, sentences)]"""
    facts = _builds(inputs) | _noise(inputs) | _rules(inputs) | _solvers(inputs) | _problems(inputs)
    return [tuple(line.split(" | ", 1)) for line in lines("limitations.md.j2", inputs=inputs, **facts)]


def _builds(inputs: Inputs) -> dict:
    known = [campaign.info.get("environment", {}) for campaign in inputs.campaigns]
    machines = dict.fromkeys(f"{e.get('cpu', 'unknown')}, {e.get('cores', '?')} cores" for e in known)
    return {"machines": list(machines), "threads": known[0].get("library_threads"),
            "blas": known[0].get("libraries", {}).get("BLAS", "BLAS"),  # its name says which kernels it runs
            "dirty": any(e.get("git_dirty") for e in known),
            "build_types": sorted({str(e.get("build_type", "")) for e in known} - {"", "Release", "RelWithDebInfo"}),
            "flags": sorted({str(e.get("solver_flags", "")) for e in known} - {""}),
            "passes": max(campaign.info.get("passes", 0) for campaign in inputs.campaigns)}


def _noise(inputs: Inputs) -> dict:
    launches = inputs.measured.launches
    launches = launches[launches["launch"] != TOGETHER]
    spread = launches.groupby(KEY)["level"].agg(["std", "count"])
    changed = inputs.cells[(inputs.cells["excluded"] == "") & (inputs.cells["verdict"] == CHANGED)]
    return {"spread": spread["std"] if len(launches) else None, "disturbed": _disturbed(launches), "changed": changed,
            "single": float((spread["count"] < 2).mean()) if len(launches) else 0.0}


def _disturbed(launches: pd.DataFrame) -> dict | None:
    """How many launches the machine disturbed, and whether it shows in the times."""
    if not launches["disturbed"].any():
        return None
    levels = launches.groupby([*KEY, "disturbed"])["level"]
    medians = levels.median().unstack().reindex(columns=[False, True])
    slower = float((medians[True] - medians[False]).dropna().median())
    return {"count": int(launches["disturbed"].sum()), "launches": len(launches), "alone": float(medians[False].isna().mean()),
            "slower": slower if math.isfinite(slower) else None, "change": abs(math.expm1(slower)),
            "usual": float(levels.std().dropna().median())}


def _counts(inputs: Inputs, cells: pd.DataFrame) -> dict[str, int]:
    """Solver -> its cells among these."""
    found = cells["solver"].value_counts()
    return {solver: found[solver] for solver in inputs.in_order(found.index)}


def _rules(inputs: Inputs) -> dict:
    """Limits of time, exclusions, budgets."""
    cells = inputs.cells
    left_out = cells[~cells["excluded"].isin(("", TASK_BUDGET))]
    return {"limits": [(name, campaign.info["limits"]) for name, campaign in zip(inputs.names, inputs.campaigns)],
            "ended": _counts(inputs, cells[(cells["excluded"] == "") & cells["claim"].isin(("time_limit", "killed"))]),
            "excluded": [(rule, inputs.in_order(of["solver"]), len(of))
                         for rule, of in left_out.groupby("excluded", sort=False)],
            "unasked": _counts(inputs, cells[cells["verdict"] == NOT_ASKED]),
            "late": cells[cells["excluded"] == TASK_BUDGET],
            "untimed": int((cells["passes"].astype(bool) & (cells["timed"] == 0)).sum())}


def _solvers(inputs: Inputs) -> dict:
    verified = inputs.cells[inputs.cells["verdict"] == VERIFIED].groupby(["solver", "tier"]).size()
    loose, strict = max(inputs.tiers, default=1), min(inputs.tiers, default=1)
    run = {key: inputs.entries[key] for key in inputs.entries if key in inputs.keys}
    return {"missing": [entry["key"] for entry in inputs.solvers if not entry["available"]],
            "drop": [key for key in inputs.keys if len(inputs.tiers) > 1
                     and verified.get((key, strict), 0) < _TIER_DROP * verified.get((key, loose), 0)],
            "direct": [key for key, entry in run.items() if not entry["uses_tolerance"]],
            "first_protocol": [key for key, entry in run.items() if entry.get("protocol") == 1],
            "at_floor": int(inputs.cells["at_floor"].sum()), "below_floor": int(inputs.cells["below_floor"].sum())}


def _problems(inputs: Inputs) -> dict:
    about = inputs.problems.values()
    problems = inputs.cells.drop_duplicates("problem")
    weights = problems[problems["counts"].astype(bool)].groupby("origin")["weight"].sum()
    shares = [f"{ORIGINS[origin]} {formats.percent(float(weights[origin] / weights.sum()))}"
              for origin in ORIGINS if weights.get(origin, 0) > 0]
    laws = sum(of["friction"] > 0 or of["bounded"] > 0 for of in about)
    return {"weights": shares if len(problems) else None, "variants": int(problems["base"].duplicated(keep=False).sum()),
            "problems": len(problems), "filled": int(problems["fill"].astype(bool).sum()), "laws": laws,
            "apart": sum(not of["counts"] for of in about) - laws,
            "steps": sum(int(of["steps"]) for campaign in inputs.campaigns for of in campaign.sequences.values()),
            "recorded": sorted({of["family"].split()[0] for of in about if of["origin"] == "recorded"})}
