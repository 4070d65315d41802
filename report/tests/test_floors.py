"""Verdicts relative to the rounding floor, on the synthetic results folder; and folders from before there were floors."""

import csv
import io
import math
import sys
import tempfile
import unittest
from pathlib import Path

import pandas as pd

_REPORT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(_REPORT), str(_REPORT / "tests")]

from lcpbench_report import floors, tables, times  # noqa: E402
from lcpbench_report.cells import Cells  # noqa: E402
from lcpbench_report.errors import ReportError  # noqa: E402
from lcpbench_report.limitations import limitations  # noqa: E402
from lcpbench_report.load import ADDED_COLUMNS, load_results  # noqa: E402
from lcpbench_report.page import render  # noqa: E402
from lcpbench_report.summary import summary_lines  # noqa: E402
from synthetic import FAMILIES, SEEDS, SIZES, floor_of, write_results  # noqa: E402

LAST = FAMILIES[-1]  # its floors: 3e-10 at n = 1000, 4e-9 at n = 3000; unknown at n = 10, 1e-15 n elsewhere


def _without_floors(folder: Path) -> None:
    """Makes the files what they were before."""
    for name in ("problems.csv", "accuracy.csv"):
        table = pd.read_csv(folder / name, dtype=str, keep_default_na=False)
        table = table.drop(columns=[column for column in ADDED_COLUMNS if column in table.columns])
        table.to_csv(folder / name, index=False)


class Floors(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.directory = tempfile.TemporaryDirectory()
        cls.cells = Cells(load_results(write_results(Path(cls.directory.name) / "results")))
        cls.page = render(cls.cells)

    @classmethod
    def tearDownClass(cls):
        cls.directory.cleanup()

    def test_a_cells_floor_is_the_largest_of_its_seeds(self):
        self.assertTrue(math.isnan(self.cells.floor(LAST, 10)))
        for f, family in enumerate(FAMILIES):
            for n in SIZES[1:]:
                self.assertAlmostEqual(self.cells.floor(family, n) / floor_of(f, n), 1, places=6)

    def test_floors_are_shown_from_a_tenth_of_the_strictest_tier_and_marked_above_it(self):
        for row in tables.verdicts(self.cells):
            shown = {1000: ("3.0e-10", False), 3000: ("4.0e-9", True)} if row["family"] == LAST else {}
            self.assertEqual((row["floor"]["text"], row["floor"]["above"]), shown.get(row["n"], ("", False)))
        self.assertIn('<td class="floor above" title="rounding floor 4.0e-9, above tier 1e-9">4.0e-9</td>', self.page)
        self.assertIn('<td class="floor" title="rounding floor 3.0e-10, below tier 1e-9">3.0e-10</td>', self.page)
        self.assertEqual(self.page.count(">floor 4.0e-9</span>"), len(SEEDS))

    def test_answers_that_pass_thanks_to_the_floor_are_verified_and_say_so(self):
        cell = self.cells.get(LAST, 3000, "ipm", 1e-9)
        self.assertTrue(cell.passes)
        self.assertGreater(cell.rho, 1e-9)
        for other in self.cells.all():
            self.assertEqual(other.at_floor, len(SEEDS) if other is cell else 0)
        for row in tables.accuracy(self.cells):
            here = (row["solver"], row["tier"]) == ("ipm", "1e-9")
            self.assertEqual(row["at_floor"], len(SEEDS) if here else 0)
            self.assertLessEqual(row["at_floor"], row["verified"])
        self.assertIn("−9" + floors.MARK, self.page)
        self.assertIn("2.5e-9" + floors.MARK, self.page)

    def test_the_limitations_count_problems_runs_and_what_is_not_known(self):
        text = dict(limitations(self.cells))["Rounding floor"]
        known = len(FAMILIES) * (len(SIZES) - 1) * len(SEEDS)
        self.assertIn(f"On {len(SEEDS)} of {known} problems ({LAST})", text)
        self.assertIn("at most 4.0e-9", text)
        self.assertIn(f"{len(SEEDS)} runs passed thanks to it", text)
        self.assertIn(f"On {len(FAMILIES) * len(SEEDS)} problems none is known", text)
        self.assertIn("Rounding floor", [line["label"] for line in summary_lines(self.cells)])

    def test_scenes_tell_their_largest_floor(self):
        facts = {scene["family"]: dict(scene["facts"]) for scene in tables.scenes(self.cells)}
        self.assertEqual(facts[LAST]["rounding floor of rho"], "at most 4.0e-9")

    def test_the_csv_has_floor_and_number_of_runs_at_it(self):
        for row in csv.DictReader(io.StringIO(times.as_csv(self.cells))):
            floor = self.cells.floor(row["family"], int(row["n"]))
            self.assertEqual(row["floor"], "" if math.isnan(floor) else f"{floor:.4g}")
            cell = self.cells.get(row["family"], int(row["n"]), row["solver"], float(row["tier"]))
            self.assertEqual(int(row["at_floor"]), cell.at_floor)


class FilesWithoutFloors(unittest.TestCase):
    def test_are_read_and_their_page_is_silent_about_floors(self):
        with tempfile.TemporaryDirectory() as directory:
            folder = write_results(Path(directory) / "results", families=FAMILIES[:2])
            _without_floors(folder)
            cells = Cells(load_results(folder))
            page = render(cells)
        self.assertFalse(floors.known(cells))
        self.assertEqual(sum(cell.at_floor for cell in cells.all()), 0)
        self.assertNotIn("Rounding floor", dict(limitations(cells)))
        self.assertIn("rho ≤ T and the backward error ≤ √T.", page)
        for words in ("rounding floor", '<td class="floor', "at floor", floors.MARK):
            self.assertNotIn(words, page)

    def test_low_floors_are_one_sentence_and_no_column(self):
        with tempfile.TemporaryDirectory() as directory:
            cells = Cells(load_results(write_results(Path(directory) / "results", families=FAMILIES[:2])))
            page = render(cells)
        self.assertIn("no verdict at 1e-9 or above leans on it", dict(limitations(cells))["Rounding floor"])
        self.assertNotIn('<td class="floor', page)
        self.assertNotIn("Rounding floor", [line["label"] for line in summary_lines(cells)])

    def test_a_flag_that_is_none_is_an_error(self):
        with tempfile.TemporaryDirectory() as directory:
            folder = write_results(Path(directory) / "results", families=FAMILIES[:1], sizes=(10,))
            table = pd.read_csv(folder / "accuracy.csv", dtype=str, keep_default_na=False)
            table.loc[1, "at_floor"] = "perhaps"
            table.to_csv(folder / "accuracy.csv", index=False)
            with self.assertRaisesRegex(ReportError, "line 3, column 'at_floor' is 'perhaps'"):
                load_results(folder)


if __name__ == "__main__":
    unittest.main()
