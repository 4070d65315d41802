"""The headline as Markdown: in short for README.md, in full for docs/results.md and summaries."""

import math

from .formats import DASH, percent, plural, power, seconds, share_of, size_class, times
from .headline_table import Entry, Headline, Ratio
from .inputs import Inputs
from .statistics.class_times import LEAST_FOR_P99
from .statistics.peer_ratio import RIGHT
from .summary import false_successes, peers


def caption(inputs: Inputs, found: Headline) -> str:
    """What a cell says, by which rule it is bold, and where it was measured."""
    return (f"Fresh times at tier {power(found.tier)}. A fresh time is one interval from the caller's arrays (J by rows, "
            "inverse masses, b, kinds of rows) to f. Validation, forms of A, ordering, factorizations, fallbacks and the "
            "solver's own check are inside. The solver object has solved other problems before, but never this one. Peers "
            "are timed in the same way, each in a process of its own. The time of a class is the median over its problems; "
            "each of k variants of one base has weight 1/k, and an answer that is not verified counts as infinitely slow. "
            f"*Right*: share verified. The best are the fastest of those that are right on {percent(RIGHT)}. **Bold**: the "
            "fastest of all, and every solver tied with it: the 95 % interval of the ratio of their times contains 1. "
            "Ratios are our time over theirs, problem by problem, with intervals by bootstrap over families and "
            f"bases{_where(inputs)}.")


def short_caption(inputs: Inputs, found: Headline) -> str:
    """The same in two sentences, for the front page."""
    return (f"Median time from the caller's arrays to f at tier {power(found.tier)}, everything inside, on problems that the "
            "solver object has not seen before; an answer that is not verified counts as infinitely slow"
            f"{_where(inputs)}. Best: the fastest of those that are right on {percent(RIGHT)} (**bold**: the fastest of all, and "
            "what the 95 % interval does not tell apart from it); ratios are our time over theirs, so above 1 we lose.")


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


def details(inputs: Inputs, found: Headline) -> str:
    """False successes, and the table of all solvers."""
    lines = [f"The 99 % quantile is given for classes with at least {LEAST_FOR_P99} problems. {false_successes(inputs)}", "",
             "Own solvers first, then the best solver of each peer library, with a second one where the best is not run on "
             "larger problems. The columns are numbers of rows. After a time stands the share verified, where that is not all, "
             "and of how many problems, where the solver's budget ended before every problem had its turn (their order is "
             f"drawn at random). ✗: half or more failed. {DASH}: not run at that size, by a rule declared before the run.", "",
             by_solver(found)]
    if found.left_out:
        lines.append(f"{plural(len(found.left_out), 'other solver or setting', 'other solvers and settings')} are in the report.\n")
    absent = [entry["key"] for entry in inputs.solvers if not entry["available"]]
    if absent:
        lines.append("Not in this build: " + ", ".join(f"`{key}`" for key in absent) + ".\n")
    return "\n".join(lines)


def render(inputs: Inputs, found: Headline) -> str:
    """Caption, both tables, and what is said about them."""
    return "\n".join([caption(inputs, found), "", classes(found), peers(found), "", details(inputs, found)])
