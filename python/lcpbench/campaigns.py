"""Campaigns: solvers, functions among them, on the problem collection or on own problems, timed and judged by the
`lcpbench` command; and the tables of their results as pandas frames.

What is timed, and how: docs/campaigns.md. Needs pandas and SciPy.
"""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import tempfile
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core
from ._command import command
from ._functions import FunctionServer
from .scenes import Scene

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["Campaign", "run", "tables"]

_TASK_COLUMNS = ["solver", "problem", "family", "rows", "tier", "verdict", "claim", "detail", "rho", "backward_error",
                 "iterations", "time_s", "call_s", "first_s", "timed", "weight"]


@dataclass(frozen=True, eq=False)
class Campaign:
    """What a campaign found.

    folder   its files (benchmarks/RESULTS.md), for `lcpbench report` and `tables`
    tasks    a row per solver, problem and tier (the tolerance asked for): verdict of the verifier and the solver's
             claim, the reason in words of what was not solved, rho, backward_error, time_s from the arrays to f
             (median over the launches; inf where the answer is not verified), first_s of the first solve; of functions
             call_s, what a call that does nothing takes of time_s
    summary  a row per solver and tier: problems, how many of them are verified, false successes, below the tier (of
             solvers that take their library's own tolerance), failed, out of time, not asked; the median of time_s, of
             call_s, and of rho over the verified ones
    tables   the tables of statistics by name, made when they are asked for: `tables`
    """

    folder: Path
    tasks: pd.DataFrame
    summary: pd.DataFrame
    tables: Mapping[str, pd.DataFrame]

    def __repr__(self) -> str:
        return f"<Campaign {str(self.folder)!r}>\n{self.summary}"

    def _repr_html_(self) -> str:
        return self.summary.to_html(index=False)


def tables(*folders: str | os.PathLike) -> Mapping[str, pd.DataFrame]:
    """The tables of campaigns' folders whose problems do not overlap, by name: cells (a row per result), coverage,
    class_times, means and the others that benchmarks/RESULTS.md describes. Each is made when it is first
    asked for.

    Raises ValueError naming the first file, line and key that does not fit.
    """
    return _inputs(folders).analysis


def _inputs(folders: Iterable[str | os.PathLike]):
    from lcpbench_report.errors import ReportError
    from lcpbench_report.inputs import load_inputs

    try:
        return load_inputs([Path(folder) for folder in folders])
    except ReportError as error:
        raise ValueError(str(error)) from None


def run(suite="smoke", solvers: Iterable[str | Callable] | Mapping[str, str | Callable] = ("auto",), *,
        tiers: Iterable[float] | None = None, filter: str = "", most_rows: int | None = None,
        launches: int | None = None, time_limit: float | None = None, folder: str | os.PathLike | None = None,
        resume: bool = False, quiet: bool = True, arguments: Iterable[str] = ()) -> Campaign:
    """Runs a campaign: every solver on every problem, judged by the verifier and timed by one clock.

    suite       of `lcpbench run` ("smoke" takes seconds), the path of a manifest, or own problems: Problems or Scenes,
                in a list or by name in a dict
    solvers     keys of available_solvers(), and functions of this process: function(problem) or
                function(problem, tolerance) by that name, which return f, or an object with f, status and perhaps iterations and
                detail, such as a Result. A dict names them, else a function's key is its name; a key of a dict may also
                stand for a solver's key with settings, "pgs,NAME=VALUE"
    tiers       tolerances asked for and judged at; None: those of the suite, 1e-3, 1e-6 and 1e-9
    filter      only problems solve/NAME/ that match this regular expression
    most_rows   no larger problems
    launches    how often every solver is timed; None: as the suite has it
    time_limit  of a solve [s]; None: by the problem's rows
    folder      of the results; None: a new temporary one, which stays
    resume      go on with the campaign that the folder has
    quiet       False: shows the command's progress
    arguments   further options of `lcpbench run`

    A function that raises an exception has failed, with its text as detail; NotImplementedError says that it does not
    take the problem. One that is not back after 1.5 times its limit and a second has failed too, and is interrupted at
    its next step of Python. It runs in a thread of this process, so that other Python threads share its time.
    Raises ValueError naming the argument, and RuntimeError where the command fails.
    """
    named = _named(solvers)
    functions = {name: solver for name, solver in named.items() if callable(solver)}
    words = ["run", "--solvers", ",".join(named)]
    for name, solver in named.items():
        if name not in functions and name != solver:
            words += ["--variant", f"{name}={solver}"]
    place = Path(tempfile.mkdtemp(prefix="lcpbench-") if folder is None else folder)
    results = place / "results" if folder is None else place
    if not isinstance(suite, (str, os.PathLike)):
        suite = _own_manifest(suite, place / "problems", quiet)
    words += ["--suite", os.fspath(suite), "-o", str(results)]
    if tiers is not None:
        words += ["--tiers", ",".join(repr(float(tier)) for tier in tiers)]
    for option, value in (("--filter", filter or None), ("--most-rows", most_rows), ("--launches", launches),
                          ("--time-limit", time_limit)):
        if value is not None:
            words += [option, str(value)]
    words += [*(["--resume"] if resume else []), *arguments]
    with FunctionServer(functions) as server:
        for name in functions:
            words += ["--external", f"{name}={server.command(name)}"]
        _run_command(words, quiet)
    return _campaign(results, list(named), server.costs)


def _named(solvers) -> dict[str, Any]:
    if isinstance(solvers, str) or callable(solvers):
        solvers = [solvers]
    if isinstance(solvers, Mapping):
        named = dict(solvers)
    else:
        pairs = [(one if isinstance(one, str) else getattr(one, "__name__", type(one).__name__).lower(), one)
                 for one in solvers]
        named = dict(pairs)
        if len(named) < len(pairs):
            raise ValueError("solvers: two have the same name; a dict names them")
    for name, solver in named.items():
        if not isinstance(solver, str) and not callable(solver):
            raise ValueError(f"solvers: {name}: expected a solver's key or a function, found {solver!r}")
        if not re.fullmatch("[a-z0-9_-]+", name):
            raise ValueError(f"solvers: {name!r}: expected a name of a-z, 0-9, '-' and '_'; a dict gives one")
    if not named:
        raise ValueError("solvers: expected at least one")
    return named


def _own_manifest(problems, folder: Path, quiet: bool) -> str:
    """A set of own problems, as `lcpbench import` makes it; answers are proved where that is quick."""
    if not isinstance(problems, Mapping):
        problems = {f"problem-{k}": problem for k, problem in enumerate(problems)}
    if not problems:
        raise ValueError("suite: expected at least one problem")
    folder.mkdir(parents=True)
    with open(folder / "own.jsonl", "w", encoding="utf-8") as file:
        for name, problem in problems.items():
            problem = problem.problem if isinstance(problem, Scene) else problem
            if not isinstance(problem, _core.Problem):
                raise ValueError(f"suite: {name}: expected a Problem or a Scene, found {type(problem).__name__}")
            file.write(problem._line(name) + "\n")
    _run_command(["import", str(folder), "--name", "own", "--provenance", "own", "--licence", "unknown"], quiet)
    return str(folder / "manifest.json")


def _run_command(words: list[str], quiet: bool) -> None:
    done = subprocess.run([str(command()), *words], stdin=subprocess.DEVNULL, text=True,
                          stdout=subprocess.PIPE if quiet else None, stderr=subprocess.PIPE if quiet else None)
    if done.returncode == 0:
        return
    what = (done.stderr or "").strip().rpartition("\n")[2] or shlex.join(["lcpbench", *words])
    raise (ValueError if done.returncode == 2 else RuntimeError)(what)


def _campaign(folder: Path, solvers: list[str], costs: Mapping[str, list[tuple[int, float]]]) -> Campaign:
    inputs = _inputs([folder])
    tasks = inputs.cells.merge(_reasons(inputs.campaigns[0]), how="left", on=["problem", "solver", "tier"])
    tasks["detail"] = tasks["detail"].fillna("")
    tasks["call_s"] = np.nan
    for name, found in costs.items():
        if found:
            mine = tasks["solver"] == name
            tasks.loc[mine, "call_s"] = _call_cost(found, tasks.loc[mine, "rows"])
    tasks = tasks[_TASK_COLUMNS]
    return Campaign(folder, tasks, _summary(tasks, solvers), inputs.analysis)


def _reasons(campaign) -> pd.DataFrame:
    """Of what was not plainly solved and verified, the reason in words."""
    import pandas as pd

    classes = campaign.classes
    found = [(classes[task.size_class][number], task.solver, task.tier, detail)
             for task in campaign.tasks for number, detail in task.details.items()]
    return pd.DataFrame(found, columns=["problem", "solver", "tier", "detail"])


def _call_cost(costs: list[tuple[int, float]], rows: pd.Series) -> np.ndarray:
    """Of every number of rows the median cost of those measured that are nearest by ratio."""
    measured = np.array(sorted({n for n, _ in costs}))
    medians = np.array([np.median([seconds for n, seconds in costs if n == of]) for of in measured])
    distance = np.abs(np.log(rows.to_numpy(dtype=float)[:, None]) - np.log(measured))
    return medians[distance.argmin(axis=1)]


def _summary(tasks: pd.DataFrame, solvers: list[str]) -> pd.DataFrame:
    import pandas as pd

    def describe(of: pd.DataFrame) -> pd.Series:
        verdicts = of["verdict"]
        verified = verdicts == "verified"
        asked = ~verdicts.isin(["not asked", "excluded"])
        return pd.Series({
            "problems": len(of), "verified": verified.sum(), "false_successes": (verdicts == "false success").sum(),
            "below_tier": (verdicts == "below the tier").sum(), "failed": verdicts.str.startswith("failed").sum(),
            "out_of_time": (verdicts == "out of time").sum(), "not_asked": (~asked).sum(),
            "median_s": of.loc[asked, "time_s"].median(), "call_s": of["call_s"].median(),
            "median_rho": of.loc[verified, "rho"].median()})

    found = dict(list(tasks.groupby(["solver", "tier"])))
    rows = [{"solver": solver, "tier": tier, **describe(found[solver, tier])}
            for solver, tier in sorted(found, key=lambda key: (solvers.index(key[0]), -key[1]))]
    counts = ["problems", "verified", "false_successes", "below_tier", "failed", "out_of_time", "not_asked"]
    return pd.DataFrame(rows).astype({name: int for name in counts})
