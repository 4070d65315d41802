"""The headline as Markdown, for README.md and summaries."""

import math

from .errors import ReportError
from .headline_table import Entry, Headline
from .inputs import Inputs
from .formats import DASH, power, seconds, share

BEGIN = "<!-- headline: written by report/headline.py -->"
END = "<!-- end of headline -->"


def caption(inputs: Inputs, found: Headline) -> str:
    """What a cell says, by which rule it is bold, and where it was measured; one line."""
    return (f"Median solve time at tier {power(found.tier)} over the problems of a size class; an answer that is not "
            "verified counts as infinitely slow, so that failing cannot help. After it the share verified, where that "
            "is not all; ✗: half or more failed; –: not run at that size, by a rule declared before. Set-up and "
            "conversion excluded. **Bold**: the fastest of those that verify most. Own solvers first, then the best "
            "of each peer library, and of its others where that one is not run on larger problems"
            f"{_where(inputs)}.")


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


def table(found: Headline) -> str:
    """A row per solver, a column per size class."""
    lines = ["| solver | " + " | ".join(f"{label} rows" for label, _ in found.columns) + " |",
             "| --- |" + " ---: |" * len(found.columns)]
    for solver, entries in found.rows.items():
        lines.append(f"| `{solver}` | " + " | ".join(map(cell, entries)) + " |")
    lines.append("| problems | " + " | ".join(str(problems) for _, problems in found.columns) + " |")
    return "\n".join(lines) + "\n"


def cell(entry: Entry | None) -> str:
    if entry is None or entry.excluded == entry.problems:
        return DASH
    verified = share(entry.verified, entry.problems)
    if not math.isfinite(entry.time_s):
        return f"✗ {verified}"
    time = f"**{seconds(entry.time_s)}**" if entry.best else seconds(entry.time_s)
    return time if entry.verified == entry.problems else f"{time} · {verified}"


def render(inputs: Inputs, found: Headline) -> str:
    """Caption, table, and what was left out of it."""
    lines = [caption(inputs, found), "", table(found)]
    if found.left_out:
        lines.append(f"{len(found.left_out)} other solvers and settings are in the report.\n")
    absent = [entry["key"] for entry in inputs.solvers if not entry["available"]]
    if absent:
        lines.append("Not in this build: " + ", ".join(f"`{key}`" for key in absent) + ".\n")
    return "\n".join(lines)


def replace_between_markers(text: str, new: str, name: str) -> str:
    """@throws ReportError without the markers"""
    begin, end = text.find(BEGIN), text.find(END)
    if begin < 0 or end < begin:
        raise ReportError(name, "the markers of the table are missing", f"'{BEGIN}' and, after it, '{END}'")
    return text[:begin] + BEGIN + "\n\n" + new + "\n" + text[end:]
