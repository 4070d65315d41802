"""The headline as Markdown, for README.md and summaries."""

import math

from .formats import DASH, percent, plural, power, seconds, share_of, size_class, times
from .headline_table import Entry, Headline, Ratio
from .inputs import Inputs
from .statistics.class_times import LEAST_FOR_P99
from .statistics.peer_ratio import RIGHT
from .summary import false_successes, peers


def caption(inputs: Inputs, found: Headline) -> str:
    """What a cell says, by which rule it is bold, and where it was measured."""
    return (f"Fresh times at tier {power(found.tier)}: one interval from the caller's arrays (J by rows, inverse masses, b, "
            "kinds of rows) to f, with validation, forms of A, ordering, factorizations, fallbacks and the solver's own "
            "check inside, by a solver object that has solved other problems and never this one; peers the same, in "
            "processes of their own. Of a class the median over its problems, each of k variants of one base with weight "
            "1/k; an answer that is not verified counts as infinitely slow. *Right*: share verified. The best are the "
            f"fastest of those that are right on {percent(RIGHT)}; **bold**: the fastest of all, and what is tied with it: "
            "the 95 % interval of the ratio of their times reaches 1. Ratios are our time over theirs, problem by problem, "
            f"intervals by bootstrap over families and bases{_where(inputs)}.")


def _where(inputs: Inputs) -> str:
    """Machine, commit and date of the first campaign that has them."""
    for campaign in inputs.campaigns:
        environment = campaign.info.get("environment") or {}
        if not environment:
            continue
        commit = str(environment.get("git_commit") or "")[:12]
        started = str(campaign.info.get("started") or "")[:10]
        parts = [environment.get("cpu"), environment.get("compiler"), "one thread",
                 commit and f"commit {commit}" + (" with changes" if environment.get("git_dirty") else ""), started]
        return " (" + ", ".join(str(part) for part in parts if part) + ")"
    return ""


def classes(found: Headline) -> str:
    """A row per size class: the best of ours against the peers."""
    lines = ["| rows | problems | best of ours | right | best right peer | right | ours / that peer "
             "| ours / fastest peer of each problem | 99 %: ours, peer |",
             "| --- | ---: | --- | ---: | --- | ---: | ---: | ---: | ---: |"]
    for row in found.classes:
        own, peer = row.entries.get(row.own), row.entries.get(row.peer)
        tails = [seconds(entry.p99_s) for entry in (own, peer) if entry and not math.isnan(entry.p99_s)]
        lines.append("| " + " | ".join([
            size_class(row.size_class), str(row.problems), _named(row.own, own), _right(own),
            _named(row.peer, peer) if peer else f"none is right on {percent(RIGHT)}", _right(peer), ratio(row.to_peer),
            ratio(row.to_fastest), ", ".join(tails) or DASH]) + " |")
    return "\n".join(lines) + "\n"


def _named(solver: str | None, entry: Entry | None) -> str:
    if solver is None or entry is None:
        return DASH
    return f"**`{solver}` {seconds(entry.time_s)}**" if entry.best else f"`{solver}` {seconds(entry.time_s)}"


def _right(entry: Entry | None) -> str:
    return DASH if entry is None else share_of(entry.share)


def ratio(found: Ratio | None) -> str:
    """0.60 (0.55–0.64): with its interval"""
    if found is None or math.isnan(found.median):
        return DASH
    interval = "" if math.isnan(found.low) else f" ({times(found.low)}–{times(found.high)})"
    return times(found.median) + interval


def by_solver(found: Headline) -> str:
    """A row per solver, a column per size class."""
    lines = ["| solver | " + " | ".join(size_class(row.size_class) for row in found.classes) + " |",
             "| --- |" + " ---: |" * len(found.classes)]
    for solver in found.solvers:
        lines.append(f"| `{solver}` | " + " | ".join(cell(row.entries.get(solver), row.problems) for row in found.classes) + " |")
    return "\n".join(lines) + "\n"


def cell(entry: Entry | None, problems: int) -> str:
    """@param problems  of the class"""
    if entry is None or not entry.attempted:
        return DASH
    verified = share_of(entry.share)
    sample = f" of {entry.problems}" if entry.problems < problems else ""
    if not math.isfinite(entry.time_s):
        return f"✗ {verified}{sample}"
    time = f"**{seconds(entry.time_s)}**" if entry.best else seconds(entry.time_s)
    return time if entry.share == 1 and not sample else f"{time} · {verified}{sample}"


def render(inputs: Inputs, found: Headline) -> str:
    """Caption, both tables, and what is said about them."""
    lines = [caption(inputs, found), "", classes(found), peers(found), "",
             f"The 99 % quantile is given where there are {LEAST_FOR_P99} problems. {false_successes(inputs)}", "",
             f"Own solvers, then the best of each peer library, and of its others where that one is not given larger "
             "problems; columns are rows. After a time the share verified, where that is not all, and of how many problems, where "
             "the solver's budget ended before all had their turn (their order is drawn by lot); ✗: half or more failed; "
             f"{DASH}: not run at that size, by a rule declared before.", "", by_solver(found)]
    if found.left_out:
        lines.append(f"{plural(len(found.left_out), 'other solver or setting', 'other solvers and settings')} are in the report.\n")
    absent = [entry["key"] for entry in inputs.solvers if not entry["available"]]
    if absent:
        lines.append("Not in this build: " + ", ".join(f"`{key}`" for key in absent) + ".\n")
    return "\n".join(lines)
