"""Made-up inputs of a report with all parts: problems of two families, a grid, pathological ones, sequences, motion."""

import itertools
import json
from pathlib import Path

from lcpbench_report.inputs import Inputs, load_inputs
from .synthetic_campaign import exclude, fail, write_campaign
from .synthetic_report import write_motion, write_steps

OWN = ("auto", "dantzig", "pgs")
# Of one library two methods: the second is quicker, and not given large problems; of another two settings: the
# default one is slower.
PEERS = ("ode-dantzig", "ode-lemke", "clp", "clp-default")
FACTORS = {"auto": 1.0, "dantzig": 0.5, "pgs": 3.0, "ode-dantzig": 2.0, "ode-lemke": 0.6, "clp": 20.0,
           "clp-default": 40.0}
FAILING, NEXT = "dantzig", "ode-lemke"  # the fastest, but not on all problems of any size; the next one
ENVIRONMENT = {"cpu": "A Processor", "compiler": "GNU 12.2.0", "git_commit": "0123456789abcdef", "git_dirty": False,
               "os": "An OS", "flags": "-O3"}


def all_inputs(folder: Path) -> Inputs:
    """With everything that a report can have."""
    problems = write_problems(folder / "standard")
    sequences = write_steps(folder / "sequences")
    (folder / "motion").mkdir()
    write_motion(folder / "motion")
    return load_inputs([problems, sequences], folder / "motion")


def write_problems(folder: Path, change=None) -> Path:
    """@param change  of a cell's record, default: failures and exclusions of some solvers"""
    write_campaign(folder, FACTORS, copies=2, change=change or _fail_some, change_problem=_of_sets(itertools.count()),
                   solvers={key: {"origin": "peer"} for key in PEERS})
    info = json.loads((folder / "campaign.json").read_text(encoding="utf-8"))
    info |= {"environment": ENVIRONMENT, "started": "2026-01-02T03:04:05Z"}
    (folder / "campaign.json").write_text(json.dumps(info), encoding="utf-8")
    return folder


def _of_sets(numbers):
    """Every fourth problem is a pathological one, another fourth has a grid."""
    def change(problem: dict) -> dict:
        index = next(numbers)
        if problem["set"] != "main":
            return problem
        return problem | {"set": "standard" if index % 4 else "pathological",
                          "grid": "mass ratio" if index % 4 == 1 else ""}
    return change


def _fail_some(record: dict) -> dict:
    """FAILING is wrong on one of the two problems of every family and size; large ones are not given to ode-lemke."""
    if record["solver"] == FAILING and record["problem"].endswith("-1"):
        return fail(record, "solved")
    if record["solver"] == "ode-lemke" and any(f"-{rows}-" in record["problem"] for rows in (200, 500)):
        return exclude(record)
    return record
