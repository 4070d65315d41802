"""What single means are worth: solvers without their self-check, peers with a check and one more solve with a shifted
diagonal, own solvers built for the baseline instruction set. Each against the solver that it is a version of; they stand
in no other table.
"""

import numpy as np
import pandas as pd

from .class_times import classes
from .coverage import coverage
from .groups import GROUP
from .intervals import Bootstrap
from .weighted import weighted_median

_COUNTS = ["verified_share", "false_successes", "below_tier"]
COLUMNS = [*GROUP, "size_class", "solver", "ablation", "base", "problems", "both", "ratio", "ratio_low", "ratio_high",
           *_COUNTS, *(f"base_{count}" for count in _COUNTS)]


def ablation_table(cells: pd.DataFrame, ablated: pd.DataFrame, solvers: list[dict]) -> pd.DataFrame:
    """A row per group, size class (and `all`) and solver of an ablation, over the problems that both have a cell on;
    problems that count only. `ratio`: weighted median of its fresh time over its base's where both are verified.

    @param cells    of cells.cell_table
    @param ablated  of cells.ablation_cells
    @param solvers  the entries of campaign.json
    """
    versions = {entry["key"]: entry for entry in solvers if entry["ablation"]}
    bases = {entry["base"] for entry in versions.values()}
    rows = []
    for label, of_class in classes(pd.concat([cells[cells["solver"].isin(bases)], ablated], ignore_index=True)):
        bootstrap = Bootstrap(of_class)
        by_solver = {solver: own.set_index("problem") for solver, own in of_class.groupby("solver", sort=False)}
        for key, entry in versions.items():
            if key not in by_solver or entry["base"] not in by_solver:
                continue
            common = by_solver[key].index.intersection(by_solver[entry["base"]].index, sort=False)
            if len(common):
                own, base = by_solver[key].loc[common], by_solver[entry["base"]].loc[common]
                rows.append(label | {"solver": key, "ablation": entry["ablation"], "base": entry["base"],
                                     "problems": len(common)} | _row(own, base, bootstrap))
    return pd.DataFrame(rows, columns=COLUMNS)


def _row(own: pd.DataFrame, base: pd.DataFrame, bootstrap: Bootstrap) -> dict:
    both = own.index[np.isfinite(own["time_s"]) & np.isfinite(base["time_s"])]
    ratios, weights = own.loc[both, "time_s"] / base.loc[both, "time_s"], own.loc[both, "weight"]
    low, high = bootstrap.median(both, ratios, weights)
    found, of_base = coverage(own), coverage(base)
    return {"both": len(both), "ratio": weighted_median(ratios, weights), "ratio_low": low, "ratio_high": high,
            **{count: found[count] for count in _COUNTS}, **{f"base_{count}": of_base[count] for count in _COUNTS}}
