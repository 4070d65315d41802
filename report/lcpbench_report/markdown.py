"""A report in Markdown (summary.md.j2), and the headline of README.md and docs/results.md (headline.md.j2)."""

from . import choice, shown_tables
from .fairness import limitations
from .headline_table import Headline, headline
from .inputs import Inputs
from .sentences import render as rendered
from .statistics.class_times import LEAST_FOR_P99
from .summary import false_successes, peers


def full_headline(inputs: Inputs, found: Headline, block: str = "") -> str:
    """@param block  only this one of the template"""
    return rendered("headline.md.j2", block, inputs=inputs, found=found, shown=shown_tables, peers=peers(found),
                    least=LEAST_FOR_P99, false_successes=false_successes(inputs))


def render(inputs: Inputs, lines: list[str]) -> str:
    """@param lines  what the report finds, a sentence each; they come first"""
    found = headline(inputs) if len(inputs.cells) else None
    friction = inputs.friction if len(inputs.cells) else None
    return rendered("summary.md.j2", inputs=inputs, lines=lines, shown=shown_tables, tier=choice.main_tier(inputs),
                    headline=full_headline(inputs, found) if found and found.classes else "",
                    with_friction=friction and headline(friction), false_with_friction=friction and false_successes(friction),
                    limitations=limitations(inputs))
