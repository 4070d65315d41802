"""The sentences of reports, which are blocks of sentences.md.j2: there are the words, here and in its callers the facts."""

import re
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from . import formats
from .statistics.rivals import PORTFOLIO
from .table import code, html, markdown


def rows_of(size_classes) -> str:
    """4–6 and 7–12 rows"""
    found = [formats.size_class(of) for of in size_classes]
    return formats.words(found) + (" row" if found[-1:] == ["1"] else " rows")


def told(row, rival: str, words: str) -> str:
    """A size class of the headline, and by how much ours and a rival differ there."""
    return f"{rows_of([row.size_class])} ({formats.times(row.rivals[rival].ratio.median)} {words})"


def few(items, most: int, between: str = ", ") -> str:
    found = list(items)
    return between.join(found[:most] + ["…"] * (len(found) > most))


def solvers(keys, most: int = 6) -> str:
    found = list(keys)
    return formats.words([*map(code, found[:most]), *[f"{len(found) - most} more"] * (len(found) > most)])


# Templates whose names end in .html.j2 escape what is put into them.
ENVIRONMENT = Environment(loader=FileSystemLoader(Path(__file__).resolve().parent), undefined=StrictUndefined,
                          autoescape=lambda name: name.endswith(".html.j2"), trim_blocks=True, lstrip_blocks=True)
ENVIRONMENT.filters |= {of.__name__: of for of in (
    formats.power, formats.seconds, formats.share_of, formats.percent, formats.signed_percent,
    formats.residual, formats.times, formats.size_class, formats.plural, formats.words, rows_of, told, few, solvers, code, html, markdown)}
ENVIRONMENT.filters["interval"] = lambda of: formats.with_interval(*of)
ENVIRONMENT.filters["split"] = str.split
ENVIRONMENT.globals |= {"DASH": formats.DASH, "PORTFOLIO": PORTFOLIO}


def render(template: str, block: str = "", **facts) -> str:
    """@param block  only this one of the template"""
    found = ENVIRONMENT.get_template(template)
    return "".join(found.blocks[block](found.new_context(facts))) if block else found.render(facts)


def _in_one_line(text: str) -> str:
    """No-break spaces stay."""
    return re.sub("[ \n]+", " ", text).strip(" \n")


def say(block: str, **facts) -> str:
    """A block of sentences.md.j2."""
    return _in_one_line(render("sentences.md.j2", block, **facts))


def lines(template: str, **facts) -> list[str]:
    """The paragraphs of a template, each in one line."""
    return [line for line in map(_in_one_line, re.split("\n{2,}", render(template, **facts))) if line]


ENVIRONMENT.globals["say"] = say
