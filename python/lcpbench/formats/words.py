"""The words of a text file and their lines, for readers of formats that are words with spaces between them."""

import codecs
import collections
import itertools
import math
import re
from collections.abc import Iterable
from typing import NoReturn

import numpy as np

from .problem import FormatError

# float() and int() take more: nan, 1_000, digits of other scripts.
_NOT_OF_NUMBERS = re.compile(rb"[^0-9eE+.-]")
_WHOLE = re.compile(rb"-?[0-9]{1,19}")
_LONGEST = 40  # of a word in a refusal
_MOST_WORDS = 1 << 16  # that are read at a time
_MARKS = {codecs.BOM_UTF8: "UTF-8", codecs.BOM_UTF16_LE: "UTF-16", codecs.BOM_UTF16_BE: "UTF-16"}


def number(word: bytes) -> float | None:
    """A finite number in plain digits, or None. What is too small for a double is 0."""
    if _NOT_OF_NUMBERS.search(word):
        return None
    try:
        value = float(word)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


class Words:
    """Every refusal is a FormatError `name:line: expected ..., found ...`. Memory: one line."""

    def __init__(self, lines: Iterable[bytes], name: str):
        self._lines = iter(lines)
        self._ahead: collections.deque[bytes] = collections.deque()
        self._name = name
        self._number = 0
        self.line = b""  # as it stands
        self._words: list[bytes] = []
        self._next = 0
        for line in self.lines_ahead(1):
            for coding in [coding for mark, coding in _MARKS.items() if line.startswith(mark)]:
                raise FormatError(f"{self.place}: expected text without a byte order mark, found one of {coding}")

    @property
    def place(self) -> str:
        """An empty file ends on its first line."""
        return f"{self._name}:{max(self._number, 1)}"

    def rejected(self, expected: str, found: object) -> FormatError:
        text = found.decode(errors="replace") if isinstance(found, bytes) else str(found)
        text = text if len(text) <= _LONGEST else text[:_LONGEST - 3] + "..."
        return FormatError(f"{self.place}: expected {expected}, found " + (f"'{text}'" if text else "nothing"))

    def reject(self, expected: str, found: object) -> NoReturn:
        raise self.rejected(expected, found)

    def reject_end(self, expected: str) -> NoReturn:
        raise FormatError(f"{self.place}: expected {expected}, found the end of the file")

    def lines_ahead(self, count: int) -> list[bytes]:
        """So many of the next lines, fewer at the end of the file, which stay where they are."""
        while len(self._ahead) < count and (line := next(self._lines, None)) is not None:
            self._ahead.append(line)
        return list(itertools.islice(self._ahead, count))

    def skip_lines(self, count: int) -> None:
        """Passes over lines that lines_ahead() has given."""
        for _ in range(count):
            self._ahead.popleft()
        self._number += count

    def ahead(self, count: int) -> list[bytes]:
        """So many of the next words, fewer at the end of the file, which stay where they are."""
        words, lines = self._words[self._next:], 0
        while len(words) < count and len(self.lines_ahead(lines + 1)) > lines:
            words += self._ahead[lines].split()
            lines += 1
        return words[:count]

    def next_line(self) -> bool:
        line = self._ahead.popleft() if self._ahead else next(self._lines, None)
        self.line = line or b""
        self._words, self._next = self.line.split(), 0
        if line is not None:
            self._number += 1
        return line is not None

    def skip_line(self) -> None:
        """Passes over the rest of this line."""
        self._next = len(self._words)

    def require_line(self, expected: str) -> None:
        if not self.next_line():
            self.reject_end(expected)

    def word(self) -> bytes:
        """The next word of this line, b"" at its end."""
        self._next += 1
        return self._words[self._next - 1] if self._next <= len(self._words) else b""

    def peek_of_any_line(self) -> bytes:
        """The next word, of this line or a later one. b"" at the end of the file only."""
        while self._next >= len(self._words):
            if not self.next_line():
                return b""
        return self._words[self._next]

    def word_of_any_line(self) -> bytes:
        self.peek_of_any_line()
        return self.word()

    def expect(self, expected: bytes) -> None:
        """b"" for the end of the line."""
        word = self.word()
        if word != expected:
            self.reject(f"'{expected.decode()}'" if expected else "the end of the line", word)

    def integer(self, least: int, most: int, what: str, word: bytes | None = None) -> int:
        word = self.word() if word is None else word
        value = int(word) if _WHOLE.fullmatch(word) else None
        if value is not None and least <= value <= most:
            return value
        self.reject(f"{what} from {least} to {most}", word)

    def number(self, word: bytes | None = None) -> float:
        word = self.word() if word is None else word
        value = number(word)
        return self.reject("a finite number", word) if value is None else value

    def integer_of_any_line(self, least: int, most: int, what: str) -> int:
        word = self.word_of_any_line()
        return self.integer(least, most, what, word) if word else self.reject_end(what)

    def numbers_of_any_line(self, count: int, what: str) -> np.ndarray:
        """`count` finite numbers. Memory in proportion to those that are there, whatever was promised."""
        parts, found = [], 0
        while found < count:
            values = self._some_numbers(found, count, what)
            parts.append(values)
            found += len(values)
        return np.concatenate(parts) if parts else np.zeros(0)

    def _some_numbers(self, begin: int, end: int, what: str) -> np.ndarray:
        """At least one of the numbers from `begin` to `end`."""
        words, lines = [], []
        while len(words) < min(end - begin, _MOST_WORDS) and self.peek_of_any_line():
            words += self._words[self._next:self._next + end - begin - len(words)]
            self._next += len(words) - (lines[-1][0] if lines else 0)
            lines.append((len(words), self._number))
        if not words:
            self.reject_end(f"number {begin + 1} of the {end} of {what}")
        if not _NOT_OF_NUMBERS.search(b"".join(words)):
            try:
                values = np.array(list(map(float, words)))
            except ValueError:
                values = np.array([np.nan])
            if np.isfinite(values).all():
                return values
        k = next(k for k, word in enumerate(words) if number(word) is None)
        self._number = next(line for last, line in lines if k < last)
        self.reject(f"number {begin + k + 1} of the {end} of {what} to be finite", words[k])
