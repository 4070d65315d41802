"""Reads a campaign's folder, schema "lcpbench-campaign/2", and checks it.

Nothing is repaired in silence: what does not fit raises ReportError naming file, line and key.
"""

import math
from collections import Counter
from pathlib import Path

from ..errors import ReportError
from .fields import check_fields, check_record, check_word
from .jsonl import is_there, read_lines, read_object
from .model import ORIGINS, PROBLEMS_FILE, STREAMS_FILE, TOLERANCES, Campaign
from .records import FILE as RECORDS_FILE
from .records import read_records
from .steps import FILE as STEPS_FILE
from .steps import read_passes, read_sequences
from .streams import read_streams

SCHEMA = "lcpbench-campaign/2"
_CAMPAIGN = {"schema": "name", "name": "text", "solvers": "list", "tiers": "list", "limits": "object",
             "size_classes": "list"}
_SOLVER = {"key": "name", "setting": "text", "origin": "text", "uses_tolerance": "boolean", "available": "boolean",
           "tolerance": "name"}
_LIMITS = {"time_per_row_s": "nonnegative", "least_s": "nonnegative", "most_s": "positive"}
_SIZE_CLASS = {"key": "name", "least": "count", "most": "count?", "stream": "count"}
_REFERENCES = ("certified", "bounded", "none")


def load_campaign(folder: Path, apart: str = "") -> Campaign:
    """A campaign of sequences alone need not have the files of problems and streams.

    @param apart  a set whose problems do not count
    @throws ReportError for the first thing that does not fit
    """
    if not folder.is_dir():
        raise ReportError(str(folder), "not a folder", "a campaign's folder")
    campaign = Campaign(_read_info(folder / "campaign.json"))
    has_problems = any(is_there(folder / name) for name in (PROBLEMS_FILE, STREAMS_FILE))
    if has_problems or not is_there(folder / STEPS_FILE):
        campaign.problems = _read_problems(folder / PROBLEMS_FILE, campaign, apart)
        read, file = (read_records, RECORDS_FILE) if is_there(folder / RECORDS_FILE) else (read_streams, STREAMS_FILE)
        campaign.tasks = read(folder / file, campaign)
    campaign.sequences = read_sequences(campaign.info, "campaign.json")
    campaign.passes = read_passes(folder / STEPS_FILE, campaign)
    return campaign


def _read_info(path: Path) -> dict:
    info = read_object(path, SCHEMA)
    check_fields(path.name, info, _CAMPAIGN)
    check_fields(f"{path.name}: limits", info["limits"], _LIMITS)
    for index, solver in enumerate(info["solvers"]):
        place = f"{path.name}: solvers[{index}]"
        check_fields(place, solver, _SOLVER)
        check_word(place, solver, "tolerance", TOLERANCES)
    for index, size_class in enumerate(info["size_classes"]):
        check_fields(f"{path.name}: size_classes[{index}]", size_class, _SIZE_CLASS)
    for what in ("solvers", "size_classes"):
        key, count = max(Counter(entry["key"] for entry in info[what]).items(), key=lambda item: item[1], default=("", 0))
        if count > 1:
            raise ReportError(path.name, f"{what}: {key!r} is there {count} times", "every key once")
    for tier in info["tiers"]:
        check_fields(f"{path.name}: tiers", {"tier": tier}, {"tier": "positive"})
    return info


def _read_problems(path: Path, campaign: Campaign, apart: str) -> dict[str, dict]:
    problems: dict[str, dict] = {}
    classes = {of["key"]: of for of in campaign.info["size_classes"]}
    sealed = set(campaign.info.get("sealed", ()))  # families, and engines, whose families begin with their names
    for place, line in read_lines(path, campaign.notes.append):
        record = check_record(place, line, "problem")
        for key, words in (("reference", _REFERENCES), ("origin", ORIGINS), ("size_class", classes)):
            check_word(place, record, key, words)
        own = classes[record["size_class"]]
        if not own["least"] <= record["rows"] <= (math.inf if own["most"] is None else own["most"]):
            raise ReportError(place, f"key 'rows' is {record['rows']}", f"a number of size class {own['key']}")
        if record["problem"] in problems:
            raise ReportError(place, f"problem {record['problem']!r} is there twice", "a line per problem")
        problems[record["problem"]] = record | {
            "sealed": record["family"].split(" ")[0] in sealed,
            "counts": record["counts"] and record["set"] != apart}
    return problems
