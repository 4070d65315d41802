"""The ablation table: what checks and instruction sets are worth, apart from every other table."""

import pandas as pd

from . import choice, formats
from .inputs import Inputs
from .statistics.class_times import ALL

_WHAT = {"no-self-check": "without its own check", "checked": "with a check and one more solve, diagonal shifted",
         "baseline": "built for the baseline instruction set"}
WORDS = ("These versions are in no other table or figure: our solvers without their own check; peers with a check and, where "
         "it fails, one more solve with a shifted diagonal; our solvers built for the baseline instruction set, for which "
         "Debian builds the peers' libraries. Time: of the version over its solver, median over the problems that both verify. "
         "Right and false: of the version, then of its solver. False: false successes and answers below the tier.")


def rows(inputs: Inputs) -> list[dict[str, str]]:
    """Column -> text, a row per solver and class, at the main tier; empty without ablations."""
    table = inputs.analysis.get("ablation")
    if table is None or table.empty:
        return []
    table = choice.counted(table, choice.main_tier(inputs))
    return [_row(of) for _, own in table.groupby("solver", sort=False) for _, of in own.iterrows()]


def _row(of: pd.Series) -> dict[str, str]:
    false, before = (int(of[prefix + "false_successes"] + of[prefix + "below_tier"]) for prefix in ("", "base_"))
    interval = "" if pd.isna(of["ratio_low"]) else f" ({formats.times(of['ratio_low'])}–{formats.times(of['ratio_high'])})"
    return {"solver": of["base"], "version": _WHAT[of["ablation"]],
            "rows": "all" if of["size_class"] == ALL else formats.size_class(of["size_class"]),
            "problems": str(int(of["problems"])),
            "time": formats.DASH if pd.isna(of["ratio"]) else formats.times(of["ratio"]) + interval,
            "right": f"{formats.share_of(of['verified_share'])}, {formats.share_of(of['base_verified_share'])}",
            "false": f"{false}, {before}"}


def markdown(inputs: Inputs) -> str:
    """Of all size classes together; empty without ablations."""
    found = [row for row in rows(inputs) if row["rows"] == "all"]
    if not found:
        return "This campaign has no ablations.\n"
    lines = [WORDS, "", "| " + " | ".join(found[0]) + " |", "| --- | --- |" + " ---: |" * (len(found[0]) - 2)]
    return "\n".join([*lines, *("| " + " | ".join(row.values()) + " |" for row in found)]) + "\n"


def checks(inputs: Inputs) -> str:
    """A sentence on what our own check changes, at the main tier, over all sizes; empty without such an ablation."""
    table = inputs.analysis.get("ablation")
    if table is None or table.empty:
        return ""
    table = choice.counted(table, choice.main_tier(inputs))
    without = table[(table["ablation"] == "no-self-check") & (table["size_class"] == ALL)]
    parts = [f"`{of['base']}` is right on {formats.share_of(of['verified_share'])} instead of "
             f"{formats.share_of(of['base_verified_share'])} and takes {formats.times(of['ratio'])} of the time"
             for _, of in without.iterrows()]
    return f"without it, {'; '.join(parts)}." if parts else ""


def section(inputs: Inputs) -> list[str]:
    """Of a summary in Markdown."""
    return ["## Ablations", "", markdown(inputs)] if rows(inputs) else []
