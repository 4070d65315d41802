"""The tables that people read, each described once: summaries and README.md have them as Markdown, the page as HTML,
papers as LaTeX. None where the inputs do not have the part.
"""

import math
from collections.abc import Callable

import pandas as pd

from . import choice, formats, peers, solver_facts
from .formats import DASH, power, residual, seconds, share_of, size_class, times, with_interval
from .headline_table import Headline, headline
from .inputs import PATHOLOGICAL, Inputs
from .sentences import say
from .statistics.cells import (BELOW_TIER, CAUSES, CLOSE, ETA, EXCLUDED, FAR, NOT_ASKED, OUT_OF_TIME, SHIFTED, VERIFIED,
                               within_rounding)
from .statistics.class_times import ALL, RATIO
from .statistics.friction import refusers
from .statistics.model import ERROR_PARTS, ORIGINS
from .statistics.rivals import FASTEST, FLAGS, OPEN, PORTFOLIO, SEALED
from .studies import DRIVER
from .table import Table
from .table import code as key

NOT_ASKED_MARK = "○"
# Counts of the tables of coverage and friction -> marks.
_FALSE = {f"false_{cause}": mark for cause, mark in ((FAR, "✗"), (CLOSE, "≈"), (ETA, "η"), (SHIFTED, "↕"))}
_MARKS = _FALSE | {"below_tier": "↓", "below_floor": "⌊", "out_of_time": "⧖", "not_asked": NOT_ASKED_MARK}
_MOST_SOLVERS = 25  # of the table of sequences


def _table(columns: list[str], rows: list[list], align: str = "") -> Table | None:
    return Table(columns, rows, align) if rows else None


_RIVALS = {PORTFOLIO: "portfolio", FASTEST: "fastest peer of each problem"}
_GROUPS = ("own scenes", "engines")  # columns beside that of all


def classes(found: Headline) -> Table:
    """A row per size class: ours against the portfolio and the fastest peer of each problem."""
    shown = [key for key in _RIVALS if any(key in row.rivals for row in found.classes)]
    there = {group for row in found.classes for rival in row.rivals.values() for group in rival.ratios}
    groups = [group for group in _GROUPS if set(_GROUPS) <= there]
    parts = [(key, group) for key in shown for group in (ALL, *groups)]
    rows = []
    for row in found.classes:
        own = row.entries.get(found.own)
        rivals = [row.rivals[key].ratios.get(group) if key in row.rivals else None for key, group in parts]
        tails = [seconds(entry.p99_s) for entry in (own, row.entries.get(found.rival)) if entry and not math.isnan(entry.p99_s)]
        rows.append([size_class(row.size_class), _sample(row.problems, row.n_eff), own.launches if own else DASH, row.peers,
                     *((_time(own), share_of(own.share)) if own else (DASH, DASH)),
                     *(DASH if of is None else with_interval(*of) for of in rivals), ", ".join(tails) or DASH])
    return Table(["rows", "problems", "launches", "peers", key(found.own) if found.own else "ours", "right",
                  *(f"ours / {_RIVALS[key]}" if group == ALL else group for key, group in parts),
                  "99 %: ours, portfolio" if found.rival == PORTFOLIO else "99 %"], rows)


def front(found: Headline) -> Table | None:
    """A row per size class and peer of its Pareto front, and the portfolio."""
    rows = [[size_class(row.size_class), key(of.key), seconds(of.time_s), share_of(of.share),
             share_of(of.own_share), _sample(row.problems, row.n_eff) if of.key not in row.entries else
             _sample(row.entries[of.key].problems, row.entries[of.key].n_eff), of.launches,
             formats.percent(of.check_share), with_interval(*of.ratio), of.relation]
            for row in found.classes for of in row.rivals.values() if of.key != FASTEST]
    return _table(["rows", "peer", "time", "right", "ours right", "problems", "launches", "checks", "ours / it", "it is"], rows,
                  "llrrrrrrrl")


def equal_flags(inputs: Inputs) -> Table | None:
    """A row per instruction set, a column per size class: ours over the peers that are compiled for no less."""
    table = choice.table(inputs, "equal_flags", choice.main_tier(inputs))
    if table.empty:
        return None
    sizes = choice.size_classes(inputs, table)
    rows = []
    for (flags, own, rival), of in table.groupby(["flags", "own", "rival"], sort=False):
        by = of.set_index("size_class")
        rows.append([flags, f"{key(own)} / {key(rival)}", *(with_interval(*by.loc[one, RATIO]) if one in by.index else DASH
                                                            for one in sizes)])
    rows.sort(key=lambda row: list(FLAGS).index(row[0]))
    return Table(["compiled for", "ours / peer", *map(size_class, sizes)], rows, "ll" + "r" * len(sizes))


def short_equal_flags(inputs: Inputs) -> Table | None:
    """The front page's: a row per instruction set, the greater of the ratios of ours to codes that are compiled for no less."""
    table = choice.table(inputs, "equal_flags", choice.main_tier(inputs))
    if table.empty:
        return None
    sizes = choice.size_classes(inputs, table)
    most = table.sort_values("ratio").groupby(["flags", "size_class"])[RATIO].last()
    rows = [[flags, *(with_interval(*most.loc[(flags, one)]) if (flags, one) in most.index else DASH for one in sizes)]
            for flags in FLAGS if flags in most.index.get_level_values(0)]
    return _table(["ours compiled for", *map(size_class, sizes)], rows, "l" + "r" * len(sizes))


def short(found: Headline) -> Table | None:
    """The front page's: a row per size class, ours against the fastest single peer of the front and the portfolio."""
    rows = []
    for row in found.classes:
        own, single, portfolio, fastest = row.entries.get(found.own), row.single, *map(row.rivals.get, (PORTFOLIO, FASTEST))
        if own and row.rivals:
            rows.append([size_class(row.size_class), seconds(own.time_s), share_of(own.share),
                         *((f"{key(single.key)} ({seconds(single.time_s)})", with_interval(*single.ratio), share_of(single.share))
                           if single else (DASH,) * 3),
                         *((with_interval(*portfolio.ratio), share_of(portfolio.share)) if portfolio else (DASH,) * 2),
                         formats.share_interval(*fastest.peer_faster) if fastest else DASH])
    return _table(["rows", key(found.own), "right", "fastest single peer", "ours / it", "it is right", "ours / portfolio", "it is right",
                   "a peer is faster on"], rows, "lrrlrrrrr")


def by_solver(found: Headline) -> Table:
    """A row per solver, a column per size class."""
    return Table(["solver", *(size_class(row.size_class) for row in found.classes)],
                 [[key(solver), *(cell(row.entries.get(solver), row.problems) for row in found.classes)]
                  for solver in found.solvers])


def cell(entry: tuple | None, problems: int) -> str:
    if entry is None or not entry.attempted:
        return NOT_ASKED_MARK if entry and entry.not_asked else DASH
    verified = share_of(entry.share)
    sample = f" of {entry.problems}" if entry.problems < problems else ""
    if not math.isfinite(entry.time_s):
        return f"✗ {verified}{sample}"
    return _time(entry) + (f" · {verified}{sample}" if entry.share < 1 or sample else "")


def _time(entry: tuple) -> str:
    return f"**{seconds(entry.time_s)}**" if entry.best else seconds(entry.time_s)


def _sample(problems: int, n_eff: float) -> str:
    """Problems, and in parentheses what their weights are worth."""
    return f"{problems} ({n_eff:.0f})"


# ----- which backend


def choices(inputs: Inputs, detailed: bool = False) -> Table | None:
    """The rule of choice.py, by size and redundancy, a column per tier.

    @param detailed  with numbers of problems and shares, and the peers that are faster
    """
    tiers = inputs.tiers
    rows: dict[tuple, dict] = {}
    for found in choice.by_class(inputs):
        ranked = found.own or found.everyone
        best, peer = ranked[0], next((rival for rival in found.everyone if not rival.own), None)
        after = [f"next {key(ranked[1].solver)} {times(ranked[1].mean / best.mean)}×"] if ranked[1:] else []
        if detailed:
            after.insert(0, f"{formats.percent(best.share)} verified")
            if peer is not None and peer.mean < best.mean:
                after.append(f"faster: {key(peer.solver)} {times(peer.mean / best.mean)}×")
        row = rows.setdefault((found.size_class, found.redundant), {"problems": found.problems})
        name = f"**{key(best.solver)}**" if detailed else key(best.solver)
        row[found.tier] = "\n".join(filter(None, [f"{name} {seconds(best.mean)}", "; ".join(after)]))
    return _table(["rows", "redundant", *["problems"] * detailed, *(f"tier {power(tier)}" for tier in tiers)],
                  [[size_class(of), "yes" if redundant else "no", *[row["problems"]] * detailed,
                    *(row.get(tier, DASH) for tier in tiers)] for (of, redundant), row in rows.items()],
                  "llr" + "l" * len(tiers) if detailed else "")


def within_deadlines(inputs: Inputs) -> Table | None:
    """Per accuracy and size of sequences, and per deadline, the solver that misses the smallest share of steps."""
    found = choice.by_deadline(inputs)
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
        share = [share_of(of["verified_share"])] if of["not_asked"] < of["problems"] else []
        return " · ".join(share + _marked(of, _MARKS))

    found = {tier: choice.table(inputs, "coverage", tier).set_index("solver") for tier in inputs.tiers}
    found = {tier: table for tier, table in found.items() if len(table)}
    return _table(["solver", *(f"tier {power(tier)}" for tier in found)],
                  [[key(solver), *(words(table.loc[solver]) if solver in table.index else DASH for table in found.values())]
                   for solver in inputs.in_order(solver for table in found.values() for solver in table.index)])


def _marked(counts: pd.Series, marks: dict[str, str]) -> list[str]:
    return [f"{mark} {int(counts[name])}" for name, mark in marks.items() if counts[name]]


def league(inputs: Inputs) -> Table | None:
    """A row per solver, at the main tier: what it verifies and claims wrongly, its mean time, and its errors."""
    means, covered, errors = (choice.table(inputs, name, choice.main_tier(inputs)) for name in ("means", "coverage", "delivered"))
    if means.empty:
        return None
    found = covered.set_index("solver").join(means.set_index("solver")[["mean", "over_best"]]).join(
        errors.set_index("solver")[["rho_median", "w_error_p99"]]).sort_values("mean")
    return Table(["solver", "right", "false", "below the tier", "out of time", "mean time", "over the best", "median ρ",
                  "99 % of errors of w"],
                 [[key(solver), share_of(of["verified_share"]) if of["attempted"] else DASH, " · ".join(_marked(of, _FALSE)) or 0,
                   int(of["below_tier"]), int(of["out_of_time"]), seconds(of["mean"]), times(of["over_best"]),
                   residual(of["rho_median"]), residual(of["w_error_p99"])]
                  for solver, of in found.iterrows()])


def winners(inputs: Inputs) -> Table | None:
    """A row per family, a column per size class: the solver of the rule of choice.py, and its mean time."""
    cells = choice.main_cells(inputs)
    sizes = choice.size_classes(inputs, cells)
    best = {of: next(iter(choice.contenders(own, inputs.own)), None) for of, own in cells.groupby(["family", "size_class"])}
    rows = [[family, *(f"{key(found.solver)}\n{seconds(found.mean)}" if (found := best.get((family, one))) else DASH for one in sizes)]
            for family in cells["family"].unique()]
    return _table(["family", *map(size_class, sizes)], rows, "l" * (len(sizes) + 1))


def robustness(inputs: Inputs) -> Table | None:
    """What becomes of problems that are meant to break something."""
    cells = pathological(inputs)
    counts = {"verified": cells["verdict"] == VERIFIED, "proved infeasible": cells["proved_infeasible"].astype(bool),
              "infeasible within rounding": within_rounding(cells),
              **{f"false: {cause}": cells["cause"] == cause for cause in CAUSES}, "below the tier": cells["verdict"] == BELOW_TIER,
              **{of: cells["verdict"] == of for of in (OUT_OF_TIME, EXCLUDED)}, NOT_ASKED: cells["verdict"] == NOT_ASKED}
    return _table(["solver", *counts], [
        [key(solver), *(int(holds[cells["solver"] == solver].sum()) for holds in counts.values())]
        for solver in inputs.in_order(cells["solver"])])


def pathological(inputs: Inputs) -> pd.DataFrame:
    """Cells of the main tier on the problems that are meant to break something."""
    return inputs.cells[(inputs.cells["set"] == PATHOLOGICAL) & (inputs.cells["tier"] == choice.main_tier(inputs))]


def origins(inputs: Inputs) -> Table | None:
    """A row per solver and a column per origin, at the main tier: the share verified, and its time over that of the
    fastest right solver of each problem. None where all problems are of one origin."""
    return _by_origin(inputs, choice.table(inputs, "origins", choice.main_tier(inputs)), 2)


def sealed(inputs: Inputs) -> Table | None:
    """A row per size class, at the main tier: the share right and the median time over that of the fastest right peer of
    each problem, of open problems and of those of sealed families and engines (campaign.json)."""
    def words(of: pd.Series | None) -> list:
        return [0, DASH, DASH] if of is None else [int(of["problems"]), share_of(of["own_share"]), with_interval(*of[RATIO])]

    columns = ["problems", "right", "ours / fastest right peer"]
    return _table(["rows", *(f"open: {name}" for name in columns), *(f"sealed: {name}" for name in columns)],
                  [[size_class(one), *words(parts.get(OPEN)), *words(parts.get(SEALED))]
                   for one, parts in _sealed(inputs).items()], "lrrrrrr")


def sealed_apart(inputs: Inputs) -> str:
    """In which size classes intervals of sealed and open problems do not overlap; "" without sealed problems."""
    found = {one: [of[RATIO].tolist() for of in parts.values()] for one, parts in _sealed(inputs).items() if len(parts) == 2}
    return say("sealed_apart", compared=len(found), apart=[one for one, (first, second) in found.items()
                                                           if first[2] < second[1] or second[2] < first[1]]) if found else ""


def _sealed(inputs: Inputs) -> dict[str, dict[str, pd.Series]]:
    """Size class -> OPEN, SEALED -> row of the table `rivals`."""
    found: dict[str, dict[str, pd.Series]] = {}
    for _, of in choice.table(inputs, "rivals", choice.main_tier(inputs)).iterrows():
        if of["origin"] in (OPEN, SEALED) and of["problems"]:
            found.setdefault(of["size_class"], {})[of["origin"]] = of
    return found


def literature(inputs: Inputs) -> Table | None:
    """The same of published problems, which count in nothing else."""
    return _by_origin(inputs, choice.table(inputs, "origins", choice.main_tier(inputs), counted=False), 1)


def _by_origin(inputs: Inputs, table: pd.DataFrame, least: int) -> Table | None:
    """@param least  origins, or there is no table"""
    there = [origin for origin in ORIGINS if len(table) and origin in set(table["origin"])]
    if len(there) < least:
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


# ----- friction


def friction_classes(inputs: Inputs) -> Table | None:
    """With friction, a row per size class: which of ours to choose, how often ours is right at every tier, and its time
    beside that of plain problems and of peers."""
    if inputs.friction is None:
        return None
    of, found = inputs.friction, headline(inputs.friction)
    ours, tiers = key(found.own), of.tiers
    shares = {tier: choice.table(of, "class_times", tier).set_index(["size_class", "solver"])["verified_share"] for tier in tiers}
    plain, against = plain_times(inputs), any(FASTEST in row.rivals for row in found.classes)
    rows = []
    for row in found.classes:
        cells = choice.main_cells(of)
        best = choice.contenders(cells[(cells["size_class"] == row.size_class) & cells["solver"].isin(of.own)], of.own)
        own = row.entries.get(found.own)
        rows.append([size_class(row.size_class), row.problems, f"**{key(best[0].solver)}**" if best else DASH,
                     _time(own) if own else DASH,
                     *(share_of(by.get((row.size_class, found.own), 0.0)) if own else DASH for by in shares.values()),
                     *[times(own.time_s / plain[row.size_class]) if own and row.size_class in plain else DASH] * bool(plain),
                     *[with_interval(*row.rivals[FASTEST].ratio) if FASTEST in row.rivals else DASH] * against])
    columns = ["rows", "problems", "choose", ours, *(f"right at {power(tier)}" for tier in tiers),
               *["over plain problems"] * bool(plain), *[f"ours / {_RIVALS[FASTEST]}"] * against]
    return _table(columns, rows, "lrl" + "r" * (len(columns) - 3))


def plain_times(inputs: Inputs) -> dict[str, float]:
    """Size class -> median fresh time of ours on problems without friction, where there are any."""
    table = choice.table(inputs, "class_times", choice.main_tier(inputs))
    table = table[table["solver"] == inputs.ours] if len(table) else table
    return {of.size_class: of.median_s for of in table.itertuples() if math.isfinite(of.median_s)}


def friction(inputs: Inputs) -> Table | None:
    """Problems with friction or bounded rows: a row per set and solver that takes some, a column per tier; and the time
    of ours over its."""
    found = _friction(inputs)
    ours = key(inputs.ours)
    tiers = [tier for tier in inputs.tiers if len(found) and (found["tier"] == tier).any()]
    of_sets = _where_several(found)
    rows = []
    for (of_set, solver), own in found.groupby(["set", "solver"], sort=False):
        by = own.set_index("tier")
        by["false_far"] += by["false_infeasible"]
        words = [" · ".join([share_of(of["right_share"]), *_marked(of, _FALSE)]) if of["solvable"] else DASH
                 for of in map(by.loc.__getitem__, tiers)]
        main = by.loc[choice.nearest(tiers)]
        rows.append([*of_sets(of_set), key(solver), peers.law(solver) or DASH, f"{int(main['taken'])} of {int(main['problems'])}", *words,
                     share_of(main["lawful_share"]) if main["solvable"] else DASH,
                     seconds(main["median_s"]) if math.isfinite(main["median_s"]) else "✗",
                     with_interval(*(main[name] for name in RATIO))])
    return _table([*of_sets("problems"), "solver", "law", "takes", *(f"right at {power(tier)}" for tier in tiers),
                   "by its own law", "median time", f"{ours} / it"],
                  rows, "l" * len(of_sets("problems")) + "ll" + "r" * (len(tiers) + 4))


def friction_errors(inputs: Inputs) -> Table | None:
    """What the wrong answers at the strictest tier are made of: a row per set and solver that has some."""
    found = _friction(inputs)
    found = found[(found["tier"] == min(inputs.tiers, default=0)) & found["rho"].notna()]
    # What rounding makes has no column.
    parts = [part for part in ERROR_PARTS if len(found) and (found[f"{part}_share"] >= 0.005).any()]
    of_sets = _where_several(found)
    rows = [[*of_sets(of["set"]), key(of["solver"]), int(of["wrong"]), residual(of["rho"]), residual(of["model_rho"]),
             *(formats.percent(round(of[f"{part}_share"], 3)) for part in parts)] for of in found.to_dict("records")]
    return _table([*of_sets("problems"), "solver", "wrong", "ρ", "ρ of its own model", *(part.replace("_", " ") for part in parts)],
                  rows, "l" * len(of_sets("problems")) + "l" + "r" * (len(parts) + 3))


def _where_several(found: pd.DataFrame) -> Callable[[str], list[str]]:
    """A cell of the column of sets, which is there where there are several."""
    return lambda cell: [cell] * (found["set"].nunique() > 1)


def _friction(inputs: Inputs) -> pd.DataFrame:
    """Rows of the analysis' table, of solvers that take something, as the registry has them."""
    found = inputs.analysis.get("friction", pd.DataFrame(columns=["set", "tier", "solver", "taken", "rho"]))
    order = {solver: place for place, solver in enumerate(inputs.keys)}
    return found[found["taken"] > 0].sort_values("solver", key=lambda keys: keys.map(order), kind="stable")


def not_taking_friction(inputs: Inputs) -> str:
    """Who takes no such problem, in words; "" where everybody takes some."""
    found = refusers(inputs.cells) if len(inputs.cells) else []
    return f"Not taken by {formats.words([key(solver) for solver in inputs.in_order(found)])}." if found else ""


# ----- sequences and motion


def sequences(inputs: Inputs, detailed: bool = False) -> Table | None:
    """Latency of a step from a warm start, and by how much a cold start takes longer.

    @param detailed  with the tier asked for and the interval of the gain, the largest gain first
    """
    table = choice.passes(inputs, choice.main_tier(inputs))
    rows = []
    if not table.empty:
        table = table.sort_values("warm_gain", ascending=False) if detailed else \
            table.set_index("solver", drop=False).loc[inputs.in_order(table["solver"])]
    for of in table.to_dict("records"):
        gain = with_interval(of["warm_gain"], of["warm_gain_low"], of["warm_gain_high"]) if detailed else \
            f"{of['warm_gain']:.2f}" if math.isfinite(of["warm_gain"]) else DASH
        rows.append([key(of["solver"]), *[power(of["tier"])] * detailed, share_of(of["verified"] / of["steps"]),
                     *(seconds(of[level]) for level in ("p50", "p99", "max")), gain])
    return _table(["solver", *["asked for"] * detailed, "verified", "median", "99 %", "largest", "cold over warm"],
                  rows if detailed else rows[:_MOST_SOLVERS])


_OF_MOTION = {"energy_error": "energy error", "penetration": "penetration [m]", "joint_error": "joint error [m]",
              "distance": "distance [m]"}
_OF_FRICTION = {"distance": "distance [m]", "creep": "creep [m]", "lost_gap": "lost gap [m]", "created": "energy created"}


def motions(motion: pd.DataFrame | None, friction: bool = False) -> list[tuple[str, str, Table]]:
    """(scene, level, table): worst values of every driver and tolerance, and counts at the end.

    @param friction  what friction errors do
    """
    found, figures = [], _OF_FRICTION if friction else _OF_MOTION
    scenes = () if motion is None else motion.groupby(["scene", "level"], sort=False)
    for (scene, level), table in scenes:
        rows = []
        loosest_first = table.sort_values("tolerance", ascending=False, kind="stable")
        runs = loosest_first.groupby([DRIVER, "tolerance"], sort=False)
        order = list(dict.fromkeys(table[DRIVER]))
        for _, run in sorted(runs, key=lambda part: order.index(part[0][0])):
            last = run.iloc[-1]
            rows.append([key(last[DRIVER]), power(last["tolerance"]), *(residual(run[of].max()) for of in figures),
                         seconds(last["solve_time_s"] / max(1, last["step"])),
                         *(int(last[of]) for of in ("solves", "failed", "not_passed")),
                         f"**{last['false_successes']}**" if last["false_successes"] else 0, last["stopped"]])
        columns = ["solver", "tolerance", *figures.values(), "time a step", "solves", "failed", "not passed", "false", "stopped"]
        found.append((scene, level, Table(columns, rows, "ll" + "r" * 9 + "w")))
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
    "front": lambda inputs: front(headline(inputs)) if len(inputs.cells) else None,
    "coverage": coverage, "origins": origins, "sealed": sealed, "literature": literature, "equal-flags": equal_flags,
    "friction-classes": friction_classes, "friction": friction,
    "friction-errors": friction_errors, "sequences": sequences,
}
