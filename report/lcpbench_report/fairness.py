"""What the numbers cannot carry. Each line states a fact of these results; lines whose fact does not hold are left
out."""

import math
from collections.abc import Iterator

import pandas as pd

from . import formats
from .inputs import Inputs
from .statistics.cells import CHANGED, NOT_ASKED, VERIFIED
from .statistics.launches import KEY, TOGETHER
from .statistics.load import ORIGINS, TASK_BUDGET

# A solver is called out as built for looser tiers when it verifies less than this part of what it does at the loosest.
_TIER_DROP = 0.75
_FEW = 2  # launches: less than this says nothing of what differs between them
_Lines = Iterator[tuple[str, str]]


def limitations(inputs: Inputs) -> list[tuple[str, str]]:
    """[(subject, sentences)]"""
    rules = (_measure, _builds, _noise, _rules, _solvers, _judging, _problems)
    return [line for rule in rules for line in rule(inputs)]


def _measure(inputs: Inputs) -> _Lines:
    if inputs.cells.empty:
        return
    passes = max(campaign.info.get("passes", 0) for campaign in inputs.campaigns)
    yield ("Fresh times", "A time is one interval from the caller's arrays (J by rows, inverse masses, b, kinds of rows) "
           "to f: validation, forms of A, scaling, ordering, analysis, factorizations, fallbacks and the solver's own check "
           "are inside, for peers as for ours; making the arrays, workspace kept from earlier problems, transport between "
           "processes and the verdict are outside. The solver object was warmed on other problems and meets each problem "
           f"once a launch, in another random order each time; the median of at most {passes} launches counts. Parts of a time "
           "are measured apart, and are never summed. Who solves problem after problem of one matrix, or from a warm "
           "start, finds that in the second time (“again”) and in the sequences.")


def _builds(inputs: Inputs) -> _Lines:
    environments = [campaign.info.get("environment", {}) for campaign in inputs.campaigns]
    machines = list(dict.fromkeys(f"{e.get('cpu', 'unknown')}, {e.get('cores', '?')} cores" for e in environments))
    threads = environments[0].get("library_threads")
    blas = environments[0].get("libraries", {}).get("BLAS", "BLAS")  # its name says which kernels it runs
    yield ("One machine" if len(machines) == 1 else "Several machines",
           f"Times are from {'; '.join(machines)}. Ratios between solvers, and even their order, can differ on "
           "another." + (f" {blas} and OpenMP ran on {formats.plural(threads, 'thread')}." if threads else ""))
    if any(e.get("git_dirty") for e in environments):
        yield ("Uncommitted changes", "The tree differed from its commit when this was built: the commit alone does not "
               "reproduce it.")
    if kinds := {str(e.get("build_type", "")) for e in environments} - {"", "Release", "RelWithDebInfo"}:
        yield ("Build type", f"Built as {formats.words(sorted(kinds))}: times are not those of an optimised build.")
    if flags := {str(e.get("solver_flags", "")) for e in environments} - {""}:
        yield ("Compiler flags", f"Our solvers are compiled with {formats.words(sorted(flags))} as well; peers come from "
               "Debian as they are, for the least common x86-64. Who compiles a peer for his own machine will see it "
               "faster.")


def _noise(inputs: Inputs) -> _Lines:
    cells = inputs.cells[inputs.cells["excluded"] == ""]
    launches = inputs.measured.launches
    launches = launches[launches["launch"] != TOGETHER]
    if len(launches):
        spread = launches.groupby(KEY)["level"].agg(["std", "count"])
        yield ("Noise", "Launches of one solver on one class differ by "
               f"{formats.percent(spread['std'].median())} in the median (standard deviation of their levels), and by more than "
               f"{formats.percent(spread['std'].quantile(0.9))} in a tenth of the classes; the intervals include this. Differences within the intervals mean nothing.")
        yield from _disturbed(launches)
        few = float((spread["count"] < _FEW).mean())
        if few > 0.005:
            yield ("Single launches", f"{formats.percent(few)} of the pairs of solver and class were launched only once: their intervals "
                   "cover problems only.")
    changed = cells[cells["verdict"] == CHANGED]
    if len(changed):
        yield ("Answers that changed", f"In {formats.plural(len(changed), 'cell')} the answer was verified when the problem "
               "was solved by itself, and not in a timed pass, after other problems: counted as failed (for example "
               f"{formats.words(list(dict.fromkeys(changed['solver']))[:5])}).")


def _disturbed(launches: pd.DataFrame) -> _Lines:
    """What share of the launches the machine disturbed, and whether it shows in the times."""
    if not launches["disturbed"].any():
        return
    levels = launches.groupby([*KEY, "disturbed"])["level"]
    medians = levels.median().unstack().reindex(columns=[False, True])
    alone = float(medians[False].isna().mean())
    slower, usual = float((medians[True] - medians[False]).dropna().median()), float(levels.std().dropna().median())
    words = [f"{formats.percent(float(launches['disturbed'].mean()))} of the launches ({int(launches['disturbed'].sum())} of {len(launches)}) "
             "were disturbed by the machine also when they were run again. They count only where the solver has no others on the "
             f"class: in {formats.percent(alone)} of the pairs of solver and class."]
    if math.isfinite(slower):
        words.append(f"Where it has both, they took {formats.percent(abs(math.expm1(slower)))} {'more' if slower > 0 else 'less'} in the median, "
                     + ("within what launches differ by anyway: it hardly matters." if abs(slower) <= usual else
                        "by which those that count may be off." if alone else "and none of them counts."))
    yield "Disturbed launches", " ".join(words)


def _few(items: list[str], most: int, between: str = ", ") -> str:
    return between.join([*items[:most], *["…"] * (len(items) > most)])


def _rules(inputs: Inputs) -> _Lines:
    """Limits of time, exclusions, budgets, builds."""
    cells = inputs.cells
    hit = cells[(cells["excluded"] == "") & cells["claim"].isin(("time_limit", "killed"))]["solver"].value_counts()
    limits = [f"{name}: {of['time_per_row_s'] * 1e3:g} ms a row, at least {of['least_s']:g} s and at most {of['most_s']:g} s"
              for name, of in zip(inputs.names, (campaign.info["limits"] for campaign in inputs.campaigns))]
    ended = ", ".join(f"{solver} {hit[solver]}" for solver in inputs.in_order(hit.index))
    yield ("Time limit", f"One solve may take ({'; '.join(limits)}). "
           + (f"{formats.plural(hit.sum(), 'cell')} ended there ({ended}); with more time some might be verified."
              if len(hit) else "No cell ended there."))
    left_out = cells[~cells["excluded"].isin(("", TASK_BUDGET))]
    if len(left_out):
        parts = [f"“{rule}” ({_few(inputs.in_order(group['solver']), 6)}: {len(group)})"
                 for rule, group in left_out.groupby("excluded", sort=False)]
        yield ("Excluded by rule", f"{formats.plural(len(left_out), 'cell')} did not take place, by rules fixed before the "
               f"run: {_few(parts, 8, '; ')}. In means, profiles and counts they stand as not solved.")
    unasked = cells[cells["verdict"] == NOT_ASKED]
    if len(unasked):
        counts = unasked["solver"].value_counts()
        yield ("Not asked", f"In {formats.plural(len(unasked), 'cell')} the solver does not take the problem as it is given, for "
               "example without J or with bilateral rows "
               f"({_few([f'{solver} {counts[solver]}' for solver in inputs.in_order(counts.index)], 8)}): no failure, and in none "
               "of its shares and medians; on the front of peers it is not right. In "
               "means and profiles over common problems they stand as not solved.")
    late = cells[cells["excluded"] == TASK_BUDGET]
    untimed = int((cells["passes"].astype(bool) & (cells["timed"] == 0)).sum())
    parts = []
    if len(late):
        parts.append(f"{formats.plural(len(late), 'cell')} had no turn, since the solver's budget for judging a size class "
                     f"was spent ({_few(inputs.in_order(late['solver']), 8)}): they stand as not solved.")
    if untimed:
        parts.append(f"{formats.plural(untimed, 'verified cell')} had no turn in a timed pass: the time of the solve that was "
                     "judged stands for it.")
    if parts:
        yield "Budgets", " ".join(parts)
    if missing := [entry["key"] for entry in inputs.solvers if not entry["available"]]:
        yield ("Not in this build", f"{formats.words(missing)}: without their libraries these have no results. “make peers” "
               "installs them.")


def _solvers(inputs: Inputs) -> _Lines:
    if len(inputs.tiers) > 1:
        verified = inputs.cells[inputs.cells["verdict"] == VERIFIED].groupby(["solver", "tier"]).size()
        loose, strict = max(inputs.tiers), min(inputs.tiers)
        if drop := [solver for solver in inputs.keys
                    if verified.get((solver, strict), 0) < _TIER_DROP * verified.get((solver, loose), 0)]:
            yield ("Loose methods at strict tiers", f"{formats.words(drop)} verify much less at {formats.power(strict)} than "
                   f"at {formats.power(loose)}: they are judged here at tiers that they are not built for too.")
    if direct := [key for key in inputs.entries if key in inputs.keys and not inputs.entries[key]["uses_tolerance"]]:
        yield ("Direct methods", f"Not steered by the tolerance: {formats.words(direct)}. One run stands for every tier, so a "
               "loose tier does not make them faster.")
    if passed := int(inputs.cells["at_floor"].sum()):
        yield ("Rounding floor", f"{formats.plural(passed, 'cell')} passed only because the tier is looser where rounding the "
               "proved answer to doubles exceeds it already (verify.h).")
    if failed := int(inputs.cells["below_floor"].sum()):
        yield ("Below the rounding floor", f"{formats.plural(failed, 'failed cell')} (⌊) asked for less than rounding the "
               "answer's own forces to doubles adds to ρ, which is all that the answer misses it by; no solver passed there. "
               "They count as failed.")
    if inputs.peers:
        yield ("Other projects' solvers", "They run in worker processes and are timed there, from the same arrays as ours: "
               "forming what the library takes, a dense A by the one shared assembly or sparse matrices, is on their clock. "
               "Their options are their own defaults (keys with -default) or the loosest that pass each tier on tuning "
               "problems, one rule for all (solvers/peers/peer_table.h). Their authors were not asked.")
    if who := [key for key in inputs.keys if inputs.entries[key].get("protocol") == 1]:
        yield ("External programs of protocol 1", f"{formats.words(who)}: these are handed matrices, not arrays. Forming them "
               "took place in the host, was timed there and is added to their times.")


def _judging(inputs: Inputs) -> _Lines:
    yield ("Own checks", "Our solvers that check an answer before they return it do so by the residual that the verifier "
           "uses, inside the clock; peers check as their libraries do. What such a check is worth shows in the ablation "
           "table, where ours run without it and peers with one and a further solve.")
    if len(inputs.cells):
        problems = inputs.cells.drop_duplicates("problem")
        filled = int(problems["fill"].astype(bool).sum())
        variants = int(problems["base"].duplicated(keep=False).sum())
        weights = problems[problems["counts"].astype(bool)].groupby("origin")["weight"].sum()
        shares = formats.words([f"{ORIGINS[origin]} {formats.percent(float(weights[origin] / weights.sum()))}"
                                for origin in ORIGINS if weights.get(origin, 0) > 0])
        yield ("Weights", f"Of the k problems of one base, which differ in one number or are steps of one motion, each weighs "
               f"1/k in medians, shares and intervals: {variants} of {len(problems)} problems share a base. Within a size "
               "class own scenes and engines weigh the same, however many problems each has (in campaigns without launches, placed scenes, motions and recordings did). Of the counted weight have: "
               f"{shares}. {filled} problems fill up size classes, by the recipes of the collection with further seeds. Intervals draw launches, and in own scenes and engines families, and bases within them.")
    if found := [entry["key"] for entry in inputs.solvers if entry.get("ablation")]:
        yield ("Ablation", f"{formats.plural(len(found), 'key')} stand in the ablation table only, in no other figure: our "
               "solvers without their own check, peers with a check and one more solve with a shifted diagonal, and our "
               "solvers built for the instruction set that Debian's peers are built for.")


def _problems(inputs: Inputs) -> _Lines:
    laws = sum(about["friction"] > 0 or about["bounded"] > 0 for about in inputs.problems.values())
    if laws:
        yield ("Friction", f"{formats.plural(laws, 'problem')} with friction or bounded rows are shown in a section of their own alone: solvers "
               "that do not take such rows would stand beside others that do.")
    if apart := sum(not about["counts"] for about in inputs.problems.values()) - laws:
        yield ("Problems apart", f"{formats.plural(apart, 'problem')} (most of them meant to break something) are shown, but "
               "are in no mean, profile or count.")
    if "deadline" in inputs.analysis:
        steps = sum(int(sequence["steps"]) for campaign in inputs.campaigns for sequence in campaign.sequences.values())
        yield ("Sequences", f"The {steps} steps of the sequences were recorded once, driven by one solver: every solver is "
               "given the same problems, not those that its own errors would lead to. The motion section shows these.")
    recorded = {about["family"].split()[0] for about in inputs.problems.values() if about["origin"] == "recorded"}
    foreign = (f" Of the scenes of {formats.words(sorted(recorded))}, in the plane or in space, contacts and joints were "
               "recorded as these engines met them, without friction and softness." if recorded else "")
    yield ("Scope", f"Scenes of our own are synthetic and planar.{foreign} All contacts {'of other problems ' * bool(laws)}are frictionless; solvers were called one at a time. ρ is our measure: a "
           "library that stops on a criterion of its own may do more work than a tier needs.")
