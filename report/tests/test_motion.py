"""Run: /usr/bin/python3 -m unittest discover -s report/tests

The section on motion, from a synthetic motion.csv.
"""

import sys
import tempfile
import unittest
from pathlib import Path

_REPORT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(_REPORT), str(_REPORT / "tests")]

from lcpbench_report import motion, motion_figure  # noqa: E402
from lcpbench_report.cells import Cells  # noqa: E402
from lcpbench_report.errors import ReportError  # noqa: E402
from lcpbench_report.load import load_results  # noqa: E402
from lcpbench_report.page import render  # noqa: E402
from lcpbench_report.style import solver_styles  # noqa: E402
from synthetic import OWN, TIERS, write_motion, write_results  # noqa: E402


class Motion(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = write_results(Path(cls.temporary.name), families=("disc-pile",), sizes=(10, 30), seeds=(1,))

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def setUp(self):
        write_motion(self.folder)

    def test_without_the_file_the_page_has_no_such_section(self):
        (self.folder / motion.FILE).unlink()
        self.assertNotIn('id="motion"', render(Cells(load_results(self.folder))))

    def test_the_page_holds_a_figure_and_a_table_per_scene(self):
        page = render(Cells(load_results(self.folder)))
        self.assertEqual(page.count('id="motion"'), 1)
        self.assertEqual(page.count('<a href="#motion">'), 1)
        for label in ("disc-pile at the velocity level", "disc-track at the acceleration level"):
            self.assertIn(f'aria-label="Energy error and penetration over time for {label}"', page)
        self.assertIn("pgs at 1e-3 (not finite)", page)
        self.assertNotIn("joint error<br>", page)  # no joints in these scenes

    def test_the_summary_takes_the_worst_values_and_the_last_counts(self):
        results = load_results(self.folder)
        table = motion.of_scene(results.motion, "disc-pile", "velocity")
        rows = {(row["solver"], row["tolerance"]): row for row in motion.summary(table, results.solvers)}
        self.assertEqual(len(rows), 1 + len(TIERS) * (len(OWN) - 1))
        full, stopped = rows["ipm", "1e-6"], rows["pgs", "1e-3"]
        self.assertEqual((full["energy"], full["penetration"], full["distance"]), ("1.0e-04", "1.0e-05", "2.0e-04"))
        self.assertEqual((full["solves"], full["false"], full["stopped"]), (100, 0, ""))
        self.assertEqual((stopped["solves"], stopped["false"], stopped["stopped"]), (50, 1, "not finite"))
        self.assertEqual(stopped["time"], "0.05")

    def test_figures_are_the_same_for_the_same_file(self):
        table = motion.of_scene(load_results(self.folder).motion, "disc-track", "acceleration")
        styles = solver_styles(load_results(self.folder).run["solvers"])
        self.assertEqual(motion_figure.figure(table, styles), motion_figure.figure(table, styles))

    def test_damage_is_named_by_line_and_column(self):
        path = self.folder / motion.FILE
        good = path.read_text(encoding="utf-8")
        for old, new, words in ((",dantzig,", ",nobody,", "line 2, column 'solver' is 'nobody'"),
                                (",dantzig,1e-09,0,0.0,", ",dantzig,1e-09,0,soon,", "line 2, column 'time' is 'soon'"),
                                ("energy_error", "energy_wrong", "column 'energy_error' is missing")):
            path.write_text(good.replace(old, new, 1), encoding="utf-8")
            with self.assertRaises(ReportError) as caught:
                load_results(self.folder)
            self.assertIn(words, str(caught.exception))


if __name__ == "__main__":
    unittest.main()
