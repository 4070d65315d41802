"""A report in one page of Markdown, for logs of builds and for messages."""

import math

import pandas as pd

from . import choice, markdown_headline
from .headline_table import headline
from .inputs import Inputs
from .formats import DASH, power, seconds, share

_MOST_SOLVERS = 25  # of a table


def render(inputs: Inputs, lines: list[str], changes: str = "") -> str:
    """@param lines    what the report finds, a sentence each; they come first
    @param changes  against an earlier run, in Markdown (statistics.changes_markdown)
    """
    parts = ["# LCPBench: " + ", ".join(inputs.names), ""]
    parts += [f"- {line}" for line in lines] + [""] * bool(lines)
    if len(inputs.cells):
        parts += ["## Times", "", markdown_headline.render(inputs, headline(inputs))]
        parts += _coverage(inputs)
    parts += _sequences(inputs)
    parts += _environment(inputs)
    parts += ["## Compared with an earlier run", "",
              *([changes.replace("\n#", "\n##").replace("# ", "### ", 1)] if changes else []),
              "    lcpbench compare OLD NEW", "",
              "reads two campaign folders of one plan and tells what became slower, faster or wrong; its exit status is "
              "1 for a regression.", ""]
    if inputs.notes:
        parts += ["## Notes", "", *(f"- {note}" for note in inputs.notes), ""]
    return "\n".join(parts)


def _table(header: list[str], rows: list[list[str]]) -> list[str]:
    return ["| " + " | ".join(header) + " |", "| --- |" + " ---: |" * (len(header) - 1),
            *("| " + " | ".join(row) + " |" for row in rows), ""]


def _coverage(inputs: Inputs) -> list[str]:
    """Of all solvers, at the shown tiers."""
    table = inputs.analysis.get("coverage")
    table = None if table is None else choice.counted(table, inputs)
    if table is None or not len(table):
        return []
    tiers = [tier for tier in choice.shown_tiers(inputs) if (table["tier"] == tier).any()]
    by = table.set_index(["solver", "tier"])
    rows = []
    for solver in inputs.keys:
        found = [by.loc[(solver, tier)] if (solver, tier) in by.index else None for tier in tiers]
        if any(of is not None for of in found):
            rows.append([f"`{solver}`", *(DASH if of is None else _cell(of) for of in found)])
    return ["## Verified and false", "",
            "Share of the problems that are verified, and ✗ with the number of false successes: answers that a solver "
            "called solved and that are not.", "",
            *_table(["solver", *(f"tier {power(tier)}" for tier in tiers)], rows)]


def _cell(of: pd.Series) -> str:
    verified = share(int(of["verified"]), int(of["problems"]))
    return f"{verified} · ✗ {int(of['false_successes'])}" if of["false_successes"] else verified


def _sequences(inputs: Inputs) -> list[str]:
    table = inputs.analysis.get("latency_by_solver")
    if table is None or not len(table):
        return []
    tier = min(set(table["tier"]), key=lambda t: abs(math.log10(t / choice.TIER)))
    chosen = table[(table["size"].astype(str) == "all") & (table["tier"] == tier) & (table["mode"] == "warm")]
    rows = []
    for solver in inputs.keys:
        for _, of in chosen[chosen["solver"] == solver].iterrows():
            gain = of["warm_gain"]
            rows.append([f"`{solver}`", share(int(of["verified"]), int(of["steps"])),
                         *(seconds(of[level]) for level in ("p50", "p99", "max")),
                         DASH if pd.isna(gain) else f"{gain:.2f}"])
    if not rows:
        return []
    return ["## Sequences of motions", "",
            f"Latency of a step from a warm start (set-up and solve) at tier {power(tier)}, and by how much a cold "
            "start takes longer.", "", *_table(["solver", "verified", "median", "99 %", "largest", "cold over warm"],
                                        rows[:_MOST_SOLVERS])]


def _environment(inputs: Inputs) -> list[str]:
    lines = ["## Measured", ""]
    for name, campaign in zip(inputs.names, inputs.campaigns):
        environment = campaign.info.get("environment") or {}
        known = [environment.get("cpu"), environment.get("os"), environment.get("compiler"), environment.get("flags"),
                 environment.get("solver_flags")]
        commit = str(environment.get("git_commit") or "")[:12]
        if commit:
            known.append(f"commit {commit}" + (" with changes" if environment.get("git_dirty") else ""))
        known.append(str(campaign.info.get("started") or "")[:10])
        count = len(campaign.problems) or len(campaign.sequences)
        what = "problems" if campaign.problems else "sequences"
        told = ", ".join(str(part) for part in known if part)
        lines.append(f"- {name}: {count} {what}" + (f"; {told}" if told else ""))
    return [*lines, ""]
