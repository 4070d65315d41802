"""How much each solver solves, and how often it says so wrongly.

Two figures of wrong claims: a *false success* is of a solver that was asked for this tier's tolerance, or whose method
has none; a claim of one that takes its library's own tolerance is an answer *below the tier*. False successes are counted by
their cause, too (cells.py), and apart from them what was *out of time*. Shares are of the
problems' weight, with Wilson's intervals (intervals.share_with_interval). Problems that a solver does not take as they are
given (*not asked*) are in no share of what it verified; `taken_share` says how much is left.
"""

import numpy as np
import pandas as pd

from .cells import BELOW_TIER, CAUSES, EXCLUDED, FALSE_SUCCESS, NOT_ASKED, OUT_OF_TIME, VERIFIED
from .groups import GROUP, groups
from .intervals import share_with_interval
from .weighted import effective_number

OF_CAUSES = [f"false_{cause}" for cause in CAUSES]
_COUNTS = ["problems", "verified", "at_floor", "false_successes", *OF_CAUSES, "below_tier", "false_infeasible", "failed",
           "below_floor", "out_of_time", "excluded", "not_asked"]
# Share -> (what is counted, out of what): names of counts.
SHARES = {"taken_share": ("taken", "problems"), "attempted_share": ("attempted", "problems"),
          "verified_share": ("verified", "taken"),
          "verified_of_attempted": ("verified", "attempted"), "false_share": ("false_successes", "attempted"),
          "below_tier_share": ("below_tier", "attempted"), "false_of_claims": ("wrong_claims", "claims")}
COLUMNS = [*GROUP, "solver", "asked", *_COUNTS, "attempted", "claims", "weight", "n_eff",
           *(share + end for share in SHARES for end in ("", "_low", "_high"))]


def coverage_table(cells: pd.DataFrame) -> pd.DataFrame:
    """A row per group and solver; problems that count only. verified + false_successes + below_tier + failed + out_of_time +
    excluded + not_asked = problems, and false_successes is the sum of OF_CAUSES; below_floor: of the failed, where the tier is
    below the rounding floor of the answer's forces and no solver passes it (cells.py); claims: answers that the solver called solved, or that were verified
    whatever it said."""
    rows = [label | {"solver": solver} | coverage(own) for label, of_group in groups(cells, counted_only=True)
            for solver, own in of_group.groupby("solver", sort=False)]
    return pd.DataFrame(rows, columns=COLUMNS)


def coverage(cells: pd.DataFrame) -> dict:
    # Name of a count -> of every cell whether it counts there.
    verdict = cells["verdict"].to_numpy()
    flags = {name: cells[name].to_numpy().astype(bool) for name in ("passes", "at_floor", "below_floor", "false_infeasible")}
    kinds = {"problems": np.ones(len(cells), dtype=bool), "at_floor": flags["passes"] & flags["at_floor"],
             "below_floor": flags["below_floor"], "false_infeasible": flags["false_infeasible"]}
    kinds |= {kind: verdict == of for kind, of in (("verified", VERIFIED), ("false_successes", FALSE_SUCCESS),
                                                   ("below_tier", BELOW_TIER), ("excluded", EXCLUDED),
                                                   ("out_of_time", OUT_OF_TIME), ("not_asked", NOT_ASKED))}
    kinds |= {name: cells["cause"].to_numpy() == cause for name, cause in zip(OF_CAUSES, CAUSES)}
    kinds["taken"] = ~kinds["not_asked"]
    kinds["attempted"] = kinds["taken"] & ~kinds["excluded"]
    kinds["wrong_claims"] = kinds["false_successes"] | kinds["below_tier"]
    kinds["claims"] = kinds["verified"] | kinds["wrong_claims"]
    kinds["failed"] = kinds["attempted"] & ~kinds["claims"] & ~kinds["out_of_time"]
    weights = cells["weight"].to_numpy(dtype=float)
    found = {"asked": bool(cells["asked"].all()), **{kind: int(holds.sum()) for kind, holds in kinds.items()},
             "weight": float(weights.sum())}
    bases = pd.factorize(cells["base"])[0]
    found["n_eff"] = effective_number(weights, bases)
    for share, (part, whole) in SHARES.items():
        of = kinds[whole]
        found |= share_with_interval(kinds[part][of], weights[of], bases[of], share, share)
    return found
