"""Whether it matters where problems come from: own scenes and motions, recordings of engines, literature."""

import pandas as pd

from .cells import NOT_ASKED, VERIFIED
from .class_times import RATIO, fastest_of_each, ratio
from .groups import COUNTED, GROUP, groups
from .intervals import Bootstrap, share_with_interval
from .launches import Levels
from .model import LITERATURE, ORIGINS, TASK_BUDGET

COLUMNS = [*GROUP, "origin", "solver", "problems", "weight", "verified_share", "verified_low", "verified_high", *RATIO]


def origin_table(cells: pd.DataFrame, levels: Levels = Levels()) -> pd.DataFrame:
    """A row per group, origin and solver: the share verified, and the weighted median of its time over that of the
    fastest verified solver of each problem, over the problems that anyone solved; inf where it fails on half. Of sets
    that do not count only literature; problems that had no turn within a task's budget are left out."""
    rows = []
    for label, of_group in groups(cells):
        turns = of_group[(of_group["excluded"] != TASK_BUDGET) & (of_group["verdict"] != NOT_ASKED)]
        fastest, parts = fastest_of_each(turns), dict(tuple(turns.groupby("origin", sort=False)))
        for origin in [of for of in ORIGINS if of in parts and (label["set"] == COUNTED or of == LITERATURE)]:
            bootstrap = Bootstrap(parts[origin])
            rows += [label | {"origin": origin, "solver": solver, "problems": len(mine), "weight": mine["weight"].sum()}
                     | ratio(mine.set_index("problem"), fastest, label["tier"], bootstrap, levels)
                     | share_with_interval(mine["verdict"] == VERIFIED, mine["weight"], mine["base"], "verified_share", "verified")
                     for solver, mine in parts[origin].groupby("solver", sort=False)]
    return pd.DataFrame(rows, columns=COLUMNS)
