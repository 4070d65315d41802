"""Every repetition a row: what a notebook wants that asks other questions than the tables."""

import csv
import gzip
import io
from pathlib import Path

from .cells import verdict_of
from .load import Campaign

COLUMNS = ["problem", "solver", "tier", "mode", "round", "repetition", "verdict", "round_passed", "disturbed", "solve_s",
           "environment"]
_DIGITS = ".9g"


def write_repetitions(campaign: Campaign, path: Path) -> int:
    """Writes them as CSV compressed by gzip, from the same files always the same bytes; cells that were excluded have
    none.

    @returns the number of rows
    """
    rows = 0
    # Without the file's name and time, which gzip would keep.
    with path.open("wb") as file, gzip.GzipFile("", "wb", fileobj=file, mtime=0) as binary, \
            io.TextIOWrapper(binary, "utf-8", newline="") as text:
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(COLUMNS)
        for (problem, solver, tier, mode), runs in campaign.cells.items():
            verdict = verdict_of(runs.record)
            for index in sorted(runs.rounds):
                words = ["false", "true"]
                about = [verdict, words[bool(runs.passed[index])], words[index in runs.disturbed]]
                for repetition, time in enumerate(runs.rounds[index]):
                    writer.writerow([problem, solver, f"{tier:g}", mode, index, repetition, *about,
                                     format(time, _DIGITS), runs.environments.get(index, "")])
                    rows += 1
    return rows
