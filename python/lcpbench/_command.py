"""The command lcpbench, which the package brings along."""

import os
import sys
from pathlib import Path

_FOLDER = Path(__file__).parent
# The programs of other projects' solvers, where the package has them: the extension would look beside Python.
if (_FOLDER / "libexec").is_dir():
    os.environ.setdefault("LCPBENCH_WORKER_DIR", str(_FOLDER / "libexec" / "lcpbench"))


def command() -> Path:
    """Where the program lcpbench is that has the solvers of this package."""
    return _FOLDER / "bin" / "lcpbench"


def main():
    """Becomes that program."""
    os.execv(command(), ["lcpbench", *sys.argv[1:]])
