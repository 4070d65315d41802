"""Writes data/recommendation.json, schema "lcpbench-recommendation/1" (benchmarks/RESULTS.md)."""

from pathlib import Path

from ..errors import ReportError
from ..statistics.jsonl import text_of
from . import evaluation, rules
from .outcomes import Outcomes

SCHEMA = "lcpbench-recommendation/1"


def make(outcomes: Outcomes, sequences: Outcomes | None = None, leave_out: frozenset[str] = frozenset()) -> dict:
    """@param sequences  what solvers did from step to step, if it was measured
    @param leave_out  families that the rules are made without; they are then not evaluated either
    """
    unknown = leave_out - set(outcomes.table.family)
    if unknown:
        raise ReportError("--leave-out", f"no problem of family {sorted(unknown)[0]!r}",
                          "one of " + ", ".join(sorted(set(outcomes.table.family))))
    return {"schema": SCHEMA, "campaigns": outcomes.campaigns, "left_out": sorted(leave_out),
            "near": rules.NEAR, "within": rules.WITHIN, "most_candidates": rules.MOST, "edges": outcomes.edges,
            "regions": _without_end(rules.make_regions(outcomes, leave_out)),
            "sequences": _without_end(rules.make_regions(sequences, leave_out)) if sequences else [],
            "evaluation": None if leave_out else evaluation.evaluate(outcomes)}


def _without_end(regions: list[dict]) -> list[dict]:
    """The largest size that was measured stands for all above it, at every tier."""
    for tier in {region["tier"] for region in regions}:
        last = max((region for region in regions if region["tier"] == tier), key=lambda region: region["where"]["rows"][0])
        last["where"]["rows"][1] = None
    return regions


def write(made: dict, path: Path) -> None:
    """The same rules are always the same bytes."""
    path.write_text(text_of(made) + "\n", "utf-8")
