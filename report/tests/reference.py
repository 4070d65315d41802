"""The committed results, read once for all tests: reading takes most of their time."""

import functools
from pathlib import Path

from lcpbench_report.inputs import Inputs, load_inputs

FOLDER = Path(__file__).resolve().parents[1] / "reference"
# Summary -> folders of its campaigns (Makefile, reference-report).
SUMMARIES = {"summary.md": ("core", "sequences"), **{f"{name}-summary.md": (name,) for name in
                                                     ("smoke", "pathological", "large", "sequences-qp")},
             "friction-summary.md": ("friction", "friction-pathological")}


@functools.cache
def inputs_of(*folders: str) -> Inputs:
    return load_inputs([FOLDER / name for name in folders], ablation=FOLDER / "ablation" if "core" in folders else None)
