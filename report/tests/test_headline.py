"""The Markdown headline table: its content, and its way into a file. Part of the suite of test_report.py."""

import contextlib
import io
import sys
import tempfile
import unittest
from pathlib import Path

_REPORT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(_REPORT), str(_REPORT / "tests")]

import headline  # noqa: E402
from lcpbench_report import markdown  # noqa: E402
from lcpbench_report.cells import Cells  # noqa: E402
from lcpbench_report.errors import ReportError  # noqa: E402
from lcpbench_report.load import load_results  # noqa: E402
from synthetic import MISSING, SIZES, SOLVERS, write_results  # noqa: E402


class Headline(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls._folder = tempfile.TemporaryDirectory()
        cls.results = Path(cls._folder.name) / "results"
        write_results(cls.results)
        cls.table = markdown.headline(Cells(load_results(cls.results)))

    @classmethod
    def tearDownClass(cls):
        cls._folder.cleanup()

    def test_there_is_a_row_for_every_solver_and_a_column_for_every_size(self):
        rows = [line for line in self.table.splitlines() if line.startswith("|")]
        self.assertEqual([row.split("|")[1].strip(" `") for row in rows],
                         ["solver", "---", *SOLVERS, "families"])
        for row in rows:
            self.assertEqual(row.count("|"), len(SIZES) + 2)

    def test_own_solvers_come_first_and_the_missing_ones_are_one_line(self):
        self.assertEqual(self.table.count("Not in this build"), 1)
        line = next(line for line in self.table.splitlines() if line.startswith("Not in this build"))
        for solver in MISSING:
            self.assertIn(f"`{solver}`", line)
            self.assertEqual(self.table.count(solver), 1)

    def test_the_machine_and_the_commit_are_named(self):
        run = load_results(self.results).run
        self.assertIn(run["cpu"], self.table)
        self.assertIn(run["git_commit"][:12], self.table)

    def test_update_replaces_what_stands_between_the_markers_and_nothing_else(self):
        readme = Path(self._folder.name) / "README.md"
        readme.write_text(f"before\n{markdown.BEGIN}\nstale text\n{markdown.END}\nafter\n", encoding="utf-8")
        for _ in range(2):  # the second time changes nothing more
            self.assertEqual(headline.main([str(self.results), "--update", str(readme)]), 0)
            text = readme.read_text(encoding="utf-8")
            self.assertTrue(text.startswith("before\n") and text.endswith("after\n"))
            self.assertIn(self.table, text)
            self.assertNotIn("stale text", text)

    def test_a_file_without_markers_is_refused(self):
        with self.assertRaises(ReportError):
            markdown.replace_between_markers("no markers", self.table, "x.md")

    def test_a_missing_folder_is_one_line_and_status_two(self):
        error = io.StringIO()
        with contextlib.redirect_stderr(error):
            self.assertEqual(headline.main([str(self.results / "nowhere")]), 2)
        self.assertEqual(error.getvalue().count("\n"), 1)


if __name__ == "__main__":
    unittest.main()
