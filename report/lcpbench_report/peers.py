"""What is known of our solvers and of the peers, whether a campaign has them or not: peers.json, as `lcpbench list peers`
writes it."""

import json
from functools import cache
from pathlib import Path

from . import formats
from .inputs import Inputs
from .table import Table, code

_FILE = Path(__file__).resolve().parent / "peers.json"
_ROUTES = {"compiled": "C or C++", "python": "Python"}
# Ends of the keys of a peer with its library's own options, and of one compiled for any x86-64.
RELATED = ("-default", "-baseline")
_RULES = {"direct": "has none", "default": "its library's own"}


@cache
def facts() -> dict:
    return json.loads(_FILE.read_text(encoding="utf-8"))


def law(solver: str) -> str:
    """Of friction, that its answers obey; "" where that is not known."""
    return next((of["law"] for of in facts()["own"] + facts()["peers"] if of["key"] == solver), "")


def rule(peer: dict) -> str:
    """The tolerance that it is given for each tier."""
    return _RULES.get(peer["tolerance"]) or ", ".join(map(formats.power, peer["tolerances"]))


def table(inputs: Inputs) -> Table:
    """A row per peer; versions are those of the campaigns."""
    rows = []
    for peer in facts()["peers"]:
        entry = inputs.entries.get(peer["key"]) or {}
        version = entry.get("library_version") or "not in these results"
        rows.append([code(peer["key"]), f"{peer['library']}: {peer['method']}", rule(peer), peer["stops"], version,
                     peer["licence"], _ROUTES[peer["route"]]])
    return Table(["key", "library and method", "tolerance at 1e-3, 1e-6, 1e-9", "stops by", "version", "licence",
                  "worker"], rows, "lwlwlwl")


def criteria() -> Table:
    """A row per solver that has a tolerance: what it is given, what that bounds, and how it is reached. Transformations
    leave it as it is."""
    return Table(["key", "tolerance at 1e-3, 1e-6, 1e-9", "which bounds", "worker"],
                 [[code(peer["key"]), rule(peer), peer["stops"], _ROUTES[peer["route"]]]
                  for peer in facts()["peers"]
                  if peer["tolerance"] == "follows" and not peer["key"].endswith(RELATED) and "within" not in peer],
                 "llll")


def left_out() -> Table:
    return Table(["solver", "why it is not included"],
                 [[other["name"], other["reason"]] for other in facts()["left_out"]], "ll")
