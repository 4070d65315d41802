"""What tests have in common: folders of their own, and the commands of report.py."""

import contextlib
import io
import tempfile
import unittest
from pathlib import Path

import report


class FolderCase(unittest.TestCase):
    """Every test has a new `folder`."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)


class SharedFolderCase(unittest.TestCase):
    """All tests of a class have one folder, `path`."""

    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.path = Path(temporary.name)


def run(*words) -> tuple[int, str, str]:
    """Exit status, standard output and standard error of `report.py WORDS...`."""
    out, error = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(error):
        try:
            status = report.main([str(word) for word in words])
        except SystemExit as end:
            status = end.code
    return status, out.getvalue(), error.getvalue()
