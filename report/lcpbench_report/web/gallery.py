"""Pictures of the scene families, with contacts and forces: a folder of <family>.svg as `lcpbench scene` draws them,
and scenes.txt, what `lcpbench list scenes` prints, for their order and what they are.
"""

import base64
from dataclasses import dataclass
from pathlib import Path

from ..errors import ReportError

WORDS = "scenes.txt"
_FRICTION = " (friction)"
_MOST_BYTES = 300_000  # of one picture: the page holds all of them


@dataclass(frozen=True)
class Picture:
    family: str
    words: str  # title and purpose
    friction: bool
    address: str  # data URI: as an image it cannot run scripts, nor can its ids clash with others


def read(folder: Path) -> list[Picture]:
    """@throws ReportError where the folder has no list, or a picture is missing, too large or none"""
    listed = folder / WORDS
    if not listed.is_file():
        raise ReportError(str(folder), f"has no {WORDS}", "what `lcpbench list scenes` prints")
    found = [line.split(maxsplit=1) for line in listed.read_text(encoding="utf-8").splitlines()]
    return [Picture(family, words.removesuffix(_FRICTION), words.endswith(_FRICTION), _address(folder / f"{family}.svg"))
            for family, words in found]


def _address(path: Path) -> str:
    if not path.is_file():
        raise ReportError(str(path), "missing", f"a picture of every scene that {WORDS} lists")
    text = path.read_bytes()
    if len(text) > _MOST_BYTES or not text.lstrip().startswith(b"<svg"):
        raise ReportError(str(path), f"{len(text)} bytes that begin with {text[:12]!r}",
                          f"an SVG picture of at most {_MOST_BYTES} bytes")
    return "data:image/svg+xml;base64," + base64.b64encode(text).decode("ascii")
