"""A report in Markdown (summary.md.j2), and the headline of README.md and docs/results.md (headline.md.j2)."""

from . import choice, shown_tables
from .fairness import limitations
from .headline_table import Headline, headline
from .inputs import Inputs
from .sentences import render as rendered
from .sentences import say
from .statistics.class_times import LEAST_FOR_P99
from .statistics.rivals import PORTFOLIO
from .summary import false_successes, peers


def caption(inputs: Inputs, found: Headline) -> str:
    """What a cell says, by which rule it is bold, and where it was measured."""
    return say("caption", found=found, where=_where(inputs), quick=_quick(inputs))


def short_caption(inputs: Inputs, found: Headline) -> str:
    """What outcomes() says, for the front page."""
    return say("short_caption", found=found, where=_where(inputs), portfolio=found.rival == PORTFOLIO)


def full_headline(inputs: Inputs, found: Headline, block: str = "") -> str:
    """@param block  only this one of the template"""
    return rendered("headline.md.j2", block, inputs=inputs, found=found, where=_where(inputs), quick=_quick(inputs),
                    shown=shown_tables, peers=peers(found), least=LEAST_FOR_P99, false_successes=false_successes(inputs),
                    absent=[entry["key"] for entry in inputs.solvers if not entry["available"]])


def ablation(inputs: Inputs) -> str:
    """The table of all size classes together."""
    table = shown_tables.ablation(inputs, all_only=True)
    return "This campaign has no ablations.\n" if table is None else f"{say('ablation_words')}\n\n{table.markdown()}"


def render(inputs: Inputs, lines: list[str], changes: str = "") -> str:
    """@param lines    what the report finds, a sentence each; they come first
    @param changes  against an earlier run, in Markdown (compare.md.j2)
    """
    found = headline(inputs) if len(inputs.cells) else None
    friction = inputs.friction if len(inputs.cells) else None
    return rendered("summary.md.j2", inputs=inputs, lines=lines, shown=shown_tables, tier=choice.main_tier(inputs),
                    headline=full_headline(inputs, found) if found and found.classes else "",
                    with_friction=friction and headline(friction), false_with_friction=friction and false_successes(friction),
                    measured=_environments(inputs), limitations=limitations(inputs),
                    changes=changes.replace("\n#", "\n##").replace("# ", "### ", 1))


def _quick(inputs: Inputs) -> dict | None:
    """The campaign of a first look, which says which commands narrow its intervals."""
    return next((campaign.info for campaign in inputs.campaigns if campaign.info["name"] == "quick"), None)


def _where(inputs: Inputs) -> str:
    """Machine, commit and date of the first campaign that has them."""
    known = [campaign.info for campaign in inputs.campaigns if campaign.info.get("environment")]
    return f" ({_measured(known[0], ['cpu', 'compiler'], *_widest(known[0]), 'one thread')})" if known else ""


def _widest(info: dict) -> list[str]:
    """What the machine has for vectors, which our kernels are chosen by."""
    has = str((info.get("environment") or {}).get("instruction_sets") or "").split()
    return [next((name for flag, name in (("avx512f", "AVX-512"), ("avx2", "AVX2")) if flag in has), "SSE2")] if has else []


def _measured(info: dict, keys: list[str], *words: str) -> str:
    """What campaign.json says of these keys of the environment, the words, commit and date."""
    environment = info.get("environment") or {}
    commit = str(environment.get("git_commit") or "")[:12]
    changes = " with changes" if environment.get("git_dirty") else ""
    parts = [*map(environment.get, keys), *words, commit and f"commit {commit}{changes}",
             str(info.get("started") or "")[:10]]
    return ", ".join(str(part) for part in parts if part)


def _environments(inputs: Inputs) -> list[str]:
    lines = []
    for name, campaign in zip(inputs.names, inputs.campaigns):
        count = f"{len(campaign.problems)} problems" if campaign.problems else f"{len(campaign.sequences)} sequences"
        told = _measured(campaign.info, ["cpu", "os", "compiler", "flags", "solver_flags"])
        lines.append(f"- {name}: " + "; ".join(filter(None, [count, told])))
    return lines
