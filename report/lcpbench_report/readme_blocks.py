"""What README.md and docs/ say that a result file holds: its text stands between markers, and is written here.

    <!-- numbers:NAME -->...<!-- end -->

A block of lines has its markers on lines of their own; a number within a sentence has them around it.
"""

import json
import os
import re
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path

from . import choice, comparison, formats, markdown, peers, shown_tables, summary
from .errors import ReportError
from .headline_table import Headline, not_won
from .inputs import Inputs
from .sentences import say
from .statistics import changes
from .statistics.load import load_campaign
from .statistics.tables import MAIN
from .table import Table, code

BLOCK = re.compile(r"<!-- numbers:([a-z-]+) -->(.*?)<!-- end -->", re.DOTALL)
FIGURE = Path("report/reference/headline.svg")  # below the repository
AGAIN = Path("report/reference/core-again")  # the same campaign, run once more
_ALT = "Median fresh time against rows: own solvers, the best of each peer library, the oracle"


@dataclass(frozen=True)
class Page:
    inputs: Inputs
    found: Headline  # of the inputs
    root: Path  # of the repository: what is committed there, and the figure
    path: Path  # of the Markdown file: its links are relative to its folder

    @property
    def info(self) -> dict:
        """campaign.json of the first campaign."""
        return self.inputs.campaigns[0].info

    def data(self, name: str) -> dict:
        return json.loads((self.root / "data" / f"{name}.json").read_text(encoding="utf-8"))

    def link(self, target: Path) -> str:
        """@param target  below the repository"""
        return Path(os.path.relpath((self.root / target).resolve(), self.path.resolve().parent)).as_posix()


def fill(text: str, page: Page) -> str:
    """@returns `text` with every block written anew
    @throws ReportError for a block that is not known
    """
    written: dict[str, str] = {}

    def write(found: re.Match) -> str:
        block = found[1]
        if block not in BLOCKS:
            raise ReportError(str(page.path), f"block 'numbers:{block}'", "one of " + ", ".join(BLOCKS))
        if block not in written:
            written[block] = BLOCKS[block](page)
        new = f"\n\n{written[block].strip()}\n\n" if found[2].startswith("\n") else written[block].strip()
        return f"<!-- numbers:{block} -->{new}<!-- end -->"

    return BLOCK.sub(write, text)


def _headline(page: Page) -> str:
    """What README shows: caption, a row per size class, where we do not surely win, figure, and a row per instruction set."""
    table, flags = shown_tables.short(page.found), shown_tables.short_equal_flags(page.inputs)
    words = say("not_won", rows=not_won(page.found)) if table else summary.peers(page.found)
    return "\n".join([say("short_caption", inputs=page.inputs, found=page.found), "", *([table.markdown()] if table else []),
                      words, "", f"![{_ALT}]({page.link(FIGURE)})",
                      *(["", say("short_flag_words"), "", flags.markdown()] if flags else [])])


def _moved(page: Page, table: bool = True) -> str:
    """How far what is published of MAIN moved from the campaign to its repetition; "" without one."""
    if not (page.root / AGAIN).is_dir():
        return ""
    found = _repetition(page.inputs, page.root / AGAIN)
    values = found.values[(found.values["tier"] == choice.main_tier(page.inputs)) & (found.values["what"].str.split().str[0] == MAIN)]
    words = say("run_twice", found=found, values=values, reach=changes.REACH, own=page.inputs.own)
    return "\n".join(["## Run twice", "", words, "", comparison.values_table(values).markdown()]) if table else words


@cache
def _repetition(inputs: Inputs, again: Path) -> changes.Comparison:
    return changes.compare(inputs.campaigns[0], load_campaign(again))


def _tuning(page: Page) -> str:
    """What data/tuned.json says of how settings were chosen."""
    tuned = page.data("tuned")
    changed: dict[str, list[int]] = {}
    for of in tuned["solvers"]:
        if of["chosen"]:
            changed.setdefault(of["solver"], []).append(of["rows"])
    where = [f"`{solver}`" + ("" if rows == tuned["problems"]["sizes"] else f" (at {formats.words(map(str, rows))} rows)")
             for solver, rows in changed.items()]
    count = len({of["solver"] for of in tuned["solvers"]})
    return say("tuning", tuned=tuned, tried=[len(of["tried"]) for of in tuned["solvers"]], solvers=count, where=where,
               rest=count - len(changed))


def _peers(page: Page) -> list[dict]:
    """All peers, with the versions that the campaign met."""
    library = {of["key"]: of["library"] for of in peers.facts()["peers"]}
    met = {library[key]: of["library_version"] for of in page.info["solvers"]
           if (key := of["base"] or of["key"]) in library and of["library_version"]}
    return [of | {"library_version": met.get(of["library"], formats.DASH)} for of in peers.facts()["peers"]]


def _solver_table(page: Page, solvers: list[dict], *more: str) -> str:
    """Key, method, whether the tolerance matters, and the settings that data/tuning.json declares, with their values.
    Keys that differ from another one by peers.RELATED have no row of their own.

    @param more  further members of the solvers' entries
    """
    declared = {of["solver"]: of["settings"] for of in page.data("tuning")["solvers"]}
    rows = []
    for of in solvers:
        if of["key"].endswith(peers.RELATED):
            continue
        settings = "; ".join(f"`{name}` {', '.join(values)}" for name, values in declared.get(of["key"], {}).items())
        rows.append([f"`{of['key']}`", of["method"], of["tolerance"], settings or formats.DASH, *(of[key] for key in more)])
    columns = ["key", "method", "tolerance", "settings", *(key.removeprefix("library_") for key in more)]
    return Table(columns, rows, "l" * len(columns)).markdown()


BLOCKS: dict[str, Callable[[Page], str]] = {
    "headline": _headline,
    # The conventions, the table by size class, false successes, and the table of all solvers.
    "headline-details": lambda page: markdown.full_headline(page.inputs, page.found),
    "moved": _moved,
    "moved-words": partial(_moved, table=False),
    "sealed": lambda page: shown_tables.sealed_apart(page.inputs),
    "streams": lambda page: say("streams", classes={of["stream"]: of["most"] for of in page.info["size_classes"] if of["stream"]}),
    "limits": lambda page: say("limits", rules=Counter((of["reason"], of["largest"]) for of in page.info.get("size_limits", []))),
    "manifests": lambda page: formats.words([f"`{of['name']}` {of['version']}" for of in page.info.get("manifests", [])]),
    "tuning": _tuning,
    "own-keys": lambda page: ", ".join(code(of["key"]) for of in peers.facts()["own"]),
    "peer-projects": lambda page: formats.words(list(dict.fromkeys(of["library"] for of in peers.facts()["peers"]))),
    "own-solvers": lambda page: _solver_table(page, peers.facts()["own"]),
    "peer-criteria": lambda page: peers.criteria().markdown(), "peers-left-out": lambda page: peers.left_out().markdown(),
    "peer-solvers": lambda page: _solver_table(page, _peers(page), "library_version", "licence"),
}
