"""Trials of the limits of `auto` (data/limits.json), on problems of the collection without what is sealed.

Every value of a limit is tried alone. Problems on which no value changes the answer (forces, iterations, methods) at a
tier are not timed: the limit is not reached. Of the others a sample is, in a campaign, and compared with the default as
`lcpbench tune` does (choice.py), all tiers together. A value takes the default's place only if it loses no answer, also of
those that are not timed, LEAST or more are timed, and it is faster by more than MARGIN with its whole interval below 1; of
several the fastest.
"""

import hashlib
import json
import math
import re
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from .. import formats
from ..errors import ReportError
from ..files import replaced
from ..statistics.cells import EXCLUDED, cell_table
from ..statistics.fields import check_fields
from ..statistics.intervals import MARGIN
from ..statistics.jsonl import read_object
from ..statistics.load import load_campaign
from ..table import Table, code
from .campaign import Command, keys_of, manifests, problems_of
from .choice import MACHINE, judge

SCHEMA, TRIALS = "lcpbench-limits/1", "lcpbench-thresholds/1"
TIERS = ("0.001", "1e-06", "1e-09")
LEAST = 10  # fewer problems say nothing of others
OPEN = ("--no-fills", "--without-sealed")


@dataclass
class Trial:
    limit: str
    values: list[str]  # besides the default
    suite: str
    rows: list[int]  # from, to
    all: bool = False  # whether all problems are timed
    after: str = "(?!)"  # a regular expression: the limit is asked after these methods, by `detail` of the default's answer


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
        self._default: dict[tuple, dict[str, tuple]] = {}
        self.seconds: dict[str, float] = {}  # the longest solve of a problem

    def differing(self, trial: Trial, tier: str) -> list[tuple[set[str], set[str]]]:
        """By value: problems whose answer is another one than by default, or all that the trial is on; and those of them whose
        answer is no longer right."""
        file = self._file(trial.suite, *trial.rows)
        if (file, tier) not in self._default:
            self._default[file, tier] = self._solve(file, tier)
        asked = {name: said for name, said in self._default[file, tier].items() if not re.fullmatch(trial.after, said[0])}
        if trial.all or not asked:
            return [(set(asked), set())] * len(trial.values)
        with tempfile.NamedTemporaryFile("w", suffix=".jsonl", dir=self._options.folder, encoding="utf-8") as some:
            with open(file, encoding="utf-8") as lines:
                some.writelines(line for line in lines if json.loads(line)["id"] in asked)
            some.flush()
            others = [self._solve(some.name, tier, "--set", f"{trial.limit}={value}") for value in trial.values]
        return [({name for name in asked if asked[name] != other.get(name)},
                 {name for name in asked if asked[name][-1] and not other.get(name, (False,))[-1]}) for other in others]

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

    def _solve(self, file: Path | str, tier: str, *setting: str) -> dict[str, tuple]:
        """By problem: the methods in words, and what else tells whether a limit was reached."""
        lines = self._command.output("solve", "--solver", "auto", "--tolerance", tier, "--time-limit",
                                     str(self._options.time_limit), *setting, str(file), statuses=(0, 1)).splitlines()
        said = {}
        for of in map(json.loads, lines):
            said[of["id"]] = (of.get("detail") or "", of.get("status"), of.get("iterations"), hash(str(of.get("f"))),
                              (of.get("verdict") or {}).get("passes") is True)
            self.seconds[of["id"]] = max(of.get("time_s") or 0, self.seconds.get(of["id"], 0))
        return said


def run_trials(command: Command, trials: list[Trial], options) -> dict:
    """@param options  data, folder, launches, problems, time_limit and cpu of the command line
    @returns the object of a file; of its `trials` each is a value of a limit"""
    listed = [[cell.strip(" `") for cell in line.split("|")] for line in command.output("list", "limits").splitlines()[2:]]
    defaults = {cells[1]: cells[2] for cells in listed}
    options.folder.mkdir(parents=True, exist_ok=True)
    answers, rows, environment = Answers(command, options), [], {}
    for trial in trials:
        by_tier = {float(tier): answers.differing(trial, tier) for tier in TIERS}
        differing = {value: {(name, tier) for tier, found in by_tier.items() for name in found[k][0]}
                     for k, value in enumerate(trial.values)}
        lost = {value: sum(len(found[k][1]) for found in by_tier.values()) for k, value in enumerate(trial.values)}
        folder = options.folder / trial.limit
        rows += [{"limit": trial.limit, "default": defaults[trial.limit]} | row
                 for row in _time(command, trial, differing, lost, answers.seconds, folder, options)]
        if (folder / "campaign.json").is_file():
            environment = json.loads((folder / "campaign.json").read_text(encoding="utf-8"))["environment"]
        print(f"{trial.limit}: {[row['differ'] for row in rows[-len(trial.values):]]} problems differ", file=sys.stderr)
    return {"schema": TRIALS, "commit": environment.get("git_commit", ""), "dirty": environment.get("git_dirty", False),
            "machine": {key: environment.get(key) for key in MACHINE}, "trials": rows}


def _time(command: Command, trial: Trial, differing: dict[str, set], lost: dict[str, int], seconds: dict[str, float],
          folder: Path, options) -> list[dict]:
    """@param differing  of every value the problems and tiers on which it changes something; `lost`: how many answers"""
    names = {value: {name for name, _ in pairs} for value, pairs in differing.items()}
    rows = [{"value": value, "differ": len(names[value]), "lost": lost[value]} for value in trial.values]
    if union := set().union(*names.values()):
        keys, drawn = keys_of("auto", 1 + len(trial.values)), []
        left = options.seconds / (len(keys) * len(TIERS) * (options.launches + 3))  # judged, timed by parts, warm-up
        for name in sorted(union, key=lambda name: hashlib.sha256(name.encode()).digest()):
            if len(drawn) < options.problems and (seconds[name] <= left or not drawn):
                drawn.append(name)
                left -= seconds[name]
        variants = [f"--variant={key}=auto,{trial.limit}={value}" for key, value in zip(keys[1:], trial.values)]
        command.run("run", "--suite", trial.suite, *OPEN, "--tiers", ",".join(TIERS), "--launches", str(options.launches),
                    "--filter", f"^solve/({'|'.join(map(re.escape, drawn))})/", "--solvers", ",".join(keys), *variants,
                    "-o", str(folder), *([] if options.cpu is None else ["--cpu", str(options.cpu)]), output=sys.stderr)
        cells = cell_table(load_campaign(folder))
        for key, row in zip(keys[1:], rows):
            is_asked = [pair in differing[row["value"]] for pair in zip(cells["problem"], cells["tier"])]
            row |= compare(cells[is_asked & cells["solver"].isin(["auto", key])], key)
    chosen = min(filter(may_replace, rows), key=lambda row: row["ratio"], default=None)
    return [{key: formats.short(value) for key, value in row.items()} | {"chosen": row is chosen} for row in rows]


def compare(cells: pd.DataFrame, key: str) -> dict:
    """@param cells  of `auto` and `key`, of problems and tiers on which they differ"""
    cells = cells[cells["verdict"] != EXCLUDED]
    if cells["solver"].nunique() < 2:
        return {}
    cells = cells.assign(problem=cells["problem"].astype(str) + "@" + cells["tier"].astype(str))
    default, of = judge(cells, ["auto", key])[1]
    return {"timed": of.problems, "right": of.verified, "right_default": default.verified, "ratio": of.ratio,
            "ratio_low": of.ratio_low, "ratio_high": of.ratio_high}


def may_replace(row: dict) -> bool:
    """Whether a value may take the default's place."""
    is_sure = row.get("timed", 0) >= LEAST and row["lost"] == 0 and row.get("right", 0) >= row.get("right_default", math.inf)
    return is_sure and row["ratio"] < 1 / MARGIN and row["ratio_high"] < 1


def table(found: dict) -> Table:
    """@param found  run_trials'"""
    changed, lines = {row["limit"] for row in found["trials"] if row["chosen"]}, []
    for row in found["trials"]:
        ratios = [row.get(name, math.nan) for name in ("ratio", "ratio_low", "ratio_high")]
        right = f"{row['right']} of {row['timed']}, default {row['right_default']}" if "right" in row else formats.DASH
        lines.append([code(row["limit"]), row["default"], row["value"], row["differ"], row["lost"], right,
                      formats.with_interval(*(math.nan if of is None else of for of in ratios)),
                      "**this**" if row["chosen"] else "" if row["limit"] in changed else "default"])
    return Table(["limit", "default", "value", "problems that differ", "answers lost", "right of those timed", "time over the default's",
                  "chosen"], lines, "lrrrrrrl")
