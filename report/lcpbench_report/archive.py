"""Makes of a campaign's folder, of a study of motion, or of curves, one that is small enough to be kept with the source.

The same files, which every script reads: campaign.json as it is; the lines of the others with numbers of few digits,
sorted so that like stands beside like, and compressed by xz. CSV files are compressed as they are.
"""

import json
import lzma
import shutil
from collections.abc import Callable
from pathlib import Path

from . import studies
from .errors import ReportError
from .files import replaced
from .statistics.jsonl import packed, read_lines
from .statistics.load import PROBLEMS_FILE, STREAMS_FILE
from .statistics.steps import FILE as STEPS_FILE

CAMPAIGN = "campaign.json"
# File -> what its lines are sorted by; significant digits of times and of other numbers. Problems keep their order,
# which is that of tables and figures. 0.5 % of a time in one pass is below what passes differ by, a residual's magnitude
# is what counts, and a single step is timed once, where the clock has hardly two digits of a microsecond.
_FILES: dict[str, tuple[Callable[[dict], tuple], int, int]] = {
    PROBLEMS_FILE: (lambda line: (), 4, 3),
    STREAMS_FILE: (lambda line: (line["size_class"], line["solver"], line["first"], -line["tier"],
                                 line["kind"] != "judge", line["kind"], line["pass"]), 3, 2),
    STEPS_FILE: (lambda step: (step["sequence"], step["solver"], -step["tier"], step["mode"], step["round"]), 3, 2),
}
_TABLES = (studies.MOTION_FILE, *map(studies.file_of, studies.CURVES))  # of studies
_AS_IT_IS = ("tier", "best_tier", "weight", "deadline_s")


def archive(folder: Path, output: Path) -> dict[str, int]:
    """@returns bytes of every file written
    @throws ReportError where `folder` is none of these, or `output` has files already
    """
    tables = [name for name in _TABLES if (folder / name).is_file()]
    if not tables and not (folder / CAMPAIGN).is_file():
        raise ReportError(str(folder), f"has no {CAMPAIGN} and no {studies.MOTION_FILE}",
                          "the folder of a campaign, of motions or of curves")
    if output.exists() and any(output.iterdir()):
        raise ReportError(str(output), "has files already", "a new folder")
    output.mkdir(parents=True, exist_ok=True)
    if tables:
        written = {}
        for name in tables:
            path = packed(output / name)
            with replaced(path) as beside:
                beside.write_bytes(lzma.compress((folder / name).read_bytes(), preset=9))
            written[path.name] = path.stat().st_size
        return written
    with replaced(output / CAMPAIGN) as beside:
        shutil.copyfile(folder / CAMPAIGN, beside)
    written = {CAMPAIGN: (output / CAMPAIGN).stat().st_size}
    for name, (order, *digits) in _FILES.items():
        if (folder / name).is_file():
            lines = sorted((order(line), number, json.dumps(_rounded(line, *digits), separators=(",", ":")))
                           for number, line in read_lines(folder / name, lambda note: None))
            path = packed(output / name)
            with replaced(path) as beside, lzma.open(beside, "wt", encoding="utf-8", preset=9) as file:
                file.writelines(text + "\n" for *_, text in lines)
            written[path.name] = path.stat().st_size
    return written


def _rounded(value: object, time_digits: int, digits: int, key: str = "") -> object:
    """The same with short numbers; a number > 0 stays one."""
    if isinstance(value, float) and key not in _AS_IT_IS:
        return float(f"{value:.{(time_digits if key.endswith('_s') else digits) - 1}e}")
    if isinstance(value, list):
        return [_rounded(entry, time_digits, digits, key) for entry in value]
    if isinstance(value, dict):
        return {name: _rounded(entry, time_digits, digits, name) for name, entry in value.items()}
    return value
