"""A report in Markdown: for logs of builds, for messages, and to be kept with the source."""

import pandas as pd

from . import ablation_table, choice, decision, markdown_headline
from .fairness import limitations
from .formats import DASH, power, ratio, seconds, share, share_of, size_class
from .headline_table import headline
from .inputs import Inputs
from .statistics.cells import BELOW_TIER, FALSE_SUCCESS, VERIFIED
from .summary import pathological

_MOST_SOLVERS = 25  # of a table


def render(inputs: Inputs, lines: list[str], changes: str = "") -> str:
    """@param lines    what the report finds, a sentence each; they come first
    @param changes  against an earlier run, in Markdown (statistics.changes_markdown)
    """
    parts = ["# LCPBench: " + ", ".join(inputs.names), ""]
    parts += [f"- {line}" for line in lines] + [""] * bool(lines)
    if len(inputs.cells):
        parts += _choices(inputs)
        parts += ["## Times", "", markdown_headline.render(inputs, headline(inputs))]
        parts += ablation_table.section(inputs)
        parts += _coverage(inputs)
        parts += _robustness(inputs)
    parts += _sequences(inputs)
    parts += _environment(inputs)
    parts += ["## Limitations that affect fairness", "",
              *(f"- **{subject}.** {sentence}" for subject, sentence in limitations(inputs)), ""]
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
    table = None if table is None else choice.counted(table)
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
            "Share of the problems that are verified; ✗ with the number of false successes: answers that a solver called "
            "solved and that are not; ↓ with the number of those of a solver that was not asked for this tier.", "",
            *_table(["solver", *(f"tier {power(tier)}" for tier in tiers)], rows)]


def _cell(of: pd.Series) -> str:
    parts = [share_of(of["verified_share"])]
    parts += [f"{mark} {int(of[column])}" for mark, column in (("✗", "false_successes"), ("↓", "below_tier")) if of[column]]
    return " · ".join(parts)


def _choices(inputs: Inputs) -> list[str]:
    """The rule of decision.py, by size and redundancy."""
    tiers = choice.shown_tiers(inputs)
    rows: dict[tuple, dict[float, str]] = {}
    for found in decision.by_class(inputs):
        ranked = found.own or found.everyone
        second = f"; next `{ranked[1].solver}` {ratio(ranked[1].mean / ranked[0].mean)}×" if ranked[1:] else ""
        rows.setdefault((found.size_class, found.redundant), {})[found.tier] = (
            f"`{ranked[0].solver}` {seconds(ranked[0].mean)}{second}")
    if not rows:
        return []
    return ["## Which backend", "",
            "Of our solvers that verify nearly as much as any (99 % of the most), the one with the least geometric mean of "
            "fresh times, failures entered with the time limit. Redundant: rows of A depend on each other.", "",
            *_table(["rows", "redundant", *(f"tier {power(tier)}" for tier in tiers)],
                    [[size_class(key), "yes" if redundant else "no", *(cells.get(tier, DASH) for tier in tiers)]
                     for (key, redundant), cells in rows.items()])]


def _robustness(inputs: Inputs) -> list[str]:
    cells = pathological(inputs)
    cells = cells[cells["tier"] == choice.main_tier(inputs)]
    if cells.empty:
        return []
    rows = []
    for solver in inputs.keys:
        mine = cells[cells["solver"] == solver]
        if len(mine):
            rows.append([f"`{solver}`", str(int((mine["verdict"] == VERIFIED).sum())),
                         str(int(mine["proved_infeasible"].astype(bool).sum())),
                         str(int((mine["verdict"] == FALSE_SUCCESS).sum())),
                         str(int((mine["verdict"] == BELOW_TIER).sum())), str(int((mine["excluded"] != "").sum()))])
    return ["## Problems that are meant to break something", "",
            f"{cells['problem'].nunique()} problems at tier {power(choice.main_tier(inputs))}; what is missing to that "
            "number failed honestly.", "",
            *_table(["solver", "verified", "proved infeasible", "false successes", "below the tier", "excluded"], rows)]


def _sequences(inputs: Inputs) -> list[str]:
    tier = choice.main_tier(inputs)
    chosen = decision.warm_passes(inputs, tier)
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
            f"Latency of a step from a warm start at tier {power(tier)}, one interval from its arrays to f, and by how much "
            "a cold start takes longer.", "",
            *_table(["solver", "verified", "median", "99 %", "largest", "cold over warm"],
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
