"""The table of goals: its ratios on cells made by hand, its words on a synthetic results folder."""

import contextlib
import io
import math
import sys
import tempfile
import unittest
from pathlib import Path
from types import SimpleNamespace

_REPORT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(_REPORT), str(_REPORT / "tests")]

import goals as script  # noqa: E402
from lcpbench_report import goals  # noqa: E402
from lcpbench_report.cells import BENCHMARK, Cell  # noqa: E402
from synthetic import FAMILIES, SIZES, write_results  # noqa: E402

ORIGINS = {"auto": "own", "fast": "own", "slow": "own", "right": "peer", "wrong": "peer", "mine": "external"}


def made_by_hand(times: dict[str, dict[str, float]]):
    """Cells of n = 10 at 1e-6: family -> solver -> seconds, negative where the answer was not verified."""
    def get(family, n, solver, tier):
        if solver not in times[family]:
            return None
        seconds = times[family][solver]
        verified = 1 if seconds > 0 else 0
        return Cell(family, n, solver, tier, 1, verified, "", "" if verified else "false success", "", 0.0,
                    abs(seconds), BENCHMARK, math.nan)

    results = SimpleNamespace(families=list(times), solvers=list(ORIGINS), origin=ORIGINS.get)
    return SimpleNamespace(results=results, sizes=lambda family: [10], get=get)


class Ratios(unittest.TestCase):
    def test_the_fastest_right_ones_count_and_nobody_else(self):
        row, = goals.rows(made_by_hand({"a": {"auto": 2e-6, "fast": 1e-6, "slow": 5e-6, "right": 4e-6, "wrong": -1e-7,
                                              "mine": 1e-8}}), 10, 1e-6)
        self.assertEqual((row.own.solver, row.peer.solver), ("fast", "right"))
        self.assertAlmostEqual(row.peer_over_auto, 2)
        self.assertAlmostEqual(row.peer_over_own, 4)
        self.assertAlmostEqual(row.auto_over_own, 2)

    def test_auto_is_no_backend_of_its_own(self):
        row, = goals.rows(made_by_hand({"a": {"auto": 1e-6, "slow": 5e-6, "right": 4e-6}}), 10, 1e-6)
        self.assertEqual(row.own.solver, "slow")
        self.assertAlmostEqual(row.auto_over_own, 0.2)

    def test_who_is_wrong_loses_and_where_no_peer_is_right_ours_win(self):
        wrong, alone, empty = goals.rows(made_by_hand({"wrong": {"auto": -1e-6, "fast": 1e-6, "right": 4e-6},
                                                       "alone": {"auto": 1e-6, "fast": 1e-6, "wrong": -1e-7},
                                                       "empty": {}}), 10, 1e-6)
        self.assertEqual((wrong.peer_over_auto, wrong.auto_over_own), (0, math.inf))
        self.assertEqual(wrong.auto_word, "false success")
        self.assertEqual((alone.peer, alone.peer_over_auto), (None, math.inf))
        self.assertTrue(math.isnan(empty.peer_over_auto))

    def test_larger_problems_have_the_larger_goal(self):
        self.assertEqual([goals.goal_of(n).at_least for n in (10, 30, 100, 300, 1000)], [1.2, 1.2, 2, 2, 2])


class Table(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls._folder = tempfile.TemporaryDirectory()
        cls.results = write_results(Path(cls._folder.name) / "results")

    @classmethod
    def tearDownClass(cls):
        cls._folder.cleanup()

    def run_script(self, *arguments: str) -> tuple[int, str, str]:
        out, error = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(error):
            status = script.main([str(self.results), *arguments])
        return status, out.getvalue(), error.getvalue()

    def test_there_is_a_row_for_every_family_at_every_size_up_to_a_thousand(self):
        status, text, _ = self.run_script()
        self.assertEqual(status, 0)
        sizes = [n for n in SIZES if n <= goals.LARGEST]
        lines = text.splitlines()
        for family in FAMILIES:
            self.assertEqual(sum(line.startswith(f"| {family} |") for line in lines), len(sizes))
        for n in sizes:
            self.assertEqual(sum(line.startswith(f"n = {n} (") for line in lines), 1)
        columns = {line.count("|") for line in lines if line.startswith("|")}
        self.assertEqual(columns, {8, 12})

    def test_verified_problems_of_auto_are_counted_at_every_tier(self):
        _, text, _ = self.run_script()
        line = next(line for line in text.splitlines() if "`auto` solves" in line)
        problems = len(FAMILIES) * 5 * 3
        self.assertEqual(line.count(f"{problems} of {problems}"), 3)

    def test_a_tier_that_was_not_run_is_one_line_and_status_two(self):
        status, _, error = self.run_script("--tier", "1e-5")
        self.assertEqual((status, error.count("\n")), (2, 1))


if __name__ == "__main__":
    unittest.main()
