"""What README says that a result file holds: its text stands between markers, and is written here.

    <!-- numbers:NAME -->...<!-- end -->

A block of lines has its markers on lines of their own; a number within a sentence has them around it.
"""

import json
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from . import ablation_table, formats, markdown_headline
from .errors import ReportError
from .headline_table import headline
from .inputs import Inputs

_BLOCK = re.compile(r"<!-- numbers:([a-z-]+) -->(.*?)<!-- end -->", re.DOTALL)
FIGURE = Path("report/reference/headline.svg")  # below the folder of README
_ALT = "Median fresh time against the number of rows: own solvers, the best of each peer library, and the oracle"


@dataclass(frozen=True)
class Source:
    inputs: Inputs
    root: Path  # README's folder: what is committed beside it


def fill(text: str, source: Source, name: str) -> str:
    """@returns `text` with every block written anew
    @throws ReportError for a block that is not known, or without any
    """
    if not _BLOCK.search(text):
        raise ReportError(name, "has no block of numbers", "'<!-- numbers:NAME -->' and, after it, '<!-- end -->'")
    written: dict[str, str] = {}

    def write(found: re.Match) -> str:
        block = found[1]
        if block not in BLOCKS:
            raise ReportError(name, f"block 'numbers:{block}'", "one of " + ", ".join(BLOCKS))
        if block not in written:
            written[block] = BLOCKS[block](source)
        new = f"\n\n{written[block].strip()}\n\n" if found[2].startswith("\n") else written[block].strip()
        return f"<!-- numbers:{block} -->{new}<!-- end -->"

    return _BLOCK.sub(write, text)


def _headline(source: Source) -> str:
    found = headline(source.inputs)
    return markdown_headline.render(source.inputs, found) + f"\n![{_ALT}]({FIGURE.as_posix()})"


def _info(source: Source) -> dict:
    """campaign.json of the first campaign."""
    return source.inputs.campaigns[0].info


def _streams(source: Source) -> str:
    """1000 problems up to 30 rows, 256 up to 100 rows"""
    largest: dict[int, int] = {}
    for of in _info(source)["size_classes"]:
        if of["stream"]:
            largest[of["stream"]] = of["most"]
    return formats.words([f"{least} problems up to {rows} rows" for least, rows in largest.items()])


def _limits(source: Source) -> str:
    """Rules of size and whom they leave out."""
    rules: dict[tuple, list[str]] = {}
    for limit in _info(source).get("size_limits", []):
        rules.setdefault((limit["reason"], limit["largest"]), []).append(f"`{limit['solver']}`")
    return "; ".join(f"{reason}: to {largest} rows ({', '.join(who)})" for (reason, largest), who in rules.items())


def _manifests(source: Source) -> str:
    return formats.words([f"`{of['name']}` {of['version']}" for of in _info(source).get("manifests", [])])


def _tuning(source: Source) -> str:
    """What data/tuned.json says of how settings were chosen."""
    tuned = json.loads((source.root / "data/tuned.json").read_text(encoding="utf-8"))
    solvers = tuned["solvers"]
    tried = [len(solver["tried"]) for solver in solvers]
    changed = [f"`{solver['solver']}`" for solver in solvers if solver["chosen"]]
    sizes = formats.words([str(size) for size in tuned["problems"]["sizes"]])
    return (f"At most {tuned['budget']} configurations of each of {len(solvers)} solvers were tried ({min(tried)} to "
            f"{max(tried)}), on {tuned['problems']['count']} problems with {sizes} rows at tier "
            f"{formats.power(tuned['tier'])}; {len(changed)} have chosen settings other than their default: "
            f"{formats.words(changed)}. The other {len(solvers) - len(changed)} keep it.")


def _recommendation(source: Source) -> str:
    """What data/recommendation.json says of families that its rules were not made of."""
    tried = json.loads((source.root / "data/recommendation.json").read_text(encoding="utf-8"))["evaluation"]
    shares = [of["families"]["share"] for of in tried["tiers"]]
    passed, groups = (sum(of["families"][key] for of in tried["tiers"]) for key in ("pass", "groups"))
    return (f"the best of the named backends is within {tried['within']:g}× of the best of ours on {100 * min(shares):.1f} % "
            f"to {100 * max(shares):.1f} % of the problems, by tier and measure, and in {passed} of {groups} cases (families "
            f"by tiers and measures) on at least {100 * tried['least_share']:.0f} %.")


BLOCKS: dict[str, Callable[[Source], str]] = {
    "headline": _headline,
    "ablation": lambda source: ablation_table.markdown(source.inputs),
    "ablation-of-checks": lambda source: ablation_table.checks(source.inputs),
    "streams": _streams,
    "passes": lambda source: str(_info(source)["passes"]),
    "limits": _limits,
    "manifests": _manifests,
    "tuning": _tuning, "recommendation": _recommendation,
}
