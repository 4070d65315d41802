"""What the numbers cannot carry. Each line states a fact of this run; lines whose fact does not hold are left out."""

import math
import statistics

from . import floors, formats
from .cells import SINGLE_RUN, Cells

# A solver is called out as built for looser tiers when its verified share falls below this part of the loosest tier's.
_TIER_DROP = 0.75
# Repetitions that spread further than this are reported as noisy.
_NOISY_SPREAD = 0.1


def limitations(cells: Cells) -> list[tuple[str, str]]:
    """[(subject, sentence)]"""
    rules = (_machine, _build, _noise, _single_runs, _disagreements, _accuracy_once, _seeds, _limit, _excluded,
             _unavailable, _tiers, _direct, _families, _reference, _floor, _setup, _scope)
    lines = []
    for rule in rules:
        lines += rule(cells)
    return lines


def _machine(cells: Cells) -> list:
    run = cells.results.run
    return [("One machine",
             f"All times are from one machine ({run['cpu']}, {formats.plural(run['cores'], 'core')}); ratios between "
             "solvers, and even their order, can differ on another."
             + (f" BLAS and OpenMP ran on {formats.plural(run['library_threads'], 'thread')}."
                if run.get("library_threads") else " How many threads BLAS used is not known."))]


def _build(cells: Cells) -> list:
    run, lines = cells.results.run, []
    if run["git_dirty"]:
        lines.append(("Uncommitted changes",
                      f"The tree differed from commit {run['git_commit'][:12]} when this was built: the commit alone "
                      "does not reproduce it."))
    if run["build_type"].lower() not in ("release", "relwithdebinfo"):
        lines.append(("Build type",
                      f"The build type is '{run['build_type']}': times are not those of an optimised build."))
    return lines


def _noise(cells: Cells) -> list:
    run = cells.results.run
    timed = [t for t in cells.results.timing if t.kind == "solve" and not t.error and t.seconds]
    spreads = [t.spread for t in timed if math.isfinite(t.spread)]
    if not timed:
        return [("No repeated timing",
                 "timing.json holds no timed cell: every time on this page is a median of at most five solves.")]
    if not spreads:
        return [("Noise unknown",
                 f"The {len(timed)} timed cells hold one repetition each, so their noise is not known.")]
    noisy = sum(s > _NOISY_SPREAD for s in spreads)
    return [("Noise",
             f"Times are medians of {run['repetitions']} repetitions of at least {run['min_time_s']:g} s. Their spread "
             f" (max - min)/median is {formats.percent(statistics.median(spreads))} in the median cell and "
             f"{formats.percent(max(spreads))} in the worst; above {formats.percent(_NOISY_SPREAD)} in {noisy} of "
             f"{len(spreads)} cells. Differences below the spread mean nothing.")]


def _single_runs(cells: Cells) -> list:
    verified = [c for c in cells.all() if c.verified]
    single = [c for c in verified if c.time_source == SINGLE_RUN]
    by_single = len(cells.results.problems) - min(cells.problem_times(tier)[1] for tier in cells.results.tiers)
    if not by_single or not any(t.kind == "solve" and t.seconds for t in cells.results.timing):
        return []
    return [("Single measurements",
             f"{len(single)} of {len(verified)} verified cells (family, n, solver, tier) were not timed repeatedly and "
             f"show the accuracy pass' time, a median of at most five solves (marked † in tables). In profiles and "
             f"rankings up to {by_single} of {len(cells.results.problems)} problems per tier are compared by "
             "those times.")]


def _disagreements(cells: Cells) -> list:
    found = cells.disagreements()
    return [("Passes disagree",
             f"In {formats.plural(len(found), 'cell')} the timing pass judged differently from the accuracy pass, for "
             f"example {found[0]}.")] if found else []


def _accuracy_once(cells: Cells) -> list:
    return [("One run for accuracy",
             "Accuracy was measured on one run per problem, solver and tier. Solvers are meant to be deterministic, "
             "but a verdict that hangs on the time limit can change from run to run.")]


def _seeds(cells: Cells) -> list:
    per_cell = cells.results.problems.groupby(["family", "n"])["seed"].nunique()
    return [("Few samples", f"Each family and size is represented by "
             f"{formats.span(list(per_cell))} random {'instance' if per_cell.max() == 1 else 'instances'}; "
             "a fraction of problems solved is a statement about these, not about a population.")]


def _families(cells: Cells) -> list:
    problems = cells.results.problems
    counts = {n: problems.loc[problems["n"] == n, "family"].nunique() for n in sorted(set(problems["n"]))}
    fewer = {n: count for n, count in counts.items() if count < len(cells.results.families)}
    if not fewer:
        return []
    parts = ", ".join(f"{count} of {len(cells.results.families)} at n = {n}" for n, count in fewer.items())
    return [("Not every size", f"Large problems come from fewer families, chosen before the run: {parts}.")]


def _limit(cells: Cells) -> list:
    limit = cells.results.run["time_limit_s"]
    if limit is None:
        return []
    hit = cells.runs[cells.runs["claim"] == "time_limit"]
    counts = hit["solver"].value_counts()
    who = ", ".join(f"{s} {counts[s]}" for s in cells.results.solvers if s in counts)
    text = "No run ended there."
    if len(hit):
        text = f"{formats.plural(len(hit), 'run')} ended there ({who}); with more time some might be verified."
    by_size = cells.results.run.get("time_limits", [])
    limits = sorted({entry["s"] for entry in by_size})
    allowed = f"{limit:g} s" if len(limits) < 2 else ", ".join(
        f"{value:g} s at n = {formats.span([e['n'] for e in by_size if e['s'] == value])}" for value in limits)
    return [("Time limit", f"A solve may take {allowed}. {text}")]


def _excluded(cells: Cells) -> list:
    run = [solver for solver in cells.results.solvers if cells.was_run(solver)]
    left_out = cells.runs[(cells.runs["excluded"] != "") & cells.runs["solver"].isin(run)]
    if left_out.empty:
        return []
    parts = []
    for rule, group in left_out.groupby("excluded", sort=False):
        who = ", ".join(s for s in cells.results.solvers if s in set(group["solver"]))
        parts.append(f"“{rule}” ({who}: {formats.plural(len(group), 'run')})")
    return [("Excluded by rule",
             f"{formats.plural(len(left_out), 'run')} did not take place: {'; '.join(parts)}. In counts and profiles "
             "they stand as not solved.")]


def _unavailable(cells: Cells) -> list:
    idle = [solver for solver in cells.results.solvers if not cells.was_run(solver)]
    lines = [("Not run", f"There are no results for {formats.words(idle)}.")] if idle else []
    missing = cells.results.missing
    if missing:
        lines.append(("Not in this build", f"{formats.words(missing)}: without their libraries these have no results. "
                      "“make peers” installs what Debian has."))
    return lines


def _tiers(cells: Cells) -> list:
    loosest, strictest = max(cells.results.tiers), min(cells.results.tiers)
    lines = []
    for solver in cells.results.solvers:
        mine = cells.runs[cells.runs["solver"] == solver]
        # Tiers that a rule left out at some sizes say nothing about the solver.
        left_out = set(mine.loc[mine["excluded"].str.startswith("tier not run"), "problem"])
        mine = mine[~mine["problem"].isin(left_out)]
        loose, strict = (int(mine.loc[mine["tier"] == tier, "verified"].sum()) for tier in (loosest, strictest))
        if loose and strict < _TIER_DROP * loose:
            lines.append((f"{solver} and strict tiers",
                          f"{solver} is verified on {loose} problems at {formats.tier(loosest)} but on {strict} at "
                          f"{formats.tier(strictest)}: it is judged here at tiers it is not built for. Its row at "
                          f"{formats.tier(loosest)} is the one to read."))
    return lines


def _direct(cells: Cells) -> list:
    direct = [s["key"] for s in cells.results.run["solvers"] if s["available"] and not s["uses_tolerance"]]
    return [("Direct methods",
             f"Not steered by the tolerance: {formats.words(direct)}. One run stands for every tier, so a loose tier "
             "does not make it faster.")] if direct else []


def _reference(cells: Cells) -> list:
    unknown = int(cells.results.problems["separating"].isna().sum())
    return [("No reference",
             f"On {formats.plural(unknown, 'problem')} no solver was verified at the strictest tier: there the "
             "separating fraction is not known.")] if unknown else []


def _floor(cells: Cells) -> list:
    sentence = floors.sentence(cells)
    return [("Rounding floor", sentence)] if sentence else []


def _setup(cells: Cells) -> list:
    return [("Set-up apart",
             "Set-up (forms of A, allocation, symbolic analysis) is not part of the solve time; it is drawn on its "
             "own. Who solves each problem once pays both.")]


def _scope(cells: Cells) -> list:
    return [("Scope",
             "Scenes are synthetic and frictionless; solvers were called one at a time, from cold starts, with their "
             "default settings. rho is our measure: a library that stops on a criterion of its own may do more work "
             "than a tier needs.")]
