#!/usr/bin/python3
"""Prints a table of the recordings beside it. It has no options."""

import gzip
import json
from pathlib import Path

FOLDER = Path(__file__).resolve().parent


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
    """The table. @param recordings  (path, header, steps), by name"""
    head = ["| file | engine | licence | scene | source | steps | rows: least / median / most | bytes |",
            "| --- | --- | --- | --- | --- | --- | ---: | ---: |"]
    total = sum(path.stat().st_size for path, _, _ in recordings)
    steps = sum(len(steps) for _, _, steps in recordings)
    end = [f"\n{len(recordings)} recordings, {steps} steps, {total / 1e6:.1f} MB."]
    return "\n".join(head + [row(*recording) for recording in recordings] + end)


def recordings():
    return [(path, *read(path)) for path in sorted(FOLDER.glob("*.jsonl.gz"))]


if __name__ == "__main__":
    print(text(recordings()))
