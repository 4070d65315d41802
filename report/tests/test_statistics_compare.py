"""Intervals: of a cell's median, of the ratio of two cells, of shares."""

import math
import sys
import unittest
from pathlib import Path

_REPORT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(_REPORT), str(_REPORT / "tests")]

import numpy as np  # noqa: E402

from lcpbench_report.statistics.cells import median_interval, quantiles, time_interval  # noqa: E402
from lcpbench_report.statistics.compare import compare_cells  # noqa: E402
from lcpbench_report.statistics.intervals import bootstrap_interval, share_interval  # noqa: E402
from synthetic_campaign import Noise, repetitions  # noqa: E402

SEEDS = 300


def _excludes_one(comparison) -> bool:
    return not comparison.low <= 1 <= comparison.high


class TwoCells(unittest.TestCase):
    def test_two_runs_of_one_binary_agree(self):
        noise = Noise(repetitions=30)
        self.assertLessEqual(self._share_that(_excludes_one, 1.0, noise), 0.08)
        self.assertLessEqual(self._share_that(lambda c: c.differs, 1.0, noise), 0.01)

    def test_what_two_runs_do_to_all_repetitions_alike_is_no_difference(self):
        noise = Noise(repetition=0.01, repetitions=30)
        self.assertGreater(self._share_that(_excludes_one, 1.01, noise), 0.5)  # sure, and yet not of the solver
        self.assertEqual(self._share_that(lambda c: c.differs, 1.01, noise), 0)
        self.assertEqual(self._share_that(lambda c: c.differs, 0.99, noise), 0)

    def test_so_they_do_where_each_round_has_a_level_of_its_own(self):
        noise = Noise(repetition=0.01, round=0.04, rounds=12, repetitions=5)
        differ = self._share_that(_excludes_one, 1.0, noise)
        self.assertLessEqual(differ, 0.1)
        # What the rounds are for: the same times without them seem to differ far too often.
        blind = self._share_that(_excludes_one, 1.0, noise, join=True)
        self.assertGreater(blind, 2 * differ)

    def test_ten_per_cent_more_time_are_found(self):
        slower = self._share_that(lambda c: c.differs and c.low > 1, 1.1, Noise(repetitions=30))
        self.assertGreaterEqual(slower, 0.95)

    def test_the_interval_holds_the_true_ratio(self):
        held = self._share_that(lambda c: c.low <= 1.3 <= c.high, 1.3, Noise(repetitions=20))
        self.assertTrue(0.88 <= held <= 0.99, held)

    def test_one_repetition_has_no_interval(self):
        comparison = compare_cells([[2.0]], [[1.0, 1.0]])
        self.assertAlmostEqual(comparison.ratio, 2.0)
        self.assertTrue(math.isnan(comparison.low) and math.isnan(comparison.high))
        self.assertFalse(comparison.differs)

    def test_rounds_need_not_be_equally_long(self):
        comparison = compare_cells([[1.0, 2.0], [3.0], [2.0], [2.0], [2.0, 2.0]], [[1.0]] * 5)
        self.assertTrue(comparison.by_rounds)
        self.assertAlmostEqual(comparison.ratio, 2.0)

    def _share_that(self, holds, factor: float, noise: Noise, join: bool = False) -> float:
        count = 0
        for seed in range(SEEDS):
            rng = np.random.default_rng([20, seed])
            slow, quick = repetitions(rng, factor, noise), repetitions(rng, 1.0, noise)
            if join:
                slow, quick = [sum(slow, [])], [sum(quick, [])]
            count += bool(holds(compare_cells(slow, quick)))
        return count / SEEDS


class Single(unittest.TestCase):
    def test_the_interval_of_a_median_holds_it(self):
        for size, least in ((5, 0.92), (6, 0.95), (30, 0.95)):
            rng = np.random.default_rng(size)
            held = [low <= 1 <= high for low, high in (median_interval(np.exp(rng.normal(0, 3, size)))
                                                       for _ in range(2000))]
            self.assertGreaterEqual(np.mean(held), least - 0.015, size)
            self.assertLess(np.mean(held), 0.99, size)
        self.assertEqual(median_interval([3.0]), (3.0, 3.0))

    def test_intervals_of_cells_know_what_differs_between_rounds(self):
        rng = np.random.default_rng(11)
        for rounds in (3, 6, 9):
            held = pooled = 0
            for _ in range(1500):
                times = np.exp(rng.normal(0, 0.05, (rounds, 1)) + rng.normal(0, 0.01, (rounds, 5)))
                low, high = time_interval(times.tolist())
                held += low <= 1 <= high
                low, high = median_interval(times.ravel())
                pooled += low <= 1 <= high
            self.assertTrue(0.93 <= held / 1500 <= 0.975, held)
            self.assertLess(pooled, held)  # repetitions taken for independent ones
        self.assertEqual(time_interval([[1.0, 2.0, 3.0]]), median_interval([1.0, 2.0, 3.0]))
        self.assertTrue(all(map(math.isnan, median_interval([]))))

    def test_quantiles(self):
        found = quantiles([5.0, 1.0, math.nan, 3.0, 2.0, 4.0])
        self.assertEqual([found[k] for k in ("min", "p25", "median", "p75", "max")], [1, 2, 3, 4, 5])
        self.assertTrue(all(map(math.isnan, quantiles([math.nan]).values())))

    def test_a_share_of_nothing_is_unknown_and_none_of_many_is_not_none(self):
        self.assertTrue(all(map(math.isnan, share_interval(0, 0))))
        low, high = share_interval(0, 100)
        self.assertEqual(low, 0)
        self.assertAlmostEqual(high, 1.96**2 / (100 + 1.96**2), places=4)  # Wilson's bound where none was seen

    def test_the_bootstrap_is_the_same_every_time(self):
        values = np.random.default_rng(1).normal(size=50)
        self.assertEqual(bootstrap_interval(values, np.median), bootstrap_interval(values, np.median))
        self.assertEqual(bootstrap_interval([2.0, 2.0], np.median), (2.0, 2.0))
        self.assertTrue(all(map(math.isnan, bootstrap_interval([1.0], np.median))))


if __name__ == "__main__":
    unittest.main()
