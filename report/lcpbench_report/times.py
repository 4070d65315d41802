"""Every cell as a row of a CSV file: solver x family x n x tier with median time and verdict."""

import csv
import io
import math

from . import formats, tables
from .cells import Cell, Cells

COLUMNS = ("solver", "origin", "family", "n", "tier", "verdict", "time_s", "convert_s", "setup_s", "time_source",
           "runs", "verified", "rho", "over_oracle", "floor", "at_floor", "reason")


def as_csv(cells: Cells) -> str:
    text = io.StringIO()
    writer = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    writer.writeheader()
    for family in cells.results.families:
        oracle = dict(cells.oracle_times(family))
        for n in cells.sizes(family):
            for solver in cells.results.solvers:
                for tier in cells.results.tiers:
                    cell = cells.get(family, n, solver, tier)
                    if cell:
                        writer.writerow(_row(cells, cell, oracle.get(n, math.nan)))
    return text.getvalue()


def _row(cells: Cells, cell: Cell, oracle: float) -> dict:
    return {"solver": cell.solver, "origin": cells.results.origin(cell.solver), "family": cell.family, "n": cell.n,
            "tier": formats.tier(cell.tier), "verdict": cell.verdict, "time_s": _number(cell.time_s),
            "convert_s": _number(cell.convert_s),
            "setup_s": _number(cells.setup_time(cell.family, cell.n, cell.solver)) if cell.runs else "",
            "time_source": cell.time_source, "runs": cell.runs, "verified": cell.verified, "rho": _number(cell.rho),
            "over_oracle": _number(cell.time_s / oracle), "floor": _number(cells.floor(cell.family, cell.n)),
            "at_floor": cell.at_floor, "reason": cell.reason}


def _number(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.4g}"


def as_markdown(cells: Cells, tier: float, families: list[str]) -> str:
    """A table per family: a row per solver, a column per size; the time where all seeds are verified, else why not."""
    parts = []
    for family in families:
        sizes = cells.sizes(family)
        parts += [f"{family}, tier {formats.tier(tier)}:", "", "| solver | " + " | ".join(map(str, sizes)) + " |",
                  "| --- |" + " ---: |" * len(sizes)]
        for row in tables.family_table(cells, family, tier):
            parts.append(f"| {row['solver']} | " + " | ".join(map(_cell, row["cells"])) + " |")
        parts += ["| oracle-chol | " + " | ".join(tables.oracle_row(cells, family)) + " |", ""]
    return "\n".join(parts)


def _cell(cell: dict) -> str:
    if cell["kind"] == "passed":
        return f"**{cell['time']}**" if cell["best"] else cell["time"]
    return formats.DASH if cell["kind"] == "excluded" else f"✗ {cell['word']}"
