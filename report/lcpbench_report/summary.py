"""What the data say, in MOST_LINES at most. Every figure is computed; a line whose data are absent is left out."""

import math

from . import choice, peers as peer_facts, shown_tables, studies
from .choice import main_tier
from .headline_table import Headline, headline, verdicts
from .inputs import Inputs
from .sentences import say, told
from .statistics.cells import BELOW_TIER, FAR, FALSE_SUCCESS, VERIFIED, ran, within_rounding
from .statistics.class_times import RATIO
from .statistics.rivals import DOMINATED, DOMINATES, FASTER, FASTEST, PORTFOLIO

MOST_LINES = 14
_MOST_PEERS = 4  # that a sentence names
_NAMES = {PORTFOLIO: "the portfolio of peers", FASTEST: "the fastest peer of each problem"}
_KINDS = {DOMINATES: "that are faster and at least as often right", FASTER: "that are faster, though less often right,"}


def summary_lines(inputs: Inputs) -> list[str]:
    """Plain text; solver keys in backticks."""
    of_cells = (_what, lambda of: peers(headline(of)), _coverage, false_successes, _fastest, _by_size,
                _accuracy, _robustness, friction)
    of_motions = (_sequences, _motion, friction_motion)
    rules = (*of_cells, *of_motions, _scaling) if len(inputs.cells) else of_motions
    return [line for rule in rules if (line := rule(inputs))][:MOST_LINES]


def _what(inputs: Inputs) -> str:
    return say("what", inputs=inputs, rows=[about["rows"] for about in inputs.problems.values()])


def _coverage(inputs: Inputs) -> str:
    counted = inputs.counted
    if counted.empty:
        return ""
    # Where a campaign was run with some solvers only, it says nothing of the others.
    turns = counted.groupby(["problem", "tier"])["solver"].transform("nunique")
    common = counted[turns == turns.max()]
    verified = (common["verdict"] == VERIFIED).groupby(common["solver"]).sum()
    cells = common.groupby("solver").size()
    solvers = inputs.in_order(cells.index)
    best = max(solvers, key=verified.get)
    return say("coverage", whole=[solver for solver in solvers if verified[solver] == cells[solver]], best=best,
               problems=common["problem"].nunique(), verified=verified[best], cells=cells[best])


def false_successes(inputs: Inputs) -> str:
    """Two figures: what claims to have solved what it was asked for, and is far from it, and what was never asked."""
    tried = inputs.cells[ran(inputs.cells)]
    own, asked = tried["solver"].isin(inputs.own), tried["asked"].astype(bool)
    false = tried["cause"] == FAR
    return say("false_successes", own=((false & own).sum(), own.sum()), unasked=(~asked).sum(),
               peers=((false & ~own).sum(), (asked & ~own).sum()) if inputs.peers else None,
               others=((tried["verdict"] == FALSE_SUCCESS) & ~false).sum(),
               worst=list(tried[false & ~own]["solver"].value_counts().items())[:3],
               below=(tried["verdict"] == BELOW_TIER).sum())


def _fastest(inputs: Inputs) -> str:
    tier = main_tier(inputs)
    means = choice.table(inputs, "means", tier).sort_values("mean").to_dict("records")
    if len(means) < 2:
        return ""
    return say("fastest", tier=tier, first=means[0], second=means[1])


def _by_size(inputs: Inputs) -> str:
    cells = choice.main_cells(inputs)
    parts = [(size_class, ranked[0]) for size_class in choice.size_classes(inputs, cells)
             if (ranked := choice.contenders(cells[cells["size_class"] == size_class], inputs.own))]
    return say("by_size", parts=parts) if len(parts) > 1 else ""


def peers(found: Headline) -> str:
    """First where nothing is decided and where we win, and at the end where we lose."""
    if found.no_peer:
        return say("no_peer", found=found)
    _, undecided, won = verdicts(found)
    wins = say("wins", won=won, undecided=undecided, found=found, name=_NAMES[found.rival])
    return " ".join(filter(None, [wins, losses(found)])) if any(verdicts(found)) else ""


def losses(found: Headline) -> str:
    """How many members of the front ours dominates; and to whom we lose, at how many rows and by how much: the rival,
    single peers of the front, the fastest of each problem."""
    lost = [(_NAMES[rival], rival, [row for row in found.classes if rival in row.rivals and row.rivals[rival].ratio.low > 1])
            for rival in dict.fromkeys((found.rival, FASTEST))]
    front = [(row, of) for row in found.classes for of in row.rivals.values() if of.front and of.key != found.rival]
    singles = [(words, [f"`{of.key}` at {told(row, of.key, 'times its time')}" for row, of in front if of.relation == kind])
               for kind, words in _KINDS.items()]
    return say("losses", lost=lost, front=len(front), dominated=sum(of.relation == DOMINATED for _, of in front),
               singles=[(words, found_) for words, found_ in singles if found_])


def _accuracy(inputs: Inputs) -> str:
    counted, tier = inputs.counted, min(inputs.tiers, default=0)
    proved = counted[(counted["tier"] == tier) & (counted["verdict"] == VERIFIED)
                     & counted["reference"].isin(("certified", "bounded")) & counted["w_error"].notna()]
    if proved.empty:
        return ""
    errors = proved.groupby("solver")["w_error"].quantile(0.99)
    most = proved["solver"].value_counts()
    enough = [solver for solver in inputs.keys if most.get(solver, 0) >= 0.95 * most.max()]
    return say("accuracy", problems=proved["problem"].nunique(), tier=tier, errors=errors,
               best=min(enough, key=errors.get), worst=max(enough, key=errors.get))


def friction(inputs: Inputs) -> str:
    """Ours on problems with friction: right at every tier, its time, and that beside plain problems and peers."""
    of = inputs.friction
    if of is None or of.ours not in set(of.cells["solver"]):
        return ""
    shares = {tier: choice.table(of, "friction", tier).set_index("solver") for tier in of.tiers}
    main, plain = shares[main_tier(of)], shown_tables.plain_times(inputs)
    over = [row.entries[of.ours].time_s / plain[row.size_class] for row in headline(of).classes
            if row.size_class in plain and of.ours in row.entries and math.isfinite(row.entries[of.ours].time_s)]
    best = sorted(of.peers, key=lambda solver: -main.loc[solver, "right_share"])[:_MOST_PEERS]
    return say("friction", of=of, own=main.loc[of.ours], tiers=shares, tier=main_tier(of), over=over,
               shares=[by.loc[of.ours, "right_share"] for by in shares.values()],
               rows=[inputs.problems[name]["rows"] for name in dict.fromkeys(of.cells["problem"])],
               peers=[(solver, main.loc[solver, RATIO], main.loc[solver, "right_share"]) for solver in best],
               others=len(of.peers) - len(best))


def _robustness(inputs: Inputs) -> str:
    cells = shown_tables.pathological(inputs)
    if cells.empty:
        return ""
    verified = (cells["verdict"] == VERIFIED) | cells["proved_infeasible"].astype(bool) | within_rounding(cells)
    right = cells[verified]["solver"].value_counts()
    false = cells[cells["cause"] == FAR]["solver"].value_counts()
    ranked = sorted(inputs.keys, key=lambda solver: (-right.get(solver, 0), false.get(solver, 0)))[:3]
    return say("robustness", cells=cells, tier=main_tier(inputs), right=right, ranked=ranked, liars=len(false))


def _sequences(inputs: Inputs) -> str:
    rows = choice.passes(inputs, main_tier(inputs))
    if rows.empty:
        return ""
    enough = rows[rows["verified_share"] >= choice.SHARE * rows["verified_share"].max()].sort_values(["p99", "p50"])
    gains = enough[enough["warm_gain"].notna()].sort_values("warm_gain", ascending=False).to_dict("records")
    return say("sequences", best=enough.iloc[0], gain=gains[0] if gains else None,
               whole=inputs.in_order(rows.loc[rows["verified_share"] == 1, "solver"]))


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
            parts.append((words, (rows["stopped"] == "").sum(), len(rows), errors["energy_error"]))
    return say("motion", parts=parts, strict=strict)


def friction_motion(inputs: Inputs) -> str:
    """What one percent of error costs: the drivers that keep every body within 1 % of the thinnest one's width of the
    reference motion, and the sweeps that this takes."""
    table = inputs.friction_motion
    if table is None:
        return ""
    warm = table[(table["start"] == "warm") & (table["width"] > 0)]
    if warm.empty:
        return ""
    runs = warm.assign(off=warm["distance"] / warm["width"]).groupby(["scene", studies.DRIVER, "tolerance"], sort=False)
    # A distance is missing where the reference stopped before.
    runs = runs.agg(solver=("solver", "last"), sweeps=("max_iterations", "last"), steps=("step", "max"),
                    off=("off", lambda of: of.max(skipna=False)), time=("solve_time_s", "last"),
                    stopped=("stopped", "last")).reset_index()
    runs["time"] /= runs["steps"].clip(lower=1)
    runs["near"] = (runs["off"] <= 0.01) & (runs["stopped"] == "")
    # The number of sweeps is the study's, or part of the key.
    in_key = runs["solver"].str.extract(r"^(.*)-(\d+)$")
    runs["code"] = in_key[0].fillna(runs["solver"])
    runs["sweeps"] = in_key[1].astype(float).fillna(runs["sweeps"])
    exact = runs[runs["sweeps"] == 0].groupby([studies.DRIVER, "tolerance"], sort=False)
    swept = []
    for code, part in runs[runs["sweeps"] > 0].groupby("code", sort=False):
        least = part[part["near"]].sort_values("sweeps").groupby("scene", sort=False).first()
        needs = [(sweeps, of) for sweeps, of in least.groupby("sweeps")]
        beyond = [scene for scene in part["scene"].unique() if scene not in least.index]
        swept.append((code, needs, beyond, part["sweeps"].max()))
    return say("friction_motion", scenes=runs["scene"].nunique(), steps=table["step"].max(), to_the_end=list(exact),
               swept=swept, law=peer_facts.law)


def _scaling(inputs: Inputs) -> str:
    """Exponents over all sizes would praise what has a large overhead; what counts is who is fast at the end."""
    cells = choice.main_cells(inputs)
    top = cells["rows"].max()
    ranked = choice.contenders(cells[cells["rows"] == top], inputs.own)
    if not ranked or top <= 100:
        return ""
    rows = choice.table(inputs, "scaling", main_tier(inputs))
    return say("scaling", top=int(top), ranked=ranked, exponents=rows[rows["solver"] == ranked[0].solver]["exponent"])
