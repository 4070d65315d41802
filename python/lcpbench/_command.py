"""The command lcpbench, which the package brings along."""

import os
import sys
from pathlib import Path


def command() -> Path:
    """Where the program lcpbench is that has the solvers of this package."""
    return Path(__file__).parent / "bin" / "lcpbench"


def main():
    """Becomes that program."""
    os.execv(command(), ["lcpbench", *sys.argv[1:]])
