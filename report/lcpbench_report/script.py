"""What the scripts of report/ have in common: one line for what does not fit."""

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

from .errors import ReportError


class Parser(argparse.ArgumentParser):
    """Tells a mistake in one line, without the usage."""

    def error(self, message: str):
        self.exit(2, f"{self.prog}: error: {message}\n")


def guarded(name: str, act: Callable[[], int | None]) -> int:
    """@returns the exit status: that of `act`, 0 where it returns none; or 2 with one line on standard error"""
    try:
        return act() or 0
    except ReportError as error:
        print(f"{name}: error: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"{name}: error: {error.filename}: {error.strerror}", file=sys.stderr)
        return 2
