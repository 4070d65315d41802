"""The campaign that tuning judges by: its problems, and all configurations of all solvers in one process."""

import json
import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

from ..errors import ReportError
from ..files import replaced
from .space import Configuration

TIER = 1e-6
SMOKE = "smoke.json"
PROBLEMS, CAMPAIGN = "problems", "campaign"  # subfolders
_MARK = "lcpbench_manifest"


@dataclass
class Command:

    program: Path

    def run(self, *arguments: str, output=None) -> None:
        """@throws CalledProcessError where it does not end with 0, and has told the user why"""
        subprocess.run([self.program, *arguments], stdout=output, check=True)

    def output(self, *arguments: str, statuses: tuple[int, ...] = (0,)) -> str:
        """@throws CalledProcessError as run, where it ends with another status"""
        found = subprocess.run([self.program, *arguments], stdout=subprocess.PIPE, text=True, check=False)
        if found.returncode not in statuses:
            found.check_returncode()
        return found.stdout

    def available(self, what: str) -> list[str]:
        """Keys that `lcpbench list` has, that are in this build, and not of scenes with friction."""
        return [line.split()[0] for line in self.output("list", what).splitlines() if not line.endswith(("(not in this build)", "(friction)"))]


def make_problems(command: Command, data: Path, folder: Path, sizes: list[int], seed: int) -> None:
    """Writes the tuning problems, those of the smoke tier and every scene family at `sizes`, as one set. Families that are
    for measuring only (data/sealed.json) are left out."""
    sealed = json.loads((data / "sealed.json").read_text(encoding="utf-8"))["families"]
    problems = folder / PROBLEMS
    problems.mkdir(parents=True, exist_ok=True)
    command.run("collection", "write", str(data / SMOKE), "-o", str(problems / "smoke.jsonl"))
    smoke = (problems / "smoke.jsonl").read_text(encoding="utf-8").splitlines(keepends=True)
    (problems / "smoke.jsonl").write_text("".join(line for line in smoke if not _is_of(line, sealed)), encoding="utf-8")
    with replaced(problems / "scenes.jsonl") as beside, open(beside, "wb") as scenes:
        for family in [family for family in command.available("scenes") if family not in sealed]:
            for size in sizes:
                command.run("generate", family, "--size", str(size), "--seed", str(seed), output=scenes)
                scenes.flush()
    command.run("import", str(problems), "--name", "tuning", "--licence", "Apache-2.0", "--provenance",
                f"{SMOKE} and lcpbench generate, seed {seed}")


def _is_of(line: str, families: list[str]) -> bool:
    return json.loads(line)["id"].startswith(tuple(f"{family}-" for family in families))


def require_disjoint(manifest: Path, data: Path) -> list[str]:
    """By id and by hash of the content.

    @returns the names of the other sets
    @throws ReportError naming the problem that is in another set
    """
    own = problems_of(manifest)
    others = []
    for path in manifests(data):
        if path.name == SMOKE:
            continue
        found = problems_of(path)
        hashes = {problem["sha256"] for problem in found.values()}
        for name, problem in own.items():
            if name in found or problem["sha256"] in hashes:
                raise ReportError(manifest.name, f"problem {name!r} is in {path.name} too",
                                  "tuning problems that nothing is compared on; another seed")
        others.append(path.stem)
    return others


LIMIT_S = 0.5  # of a solve; the same for all, so that slow ones do not take the evening


def run_campaign(command: Command, manifest: Path, folder: Path, tried: dict[str, list[Configuration]], launches: int,
                 cpu: int | None, resume: bool) -> Path:
    """@param tried  solver -> its configurations, the default first
    @returns the campaign's folder
    """
    campaign = folder / CAMPAIGN
    arguments = ["run", "--suite", str(manifest), "--tiers", f"{TIER:g}", "--launches", str(launches),
                 "--time-limit", f"{LIMIT_S:g}", "-o", str(campaign)]
    arguments += ["--solvers", ",".join(key for solver, all_ in tried.items() for key in keys_of(solver, len(all_)))]
    for solver, configurations in tried.items():
        for key, configuration in list(zip(keys_of(solver, len(configurations)), configurations))[1:]:
            arguments += ["--variant", f"{key}={solver}," + ",".join(f"{k}={v}" for k, v in configuration.items())]
    if cpu is not None:
        arguments += ["--cpu", str(cpu)]
    command.run(*arguments, *(["--resume"] if resume else []))
    return campaign


def keys_of(solver: str, count: int) -> list[str]:
    """The default runs under the solver's own key."""
    return [solver, *(f"{solver}-try{index}" for index in range(1, count))]


def manifests(data: Path) -> list[Path]:
    return [path for path in sorted(data.glob("*.json")) if _MARK in json.loads(path.read_text(encoding="utf-8"))]


def problems_of(manifest: Path) -> dict[str, dict]:
    return {problem["id"]: problem for problem in json.loads(manifest.read_text(encoding="utf-8"))["problems"]}


def sizes_of(text: str) -> list[int]:
    words = text.split(",")
    if not all(re.fullmatch("[1-9][0-9]{0,8}", word) for word in words):
        raise ReportError("--sizes", f"found {text!r}", "rows, divided by commas")
    return [int(word) for word in words]


def chosen_solvers(asked: str | None, declared: list[str], available: list[str]) -> list[str]:
    """The solvers of --solvers, in the order of the declaration."""
    there = [key for key in declared if key in available]
    wanted = there if asked is None else asked.split(",")
    if unknown := [key for key in wanted if key not in there]:
        raise ReportError("--solvers", f"{unknown[0]!r} is not declared or not in this build", "some of " + ", ".join(there))
    return [key for key in there if key in wanted]
