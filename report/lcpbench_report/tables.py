"""The rows of every table, as plain values that page.html.j2 only has to set."""

import math

import pandas as pd

from . import formats
from .cells import SINGLE_RUN, Cell, Cells, failure_line, failure_word
from .stats import median, nearest_sizes
from .summary import ranking, size_classes

_HEADLINE_SIZES = [10, 100, 1000]


def headline(cells: Cells) -> list[dict]:
    """A row per family and size near 10, 100, 1000; per solver time and rho at the strictest tier passed."""
    rows = []
    for family in cells.results.families:
        sizes = nearest_sizes(cells.sizes(family), _HEADLINE_SIZES)
        for n in sizes:
            found = [cells.strictest(family, n, solver) for solver in cells.results.solvers]
            passed = [c for c in found if c and c.passes]
            top = min((c.tier for c in passed), default=None)
            best = min((c.time_s for c in passed if c.tier == top), default=math.nan)
            rows.append({"family": family, "n": n, "first": n == sizes[0], "span": len(sizes),
                         "cells": [_headline_cell(c, top, best) for c in found]})
    return rows


def _headline_cell(cell: Cell | None, top: float | None, best: float) -> dict:
    if cell is None:
        return {"kind": "absent"}
    if not cell.passes:
        part = f"{cell.verified} of {cell.runs} verified" if cell.verified else ""
        return {"kind": "excluded" if cell.excluded else "failed", "word": cell.failure, "reason": cell.reason,
                "part": part, "rho": formats.residual(cell.rho)}
    return {"kind": "passed", "time": formats.seconds(cell.time_s), "rho": formats.residual(cell.rho),
            "tier": formats.tier(cell.tier), "looser": cell.tier != top, "single": cell.time_source == SINGLE_RUN,
            "best": cell.tier == top and cell.time_s == best}


def rankings(cells: Cells) -> list[dict]:
    """Per tier (strictest first) and size class the solvers, best first."""
    classes = size_classes(list(cells.results.problems["n"]))
    return [{"tier": formats.tier(tier),
             "classes": [{"label": c.label, "ranks": [_rank(r) for r in ranking(cells, tier, c)]} for c in classes]}
            for tier in reversed(cells.results.tiers)]


def _rank(rank) -> dict:
    return {"solver": rank.solver, "fastest": rank.fastest, "problems": rank.problems, "verified": rank.verified,
            "ratio": formats.ratio(rank.mean_ratio)}


def other_claims(cells: Cells) -> list[str]:
    """Claims other than success, in the order of their frequency."""
    claims = cells.runs.loc[cells.runs["excluded"] == "", "claim"].value_counts()
    return [claim for claim in claims.index if claim != "solved"]


def accuracy(cells: Cells) -> list[dict]:
    """A row per solver and tier, strictest tier first."""
    rows = []
    for solver in cells.results.solvers:
        mine = cells.runs[cells.runs["solver"] == solver]
        if not cells.was_run(solver):
            rows.append({"solver": solver, "absent": True, "first": True, "span": 1})
        for i, tier in enumerate(reversed(cells.results.tiers) if cells.was_run(solver) else []):
            row = accuracy_row(mine[mine["tier"] == tier], other_claims(cells))
            rows.append({"solver": solver, "tier": formats.tier(tier), "absent": False, "first": i == 0,
                         "span": len(cells.results.tiers), **row})
    return rows


def accuracy_row(runs: pd.DataFrame, claims: list[str]) -> dict:
    """Counts and residuals of one solver at one tier. Excluded runs count as problems and as nothing else."""
    tried = runs[runs["excluded"] == ""]
    good = tried[tried["verified"]]
    return {
        "problems": len(runs), "excluded": len(runs) - len(tried),
        "claimed": int((tried["claim"] == "solved").sum()),
        "verified": len(good), "share": len(good) / len(runs) if len(runs) else 0.0,
        "unclaimed": int((good["claim"] != "solved").sum()),
        "false_success": int(tried["false_success"].sum()),
        "false_infeasible": int(tried["false_infeasible"].sum()),
        "claims": [int((tried["claim"] == claim).sum()) for claim in claims],
        "rho_median": formats.residual(median(good["rho"])), "rho_max": formats.residual(good["rho"].max()),
        "backward_max": formats.residual(good["backward_error"].max()),
        "w_error_max": formats.residual(good["w_error"].max()),
    }


def verdicts(cells: Cells) -> dict:
    """One look at everything: a row per solver, a cell per family and size: the strictest tier that all seeds pass."""
    tiers = list(reversed(cells.results.tiers))
    groups = [{"family": family, "sizes": cells.sizes(family)} for family in cells.results.families]
    rows = []
    for solver in cells.results.solvers:
        row = []
        for group in groups:
            for n in group["sizes"]:
                row.append(_verdict(cells, group["family"], n, solver, tiers) | {"first": n == group["sizes"][0]})
        rows.append({"solver": solver, "cells": row})
    return {"groups": groups, "rows": rows}


def _verdict(cells: Cells, family: str, n: int, solver: str, tiers: list[float]) -> dict:
    cell = cells.strictest(family, n, solver)
    name = f"{solver}, {family}, n = {n}: "
    if cell is None or cell.excluded:
        return {"kind": "level-1", "text": "", "title": name + (cell.reason if cell else "not run")}
    lied = [c for t in tiers if (c := cells.get(family, n, solver, t)) and c.failure.startswith("false")]
    if lied:
        return {"kind": "false", "text": "!", "title": f"{name}{lied[0].failure} at {formats.tier(lied[0].tier)}"}
    if not cell.passes:
        return {"kind": "level0", "text": "✗", "title": name + cell.failure}
    exponent = formats.tier(cell.tier).split("e")[1].replace("-", "−")
    return {"kind": f"level{tiers.index(cell.tier) + 1}", "text": exponent,
            "title": f"{name}passes {formats.tier(cell.tier)}, rho {formats.residual(cell.rho)}"}


def residual_map(cells: Cells) -> list[dict]:
    """Per family: a row per problem, a cell per solver with rho when the strictest tier was asked for."""
    strictest = min(cells.results.tiers)
    at_tier = cells.runs[cells.runs["tier"] == strictest].set_index(["problem", "solver"])
    families = []
    for family in cells.results.families:
        problems = cells.results.problems
        mine = problems[problems["family"] == family].sort_values(["n", "seed"], kind="stable")
        rows = [{"problem": p.problem, "n": p.n, "seed": p.seed,
                 "cells": [_map_cell(cells, at_tier, p.problem, solver) for solver in cells.results.solvers]}
                for p in mine.itertuples(index=False)]
        verified = sum(cell["level"] == 1 for row in rows for cell in row["cells"])
        families.append({"family": family, "rows": rows, "verified": verified,
                         "of": len(rows) * len(cells.results.solvers)})
    return families


def _map_cell(cells: Cells, at_tier: pd.DataFrame, problem: str, solver: str) -> dict:
    """`level` 1 is the strictest tier, 2 the next, ...; 0 is none."""
    if (problem, solver) not in at_tier.index:
        return {"level": -1, "rho": formats.DASH, "word": "", "false": False, "title": "not run"}
    run = at_tier.loc[(problem, solver)]
    if run["excluded"]:
        return {"level": -1, "rho": "excluded", "word": "", "false": False, "title": run["excluded"]}
    level = 0
    for i, tier in enumerate(reversed(cells.results.tiers), start=1):
        if not level and run["best_tier"] > 0 and run["best_tier"] <= tier * (1 + 1e-6):
            level = i
    word = "" if run["verified"] else failure_word(run)
    return {"level": level, "rho": formats.residual(run["rho"]), "word": word, "false": bool(run["false_success"]),
            "title": "" if run["verified"] else failure_line(run)}


def failures(cells: Cells) -> list[dict]:
    """What went wrong, grouped by solver, tier, family and kind, with one example each."""
    bad = cells.runs[~cells.runs["verified"] & (cells.runs["excluded"] == "")].copy()
    if bad.empty:
        return []
    bad["word"] = [failure_word(run) for _, run in bad.iterrows()]
    order = {s: i for i, s in enumerate(cells.results.solvers)}
    families = {f: i for i, f in enumerate(cells.results.families)}
    rows = []
    for (solver, tier, family, word), group in bad.groupby(["solver", "tier", "family", "word"], sort=False):
        example = group.sort_values(["n", "seed"], kind="stable").iloc[0]
        sizes = ", ".join(str(n) for n in sorted(set(group["n"])))
        rows.append({"solver": solver, "tier": formats.tier(tier), "family": family, "word": word, "count": len(group),
                     "sizes": sizes, "rho": formats.residual(example["rho"]),
                     "example": failure_line(example), "false": word.startswith("false"),
                     "key": (order[solver], tier, families[family], word)})
    return sorted(rows, key=lambda row: row["key"])


def scenes(cells: Cells) -> list[dict]:
    """Facts about each family, from problems.csv."""
    described = {scene["key"]: scene for scene in cells.results.run["scenes"]}
    rows = []
    for family in cells.results.families:
        mine = cells.results.problems[cells.results.problems["family"] == family]
        scene = described.get(family, {"title": family, "purpose": ""})
        rows.append({
            "family": family, "title": scene["title"], "purpose": scene["purpose"],
            "facts": [(name, value) for name, value in (
                ("sizes n", ", ".join(str(n) for n in sorted(set(mine["n"])))),
                ("problems", str(len(mine))),
                ("movable bodies", _span(mine["movable"], lambda v: f"{v:.0f}")),
                ("density of A", _span(mine["nnz_a"] / mine["n"] ** 2, formats.percent)),
                ("separating rows", _span(mine["separating"], formats.percent)),
                ("redundancy n − rank A", _redundancy(mine)),
            ) if value]})
    return rows


def _span(values: pd.Series, form) -> str:
    known = [float(v) for v in values.dropna()]
    return formats.span(known, form) if known else ""


def _redundancy(problems: pd.DataFrame) -> str:
    """Per size, where the rank is known; the share of n in brackets for the largest of them."""
    known = problems[problems["rank_a"].notna()]
    if known.empty:
        return ""
    missing = known["n"] - known["rank_a"]
    if not missing.any():
        return f"0 (full rank up to n = {known['n'].max()})"
    share = missing / known["n"]
    return (f"{formats.span([int(m) for m in missing])} for n up to {known['n'].max()} "
            f"({_span(share, formats.percent)} of n)")
