"""Makes of a campaign's folder, or of a study of motion, one that is small enough to be kept with the source.

campaign.json and motion.json as they are; problems and motions with few digits; steps of sequences, too, without iterations
and backward errors; of streams a record per solver, size class and tier (statistics/records.py), which has every verdict,
residual and time. All but those two are compressed by xz.
"""

import csv
import io
import json
import lzma
import math
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
# File -> what its lines are sorted by, and what of a line is kept. Problems keep their order, which is that of tables and
# figures.
_FILES: dict[str, tuple[Callable[[dict], tuple], Callable[[dict], dict]]] = {
    PROBLEMS_FILE: (lambda line: (), lambda line: _rounded(line, 3)),
    STEPS_FILE: (lambda step: (step["sequence"], step["solver"], -step["tier"], step["mode"], step["round"]), lambda step: _step(step)),
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
    written = {name: _motion((folder / name).read_text(encoding="utf-8")) for name in tables}
    if campaign is not None:
        for name, (order, kept) in _FILES.items():
            if is_there(folder / name):
                lines = sorted((line for _, line in read_lines(folder / name, lambda note: None)), key=order)
                written[name] = _bytes(map(kept, lines))
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


def _motion(table: str) -> bytes:
    """What is measured in three digits, times in five."""
    columns, *rows = csv.reader(table.splitlines())
    digits = [{"number": 5, "number?": 3}.get(studies.MOTION_COLUMNS.get(column)) for column in columns]
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(
        [columns, *([f"{float(cell):.{of}g}" if of and cell else cell for of, cell in zip(digits, row)] for row in rows)])
    return text.getvalue().encode("utf-8")


def _rounded(value: object, digits: int, key: str = "") -> object:
    """The same with short numbers, times with a digit more; a number > 0 stays one."""
    if isinstance(value, float) and key not in _AS_IT_IS:
        return float(f"{value:.{digits - (not key.endswith('_s'))}e}")
    if isinstance(value, list):
        return [_rounded(entry, digits, key) for entry in value]
    if isinstance(value, dict):
        return {name: _rounded(entry, digits, name) for name, entry in value.items()}
    return value


def _step(step: dict) -> dict:
    """Latencies and residuals are in few steps, for the same digits to come again."""
    if step["excluded"]:
        return step
    latency = [time and math.exp(round(math.log(time) / records.SINGLE_STEP) * records.SINGLE_STEP) for time in step["latency_s"]]
    residuals = {key: [value and records.rounded_up(value) for value in step[key]] for key in ("rho", "w_error")}
    return _rounded(step | residuals | {"iterations": [], "backward_error": [], "latency_s": latency}, 2)
