"""Reads files of JSON, and of JSON lines that a process may have been appending to when it was stopped; writes JSON."""

import json
import lzma
from collections.abc import Callable, Iterator
from pathlib import Path

from ..errors import ReportError
from ..files import write_text


def read_object(path: Path, schema: str, expected: str = "the files of a campaign, benchmarks/RESULTS.md") -> dict:
    """@throws ReportError where the file is missing or no JSON object of this schema"""
    if not path.is_file():
        raise ReportError(path.name, f"missing in {path.parent}", expected)
    try:
        found = json.loads(path.read_bytes().decode("utf-8"))
    except ValueError as error:
        raise ReportError(path.name, str(error), "JSON") from error
    if not isinstance(found, dict) or found.get("schema") != schema:
        word = found.get("schema") if isinstance(found, dict) else found
        raise ReportError(path.name, f"schema is {str(word)[:60]!r}", f"{schema!r}")
    return found


def text_of(value, indent: str = "") -> str:
    """JSON that reviews as a difference: lists and objects that hold no others are on one line."""
    elements = value.values() if isinstance(value, dict) else value
    if not isinstance(value, dict | list) or not any(isinstance(element, dict | list) for element in elements):
        return json.dumps(value, ensure_ascii=False)
    inner = indent + " "
    if isinstance(value, dict):
        parts = [f"{inner}{json.dumps(key)}: {text_of(element, inner)}" for key, element in value.items()]
        return "{\n" + ",\n".join(parts) + "\n" + indent + "}"
    return "[\n" + ",\n".join(inner + text_of(element, inner) for element in value) + "\n" + indent + "]"


def write_object(path: Path, value: dict) -> None:
    """The same object is always the same bytes."""
    write_text(path, text_of(value) + "\n")


def read_lines(path: Path, note: Callable[[str], None]) -> Iterator[tuple[str, object]]:
    """File and line, for messages, and what stands there. Lazily: a campaign's cells may fill hundreds of megabytes.

    Where the file is not there, but one with the ending .xz is, that is read: results that are kept (compact.py).
    A torn last line, that is one without a line break that is not JSON, is passed over with a note.
    @throws ReportError for a missing file, and for any other line that is not JSON
    """
    if not is_there(path):
        raise ReportError(path.name, f"missing in {path.parent}", "the files of a campaign, benchmarks/RESULTS.md")
    try:
        with path.open("rb") if path.is_file() else lzma.open(packed(path), "rb") as file:
            for number, line in enumerate(file, start=1):
                place = f"{path.name}:{number}"
                try:
                    value = _DECODER.decode(line.decode("utf-8"))
                except ValueError as error:  # of which UnicodeDecodeError and JSONDecodeError are kinds
                    if not line.endswith(b"\n"):
                        note(f"{place}: the last line is torn, and was ignored")
                        return
                    raise ReportError(place, str(error), "a line of JSON") from error
                yield place, value
    except (lzma.LZMAError, EOFError) as error:
        raise ReportError(packed(path).name, str(error), "a file compressed by xz") from error


def packed(path: Path) -> Path:
    return path.with_name(path.name + ".xz")


def is_there(path: Path) -> bool:
    return path.is_file() or packed(path).is_file()


def _refuse(word: str) -> float:
    raise ValueError(f"{word} is not JSON")


_DECODER = json.JSONDecoder(parse_constant=_refuse)
