"""Which two campaigns can be compared: two runs of one plan, by other builds perhaps.

Builds may differ in which solvers they have and of what version. What every solver was asked must not.
"""

import json

from ..errors import ReportError
from .load import Campaign
from .same import ENVIRONMENT

# Of a solver: what it was asked; `base` and `settings` are of variants alone. The rest describes its build, or is a
# label (`setting`).
_ASKED = {"uses_tolerance": None, "tolerance": None, "ablation": None, "base": "", "settings": {}}


def require_same_plan(old: Campaign, new: Campaign) -> None:
    """@throws ReportError naming the first key of campaign.json that differs"""
    ignored = (*ENVIRONMENT, "solvers")
    for key in [*old.info, *(key for key in new.info if key not in old.info)]:
        if key not in ignored and old.info.get(key) != new.info.get(key):
            raise ReportError("campaign.json", f"key '{key}' is {_word(old.info.get(key))} in OLD and "
                              f"{_word(new.info.get(key))} in NEW", "two campaigns of one plan")
    asked = [{solver["key"]: {k: solver.get(k, absent) for k, absent in _ASKED.items()} for solver in c.info["solvers"]} for c in (old, new)]
    for key in asked[0]:
        if key in asked[1] and asked[0][key] != asked[1][key]:
            raise ReportError("campaign.json", f"solver {key!r} is {_word(asked[0][key])} in OLD and "
                              f"{_word(asked[1][key])} in NEW", "two campaigns of one plan")
    for name, about in old.problems.items():
        other = new.problems.get(name, about)
        for key in ("set", "family", "base", "weight", "size_class", "rows", "counts", "reference"):
            if about[key] != other[key]:
                raise ReportError("problems.jsonl", f"problem {name!r} has {key} {about[key]!r} in OLD and "
                                  f"{other[key]!r} in NEW", "two campaigns of one plan")


def _word(value) -> str:
    text = json.dumps(value)
    return text if len(text) <= 80 else text[:77] + "..."
