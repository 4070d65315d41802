"""The tables that people read, each described once: summaries and README.md have them as Markdown, the page as HTML,
papers as LaTeX. None where the inputs do not have the part.
"""

import math
from collections.abc import Callable

import pandas as pd

from . import choice, decision, formats, solver_facts
from .formats import DASH, power, residual, seconds, share_of, size_class, times
from .headline_table import Entry, Headline, headline, verdicts
from .inputs import PATHOLOGICAL, Inputs
from .statistics.cells import BELOW_TIER, FALSE_SUCCESS, NOT_ASKED, VERIFIED, within_rounding
from .statistics.class_times import ALL, RIGHT
from .statistics.load import ORIGINS
from .table import Table
from .table import code as key

NOT_ASKED_MARK = "○"
_MOST_SOLVERS = 25  # of the table of sequences


def _table(columns: list[str], rows: list[list], align: str = "") -> Table | None:
    return Table(columns, rows, align) if rows else None


def classes(found: Headline) -> Table:
    """A row per size class: the best of ours against the peers."""
    rows = []
    for row in found.classes:
        own, peer = row.entries.get(row.own), row.entries.get(row.peer)
        tails = [seconds(entry.p99_s) for entry in (own, peer) if entry and not math.isnan(entry.p99_s)]
        rows.append([size_class(row.size_class), row.problems, *_named(row.own, own, DASH),
                     *_named(row.peer, peer, found.no_peer or f"none is right on {formats.percent(RIGHT)}"),
                     *(DASH if of is None else _with_interval(of.median, of.low, of.high)
                       for of in (row.to_peer, row.to_fastest)), ", ".join(tails) or DASH])
    return Table(["rows", "problems", "best of ours", "right", "best right peer", "right", "ours / that peer",
                  "ours / fastest peer of each problem", "99 %: ours, peer"], rows, "lrlrlrrrr")


def outcomes(found: Headline) -> Table | None:
    """The front page's: a row where we lose, one where nothing is decided, and one where we win, over size classes."""
    rows = []
    for words, classes_ in zip(("slower", "not told apart", "faster"), verdicts(found)):
        if classes_:
            before = [None, *(row.own for row in classes_)]  # a name stands once
            own = [f"{key(row.own)} " * (row.own != last) + seconds(row.entries[row.own].time_s)
                   for row, last in zip(classes_, before)]
            ratios = [_with_interval(*row.to_fastest) for row in classes_]
            rows.append([words, *map(", ".join, ([size_class(row.size_class) for row in classes_], own, ratios))])
    return _table(["ours is", "rows", "our median time", "ours / fastest peer of each problem"], rows, "llll")


def by_solver(found: Headline) -> Table:
    """A row per solver, a column per size class."""
    return Table(["solver", *(size_class(row.size_class) for row in found.classes)],
                 [[key(solver), *(cell(row.entries.get(solver), row.problems) for row in found.classes)]
                  for solver in found.solvers])


def cell(entry: Entry | None, problems: int) -> str:
    if entry is None or not entry.attempted:
        return NOT_ASKED_MARK if entry and entry.not_asked else DASH
    verified = share_of(entry.share)
    sample = f" of {entry.problems}" if entry.problems < problems else ""
    if not math.isfinite(entry.time_s):
        return f"✗ {verified}{sample}"
    time = f"**{seconds(entry.time_s)}**" if entry.best else seconds(entry.time_s)
    return time if entry.share == 1 and not sample else f"{time} · {verified}{sample}"


def _with_interval(value: float, low: float, high: float) -> str:
    """0.60 (0.55–0.64)"""
    if math.isnan(value):
        return DASH
    return times(value) + ("" if math.isnan(low) else f" ({times(low)}–{times(high)})")


def _named(solver: str | None, entry: Entry | None, without: str) -> tuple[str, str]:
    """Who and how fast, and the share that is right."""
    if entry is None:
        return without, DASH
    words = f"{key(solver)} {seconds(entry.time_s)}"
    return f"**{words}**" if entry.best else words, share_of(entry.share)


def ablation(inputs: Inputs, all_only: bool = False) -> Table | None:
    """A row per solver and class, at the main tier.

    @param all_only  of all size classes together
    """
    rows, found = [], ablations(inputs)
    for of in (found[found["size_class"] == ALL] if all_only and len(found) else found).to_dict("records"):
        false, before = (int(of[prefix + "false_successes"] + of[prefix + "below_tier"]) for prefix in ("", "base_"))
        rows.append([of["base"], solver_facts.ABLATIONS[of["ablation"]],
                     "all" if of["size_class"] == ALL else size_class(of["size_class"]), int(of["problems"]),
                     _with_interval(of["ratio"], of["ratio_low"], of["ratio_high"]),
                     f"{share_of(of['verified_share'])}, {share_of(of['base_verified_share'])}", f"{false}, {before}"])
    return _table(["solver", "version", "rows", "problems", "time", "right", "false"], rows, "llrrrrr")


def ablations(inputs: Inputs) -> pd.DataFrame:
    """The analysis' table at the main tier, by solver; empty without ablations."""
    table = choice.table(inputs, "ablation", choice.main_tier(inputs))
    return pd.concat([own for _, own in table.groupby("solver", sort=False)]) if len(table) else table


# ----- which backend

def choices(inputs: Inputs, detailed: bool = False) -> Table | None:
    """The rule of decision.py, by size and redundancy, a column per tier.

    @param detailed  with numbers of problems and shares, and the peers that are faster
    """
    tiers = choice.shown_tiers(inputs)
    rows: dict[tuple, dict] = {}
    for found in decision.by_class(inputs):
        ranked = found.own or found.everyone
        best, peer = ranked[0], next((rival for rival in found.everyone if not rival.own), None)
        after = [f"next {key(ranked[1].solver)} {formats.ratio(ranked[1].mean / best.mean)}×"] if ranked[1:] else []
        if detailed:
            after.insert(0, f"{formats.percent(best.share)} verified")
            if peer is not None and peer.mean < best.mean:
                after.append(f"faster: {key(peer.solver)} {formats.ratio(peer.mean / best.mean)}×")
        row = rows.setdefault((found.size_class, found.redundant), {"problems": found.problems})
        name = f"**{key(best.solver)}**" if detailed else key(best.solver)
        row[found.tier] = "\n".join(filter(None, [f"{name} {seconds(best.mean)}", "; ".join(after)]))
    return _table(["rows", "redundant", *["problems"] * detailed, *(f"tier {power(tier)}" for tier in tiers)],
                  [[size_class(of), "yes" if redundant else "no", *[row["problems"]] * detailed,
                    *(row.get(tier, DASH) for tier in tiers)] for (of, redundant), row in rows.items()],
                  "llr" + "l" * len(tiers) if detailed else "")


def within_deadlines(inputs: Inputs) -> Table | None:
    """Per accuracy and size of sequences, and per deadline, the solver that misses the smallest share of steps."""
    found = decision.by_deadline(inputs)
    if not found:
        return None

    def words(of: dict | None) -> str:
        if of is None:
            return DASH
        missed = f"{formats.percent(of['missed'])} missed" if of["missed"] else "none missed"
        if of["next"]:
            share, p99, solver = of["next"]
            missed += f"; next {key(solver)}: {formats.percent(share) if share else 'none'}, {seconds(p99)}"
        return f"{key(of['solver'])} p99 {seconds(of['p99'])}\n{missed}"

    limits = [f"{seconds(of['deadline_s'])} a step" for of in found[0]["choices"]]
    return Table(["accuracy", "rows", *limits],
                 [[power(row["tier"]), row["size"], *map(words, row["choices"])] for row in found],
                 "ll" + "l" * len(limits))


# ----- what is right

def coverage(inputs: Inputs) -> Table | None:
    """Share verified of all solvers at the shown tiers, and wrong claims: a row per solver, a column per tier."""
    def words(of: pd.Series) -> str:
        marks = {"false_successes": "✗", "below_tier": "↓", "below_floor": "⌊"}
        wrong = [f"{mark} {int(of[column])}" for column, mark in marks.items() if of[column]]
        unasked = [f"{NOT_ASKED_MARK} {int(of['not_asked'])}"] * bool(of["not_asked"])
        share = [share_of(of["verified_share"])] if of["not_asked"] < of["problems"] else []
        return " · ".join(share + wrong + unasked)

    found = {tier: choice.table(inputs, "coverage", tier).set_index("solver") for tier in choice.shown_tiers(inputs)}
    found = {tier: table for tier, table in found.items() if len(table)}
    return _table(["solver", *(f"tier {power(tier)}" for tier in found)],
                  [[key(solver), *(words(table.loc[solver]) if solver in table.index else DASH for table in found.values())]
                   for solver in inputs.in_order(solver for table in found.values() for solver in table.index)])


def robustness(inputs: Inputs) -> Table | None:
    """Problems that are meant to break something, at the main tier."""
    cells = pathological(inputs)
    cells = cells[cells["tier"] == choice.main_tier(inputs)]
    counts = {"verified": cells["verdict"] == VERIFIED, "proved infeasible": cells["proved_infeasible"].astype(bool),
              "infeasible within rounding": within_rounding(cells),
              "false successes": cells["verdict"] == FALSE_SUCCESS, "below the tier": cells["verdict"] == BELOW_TIER,
              "excluded": cells["excluded"] != "", NOT_ASKED: cells["verdict"] == NOT_ASKED}
    return _table(["solver", *counts], [
        [key(solver), *(int(holds[cells["solver"] == solver].sum()) for holds in counts.values())]
        for solver in inputs.in_order(cells["solver"])])


def pathological(inputs: Inputs) -> pd.DataFrame:
    cells = inputs.cells
    return cells[cells["set"] == PATHOLOGICAL]


def origins(inputs: Inputs) -> Table | None:
    """A row per solver and a column per origin, at the main tier: the share verified, and its time over that of the
    fastest right solver of each problem. None where all problems are of one origin."""
    table = choice.table(inputs, "origins", choice.main_tier(inputs))
    there = [origin for origin in ORIGINS if len(table) and origin in set(table["origin"])]
    if len(there) < 2:
        return None
    by = table.set_index(["solver", "origin"])
    most = table.groupby("origin")["problems"].max()

    def words(solver: str, origin: str) -> str:
        if (solver, origin) not in by.index:
            return DASH
        of = by.loc[(solver, origin)]
        ratio = f"{times(of['ratio'])}×" if math.isfinite(of["ratio"]) else "✗"
        sample = f" of {int(of['problems'])}" if of["problems"] < most[origin] else ""
        return f"{share_of(of['verified_share'])}{sample} · {ratio}"

    return Table(["solver", *(f"{ORIGINS[origin]} ({most[origin]})" for origin in there)],
                 [[key(solver), *(words(solver, origin) for origin in there)] for solver in
                  inputs.in_order(table["solver"])])


# ----- sequences and motion

def sequences(inputs: Inputs, detailed: bool = False) -> Table | None:
    """Latency of a step from a warm start, and by how much a cold start takes longer.

    @param detailed  with the tier asked for and the interval of the gain, the largest gain first
    """
    table = decision.passes(inputs, choice.main_tier(inputs))
    rows = []
    if not table.empty:
        table = table.sort_values("warm_gain", ascending=False) if detailed else \
            table.set_index("solver", drop=False).loc[inputs.in_order(table["solver"])]
    for of in table.to_dict("records"):
        gain = _with_interval(of["warm_gain"], of["warm_gain_low"], of["warm_gain_high"]) if detailed else \
            f"{of['warm_gain']:.2f}" if math.isfinite(of["warm_gain"]) else DASH
        rows.append([key(of["solver"]), *[power(of["tier"])] * detailed, share_of(of["verified"] / of["steps"]),
                     *(seconds(of[level]) for level in ("p50", "p99", "max")), gain])
    return _table(["solver", *["asked for"] * detailed, "verified", "median", "99 %", "largest", "cold over warm"],
                  rows if detailed else rows[:_MOST_SOLVERS])


def motions(inputs: Inputs) -> list[tuple[str, str, Table]]:
    """(scene, level, table): worst values of every solver and tolerance, and counts at the end."""
    found = []
    scenes = () if inputs.motion is None else inputs.motion.groupby(["scene", "level"], sort=False)
    for (scene, level), table in scenes:
        rows = []
        loosest_first = table.sort_values("tolerance", ascending=False, kind="stable")
        runs = loosest_first.groupby(["solver", "tolerance"], sort=False)
        order = list(dict.fromkeys(table["solver"]))
        for _, run in sorted(runs, key=lambda part: order.index(part[0][0])):
            last = run.iloc[-1]
            rows.append([key(last["solver"]), power(last["tolerance"]),
                         *(residual(run[of].max()) for of in ("energy_error", "penetration", "joint_error", "distance")),
                         seconds(last["solve_time_s"] / max(1, last["step"])),
                         *(int(last[of]) for of in ("solves", "failed", "not_passed")),
                         f"**{last['false_successes']}**" if last["false_successes"] else 0, last["stopped"]])
        columns = ["solver", "tolerance", "energy error", "penetration [m]", "joint error [m]", "distance [m]",
                   "time a step", "solves", "failed", "not passed", "false", "stopped"]
        found.append((scene, level, Table(columns, rows, "ll" + "r" * 9 + "l")))
    return found


def settings(inputs: Inputs) -> Table:
    """How every solver was set, whose it is, and what it was given."""
    limits = {entry["solver"]: entry for campaign in inputs.campaigns for entry in campaign.info.get("size_limits", [])}
    rows = []
    for entry in map(inputs.entries.get, inputs.keys):
        limit = next((limits[name] for name in limits if f"{entry['key']}-".startswith(name + "-")), None)
        values = ", ".join(f"{name} = {value}" for name, value in entry.get("settings", {}).items())
        whose = f"{solver_facts.ORIGINS.get(entry['origin'], '')} {entry.get('library_version', '')}"
        rows.append([key(entry["key"]), entry.get("method", ""), whose.strip(),
                     f"{solver_facts.setting(entry)} {values}".strip(), solver_facts.TOLERANCES[entry["tolerance"]],
                     f"{limit['largest']} rows: {limit['reason']}" if limit else "any", entry.get("licence", "")])
    return Table(["solver", "method", "whose", "settings", "stops by", "largest problem given", "licence"], rows,
                 "lwlwlww")


# Name of the file -> table of papers.
PAPERS: dict[str, Callable[[Inputs], Table | None]] = {
    "headline": lambda inputs: by_solver(headline(inputs)) if len(inputs.cells) and headline(inputs).solvers else None,
    "coverage": coverage, "origins": origins, "sequences": sequences,
}
