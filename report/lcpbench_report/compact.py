"""Makes of a campaign's folder, or of a study of motion, one that is small enough to be kept with the source.

campaign.json and motion.json as they are; problems and steps of sequences with few digits; of streams a record per solver, size class and
tier (statistics/records.py), which has every verdict, residual and time;
CSV files as they are. All but those two are compressed by xz.
"""

import json
import lzma
import shutil
from collections.abc import Callable, Iterable
from pathlib import Path

from . import studies
from .errors import ReportError
from .files import replaced
from .statistics import records
from .statistics.cells import measured
from .statistics.jsonl import is_there, packed, read_lines
from .statistics.load import load_campaign
from .statistics.model import PROBLEMS_FILE, STREAMS_FILE
from .statistics.steps import FILE as STEPS_FILE

CAMPAIGN = "campaign.json"
_DESCRIPTIONS = (CAMPAIGN, "motion.json")
# File -> what its lines are sorted by; significant digits of times and of other numbers. Problems keep their order,
# which is that of tables and figures. A residual's magnitude is what counts, and a single step is timed once, where the
# clock has hardly two digits of a microsecond.
_FILES: dict[str, tuple[Callable[[dict], tuple], int, int]] = {
    PROBLEMS_FILE: (lambda line: (), 4, 3),
    STEPS_FILE: (lambda step: (step["sequence"], step["solver"], -step["tier"], step["mode"], step["round"]), 3, 2),
}
_AS_IT_IS = ("tier", "weight", "deadline_s")


def compact(folder: Path, output: Path) -> dict[str, int]:
    """@returns bytes of every file written
    @throws ReportError where `folder` is none of these, or `output` has files already
    """
    tables = [studies.MOTION_FILE] if (folder / studies.MOTION_FILE).is_file() else []
    if not tables and not (folder / CAMPAIGN).is_file():
        raise ReportError(str(folder), f"has no {CAMPAIGN} and no {studies.MOTION_FILE}",
                          "the folder of a campaign or of motions")
    if output.exists() and any(output.iterdir()):
        raise ReportError(str(output), "has files already", "a new folder")
    campaign = None if tables else load_campaign(folder)
    output.mkdir(parents=True, exist_ok=True)
    for name in _DESCRIPTIONS:
        if (folder / name).is_file():
            with replaced(output / name) as beside:
                shutil.copyfile(folder / name, beside)
    written = {name: (folder / name).read_bytes() for name in tables}
    if campaign is not None:
        for name, (order, *digits) in _FILES.items():
            if is_there(folder / name):
                lines = sorted((line for _, line in read_lines(folder / name, lambda note: None)), key=order)
                written[name] = _bytes(_rounded(line, *digits) for line in lines)
        if is_there(folder / STREAMS_FILE) or is_there(folder / records.FILE):
            written[records.FILE] = _bytes(sorted(records.lines(campaign, measured(campaign)), key=lambda line: (
                records.has_times(line), line["size_class"], line["solver"], line["first"], -line["tier"])))
    sizes = {}
    for name, content in written.items():
        path = packed(output / name)
        with replaced(path) as beside:
            beside.write_bytes(lzma.compress(content, preset=9))
        sizes[path.name] = path.stat().st_size
    return sizes


def _bytes(lines: Iterable[dict]) -> bytes:
    return "".join(json.dumps(line, separators=(",", ":"), ensure_ascii=False) + "\n" for line in lines).encode("utf-8")


def _rounded(value: object, time_digits: int, digits: int, key: str = "") -> object:
    """The same with short numbers; a number > 0 stays one."""
    if isinstance(value, float) and key not in _AS_IT_IS:
        return float(f"{value:.{(time_digits if key.endswith('_s') else digits) - 1}e}")
    if isinstance(value, list):
        return [_rounded(entry, time_digits, digits, key) for entry in value]
    if isinstance(value, dict):
        return {name: _rounded(entry, time_digits, digits, name) for name, entry in value.items()}
    return value
