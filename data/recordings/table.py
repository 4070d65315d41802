#!/usr/bin/python3
"""Writes the table of data/recordings/README.md, from the recordings.

usage: table.py [--check]    (--check: exit status 1 where the README is not what would be written)
"""

import gzip
import json
import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
_README = FOLDER / "README.md"
_BEGIN = "<!-- table: written by data/recordings/table.py -->"
_END = "<!-- end of table -->"


def read(path):
    """The header, and the steps."""
    with gzip.open(path, "rt", encoding="utf-8") as lines:
        header, *steps = map(json.loads, lines)
    return header, steps


def rows_of(step):
    return len(step["contacts"]) + sum(len(joint["rows"]) for joint in step["joints"])


def row(path, header, steps):
    """A line of the table."""
    rows = sorted(map(rows_of, steps))
    first, last = steps[0]["step"], steps[-1]["step"]
    numbers = f"{len(steps)}: {first} … {last}" if len(steps) > 1 else f"1: {first}"
    cells = [f"`{path.name}`", f"{header['engine']} {header['engine_version']}", header["licence"], header["scene"],
             header["source"].partition("; left out")[0], numbers,
             f"{rows[0]} / {rows[len(rows) // 2]} / {rows[-1]}", path.stat().st_size]
    return "| " + " | ".join(map(str, cells)) + " |"


def text(recordings):
    """What the README holds between its marks. @param recordings  (path, header, steps), by name"""
    head = ["| file | engine | licence | scene | source | steps | rows: least / median / most | bytes |",
            "| --- | --- | --- | --- | --- | --- | ---: | ---: |"]
    total = sum(path.stat().st_size for path, _, _ in recordings)
    steps = sum(len(steps) for _, _, steps in recordings)
    end = [f"\n{len(recordings)} recordings, {steps} steps, {total / 1e6:.1f} MB."]
    return "\n".join(head + [row(*recording) for recording in recordings] + end)


def is_up_to_date(recordings):
    return _written(recordings) == _README.read_text(encoding="utf-8")


def _written(recordings):
    before, _, rest = _README.read_text(encoding="utf-8").partition(_BEGIN)
    return f"{before}{_BEGIN}\n{text(recordings)}\n{_END}{rest.partition(_END)[2]}"


def recordings():
    return [(path, *read(path)) for path in sorted(FOLDER.glob("*.jsonl.gz"))]


if __name__ == "__main__":
    if sys.argv[1:] == ["--check"]:
        sys.exit(0 if is_up_to_date(recordings()) else "data/recordings/README.md is out of date: run table.py beside it")
    _README.write_text(_written(recordings()), encoding="utf-8")
