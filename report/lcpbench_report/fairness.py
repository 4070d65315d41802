"""What the numbers cannot carry: facts of these results, which limitations.md.j2 states. What does not hold is left out."""

import math

import pandas as pd

from . import choice, formats
from .inputs import Inputs
from .sentences import lines
from .statistics.cells import CHANGED, EXCLUDED, NOT_ASKED, OUT_OF_TIME, VERIFIED
from .statistics.launches import KEY, OFF, TOGETHER
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
    return {"noise": _launches(launches) if len(launches) else None, "rounds": _rounds(inputs, launches), "changed": changed,
            "off": math.expm1(OFF), "single": float((spread["count"] < 2).mean()) if len(launches) else 0.0}


def _launches(launches: pd.DataFrame) -> dict:
    """How far levels lie apart, each from the median of its solver, class and tier; and how many are flagged."""
    by_key = launches.groupby(KEY)
    away = (launches["level"] - by_key["level"].transform("median")).map(math.expm1)
    flagged = launches["flagged"].astype(bool)
    return {"count": len(launches), "least": away.min(), "most": away.max(), "spread": by_key["level"].std(),
            "flagged": int(flagged.sum()), "alone": float(flagged.groupby([launches[key] for key in KEY]).all().mean())}


def _rounds(inputs: Inputs, launches: pd.DataFrame) -> dict | None:
    """How many were repeated, and how long they took, from the begin of the first launch to that of the last, at the main tier;
    None where no launch says when it began."""
    first = max(campaign.first_round for campaign in inputs.campaigns)
    known = launches[launches["began_s"].notna() & (launches["launch"] >= first) & (launches["tier"] == choice.main_tier(inputs))]
    if known.empty:
        return None
    began = known.groupby(["size_class", "tier", "launch"])["began_s"].agg(["min", "max"])
    usual = max(campaign.info.get("passes", 0) for campaign in inputs.campaigns)
    lasted = began["max"] - began["min"]
    return {"count": len(began), "repeated": int((began.index.get_level_values("launch") > usual).sum()),
            "median_s": lasted.median(), "most_s": lasted.max()}


def _counts(inputs: Inputs, cells: pd.DataFrame) -> dict[str, int]:
    """Solver -> its cells among these."""
    found = cells["solver"].value_counts()
    return {solver: found[solver] for solver in inputs.in_order(found.index)}


def _rules(inputs: Inputs) -> dict:
    """Limits of time, exclusions, budgets."""
    cells = inputs.cells
    left_out = cells[(cells["verdict"] == EXCLUDED) & (cells["excluded"] != TASK_BUDGET)]
    return {"limits": [(name, campaign.info["limits"]) for name, campaign in zip(inputs.names, inputs.campaigns)],
            "ended": _counts(inputs, cells[cells["verdict"] == OUT_OF_TIME]),
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
