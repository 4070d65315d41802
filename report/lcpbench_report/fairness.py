"""What the numbers cannot carry. Each line states a fact of these results; lines whose fact does not hold are left
out."""

from . import formats
from .inputs import Inputs
from .statistics.cells import CHANGED, LEAST_PASSES
from .statistics.load import TASK_BUDGET

# A solver is called out as built for looser tiers when it verifies less than this part of what it does at the loosest.
_TIER_DROP = 0.75
# Cells whose time is uncertain by more than this are counted.
_UNCERTAIN = 0.1


def limitations(inputs: Inputs) -> list[tuple[str, str]]:
    """[(subject, sentences)]"""
    rules = (_measure, _machine, _builds, _noise, _changed, _limit, _excluded, _budget, _unavailable, _tiers, _direct, _floor,
             _processes, _first_version, _checks, _weights, _ablation, _sets, _deadlines, _scope)
    return [line for rule in rules for line in rule(inputs)]


def _measure(inputs: Inputs) -> list:
    if inputs.cells.empty:
        return []
    passes = max(campaign.info.get("passes", 0) for campaign in inputs.campaigns)
    return [("Fresh times", "A time is one interval from the caller's arrays (J by rows, inverse masses, b, kinds of rows) "
             "to f: validation, forms of A, scaling, ordering, analysis, factorizations, fallbacks and the solver's own check "
             "are inside, for peers as for ours; making the arrays, workspace kept from earlier problems, transport between "
             "processes and the verdict are outside. The solver object was warmed on other problems and meets each problem "
             f"once a pass, in another random order each time; the median of at most {passes} passes counts. Below 2 µs a "
             "pair of clock reads covers several different problems, and each is given their mean. Parts of a time are from "
             "passes of their own, and are never summed. Who solves problem after problem of one matrix, or from a warm "
             "start, finds that in the second time (“again”) and in the sequences.")]


def _environments(inputs: Inputs) -> list[dict]:
    return [campaign.info.get("environment", {}) for campaign in inputs.campaigns]


def _machine(inputs: Inputs) -> list:
    machines = list(dict.fromkeys(f"{e.get('cpu', 'unknown')}, {e.get('cores', '?')} cores"
                                  for e in _environments(inputs)))
    threads = _environments(inputs)[0].get("library_threads")
    return [("One machine" if len(machines) == 1 else "Several machines",
             f"Times are from {'; '.join(machines)}. Ratios between solvers, and even their order, can differ on "
             "another." + (f" BLAS and OpenMP ran on {formats.plural(threads, 'thread')}." if threads else ""))]


def _builds(inputs: Inputs) -> list:
    lines = []
    if any(e.get("git_dirty") for e in _environments(inputs)):
        lines.append(("Uncommitted changes", "The tree differed from its commit when this was built: the commit alone "
                      "does not reproduce it."))
    kinds = {str(e.get("build_type", "")) for e in _environments(inputs)} - {"", "Release", "RelWithDebInfo"}
    if kinds:
        lines.append(("Build type", f"Built as {formats.words(sorted(kinds))}: times are not those of an optimised "
                      "build."))
    flags = {str(e.get("solver_flags", "")) for e in _environments(inputs)}
    if flags - {""}:
        lines.append(("Compiler flags", f"Our solvers are compiled with {formats.words(sorted(flags - {''}))} as well; "
                      "peers come from Debian as they are, for the least common x86-64. Who compiles a peer for his "
                      "own machine will see it faster."))
    return lines


def _run(inputs: Inputs):
    return inputs.cells[inputs.cells["excluded"] == ""]


def _noise(inputs: Inputs) -> list:
    cells = _run(inputs)
    timed = cells[cells["passes"].astype(bool) & cells["fresh_low"].notna()]
    if timed.empty:
        return []
    half = (timed["fresh_high"] - timed["fresh_low"]) / 2 / timed["fresh_s"]
    disturbed = int((cells["disturbed"] > 0).sum())
    few = float((timed["timed"] < LEAST_PASSES).mean())
    lines = [("Noise",
              f"The 95 % interval of a problem's time has a half width of {formats.percent(half.median())} in the median; "
              f"it is above {formats.percent(_UNCERTAIN)} for {formats.percent(float((half > _UNCERTAIN).mean()))} of the "
              f"times. {disturbed} of {len(cells)} cells had a pass that the machine disturbed even when it was run "
              "again; it does not count where there are others. Differences within the intervals mean nothing.")]
    if few > 0.005:
        lines.append(("Few passes", f"{formats.percent(few)} of the timed cells have fewer than {LEAST_PASSES} passes, and "
                      "their intervals say nothing of what differs between passes."))
    return lines


def _changed(inputs: Inputs) -> list:
    cells = _run(inputs)
    changed = cells[cells["verdict"] == CHANGED]
    if changed.empty:
        return []
    who = list(dict.fromkeys(changed["solver"]))[:5]
    return [("Answers that changed", f"In {formats.plural(len(changed), 'cell')} the answer was verified when the problem was "
             "solved by itself, and not in a timed pass, after other problems: counted as failed (for example "
             f"{formats.words(who)}).")]


def _limit(inputs: Inputs) -> list:
    cells = _run(inputs)
    hit = cells[cells["claim"].isin(("time_limit", "killed"))]
    lines = []
    for name, campaign in zip(inputs.names, inputs.campaigns):
        limits = campaign.info["limits"]
        lines.append(f"{name}: {limits['time_per_row_s'] * 1e3:g} ms a row, at least {limits['least_s']:g} s and at most "
                     f"{limits['most_s']:g} s")
    who = hit["solver"].value_counts()
    ended = ", ".join(f"{solver} {who[solver]}" for solver in inputs.keys if solver in who)
    return [("Time limit", f"One solve may take ({'; '.join(lines)}). "
             + (f"{formats.plural(len(hit), 'cell')} ended there ({ended}); with more time some might be verified."
                if len(hit) else "No cell ended there."))]


def _excluded(inputs: Inputs) -> list:
    left_out = inputs.cells[~inputs.cells["excluded"].isin(("", TASK_BUDGET))]
    if left_out.empty:
        return []
    parts = []
    for rule, group in left_out.groupby("excluded", sort=False):
        who = [solver for solver in inputs.keys if solver in set(group["solver"])]
        parts.append(f"“{rule}” ({', '.join(who[:6])}{', …' if len(who) > 6 else ''}: {len(group)})")
    return [("Excluded by rule", f"{formats.plural(len(left_out), 'cell')} did not take place, by rules fixed before the "
             f"run: {'; '.join(parts[:8])}{'; …' if len(parts) > 8 else ''}. In means, profiles and counts they stand as "
             "not solved.")]


def _budget(inputs: Inputs) -> list:
    cells = inputs.cells
    late = cells[cells["excluded"] == TASK_BUDGET]
    untimed = int((cells["passes"].astype(bool) & (cells["timed"] == 0)).sum())
    if late.empty and not untimed:
        return []
    who = [solver for solver in inputs.keys if solver in set(late["solver"])]
    parts = []
    if len(late):
        parts.append(f"{formats.plural(len(late), 'cell')} had no turn, since the solver's budget for judging a size class "
                     f"was spent ({', '.join(who[:8])}{', …' if len(who) > 8 else ''}): they stand as not solved.")
    if untimed:
        parts.append(f"{formats.plural(untimed, 'verified cell')} had no turn in a timed pass: the time of the solve that was "
                     "judged stands for it.")
    return [("Budgets", " ".join(parts))]


def _unavailable(inputs: Inputs) -> list:
    missing = [entry["key"] for entry in inputs.solvers if not entry["available"]]
    return [("Not in this build", f"{formats.words(missing)}: without their libraries these have no results. “make "
             "peers” installs what Debian has.")] if missing else []


def _tiers(inputs: Inputs) -> list:
    if len(inputs.tiers) < 2 or inputs.cells.empty:
        return []
    verified = inputs.cells[inputs.cells["verdict"] == "verified"]
    counts = verified.groupby(["solver", "tier"]).size()
    loose, strict = max(inputs.tiers), min(inputs.tiers)
    drop = [solver for solver in inputs.keys
            if counts.get((solver, loose), 0) and
            counts.get((solver, strict), 0) < _TIER_DROP * counts.get((solver, loose), 0)]
    return [("Loose methods at strict tiers", f"{formats.words(drop)} verify much less at {formats.power(strict)} than at "
             f"{formats.power(loose)}: they are judged here at tiers that they are not built for too.")] if drop else []


def _direct(inputs: Inputs) -> list:
    direct = [e["key"] for e in inputs.solvers if e["key"] in inputs.keys and not e["uses_tolerance"]]
    return [("Direct methods", f"Not steered by the tolerance: {formats.words(direct)}. One run stands for every tier, "
             "so a loose tier does not make them faster.")] if direct else []


def _floor(inputs: Inputs) -> list:
    passed = int(inputs.cells["at_floor"].sum())
    return [("Rounding floor", f"{formats.plural(passed, 'cell')} passed only because the tier is looser where rounding "
             "the proved answer to doubles exceeds it already (rounding_floor.h).")] if passed else []


def _processes(inputs: Inputs) -> list:
    peers = [solver for solver in inputs.keys if solver not in inputs.own]
    return [("Other projects' solvers", "They run in worker processes and are timed there, from the same arrays as ours: "
             "forming what the library takes, a dense A by the one shared assembly or sparse matrices, is on their clock. "
             "Their options are their own defaults (keys with -default) or the loosest that pass each tier on tuning "
             "problems, one rule for all (solvers/peers/tier_settings.h). Their authors were not asked.")] if peers else []


def _first_version(inputs: Inputs) -> list:
    who = [entry["key"] for entry in inputs.solvers if entry.get("protocol") == 1 and entry["key"] in inputs.keys]
    return [("External programs of protocol 1", f"{formats.words(who)}: these are handed matrices, not arrays. Forming them "
             "took place in the host, was timed there and is added to their times.")] if who else []


def _checks(inputs: Inputs) -> list:
    return [("Own checks", "Our solvers that check an answer before they return it do so by the residual that the verifier "
             "uses, inside the clock; peers check as their libraries do. What such a check is worth shows in the ablation "
             "table, where ours run without it and peers with one and a further solve.")]


def _weights(inputs: Inputs) -> list:
    if inputs.cells.empty:
        return []
    problems = inputs.cells.drop_duplicates("problem")
    variants = int((problems["weight"] < 1).sum())
    motion, weight = problems[(problems["origin"] == "motion") & problems["counts"].astype(bool)], problems["weight"]
    share = motion["weight"].sum() / max(weight[problems["counts"].astype(bool)].sum(), 1e-300)
    filled = int(problems["fill"].astype(bool).sum())
    return [("Weights", f"Of the k problems of one base, which differ in one number or are steps of one motion, each weighs "
             f"1/k in medians, shares and intervals: {variants} of {len(problems)} problems weigh less than 1. "
             f"{formats.percent(float(share))} of the counted weight are steps of motions; {filled} problems fill up size "
             "classes, by the recipes of the collection with further seeds. Intervals draw families, and bases within them.")]


def _ablation(inputs: Inputs) -> list:
    found = [entry["key"] for entry in inputs.solvers if entry.get("ablation")]
    return [("Ablation", f"{formats.plural(len(found), 'key')} stand in the ablation table only, in no other figure: our "
             "solvers without their own check, peers with a check and one more solve with a shifted diagonal, and our "
             "solvers built for the instruction set that Debian's peers are built for.")] if found else []


def _sets(inputs: Inputs) -> list:
    apart = [about for about in inputs.problems.values() if not about["counts"]]
    return [("Problems apart", f"{formats.plural(len(apart), 'problem')} (most of them meant to break something) are shown, "
             "but are in no mean, profile or count.")] if apart else []


def _deadlines(inputs: Inputs) -> list:
    if "deadline" not in inputs.analysis:
        return []
    steps = sum(int(sequence["steps"]) for campaign in inputs.campaigns for sequence in campaign.sequences.values())
    return [("Sequences", f"The {steps} steps of the sequences were recorded once, driven by one solver: every solver is "
             "given the same problems, not those that its own errors would lead to. The motion section shows these.")]


def _scope(_: Inputs) -> list:
    return [("Scope", "Scenes are synthetic, planar and frictionless; solvers were called one at a time. ρ is our "
             "measure: a library that stops on a criterion of its own may do more work than a tier needs.")]
