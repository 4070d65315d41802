"""The rows of every table, as plain values that page.html.j2 only has to set."""

import math

import pandas as pd

from . import floors, formats
from .cells import SINGLE_RUN, Cell, Cells, failure_line, failure_word
from .figures import growth
from .stats import geometric_mean, median
from .summary import ranking, size_classes

ORIGIN_TITLES = {"own": "own solvers", "peer": "peers", "external": "external solvers"}


def all_sizes(cells: Cells) -> list[int]:
    return sorted(set(cells.results.problems["n"]))


def headline(cells: Cells, tier: float) -> list[dict]:
    """A row per solver, a cell per size: the median over the verified families of the time at this tier, how many
    families those are, and the geometric mean of time over oracle-chol. Bold: the fastest of those with most families.
    """
    families = cells.results.families
    oracle = {(family, n): t for family in families for n, t in cells.oracle_times(family)}
    columns = []
    for n in all_sizes(cells):
        present = [family for family in families if n in cells.sizes(family)]
        columns.append({solver: _headline_cell(cells, present, n, solver, tier, oracle)
                        for solver in cells.results.solvers})
        most = max((cell["verified"] for cell in columns[-1].values()), default=0)
        full = [cell for cell in columns[-1].values() if cell["verified"] == most and most]
        for cell in full:
            cell["best"] = cell["seconds"] == min(other["seconds"] for other in full)
    rows, origin = [], None
    for solver in cells.results.solvers:
        new, origin = cells.results.origin(solver) != origin, cells.results.origin(solver)
        rows.append({"solver": solver, "group": ORIGIN_TITLES[origin] if new else "",
                     "cells": [column[solver] for column in columns]})
    return rows


def _headline_cell(cells: Cells, families: list[str], n: int, solver: str, tier: float, oracle: dict) -> dict:
    found = [cell for family in families if (cell := cells.get(family, n, solver, tier))]
    passed = [cell for cell in found if cell.passes]
    ratios = [cell.time_s / oracle[cell.family, n] for cell in passed if oracle.get((cell.family, n))]
    time = median([cell.time_s for cell in passed])
    rules = list(dict.fromkeys(cell.excluded for cell in found if cell.excluded))
    words = list(dict.fromkeys(cell.verdict for cell in found if cell.verdict not in ("verified", "excluded")))
    return {"verified": len(passed), "of": len(families), "seconds": time, "time": formats.seconds(time),
            "ratio": formats.ratio(geometric_mean(ratios)), "best": False, "excluded": not passed and not words,
            "word": words[0] if words else "", "title": "; ".join(words + rules)}


def family_table(cells: Cells, family: str, tier: float) -> list[dict]:
    """A row per solver, a cell per size of the family: time and verdict at this tier; oracle-chol in the last row."""
    sizes = cells.sizes(family)
    fastest = {}
    for n in sizes:
        times = [c.time_s for s in cells.results.solvers if (c := cells.get(family, n, s, tier)) and c.passes]
        fastest[n] = min((t for t in times if math.isfinite(t)), default=math.nan)
    rows = []
    for solver in cells.results.solvers:
        slope = growth(cells, family, tier, solver)
        rows.append({"solver": solver, "exponent": f"{slope.exponent:.2f}" if slope else "",
                     "range": f"n = {slope.n_min}–{slope.n_max}, {slope.points} points" if slope else "",
                     "cells": [_family_cell(cells.get(family, n, solver, tier), fastest[n]) for n in sizes]})
    return rows


def oracle_row(cells: Cells, family: str) -> list[str]:
    times = dict(cells.oracle_times(family))
    return [formats.seconds(times.get(n, math.nan)) for n in cells.sizes(family)]


def _family_cell(cell: Cell | None, fastest: float) -> dict:
    if cell is None or cell.verdict == "excluded":
        return {"kind": "excluded", "word": "not run", "reason": cell.excluded if cell else ""}
    if not cell.passes:
        word = f"{cell.verified} of {cell.runs} verified" if cell.verified else cell.verdict
        return {"kind": "failed", "word": word, "reason": f"{cell.verdict}: {cell.reason}",
                "false": cell.verdict.startswith("false")}
    convert = f"+ {formats.seconds(cell.convert_s)}" if cell.convert_s > 0 else ""
    return {"kind": "passed", "time": formats.seconds(cell.time_s), "convert": convert,
            "single": cell.time_source == SINGLE_RUN, "best": cell.time_s == fastest,
            "reason": f"rho {formats.residual(cell.rho)}, {cell.verified} of {cell.runs} verified"}


def rankings(cells: Cells) -> list[dict]:
    """Per tier (strictest first) and size class the solvers, best first; those without a verified answer apart. Without
    classes in which the tier was not asked of all."""
    classes = size_classes(list(cells.results.problems["n"]))
    found = []
    for tier in reversed(cells.results.tiers):
        tables = []
        for c in classes:
            ranks = ranking(cells, tier, c)
            if not ranks:
                continue
            tables.append({"label": c.label, "ranks": [_rank(r) for r in ranks if r.verified],
                           "none": [r.solver for r in ranks if not r.verified]})
        found.append({"tier": formats.tier(tier), "classes": tables})
    return found


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
    claims = other_claims(cells)
    for tier in reversed(cells.results.tiers):
        at_tier = cells.runs[cells.runs["tier"] == tier]
        by_solver = dict(list(at_tier.groupby("solver")))
        for solver in cells.results.solvers:
            absent = not cells.was_run(solver)
            row = {} if absent else accuracy_row(by_solver.get(solver, at_tier.iloc[:0]), claims)
            rows.append({"solver": solver, "tier": formats.tier(tier), "absent": absent, **row})
    return rows


def accuracy_row(runs: pd.DataFrame, claims: list[str]) -> dict:
    """Counts and residuals of one solver at one tier. Excluded runs count as problems and as nothing else."""
    tried = runs[runs["excluded"] == ""]
    good = tried[tried["verified"]]
    counts = [int((tried["claim"] == claim).sum()) for claim in claims]
    return {
        "problems": len(runs), "excluded": len(runs) - len(tried),
        "claimed": int((tried["claim"] == "solved").sum()),
        "verified": len(good), "share": len(good) / len(runs) if len(runs) else 0.0,
        "at_floor": int(good["at_floor"].sum()),
        "unclaimed": int((good["claim"] != "solved").sum()),
        "false_success": int(tried["false_success"].sum()),
        "false_infeasible": int(tried["false_infeasible"].sum()),
        "claims": counts,
        "gave_up": ", ".join(f"{formats.status(claim)} {count}" for claim, count in zip(claims, counts) if count),
        "rho_median": formats.residual(median(good["rho"])), "rho_max": formats.residual(good["rho"].max()),
        "backward_max": formats.residual(good["backward_error"].max()),
        "w_error_max": formats.residual(good["w_error"].max()),
    }


def verdicts(cells: Cells) -> list[dict]:
    """One look at everything: a row per family and size, a cell per solver: the strictest tier that all seeds pass."""
    tiers = list(reversed(cells.results.tiers))
    return [{"family": family, "n": n, "first": n == cells.sizes(family)[0], "span": len(cells.sizes(family)),
             "floor": _floor(cells, cells.floor(family, n)),
             "cells": [_verdict(cells, family, n, solver, tiers) for solver in cells.results.solvers]}
            for family in cells.results.families for n in cells.sizes(family)]


def _floor(cells: Cells, floor: float) -> dict:
    return {"text": floors.text(cells, floor), "above": floors.above(cells, floor),
            "title": floors.title(cells, floor) if floors.text(cells, floor) else ""}


def _verdict(cells: Cells, family: str, n: int, solver: str, tiers: list[float]) -> dict:
    cell = cells.strictest(family, n, solver)
    name = f"{solver}, {family}, n = {n}: "
    tried = [c for t in tiers if (c := cells.get(family, n, solver, t)) and not c.excluded]
    if cell is None or not tried:
        return {"kind": "level-1", "text": "", "title": name + (cell.reason if cell else "not run")}
    lied = [c for c in tried if c.failure.startswith("false")]
    lie = f"{lied[0].failure} at {formats.tier(lied[0].tier)}" if lied else ""
    if not cell.passes:
        return {"kind": "false", "text": "!", "title": name + lie} if lied else \
               {"kind": "level0", "text": "✗", "title": name + tried[-1].failure}
    exponent = formats.tier(cell.tier).split("e")[1].replace("-", "−")
    return {"kind": f"level{tiers.index(cell.tier) + 1}" + (" lied" if lied else ""),
            "text": exponent + (floors.MARK if cell.at_floor else "") + ("!" if lied else ""),
            "title": f"{name}passes {formats.tier(cell.tier)}, rho {formats.residual(cell.rho)}"
                     + (" (thanks to the rounding floor)" if cell.at_floor else "")
                     + (f"; {lie}" if lied else "")}


def residual_map(cells: Cells) -> list[dict]:
    """Per family: a column per problem, a row per solver with rho when the strictest tier was asked for."""
    strictest = min(cells.results.tiers)
    at_tier = {(run["problem"], run["solver"]): run
               for run in cells.runs[cells.runs["tier"] == strictest].to_dict("records")}
    families = []
    for family in cells.results.families:
        problems = cells.results.problems
        mine = list(problems[problems["family"] == family].sort_values(["n", "seed"], kind="stable")
                    .itertuples(index=False))
        rows = [{"solver": solver, "cells": [_map_cell(cells, at_tier.get((p.problem, solver))) for p in mine]}
                for solver in cells.results.solvers]
        verified = sum(cell["level"] == 1 for row in rows for cell in row["cells"])
        families.append({"family": family, "rows": rows, "verified": verified,
                         "problems": [{"name": p.problem, "n": p.n, "seed": p.seed,
                                       "floor": _floor(cells, p.floor)} for p in mine],
                         "of": len(rows) * len(mine)})
    return families


def _map_cell(cells: Cells, run: dict | None) -> dict:
    """`level` 1 is the strictest tier, 2 the next, ...; 0 is none."""
    if run is None or run["excluded"]:
        return {"level": -1, "rho": formats.DASH, "word": "", "at_floor": False, "false": False,
                "title": run["excluded"] if run else "not run"}
    # best_tier knows the three usual tiers only; a run may have had others.
    level = 1 if run["verified"] else 0
    for i, tier in enumerate(reversed(cells.results.tiers), start=1):
        if not level and run["best_tier"] > 0 and run["best_tier"] <= tier * (1 + 1e-6):
            level = i
    word = "" if run["verified"] else failure_word(run)
    return {"level": level, "rho": formats.residual(run["rho"]), "word": word,
            "at_floor": bool(run["verified"] and run["at_floor"]), "false": bool(run["false_success"]),
            "title": "" if run["verified"] else failure_line(run)}


def failures(cells: Cells) -> list[dict]:
    """What went wrong, grouped by solver, tier and kind, with one example each."""
    bad = cells.runs[~cells.runs["verified"] & (cells.runs["excluded"] == "")]
    groups: dict[tuple, list[dict]] = {}
    for run in bad.to_dict("records"):
        groups.setdefault((run["solver"], run["tier"], failure_word(run)), []).append(run)
    order = {s: i for i, s in enumerate(cells.results.solvers)}
    families = {f: i for i, f in enumerate(cells.results.families)}
    rows = []
    for (solver, tier, word), group in groups.items():
        example = min(group, key=lambda run: (run["n"], families[run["family"]], run["seed"]))
        names = sorted({run["family"] for run in group}, key=families.get)
        rows.append({"solver": solver, "tier": formats.tier(tier), "word": word, "count": len(group),
                     "families": names[0] if len(names) == 1 else f"{len(names)} families",
                     "names": formats.words(names), "sizes": ", ".join(str(n) for n in sorted({r["n"] for r in group})),
                     "rho": formats.residual(example["rho"]), "problem": example["problem"],
                     "example": failure_line(example), "false": word.startswith("false"),
                     "key": (order[solver], tier, word)})
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
                ("rounding floor of rho", floors.largest(mine)),
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
