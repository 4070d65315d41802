"""data/portfolio.json: which peers a portfolio asks in every size class, and in which order (statistics/portfolio.py)."""

import pandas as pd

from ..choice import nearest
from ..errors import ReportError
from ..statistics.cells import cell_table
from ..statistics.class_times import ALL, classes
from ..statistics.model import Campaign
from ..statistics.portfolio import best_order
from ..statistics.rivals import is_own
from .choice import MACHINE

SCHEMA = "lcpbench-portfolio/1"


def describe(campaigns: list[Campaign]) -> dict:
    """@param campaigns  on tuning problems, which nothing is compared on
    @throws ReportError where no peer was run
    """
    peers = [key for campaign in campaigns for key, entry in campaign.solvers.items() if not is_own(entry)]
    cells = pd.concat([cell_table(campaign) for campaign in campaigns], ignore_index=True)
    cells = cells[cells["solver"].isin(peers)]
    tier = nearest(sorted(set(cells["tier"])))
    orders = {label["size_class"]: best_order(of, [key for key in dict.fromkeys(peers) if key in set(of["solver"])])
              for label, of in classes(cells[cells["tier"] == tier]) if label["size_class"] != ALL}
    if not any(orders.values()):
        raise ReportError("the campaigns", "no peer is right on a problem that counts", "a campaign with peers")
    environment = campaigns[0].info.get("environment", {})
    return {"schema": SCHEMA, "commit": environment.get("git_commit", ""),
            "machine": {key: environment.get(key) for key in MACHINE}, "tier": tier,
            "classes": {size_class: order for size_class, order in orders.items() if order}}
