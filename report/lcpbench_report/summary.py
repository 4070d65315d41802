"""The answer in about ten lines, and the ranking behind it. Every word that names a solver comes from the data."""

import math
from dataclasses import dataclass

import numpy as np

from . import floors, formats
from .cells import Cells
from .stats import geometric_mean, time_ratios

# Sizes fall into classes around 10, 100, 1000 and 10000; the bounds are the half decades between them.
_CLASS_BOUNDS = (10**1.5, 10**2.5, 10**3.5)
_TIER_NOT_RUN = "tier not run"  # how that rule of benchmarks/suite.cc begins


@dataclass
class Rank:
    """One solver in one size class at one tier."""

    solver: str
    problems: int
    verified: int
    fastest: int  # number of problems on which it has the smallest time
    mean_ratio: float  # geometric mean over its verified problems of time / best time


@dataclass
class SizeClass:
    label: str  # "n = 10–30"
    sizes: list[int]


def size_classes(sizes: list[int]) -> list[SizeClass]:
    """Small, medium, large and larger ones, labelled by the sizes that are present; empty classes are left out."""
    bounds = (0.0, *_CLASS_BOUNDS, math.inf)
    groups = [sorted({n for n in sizes if low < n <= high}) for low, high in zip(bounds, bounds[1:])]
    return [SizeClass(f"n = {formats.span(group)}", group) for group in groups if group]


def tier_was_left_out(cells: Cells, tier: float, size_class: SizeClass) -> bool:
    """Whether a rule spared some solvers this tier at these sizes: direct methods, whose one run is judged at every
    tier, would be compared among themselves."""
    runs = cells.runs
    problems = cells.results.problems
    names = problems.loc[problems["n"].isin(size_class.sizes), "problem"]
    spared = runs["excluded"].str.startswith(_TIER_NOT_RUN) & (runs["tier"] == tier) & runs["problem"].isin(names)
    return bool(spared.any())


def ranking(cells: Cells, tier: float, size_class: SizeClass) -> list[Rank]:
    """Best first: by problems won, then by problems verified, then by mean ratio. Empty where the tier was not asked of
    every solver."""
    if tier_was_left_out(cells, tier, size_class):
        return []
    times, _ = cells.problem_times(tier)
    problems = cells.results.problems
    names = set(problems.loc[problems["n"].isin(size_class.sizes), "problem"])
    times = times.loc[[name for name in times.index if name in names]]
    ratios = time_ratios(times)
    ranks = []
    for solver in times.columns:
        ratio = ratios[solver].to_numpy()
        finite = ratio[np.isfinite(ratio)]
        ranks.append(Rank(solver, len(ratio), len(finite), int((finite == 1.0).sum()), geometric_mean(list(finite))))
    return sorted(ranks, key=lambda r: (-r.fastest, -r.verified, r.mean_ratio if r.verified else math.inf))


def summary_lines(cells: Cells) -> list[dict]:
    """[{'label', 'text', 'alert'}]: scope, the fastest per tier, false successes, a line per solver."""
    lines = [{"label": "Scope", "text": _scope(cells), "alert": False}]
    for tier in reversed(cells.results.tiers):
        lines.append({"label": f"Fastest at {formats.tier(tier)}", "text": _fastest(cells, tier), "alert": False})
    wrong = cells.runs[cells.runs["false_success"]]
    lines.append({"label": "False successes", "text": _false_successes(cells, wrong), "alert": len(wrong) > 0})
    if any(floors.above(cells, floor) for floor in cells.results.problems["floor"]):
        lines.append({"label": "Rounding floor", "text": floors.sentence(cells), "alert": False})
    for solver in cells.results.solvers:
        lines.append({"label": solver, "text": _solver_line(cells, solver), "alert": False, "solver": solver,
                      "origin": cells.results.origin(solver)})
    if cells.results.missing:
        lines.append({"label": "Not in this build", "text": f"{formats.words(cells.results.missing)}.", "alert": False})
    return lines


def _scope(cells: Cells) -> str:
    results = cells.results
    problems = results.problems
    solvers = [s for s in results.solvers if cells.was_run(s)]
    tiers = formats.words([formats.tier(t) for t in results.tiers])
    excluded = int((cells.runs["excluded"] != "").sum())
    families = formats.plural(len(results.families), "family", "families")
    return (f"{formats.plural(len(problems), 'problem')} from {families}, n = {formats.span(list(problems['n']))}; "
            f"{formats.plural(len(solvers), 'solver')}{_origins(cells, solvers)} at tiers {tiers}: "
            f"{len(cells.runs) - excluded} answers judged, {excluded} excluded by rule.")


def _origins(cells: Cells, solvers: list[str]) -> str:
    words = {"own": "of our own", "peer": "of others", "external": "external"}
    counts = {word: sum(cells.results.origin(s) == key for s in solvers) for key, word in words.items()}
    present = [f"{count} {word}" for word, count in counts.items() if count]
    return f" ({', '.join(present)})" if len(present) > 1 else ""


def _fastest(cells: Cells, tier: float) -> str:
    parts = []
    for size_class in size_classes(list(cells.results.problems["n"])):
        best = next(iter(ranking(cells, tier, size_class)), None)
        if tier_was_left_out(cells, tier, size_class):
            parts.append(f"{size_class.label}: not run")
        elif best is None or best.verified == 0:
            parts.append(f"{size_class.label}: no solver verified")
        else:
            parts.append(f"{size_class.label}: {best.solver} (first on {best.fastest} of {best.problems}, "
                         f"verified on {best.verified})")
    return "; ".join(parts) + "."


def _false_successes(cells: Cells, wrong) -> str:
    claims = int(((cells.runs["claim"] == "solved") & (cells.runs["excluded"] == "")).sum())
    if wrong.empty:
        return f"none: all {claims} claims of success hold at the tier that was asked for."
    counts = wrong["solver"].value_counts()
    by_solver = ", ".join(f"{solver} {counts[solver]}" for solver in cells.results.solvers if solver in counts)
    return f"{len(wrong)} of {claims} claims of success do not hold ({by_solver})."


def _solver_line(cells: Cells, solver: str) -> str:
    runs = cells.runs[cells.runs["solver"] == solver]
    if not cells.was_run(solver):
        rules = [rule for rule in dict.fromkeys(runs["excluded"]) if rule]
        return "not run" + (f": {formats.words(rules)}." if rules else ".")
    counts = []
    for tier in reversed(cells.results.tiers):
        at_tier = runs[runs["tier"] == tier]
        if len(at_tier):
            counts.append(f"{int(at_tier['verified'].sum())}/{len(at_tier)} at {formats.tier(tier)}")
    return f"verified {', '.join(counts)}; {_first_failure(cells, solver)}."


def _first_failure(cells: Cells, solver: str) -> str:
    """Smallest n at which a cell fails at the strictest tier; and from where on cells are excluded."""
    strictest = min(cells.results.tiers)
    order = {family: i for i, family in enumerate(cells.results.families)}
    mine = sorted((c for c in cells.all() if c.solver == solver and c.tier == strictest),
                  key=lambda c: (c.n, order[c.family]))
    failed = [c for c in mine if not c.passes and not c.excluded]
    excluded = [c for c in mine if c.excluded]
    text = f"no failure at {formats.tier(strictest)}"
    if failed:
        first = failed[0]
        others = len({c.family for c in failed if c.n == first.n}) - 1
        more = f" and {formats.plural(others, 'other family', 'other families')}" if others else ""
        rho = f", rho {formats.residual(first.rho)}" if math.isfinite(first.rho) else ""
        text = f"first fails {formats.tier(strictest)} at n = {first.n} in {first.family}{more} ({first.failure}{rho})"
    if excluded:
        text += f"; {formats.plural(len(excluded), 'cell')} excluded from n = {excluded[0].n} on"
    return text

