"""How much each solver solves, and how often it says so wrongly. Shares with Wilson's intervals (1927)."""

import pandas as pd

from .cells import EXCLUDED, FALSE_SUCCESS, VERIFIED
from .groups import GROUP, groups
from .intervals import share_interval

_COUNTS = ["problems", "verified", "at_floor", "false_successes", "false_infeasible", "failed", "excluded"]
# Share -> what is counted, out of what.
SHARES = {"verified_share": ("verified", "problems"), "verified_of_attempted": ("verified", "attempted"),
          "false_share": ("false_successes", "attempted"), "false_of_claims": ("false_successes", "claims")}
COLUMNS = [*GROUP, "solver", *_COUNTS, "attempted", "claims",
           *(share + end for share in SHARES for end in ("", "_low", "_high"))]


def coverage_table(cells: pd.DataFrame) -> pd.DataFrame:
    """A row per group and solver; problems that count only. verified + false_successes + failed + excluded = problems;
    claims: answers that the solver called solved, or that were verified whatever it said."""
    rows = []
    for group in groups(cells, counted_only=True):
        for solver, own in group.cells.groupby("solver", sort=False):
            rows.append({**group.label, "solver": solver, **_counts(own)})
            for share, (part, whole) in SHARES.items():
                low, high = share_interval(rows[-1][part], rows[-1][whole])
                value = rows[-1][part] / rows[-1][whole] if rows[-1][whole] else float("nan")
                rows[-1] |= {share: value, f"{share}_low": low, f"{share}_high": high}
    return pd.DataFrame(rows, columns=COLUMNS)


def _counts(cells: pd.DataFrame) -> dict:
    verdict = cells["verdict"]
    found = {"problems": len(cells), "verified": int((verdict == VERIFIED).sum()),
             "at_floor": int((cells["passes"].astype(bool) & cells["at_floor"].astype(bool)).sum()),
             "false_successes": int((verdict == FALSE_SUCCESS).sum()),
             "false_infeasible": int(cells["false_infeasible"].astype(bool).sum()),
             "excluded": int((verdict == EXCLUDED).sum())}
    found["attempted"] = found["problems"] - found["excluded"]
    found["failed"] = found["attempted"] - found["verified"] - found["false_successes"]
    found["claims"] = found["verified"] + found["false_successes"]
    return found
