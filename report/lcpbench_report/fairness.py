"""What the numbers cannot carry. Each line states a fact of these results; lines whose fact does not hold are left
out."""

from . import formats
from .inputs import Inputs

# A solver is called out as built for looser tiers when it verifies less than this part of what it does at the loosest.
_TIER_DROP = 0.75
# Cells whose time is uncertain by more than this are counted.
_UNCERTAIN = 0.1


def limitations(inputs: Inputs) -> list[tuple[str, str]]:
    """[(subject, sentences)]"""
    rules = (_machine, _builds, _noise, _rounds, _limit, _excluded, _unavailable, _tiers, _direct, _floor, _setup, _steps,
             _processes, _sets, _deadlines, _scope)
    return [line for rule in rules for line in rule(inputs)]


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
    return inputs.cells[inputs.cells["excluded"] == ""] if len(inputs.cells) else inputs.cells


def _noise(inputs: Inputs) -> list:
    cells = _run(inputs)
    if cells.empty:
        return []
    passed = cells[cells["passes"].astype(bool) & cells["solve_low"].notna()]
    if passed.empty:
        return []
    half = (passed["solve_high"] - passed["solve_low"]) / 2 / passed["solve_median"]
    disturbed = int((cells["rounds_disturbed"] > 0).sum())
    return [("Noise",
             f"The 95 % interval of a cell's time has a half width of {formats.percent(half.median())} in the median; "
             f"it is above {formats.percent(_UNCERTAIN)} for {formats.percent(float((half > _UNCERTAIN).mean()))} of the "
             f"cells. {disturbed} of {len(cells)} cells had a round that the machine disturbed even when it was run "
             "again; it does not count where there are others. Differences within the intervals mean nothing.")]


def _rounds(inputs: Inputs) -> list:
    cells = _run(inputs)
    if cells.empty:
        return []
    changed = cells[cells["rounds_changed"] > 0]
    few = float((cells.loc[cells["passes"].astype(bool), "rounds"] < 3).mean()) if cells["passes"].any() else 0.0
    lines = []
    if len(changed):
        who = list(dict.fromkeys(changed["solver"]))[:5]
        lines.append(("Verdicts that changed",
                      f"In {formats.plural(len(changed), 'cell')} a later round had another verdict than the first, "
                      f"which counts (for example {formats.words(who)}): mostly at the time limit."))
    if few > 0.005:
        lines.append(("Few rounds", f"{formats.percent(few)} of the timed cells were visited in fewer than three rounds, "
                      "and their intervals say nothing of what differs between rounds."))
    return lines


def _limit(inputs: Inputs) -> list:
    cells = _run(inputs)
    hit = cells[cells["claim"].isin(("time_limit", "killed"))] if len(cells) else cells
    lines = []
    for name, campaign in zip(inputs.names, inputs.campaigns):
        limits = campaign.info["limits"]
        lines.append(f"{name}: {limits['time_per_row_s'] * 1e3:g} ms a row, at least {limits['least_s']:g} s and at most "
                     f"{limits['most_s']:g} s")
    who = hit["solver"].value_counts() if len(hit) else {}
    ended = ", ".join(f"{solver} {who[solver]}" for solver in inputs.keys if solver in who)
    return [("Time limit", f"One solve may take ({'; '.join(lines)}). "
             + (f"{formats.plural(len(hit), 'cell')} ended there ({ended}); with more time some might be verified."
                if len(hit) else "No cell ended there."))]


def _excluded(inputs: Inputs) -> list:
    left_out = inputs.cells[inputs.cells["excluded"] != ""] if len(inputs.cells) else inputs.cells
    if left_out.empty:
        return []
    parts = []
    for rule, group in left_out.groupby("excluded", sort=False):
        who = [solver for solver in inputs.keys if solver in set(group["solver"])]
        parts.append(f"“{rule}” ({', '.join(who[:6])}{', …' if len(who) > 6 else ''}: {len(group)})")
    return [("Excluded by rule", f"{formats.plural(len(left_out), 'cell')} did not take place, by rules fixed before the "
             f"run: {'; '.join(parts[:8])}{'; …' if len(parts) > 8 else ''}. In means, profiles and counts they stand as "
             "not solved.")]


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
    passed = int(inputs.cells["at_floor"].sum()) if len(inputs.cells) else 0
    return [("Rounding floor", f"{formats.plural(passed, 'cell')} passed only because the tier is looser where rounding "
             "the proved answer to doubles exceeds it already (rounding_floor.h).")] if passed else []


def _setup(_: Inputs) -> list:
    return [("Set-up apart", "Set-up (forms of A, allocation, symbolic analysis) is not part of the solve time; the "
             "explorer shows it and the sum. Who solves each problem once pays both.")]


def _processes(inputs: Inputs) -> list:
    peers = [solver for solver in inputs.keys if solver not in inputs.own]
    return [("Other projects' solvers", "They run in worker processes and time themselves there, without conversions; "
             "their options are their own defaults (keys with -default) or the loosest that pass each tier on tuning "
             "problems, one rule for all (solvers/peers/tier_settings.h). Their authors were not asked.")] if peers else []


def latency_note(inputs: Inputs) -> str:
    """What the latency of other projects' solvers leaves out; empty without any."""
    table = inputs.analysis.get("latency_by_solver")
    if table is None or set(table["solver"]) <= set(inputs.own):
        return ""
    return ("The latency of other projects' solvers has no set-up, in which A is formed for them: it is measured across "
            "processes, where no engine has it. Ours has. The solve alone compares both.")


def _steps(inputs: Inputs) -> list:
    text = latency_note(inputs)
    return [("Latency of steps", text)] if text else []


def _sets(inputs: Inputs) -> list:
    apart = [about for about in inputs.problems.values() if not about["counts"]]
    return [("Problems apart", f"{formats.plural(len(apart), 'problem')} (tiny ones and those meant to break something) "
             "are shown, but are in no mean, profile or count.")] if apart else []


def _deadlines(inputs: Inputs) -> list:
    if "deadline" not in inputs.analysis:
        return []
    steps = sum(int(sequence["steps"]) for campaign in inputs.campaigns for sequence in campaign.sequences.values())
    return [("Sequences", f"The {steps} steps of the sequences were recorded once, driven by one solver: every solver is "
             "given the same problems, not those that its own errors would lead to. The motion section shows these.")]


def _scope(_: Inputs) -> list:
    return [("Scope", "Scenes are synthetic, planar and frictionless; solvers were called one at a time. ρ is our "
             "measure: a library that stops on a criterion of its own may do more work than a tier needs.")]
