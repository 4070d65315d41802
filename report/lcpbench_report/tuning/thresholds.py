"""Trials of the limits of `auto` (data/limits.json), on problems of the collection without what is sealed.

Every value of a limit is tried alone, the others being the defaults. Problems on which no value changes anything of the
answer (forces, iterations, methods) at a tier are not timed: the limit is not reached. Of the others a fair sample is,
in a campaign. The time is the weighted median ratio to the default's over problems and tiers that both solve and on
which the value changes something, with its interval by bases and launches (statistics/pairwise.py). A value replaces
the default only if it is right at least as often and the whole interval lies below 1, the ratio below 1 / MARGIN; of
several the one with the least ratio.
"""

import hashlib
import json
import math
import re
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from .. import formats
from ..errors import ReportError
from ..files import replaced
from ..statistics.cells import VERIFIED, measured
from ..statistics.fields import check_fields
from ..statistics.intervals import MARGIN, Bootstrap
from ..statistics.jsonl import read_object
from ..statistics.launches import Levels
from ..statistics.load import load_campaign
from ..statistics.pairwise import ABOUT, compare_two
from ..table import Table, code
from .campaign import Command, keys_of, manifests, problems_of
from .choice import MACHINE

SCHEMA, TRIALS = "lcpbench-limits/1", "lcpbench-thresholds/1"
TIERS = ("0.001", "1e-06", "1e-09")
OPEN = ("--no-fills", "--without-sealed")
SAID = ("status", "iterations", "detail", "f")  # of an answer: what tells whether a limit was reached


@dataclass
class Trial:
    limit: str
    values: list[str]  # besides the default
    suite: str
    rows: list[int]  # from, to
    all: bool = False  # whether all problems are timed


def load_trials(path: Path, only: str | None) -> list[Trial]:
    """@throws ReportError for what does not fit; whether limits exist and take the values says `lcpbench`"""
    fields = {"limit": "name", "values": "list", "suite": "name", "rows": "list"}
    content = check_fields(path.name, read_object(path, SCHEMA, "what is tried of the limits of auto"), {"trials": "list"})
    trials = {of["limit"]: Trial(**check_fields(f"{path.name}: trials[{k}]", of, fields)) for k, of in enumerate(content["trials"])}
    wanted = list(trials) if only is None else only.split(",")
    if unknown := [name for name in wanted if name not in trials]:
        raise ReportError("--only", f"{unknown[0]!r} has no trial", "some of " + ", ".join(trials))
    return [trials[name] for name in wanted]


class Answers:
    """What `lcpbench solve` says of open problems; by default once for all trials on the same problems."""

    def __init__(self, command: Command, options):
        self._command, self._options = command, options
        self._files: set[Path] = set()
        self._default: dict[tuple, dict[str, str]] = {}

    def differing(self, trial: Trial, value: str, tier: str) -> set[str]:
        """Problems whose answer is another one than by default, or all that the trial is on."""
        file = self._file(trial.suite, *trial.rows)
        if (file, tier) not in self._default:
            self._default[file, tier] = self._solve(file, tier)
        default = self._default[file, tier]
        other = {} if trial.all else self._solve(file, tier, "--set", f"{trial.limit}={value}")
        return {name for name in default if default[name] != other.get(name)}

    def _file(self, suite: str, least: int, most: int) -> Path:
        path = self._options.folder / f"{suite}-{least}-{most}.jsonl"
        if path not in self._files:
            listed = self._command.output("run", "--suite", suite, "--solvers", "auto", "--tiers", TIERS[0], *OPEN,
                                          "--benchmark_list_tests")
            names = {line.split("/")[1] for line in listed.splitlines() if line.startswith("solve/")}
            with replaced(path) as beside, open(beside, "wb") as output:
                for manifest in manifests(self._options.data):
                    asked = [name for name, of in problems_of(manifest).items() if name in names and least <= of["rows"] <= most]
                    names.difference_update(asked)
                    if asked:
                        self._command.run("collection", "write", str(manifest), *asked, output=output)
            self._files.add(path)
        return path

    def _solve(self, file: Path, tier: str, *setting: str) -> dict[str, str]:
        lines = self._command.output("solve", "--solver", "auto", "--tolerance", tier, "--time-limit",
                                     str(self._options.time_limit), *setting, str(file), statuses=(0, 1)).splitlines()
        return {of["id"]: hashlib.sha256(repr([of.get(name) for name in SAID]).encode()).hexdigest() for of in map(json.loads, lines)}


def run_trials(command: Command, trials: list[Trial], options) -> dict:
    """@param options  data, folder, launches, problems, time_limit and cpu of the command line
    @returns the object of a file; of its `trials` each is a value of a limit"""
    listed = [[cell.strip(" `") for cell in line.split("|")] for line in command.output("list", "limits").splitlines()[2:]]
    defaults = {cells[1]: cells[2] for cells in listed}
    options.folder.mkdir(parents=True, exist_ok=True)
    answers, rows, environment = Answers(command, options), [], {}
    for trial in trials:
        differing = {value: {(name, float(tier)) for tier in TIERS for name in answers.differing(trial, value, tier)}
                     for value in trial.values}
        folder = options.folder / trial.limit
        rows += [{"limit": trial.limit, "default": defaults[trial.limit]} | row
                 for row in _time(command, trial, differing, folder, options)]
        if (folder / "campaign.json").is_file():
            environment = json.loads((folder / "campaign.json").read_text(encoding="utf-8"))["environment"]
        print(f"{trial.limit}: {[row['differ'] for row in rows[-len(trial.values):]]} problems differ", file=sys.stderr)
    return {"schema": TRIALS, "commit": environment.get("git_commit", ""), "dirty": environment.get("git_dirty", False),
            "machine": {key: environment.get(key) for key in MACHINE}, "trials": rows}


def _time(command: Command, trial: Trial, differing: dict[str, set], folder: Path, options) -> list[dict]:
    """@param differing  of every value the problems and tiers on which it changes something"""
    names = {value: {name for name, _ in pairs} for value, pairs in differing.items()}
    rows = [{"value": value, "differ": len(names[value])} for value in trial.values]
    if union := set().union(*names.values()):
        drawn = sorted(union, key=lambda name: hashlib.sha256(name.encode()).digest())[:options.problems]
        keys = keys_of("auto", 1 + len(trial.values))
        variants = [f"--variant={key}=auto,{trial.limit}={value}" for key, value in zip(keys[1:], trial.values)]
        command.run("run", "--suite", trial.suite, *OPEN, "--tiers", ",".join(TIERS), "--launches", str(options.launches),
                    "--filter", f"^solve/({'|'.join(map(re.escape, drawn))})/", "--solvers", ",".join(keys), *variants,
                    "-o", str(folder), *([] if options.cpu is None else ["--cpu", str(options.cpu)]), output=sys.stderr)
        cells, launched = measured(load_campaign(folder))
        for key, row in zip(keys[1:], rows):
            is_asked = [pair in differing[row["value"]] for pair in zip(cells["problem"], cells["tier"])]
            row |= compare(cells[is_asked & cells["solver"].isin(["auto", key])], Levels(launched), key)
    allowed = [row for row in rows if may_replace(row)]
    chosen = min(allowed, key=lambda row: row["ratio"], default=None)
    return [{key: formats.short(value) for key, value in row.items()} | {"chosen": row is chosen} for row in rows]


def compare(cells: pd.DataFrame, levels: Levels, key: str) -> dict:
    """@param cells  of `auto` and `key`, of problems and tiers on which they differ"""
    cells = cells.assign(at=cells["problem"].astype(str) + "@" + cells["tier"].astype(str))
    times = cells.pivot(index="at", columns="solver", values="time_s").dropna()
    if times.empty:
        return {}
    about = cells.drop_duplicates("at").set_index("at").loc[times.index, ABOUT]

    def shift(solver: str, classes: pd.Series, weights: np.ndarray):
        return sum(levels.shift(solver, classes, float(tier), weights) for tier in TIERS) / len(TIERS)
    right = cells[cells["verdict"] == VERIFIED]["solver"].value_counts()
    found = {"timed": len(times), "right": int(right.get(key, 0)), "right_default": int(right.get("auto", 0))}
    if np.isfinite(times).all(axis=1).any():
        pair = compare_two(times, about, Bootstrap(about.assign(problem=about.index)), key, "auto", shift=shift)
        found |= {name: pair[name] for name in ("ratio", "ratio_low", "ratio_high")}
    return found


def may_replace(row: dict) -> bool:
    """Whether a value may take the default's place."""
    return "ratio" in row and row["right"] >= row["right_default"] and row["ratio"] < 1 / MARGIN and row["ratio_high"] < 1


def table(found: dict) -> Table:
    """@param found  run_trials'"""
    changed, lines = {row["limit"] for row in found["trials"] if row["chosen"]}, []
    for row in found["trials"]:
        ratios = [row.get(name, math.nan) for name in ("ratio", "ratio_low", "ratio_high")]
        right = f"{row['right']} of {row['timed']}, default {row['right_default']}" if "right" in row else formats.DASH
        lines.append([code(row["limit"]), row["default"], row["value"], row["differ"], right,
                      formats.with_interval(*(math.nan if of is None else of for of in ratios)),
                      "**this**" if row["chosen"] else "" if row["limit"] in changed else "default"])
    return Table(["limit", "default", "value", "problems that differ", "right", "time over the default's", "chosen"], lines, "lrrrrrl")
