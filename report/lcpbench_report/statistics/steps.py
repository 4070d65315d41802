"""Reads steps.jsonl, the passes of solvers over sequences, and checks it against campaign.json."""

import math
from pathlib import Path

import numpy as np

from ..errors import ReportError
from .fields import check_fields, check_numbers, check_places, check_record, check_tier, check_word
from .jsonl import is_there, read_lines
from .model import NOT_ASKED, UNSUPPORTED, Campaign, PassKey, PassRuns, Round

FILE = "steps.jsonl"
OUTCOMES = ("completed", "budget", "crashed", "killed", "out_of_memory")
_SEQUENCE = {"sequence": "name", "set": "name", "family": "name", "rows": "count", "most_rows": "count",
             "steps": "count"}


def read_sequences(info: dict, place: str) -> dict[str, dict]:
    """What campaign.json says of its sequences, by name; nothing where it has none."""
    sequences: dict[str, dict] = {}
    for index, sequence in enumerate(info.get("sequences", [])):
        record = check_fields(f"{place}: sequences[{index}]", sequence, _SEQUENCE)
        if record["sequence"] in sequences:
            raise ReportError(place, f"sequence {record['sequence']!r} is there twice", "every sequence once")
        sequences[record["sequence"]] = record
    return sequences


def read_passes(path: Path, campaign: Campaign) -> dict[PassKey, PassRuns]:
    """@returns nothing where there is no such file: a campaign without sequences"""
    passes: dict[PassKey, PassRuns] = {}
    if not is_there(path):
        return passes
    tiers, sequences = campaign.info["tiers"], campaign.sequences
    for place, line in read_lines(path, campaign.notes.append):
        record = check_record(place, line, "pass")
        check_word(place, record, "sequence", sequences)
        check_word(place, record, "solver", campaign.available)
        key = (record["sequence"], record["solver"], check_tier(place, tiers, record["tier"]), record["mode"])
        runs = passes.setdefault(key, PassRuns(record["deadline_s"]))
        index = int(record["round"])
        if index in runs.rounds or runs.excluded:
            raise ReportError(place, f"round {index} of this pass is there twice", "a line per pass and round")
        if record["excluded"]:
            runs.excluded = record["excluded"]
        else:
            runs.rounds[index] = _round(place, record, sequences[record["sequence"]]["steps"], tiers)
    for key, runs in passes.items():
        if not runs.excluded and 0 not in runs.rounds:
            raise ReportError(path.name, f"pass {', '.join(map(str, key))} has no round 0", "a line for every round")
        if any(one.unsupported for one in runs.rounds.values()):
            runs.excluded = NOT_ASKED
            runs.rounds.clear()
    return passes


def _round(place: str, record: dict, steps: int, tiers: list[float]) -> Round:
    check_record(place, record, "steps")
    check_word(place, record, "outcome", OUTCOMES)
    check_fields(f"{place}: claims", record["claims"], dict.fromkeys(record["claims"], "count"))
    reached = int(record["reached"])
    if record["steps"] != steps or reached > steps:
        raise ReportError(place, f"{reached} of {record['steps']} steps", f"the {steps} steps of campaign.json")
    verified, false_successes = {}, {}
    for verdict in record["verdicts"]:
        check_record(f"{place}: verdicts", verdict, "step_verdict")
        tier = check_tier(f"{place}: verdicts", tiers, verdict["tier"])
        verified[tier] = ~_marked(f"{place}: failed_steps", verdict["failed_steps"], steps)
        false_successes[tier] = int(verdict["false_successes"])
        if verified[tier].sum() != verdict["passed"] or verdict["passed"] + verdict["failed"] != steps:
            raise ReportError(place, f"{verdict['passed']} passed and {verdict['failed']} failed",
                              f"{steps} steps, and as many failed as are listed")
    if check_tier(place, tiers, record["tier"]) not in verified:
        raise ReportError(place, "no verdict at the tier asked for", "one among 'verdicts'")
    return Round(verified, false_successes,
                 *(_marked(f"{place}: {key}", record[key], steps) for key in ("late", "preempted")),
                 record["claims"].get(UNSUPPORTED, 0) > 0,
                 *(np.pad(check_numbers(place, record, "steps", key, reached), (0, steps - reached),
                          constant_values=math.nan) for key in ("latency_s", "rho", "w_error")))


def _marked(place: str, listed: list, steps: int) -> np.ndarray:
    marks = np.zeros(steps, dtype=bool)
    marks[check_places(place, listed, steps)] = True
    return marks
