"""What a campaign finds where the truth is known: a solver against itself under another name, and against itself slowed
by a known factor (`lcpbench run --variant`).
"""

import pandas as pd

from .cells import cell_table
from .load import Campaign
from .pairwise import A_FASTER, NO_DIFFERENCE, pairwise_table
from ..errors import ReportError
from ..table import Table

SLOWDOWN = "slowdown"
COLUMNS = ["tier", "solver", "variant", "slowdown", "problems", "ratio", "ratio_low", "ratio_high", "expected", "found",
           "right"]


def calibration_table(campaign: Campaign) -> pd.DataFrame:
    """Over problems that count, a row per tier and variant that is its base or its base slowed: time of the variant over
    that of the base.

    @throws ReportError where the campaign has no such variant
    """
    known = {(entry["base"], key): float((entry.get("settings") or {}).get(SLOWDOWN, 1))
             for key, entry in campaign.solvers.items()
             if entry.get("base") in campaign.solvers and set(entry.get("settings") or {}) <= {SLOWDOWN}}
    if not known:
        raise ReportError("campaign.json", "no solver is a variant without settings or with a slow-down",
                          "a campaign run with --variant KEY=SOLVER and --variant KEY=SOLVER,slowdown=1.1")
    cells = cell_table(campaign)
    pairs = pairwise_table(cells[cells["counts"]]).set_index(["a", "b"]).sort_index()
    rows = []
    for (base, variant), factor in known.items():
        for _, pair in pairs.loc[[(base, variant)]].iterrows():
            expected = A_FASTER if factor > 1 else NO_DIFFERENCE
            rows.append([pair["tier"], base, variant, factor, pair["both"], 1 / pair["ratio"], 1 / pair["ratio_high"],
                         1 / pair["ratio_low"], expected, pair["verdict"], bool(pair["verdict"] == expected)])
    return pd.DataFrame(rows, columns=COLUMNS)


def as_table(found: pd.DataFrame) -> Table:
    """What was not found as expected in bold."""
    return Table(["solver", "against", "tier", "problems", "time ratio", "95 % interval", "expected", "found"],
                 [[f"`{row.solver}`", f"slowed by {row.slowdown:g}" if row.slowdown > 1 else "itself", f"{row.tier:.0e}",
                   row.problems, f"{row.ratio:.3f}", f"{row.ratio_low:.3f} … {row.ratio_high:.3f}", row.expected,
                   row.found if row.right else f"**{row.found}**"] for row in found.itertuples()], "llrrrlll")
