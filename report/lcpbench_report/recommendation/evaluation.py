"""Tries rules on what they were not made of, and makes data/recommendation.json of both (benchmarks/RESULTS.md).

For every family rules are made of all other families. On each of its problems the recommendation is the fastest of
the candidates that is verified there, since that is what `lcpbench recommend` finds out by measuring them; it is right
where its time is within WITHIN of the best measured solver. A family passes where the median of that ratio is at
most WITHIN and it is right on LEAST_SHARE of the problems or more. The same with seeds in the place of families, and
with sources: all that one engine met, or that was published as one family, is held out at once.
"""

import math

import numpy as np
import pandas as pd

from ..errors import ReportError
from ..formats import short
from . import rules
from .outcomes import Edges, Outcomes
from .rules import WITHIN, TierTable

SCHEMA = "lcpbench-recommendation/1"
LEAST_SHARE = 0.9


def make(outcomes: Outcomes, sequences: Outcomes | None = None, leave_out: frozenset[str] = frozenset()) -> dict:
    """@param sequences  what solvers did from step to step, if it was measured
    @param leave_out  families that the rules are made without; they are then not evaluated either
    """
    families = set(outcomes.table["family"])
    if leave_out - families:
        raise ReportError("--leave-out", f"no problem of family {min(leave_out - families)!r}",
                          "one of " + ", ".join(sorted(families)))
    return {"schema": SCHEMA, "campaigns": outcomes.campaigns, "left_out": sorted(leave_out),
            "near": rules.NEAR, "within": WITHIN, "most_candidates": rules.MOST, "edges": outcomes.edges,
            "regions": _without_end(rules.make_regions(outcomes, leave_out)),
            "sequences": _without_end(rules.make_regions(sequences, leave_out)) if sequences else [],
            "evaluation": None if leave_out else evaluate(outcomes)}


def _without_end(regions: list[dict]) -> list[dict]:
    """The largest size that was measured stands for all above it, at every tier."""
    for tier in {region["tier"] for region in regions}:
        of_tier = [region["where"]["rows"] for region in regions if region["tier"] == tier]
        max(of_tier, key=lambda rows: rows[0])[1] = None
    return regions


def evaluate(outcomes: Outcomes) -> dict:
    tables, edges = rules.tier_tables(outcomes), outcomes.edges
    by_family = [row for table in tables for row in held_out(outcomes, table, table.families, edges)]
    by_seed = [row for table in tables for row in held_out(outcomes, table, table.seeds.fillna(-1), edges)]
    by_source = [row for table in tables for row in held_out(outcomes, table, table.sources, edges)]
    return {"within": WITHIN, "least_share": LEAST_SHARE, "most_candidates": rules.MOST,
            "divisions": compare_divisions(outcomes),
            "tiers": [{"tier": table.tier} | {name: _summary([row for row in rows if row["tier"] == table.tier])
                                              for name, rows in (("families", by_family), ("seeds", by_seed),
                                                                    ("sources", by_source))}
                      for table in tables],
            "families": [_plain(row, "family", str) for row in by_family],
            "seeds": [_plain(row, "seed", int) for row in by_seed],
            "sources": [_plain(row, "source", str) for row in by_source]}


def compare_divisions(outcomes: Outcomes) -> list[dict]:
    """What the regions of the outcomes' edges are worth for families that were held out, and those divided once more by
    each other feature, at its median or, where that is its least value, above it: whether a feature helps."""
    divisions = [outcomes.edges]
    for name, values in outcomes.features.drop(columns=list(outcomes.edges)).items():
        if values.nunique() > 1:
            least, middle = values.min(), values.median()
            above = middle if middle > least else values[values > least].min()
            divisions.append(outcomes.edges | {name: [float(least), float(above)]})
    tables = rules.tier_tables(outcomes)
    found = []
    for division in divisions:
        summary = _summary([row for table in tables for row in held_out(outcomes, table, table.families, division)])
        found.append({"features": list(division), "families": summary["groups"],
                      **{key: summary[key] for key in ("pass", "problems", "right")}})
    return found


def held_out(outcomes: Outcomes, table: TierTable, groups: pd.Series, edges: Edges) -> list[dict]:
    """A row per group (of problems), held out in turn; problems without one are always among those that rules are made
    of."""
    numbers, sizes = rules.partition(outcomes, edges)
    own = [key for key in outcomes.own if key in table.verified]
    rows = []
    for group in sorted(groups.dropna().unique()):
        problems, training = (groups.index[mask.to_numpy()] for mask in (groups == group, groups != group))
        if len(training) == 0:
            continue
        # Of the table nothing but the training problems' rows is read.
        candidates = rules.choose_candidates(table, numbers, sizes, own, training)
        found = pd.concat([table.times.loc[of_region, candidates[number][0]].min(axis=1)
                           for number, of_region in problems.groupby(numbers[problems]).items()])
        rows.append({"group": group, "tier": table.tier} | _judge(found[problems], table.times.loc[problems], own))
    return rows


def _judge(found: pd.Series, of_problems: pd.DataFrame, own: list[str]) -> dict:
    ratio, ratio_all = ((found / best)[best < math.inf].fillna(math.inf)
                        for best in (of_problems[own].min(axis=1), of_problems.min(axis=1)))
    share, share_all = (float((some <= WITHIN).mean()) for some in (ratio, ratio_all))
    median = float(np.quantile(ratio, 0.5, method="lower")) if len(ratio) else math.nan
    return {"problems": len(ratio), "right": int((ratio <= WITHIN).sum()), "share": share, "median": median,
            "worst": float(ratio.max()), "share_all": share_all,
            "passes": bool(median <= WITHIN and share >= LEAST_SHARE)}


def _summary(rows: list[dict]) -> dict:
    problems, right = (sum(row[key] for row in rows) for key in ("problems", "right"))
    return {"groups": len(rows), "pass": sum(row["passes"] for row in rows), "problems": problems, "right": right,
            "share": short(right / problems) if problems else None}


def _plain(row: dict, name: str, kind: type) -> dict:
    """As JSON has it: what is not finite is null."""
    return {name: kind(row["group"])} | {key: short(value) for key, value in row.items() if key != "group"}


def as_text(evaluation: dict) -> str:
    """Tables of families and sources that were held out, of their sums by tier, and of divisions."""
    tables = {"families held out": pd.DataFrame(evaluation["families"]),
              "sources held out": pd.DataFrame(evaluation["sources"]), "by tier": pd.json_normalize(evaluation["tiers"]),
              "regions by, all tiers": pd.DataFrame(evaluation["divisions"])}
    return "\n\n".join(f"{title}:\n{table.to_string(index=False)}" for title, table in tables.items())
