"""What tests have in common: folders of their own, edits of campaigns' files, and the commands of report.py."""

import contextlib
import io
import json
import tempfile
import unittest
from collections.abc import Callable
from pathlib import Path
from unittest import mock

import report
from lcpbench_report.charts import plotly
from lcpbench_report.inputs import Inputs, load_inputs
from lcpbench_report.statistics.load import load_campaign
from lcpbench_report.statistics.model import Campaign
from lcpbench_report.web import page


class FolderCase(unittest.TestCase):
    """Every test has a new `folder`."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def assert_refused(self, *words, told: tuple[str, ...] = ()) -> None:
        """`report.py WORDS...` ends with status 2, writes nothing and tells why in one line."""
        status, out, error = run(*words)
        self.assertEqual((status, out, error.count("\n")), (2, "", 1), error)
        self.assertNotIn("\x1b", error)
        for word in told:
            self.assertIn(word, error)


class SharedFolderCase(unittest.TestCase):
    """All tests of a class have one folder, `path`."""

    assert_refused = FolderCase.assert_refused

    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.path = Path(temporary.name)


def campaign_of(write: Callable[..., Path], *arguments, **more) -> Campaign:
    """What is read of a folder that `write` fills."""
    with tempfile.TemporaryDirectory() as folder:
        return load_campaign(write(Path(folder), *arguments, **more))


def inputs_of(write: Callable[..., Path], *arguments, **more) -> Inputs:
    with tempfile.TemporaryDirectory() as folder:
        return load_inputs([write(Path(folder), *arguments, **more)])


def page_of(inputs: Inputs, *pictures) -> str:
    """Without Plotly's script, which takes a second and says nothing here."""
    with mock.patch.object(plotly, "script", return_value=""):
        return page.render(inputs, *pictures)


def run(*words) -> tuple[int, str, str]:
    """Exit status, standard output and standard error of `report.py WORDS...`."""
    out, error = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(error):
        try:
            status = report.main([str(word) for word in words])
        except SystemExit as end:
            status = end.code
    return status, out.getvalue(), error.getvalue()


def json_of(path: Path):
    return json.loads(path.read_text(encoding="utf-8"))


def edit_info(folder: Path, **members) -> dict:
    """@returns what campaign.json of the folder has now"""
    info = json_of(folder / "campaign.json") | members
    (folder / "campaign.json").write_text(json.dumps(info), encoding="utf-8")
    return info


def edit_lines(path: Path, change: Callable[[dict], dict | None]) -> None:
    """@param change  of every line's object; None: the line goes"""
    lines = [change(json.loads(line)) for line in path.read_text(encoding="utf-8").splitlines()]
    path.write_text("".join(json.dumps(line) + "\n" for line in lines if line is not None), encoding="utf-8")
