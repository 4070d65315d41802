"""The committed results, read once for all tests: reading takes most of their time."""

import functools
import json
import lzma
import unittest
from pathlib import Path
from types import SimpleNamespace

from lcpbench_report import shown_tables
from lcpbench_report.headline_table import headline
from lcpbench_report.inputs import Inputs, load_inputs

FOLDER = Path(__file__).resolve().parents[1] / "reference"
# Summary -> folders of its campaigns (Makefile, reference-report).
SUMMARIES = {"summary.md": ("core", "sequences"), **{f"{name}-summary.md": (name,) for name in ("pathological", "large")},
             "friction-summary.md": ("friction", "friction-pathological")}

ROOT = FOLDER.parents[1]
# README.md and docs/, which hold blocks of numbers.
PAGES = {path: path.read_text(encoding="utf-8") for path in [*sorted(ROOT.glob("*.md")), *sorted(ROOT.glob("docs/*.md"))]}

_TABLES = (shown_tables.coverage, shown_tables.origins, shown_tables.literature, shown_tables.robustness, shown_tables.sequences,
           shown_tables.friction, shown_tables.friction_classes, shown_tables.friction_errors)
_OF_HEADLINE = (shown_tables.classes, shown_tables.front, shown_tables.by_solver)


@functools.cache
def inputs_of(*folders: str) -> Inputs:
    return load_inputs([FOLDER / name for name in folders])


def described(folder: str) -> SimpleNamespace:
    """Of an Inputs what campaign.json and the list of problems say, in no time."""
    info = json.loads((FOLDER / folder / "campaign.json").read_text(encoding="utf-8"))
    with lzma.open(FOLDER / folder / "problems.jsonl.xz", "rt", encoding="utf-8") as lines:
        problems = {about["problem"]: about for about in map(json.loads, lines)}
    return SimpleNamespace(campaigns=[SimpleNamespace(info=info)], problems=problems)


def check_tables(case: unittest.TestCase, name: str) -> None:
    """The summary has the tables that the code makes of its folders today: times by class, the front, all solvers by size,
    coverage, origins, literature, problems that break something, sequences, friction. Not compared, because it takes
    minutes: which backend (means of every class)."""
    text = (FOLDER / name).read_text(encoding="utf-8")
    inputs = inputs_of(*SUMMARIES[name])
    tables = [make(inputs) for make in _TABLES if len(inputs.cells) or make is shown_tables.sequences]
    if len(inputs.cells) and headline(inputs).classes:
        tables += [make(headline(inputs)) for make in _OF_HEADLINE]
    for table in filter(None, tables):
        with case.subTest(name, columns=table.columns[:4]):
            missing = [line for line in table.markdown().splitlines() if line not in text]
            case.assertEqual(missing, [], "make reference-report writes it")
