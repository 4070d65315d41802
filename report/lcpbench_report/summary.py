"""What the data say, in ten lines at most. Every figure is computed; a line whose data are absent is left out."""

import math

from . import choice, decision, formats, shown_tables
from .choice import main_tier
from .headline_table import ClassRow, Headline, headline, low, verdicts
from .inputs import Inputs
from .statistics.cells import BELOW_TIER, FALSE_SUCCESS, NOT_RUN, VERIFIED, within_rounding
from .statistics.class_times import RATIO
from .statistics.load import ORIGINS
from .statistics.rivals import DOMINATED, DOMINATES, FASTER, FASTEST, PORTFOLIO

MOST_LINES = 13
_NAMES = {PORTFOLIO: "the portfolio of peers", FASTEST: "the fastest peer of each problem"}
# Rankings that correlate as much, by the lower end of the interval, are called the same, or alike.
_SAME, _ALIKE = 0.95, 0.8


def summary_lines(inputs: Inputs) -> list[str]:
    """Plain text; solver keys in backticks."""
    of_cells = (_what, lambda of: peers(headline(of)), _coverage, false_successes, _fastest, _by_size, origins,
                _accuracy, _robustness, friction)
    rules = (*of_cells, _sequences, _motion, _scaling) if len(inputs.cells) else (_sequences, _motion)
    return [line for rule in rules if (line := rule(inputs))][:MOST_LINES]


def _keys(solvers: list[str], most: int = 6) -> str:
    shown = [f"`{solver}`" for solver in solvers[:most]]
    if len(solvers) > most:
        shown.append(f"{len(solvers) - most} more")
    return formats.words(shown)


def _what(inputs: Inputs) -> str:
    cells = inputs.cells
    rows = [about["rows"] for about in inputs.problems.values()]
    others = f" and {formats.plural(len(inputs.peers), 'setting')} of other projects' solvers" if inputs.peers else ""
    return (f"{formats.plural(len(inputs.own), 'solver')} of ours{others} on {len(inputs.problems)} problems of "
            f"{cells['family'].nunique()} families, {min(rows)} to {max(rows)} rows, at "
            f"{formats.words([formats.power(t) for t in inputs.tiers])}: {len(cells)} cells, each answer judged by one "
            "verifier, each time from the caller's arrays to the forces of a problem that the solver has not seen.")


def _coverage(inputs: Inputs) -> str:
    counted = inputs.counted
    if counted.empty:
        return ""
    # Where a campaign was run with some solvers only, it says nothing of the others.
    turns = counted.groupby(["problem", "tier"])["solver"].transform("nunique")
    common = counted[turns == turns.max()]
    problems = common["problem"].nunique()
    verified = (common["verdict"] == VERIFIED).groupby(common["solver"]).sum()
    cells = common.groupby("solver").size()
    whole = [solver for solver in inputs.in_order(cells.index) if verified[solver] == cells[solver]]
    if whole:
        return (f"All of the {problems} problems that count and that every solver was run on are verified at every tier "
                f"by {_keys(whole)}.")
    best = max(inputs.in_order(cells.index), key=verified.get)
    return (f"No solver verifies all of the {problems} problems that count at every tier; `{best}` comes closest, with "
            f"{int(verified[best])} of {int(cells[best])} cells.")


def false_successes(inputs: Inputs) -> str:
    """Two figures: what claims to have solved what it was asked for, and what was never asked."""
    cells = inputs.cells
    ran = cells[~cells["verdict"].isin(NOT_RUN)]
    own, asked = ran["solver"].isin(inputs.own), ran["asked"].astype(bool)
    false = ran["verdict"] == FALSE_SUCCESS
    text = (f"False successes (claimed solved, refuted by the verifier), over all tiers: {int((false & own).sum())} in "
            f"{int(own.sum())} solves of ours")
    if not inputs.peers:
        return text + "."
    most = ran[false & ~own]["solver"].value_counts()
    worst = [f"`{solver}` {count}" for solver, count in most.items()][:3]
    text += (f", {int((false & ~own).sum())} in {int((asked & ~own).sum())} of other projects' solvers that were asked for "
             "the tier: the adapter passes it on, or the method is direct" + (f" (most: {', '.join(worst)})" if worst else ""))
    if asked.all():
        return text + "."
    return (text + f". Solvers that run with their library's own tolerance and were never asked for the tier end below it "
            f"in {int((ran['verdict'] == BELOW_TIER).sum())} of {int((~asked).sum())} solves.")


def _fastest(inputs: Inputs) -> str:
    tier = main_tier(inputs)
    means = choice.table(inputs, "means", tier).sort_values("mean")
    if len(means) < 2:
        return ""
    first, second = means.iloc[0], means.iloc[1]
    pairs = choice.table(inputs, "pairwise", tier)
    pairs = pairs[pairs["a"] == first["solver"]]
    won = int((pairs["verdict"] == "A faster").sum())
    return (f"Fastest over all sizes at {formats.power(tier)}: `{first['solver']}`, shifted geometric mean "
            f"{formats.seconds(first['mean'])} with failures at the time limit; next is `{second['solver']}` with "
            f"{formats.ratio(second['mean'] / first['mean'])} times as much. In pairwise tests, corrected for their "
            f"number, `{first['solver']}` is faster than {won} of {len(pairs)} others.")


def _by_size(inputs: Inputs) -> str:
    cells, parts = choice.main_cells(inputs), []
    for size_class in choice.size_classes(inputs, cells):
        ranked = decision.contenders(cells[cells["size_class"] == size_class], inputs.own)
        if ranked:
            best = ranked[0]
            parts.append(f"{_rows([formats.size_class(size_class)])} `{best.solver}` ({formats.seconds(best.mean)})")
    return f"By size, among those that verify as much as any: {'; '.join(parts)}." if len(parts) > 1 else ""


def origins(inputs: Inputs) -> str:
    """Whether the ranking of solvers changes with where problems come from."""
    table = choice.table(inputs, "rank_correlation", main_tier(inputs))
    if table.empty:
        return ""
    parts = [f"{ORIGINS[of['origin']]} and {ORIGINS[of['other']]} {of['correlation']:.2f} "
             f"({of['correlation_low']:.2f}–{of['correlation_high']:.2f})" for of in table.to_dict("records")]
    least = table.loc[table["correlation"].idxmin()]
    words = ("hardly changes" if table["correlation_low"].min() >= _SAME
             else "changes little" if table["correlation_low"].min() >= _ALIKE
             else f"changes, most between {ORIGINS[least['origin']]} and {ORIGINS[least['other']]}")
    return (f"With the origin of problems the ranking of solvers {words}: rank correlations at "
            f"{formats.power(main_tier(inputs))}, in the size classes that two origins have in common, are "
            f"{'; '.join(parts)}.")


def peers(found: Headline) -> str:
    """First where nothing is decided and where we win, and at the end where we lose."""
    if found.no_peer:
        return f"Nothing here compares with other projects' solvers: {found.no_peer}."
    _, undecided, won = verdicts(found)
    name, parts = _NAMES[found.rival], []
    if won:
        parts.append(f"Against {name} we win at {formats.words([_told(row, found.rival, 'of its time') for row in won])}.")
    if undecided:
        parts.append(f"Undecided, because the interval contains 1: {_rows([formats.size_class(row.size_class) for row in undecided])}.")
    return " ".join([*parts, losses(found)]) if any(verdicts(found)) else ""


def losses(found: Headline) -> str:
    """How many members of the front ours dominates; and to whom we lose, at how many rows and by how much: the rival,
    single peers of the front, the fastest of each problem."""
    parts = []
    for rival in dict.fromkeys((found.rival, FASTEST)):
        lost = [row for row in found.classes if rival in row.rivals and low(row, rival) > 1]
        told = [_told(row, rival, "times its time") for row in lost]
        parts.append(f"to {_NAMES[rival]} " + (f"at {formats.words(told)}" if lost else "at no size"))
    front = [(row, of) for row in found.classes for of in row.rivals.values() if of.front and of.key != found.rival]
    for words, kind in (("that are faster and at least as often right", DOMINATES), ("that are faster, though less often right,", FASTER)):
        if told := [f"`{of.key}` at {_told(row, of.key, 'times its time')}" for row, of in front if of.relation == kind]:
            parts.append(f"to single peers {words} {formats.words(told)}")
    dominated = sum(of.relation == DOMINATED for _, of in front)
    start = ("On the fronts of single peers (no other is both faster and right on as much), ours is faster than "
             f"{dominated} of {len(front)}, and right at least as often. " if front else "")
    return f"{start}We lose {'; '.join(parts)}."


def _rows(size_classes: list[str]) -> str:
    return formats.words(size_classes) + (" row" if size_classes[-1:] == ["1"] else " rows")


def _told(row: ClassRow, rival: str, words: str) -> str:
    median = row.rivals[rival].ratio.median
    return f"{_rows([formats.size_class(row.size_class)])} ({formats.times(median)} {words})"


def _accuracy(inputs: Inputs) -> str:
    counted, tier = inputs.counted, min(inputs.tiers, default=0)
    proved = counted[(counted["tier"] == tier) & (counted["verdict"] == VERIFIED)
                     & counted["reference"].isin(("certified", "bounded")) & counted["w_error"].notna()]
    if proved.empty:
        return ""
    errors = proved.groupby("solver")["w_error"].quantile(0.99)
    most = proved["solver"].value_counts()
    enough = [solver for solver in inputs.keys if most.get(solver, 0) >= 0.95 * most.max()]
    best, worst = min(enough, key=errors.get), max(enough, key=errors.get)
    return (f"Against proved answers ({proved['problem'].nunique()} problems, {formats.power(tier)}) w of `{best}` is off "
            f"by at most {formats.residual(errors[best])} in 99 of 100 verified answers, of `{worst}` by "
            f"{formats.residual(errors[worst])} (of those that verify 95 % as many as any).")


def friction(inputs: Inputs) -> str:
    """Ours on problems with friction: right at every tier, its time, and that beside plain problems and peers."""
    of = inputs.friction
    if of is None or of.ours not in set(of.cells["solver"]):
        return ""
    shares = {tier: choice.table(of, "friction", tier).set_index("solver") for tier in choice.shown_tiers(of)}
    main = shares[main_tier(of)]
    own, plain = main.loc[of.ours], shown_tables.plain_times(inputs)
    rows = [inputs.problems[name]["rows"] for name in dict.fromkeys(of.cells["problem"])]
    parts = [f"With friction `{of.ours}` is right on {formats.words([formats.share_of(by.loc[of.ours, 'right_share']) for by in shares.values()])} at "
             f"{formats.words([formats.power(tier) for tier in shares])} of {int(own['solvable'])} problems of {min(rows)} to {max(rows)} rows, "
             f"median fresh time {formats.seconds(own['median_s'])} at {formats.power(main_tier(of))}"]
    over = [row.entries[of.ours].time_s / plain[row.size_class] for row in headline(of).classes
            if row.size_class in plain and of.ours in row.entries and math.isfinite(row.entries[of.ours].time_s)]
    if over:
        parts.append(f"by size class {formats.times(min(over))} to {formats.times(max(over))} times that of plain problems")
    for solver in of.peers:
        its = main.loc[solver]
        parts.append(f"{shown_tables.with_interval(*(its[name] for name in RATIO))} of the time of `{solver}`, which is right on "
                     f"{formats.share_of(its['right_share'])}")
    return "; ".join(parts) + "."


def _robustness(inputs: Inputs) -> str:
    cells = shown_tables.pathological(inputs)
    cells = cells[cells["tier"] == main_tier(inputs)]
    if cells.empty:
        return ""
    right = (cells["verdict"] == VERIFIED) | cells["proved_infeasible"].astype(bool) | within_rounding(cells)
    verified = cells[right]["solver"].value_counts()
    false = cells[cells["verdict"] == FALSE_SUCCESS]["solver"].value_counts()
    ranked = sorted(inputs.keys, key=lambda solver: (-verified.get(solver, 0), false.get(solver, 0)))[:3]
    parts = [f"`{solver}` {int(verified.get(solver, 0))}" for solver in ranked]
    return (f"Of {cells['problem'].nunique()} problems meant to break something, at {formats.power(main_tier(inputs))} "
            f"most are answered rightly (solved, or infeasible by a proof or within rounding) by {', '.join(parts)}; {len(false)} of "
            f"{cells['solver'].nunique()} solvers claim a wrong answer at least once.")


def _sequences(inputs: Inputs) -> str:
    rows = decision.passes(inputs, main_tier(inputs))
    if rows.empty:
        return ""
    most = rows["verified_share"].max()
    enough = rows[rows["verified_share"] >= decision.SHARE * most].sort_values(["p99", "p50"])
    best = enough.iloc[0]
    gains = enough[enough["warm_gain"].notna()].sort_values("warm_gain", ascending=False)
    gain = "" if gains.empty else (f"; a warm start gains most for `{gains.iloc[0]['solver']}` "
                                   f"({formats.ratio(gains.iloc[0]['warm_gain'])} times)")
    whole = inputs.in_order(rows.loc[rows["verified_share"] == 1, "solver"])
    every = f"; all are verified of {_keys(whole)}" if whole else ""
    return (f"Steps of motions, warm, asked for {formats.power(best['tier'])}: the least 99th percentile has "
            f"`{best['solver']}`, {formats.seconds(best['p99'])} (median {formats.seconds(best['p50'])}, largest "
            f"{formats.seconds(best['max'])}), which verifies {best['verified_share']:.2%} of {int(best['steps'])}"
            f"{every}{gain}.")


def _motion(inputs: Inputs) -> str:
    table = inputs.motion
    if table is None:
        return ""
    last = table.sort_values("step").groupby(["scene", "level", "solver", "tolerance"]).last().reset_index()
    strict = min(table["tolerance"])
    worst = table[table["tolerance"] == strict].groupby(["scene", "level", "solver"])["energy_error"].max().reset_index()
    parts = []
    for words, of in (("ours", True), ("other projects' solvers", False)):
        rows, errors = (some[some["solver"].isin(inputs.own) == of] for some in (last, worst))
        if len(rows):
            ended = int((rows["stopped"] == "").sum())
            parts.append(f"with {words} {ended} of {len(rows)} motions run to their end, and at {formats.power(strict)} the "
                         f"energy is off by {formats.residual(errors['energy_error'].median())} in the median and "
                         f"{formats.residual(errors['energy_error'].max())} at most (of the largest kinetic energy)")
    return f"Driven by a solver, {'; '.join(parts)}."


def _scaling(inputs: Inputs) -> str:
    """Exponents over all sizes would praise what has a large overhead; what counts is who is fast at the end."""
    cells = choice.main_cells(inputs)
    top = cells["rows"].max()
    ranked = decision.contenders(cells[cells["rows"] == top], inputs.own)
    if not ranked or top <= 100:
        return ""
    best = ranked[0]
    second = f"; next is `{ranked[1].solver}` with {formats.ratio(ranked[1].mean / best.mean)} times" if ranked[1:] else ""
    rows = choice.table(inputs, "scaling", main_tier(inputs))
    rows = rows[rows["solver"] == best.solver]
    growth = f"; over all sizes its time grows as n^{rows['exponent'].median():.2f} (median over families)" if len(rows) else ""
    return (f"At the largest size, {int(top)} rows, `{best.solver}` is the fastest of those that verify as much as any "
            f"({best.verified} of {best.problems}), with {formats.seconds(best.mean)}{second}{growth}.")
