"""Tries rules on what they were not made of.

For every family rules are made of all other families. On each of its problems the recommendation is the fastest of
the candidates that is verified there, since that is what `lcpbench recommend` finds out by measuring them; it is right
where its time is within WITHIN of the best measured solver. A family passes where the median of that ratio is at
most WITHIN and it is right on LEAST_SHARE of the problems or more. The same with seeds in the place of families.
"""

import math

import numpy as np
import pandas as pd

from .outcomes import Edges, Outcomes
from .rules import MOST, WITHIN, TierTable, choose_candidates, partition, tier_tables

LEAST_SHARE = 0.9


def evaluate(outcomes: Outcomes) -> dict:
    """The member `evaluation` (benchmarks/RESULTS.md)."""
    tables, edges = tier_tables(outcomes), outcomes.edges
    by_family = [row for table in tables for row in held_out(outcomes, table, table.families, edges)]
    by_seed = [row for table in tables for row in held_out(outcomes, table, table.seeds.fillna(-1), edges)]
    return {"within": WITHIN, "least_share": LEAST_SHARE, "most_candidates": MOST,
            "divisions": compare_divisions(outcomes),
            "tiers": [_summary(table.tier, by_family, by_seed) for table in tables],
            "families": [_plain(row, "family") for row in by_family], "seeds": [_plain(row, "seed") for row in by_seed]}


def compare_divisions(outcomes: Outcomes) -> list[dict]:
    """What the regions of the outcomes' edges are worth for families that were held out, and those divided once more by each other
    feature, at its median or, where that is its least value, above it: whether a feature helps."""
    divisions = [outcomes.edges]
    for name in outcomes.features.columns:
        values = outcomes.features[name].dropna()
        if name in outcomes.edges or values.nunique() < 2:
            continue
        least, middle = float(values.min()), float(values.median())
        above = middle if middle > least else float(values[values > least].min())
        divisions.append(outcomes.edges | {name: [least, above]})
    tables = tier_tables(outcomes)
    found = []
    for division in divisions:
        rows = [row for table in tables for row in held_out(outcomes, table, table.families, division)]
        problems = sum(row["problems"] for row in rows)
        found.append({"features": list(division), "families": len(rows), "pass": sum(row["passes"] for row in rows),
                      "problems": problems, "right": sum(row["right"] for row in rows)})
    return found


def held_out(outcomes: Outcomes, table: TierTable, groups: pd.Series, edges: Edges) -> list[dict]:
    """A row per group (of problems), held out in turn."""
    numbers, sizes = partition(outcomes, edges)
    own = [key for key in outcomes.own if key in table.verified]
    rows = []
    for group in sorted(groups.unique()):
        problems = groups.index[(groups == group).to_numpy()]
        training = groups.index[(groups != group).to_numpy()]
        if len(training) == 0:
            continue
        # Of the table nothing but the training problems' rows is read.
        candidates = choose_candidates(table, numbers, sizes, own, training)
        times, of_region = table.times, numbers[problems]
        found = pd.concat([times.loc[problems[(of_region == number).to_numpy()], candidates.solvers[number]].min(axis=1)
                           for number in of_region.unique()])
        rows.append({"group": group, "tier": table.tier} | _judge(found[problems], times.loc[problems], own))
    return rows


def _judge(found: pd.Series, of_problems: pd.DataFrame, own: list[str]) -> dict:
    best_own, best_all = of_problems[own].min(axis=1), of_problems.min(axis=1)
    solvable = best_own < math.inf
    ratio = (found / best_own)[solvable].fillna(math.inf)
    ratio_all = (found / best_all)[best_all < math.inf].fillna(math.inf)
    share = float((ratio <= WITHIN).mean()) if len(ratio) else math.nan
    median = _median(ratio)
    return {"problems": int(len(ratio)), "right": int((ratio <= WITHIN).sum()), "share": share, "median": median,
            "worst": float(ratio.max()) if len(ratio) else math.nan,
            "share_all": float((ratio_all <= WITHIN).mean()) if len(ratio_all) else math.nan,
            "passes": bool(median <= WITHIN and share >= LEAST_SHARE)}


def _median(ratio: pd.Series) -> float:
    return float(np.quantile(ratio, 0.5, method="lower")) if len(ratio) else math.nan


def _summary(tier: float, by_family: list[dict], by_seed: list[dict]) -> dict:
    summary: dict = {"tier": tier}
    for name, rows in (("families", by_family), ("seeds", by_seed)):
        of_tier = [row for row in rows if row["tier"] == tier]
        problems = sum(row["problems"] for row in of_tier)
        summary[name] = {"groups": len(of_tier), "pass": sum(row["passes"] for row in of_tier), "problems": problems,
                         "right": sum(row["right"] for row in of_tier),
                         "share": _digits(sum(row["right"] for row in of_tier) / problems if problems else math.nan)}
    return summary


def _plain(row: dict, name: str) -> dict:
    """As JSON has it: what is not finite is null."""
    group = int(row["group"]) if name == "seed" else row["group"]
    return {name: group} | {key: _digits(value) if isinstance(value, float) else value
                            for key, value in row.items() if key != "group"}


def _digits(value: float) -> float | None:
    return float(f"{value:.4g}") if math.isfinite(value) else None


def as_text(evaluation: dict) -> str:
    """A table per tier."""
    lines = []
    for summary in evaluation["tiers"]:
        lines.append(f"tier {summary['tier']:g}, rules made without the family: share of its "
                     f"problems within {evaluation['within']:g} x of the best own solver (of all solvers)")
        for row in evaluation["families"]:
            if row["tier"] != summary["tier"]:
                continue
            median, worst = (f"{row[key]:.3g}" if row[key] is not None else "-" for key in ("median", "worst"))
            lines.append(f"  {row['family']:<18} {row['right']:>3} of {row['problems']:>3}  {row['share'] or 0:7.1%} "
                         f"({row['share_all'] or 0:6.1%})  median {median}, worst {worst}"
                         f"{'' if row['passes'] else '  DOES NOT PASS'}")
        for name in ("families", "seeds"):
            of = summary[name]
            lines.append(f"  {of['pass']} of {of['groups']} {name} pass; "
                         f"{of['share'] or 0:.1%} of {of['problems']} problems")
    lines.append("regions by, all tiers:")
    for of in evaluation["divisions"]:
        lines.append(f"  {', '.join(of['features']):<28} {of['pass']} of {of['families']} families pass; "
                     f"{of['right']} of {of['problems']} problems")
    return "\n".join(lines)
