"""Is "faster" said when it should be, and only then: seeded campaigns in which the truth is known."""

import math
import unittest
from unittest import mock

import numpy as np
import pandas as pd

from lcpbench_report.statistics import pairwise
from lcpbench_report.statistics.intervals import holm
from .synthetic_campaign import Noise, cells_of, median_times

INF = math.inf
SAME_SEEDS, SLOWER_SEEDS, INTERVAL_SEEDS = 200, 60, 150


def pair(table: pd.DataFrame, a: str, b: str) -> pd.Series:
    return table[(table["a"] == a) & (table["b"] == b)].iloc[0]


def compared(times: pd.DataFrame, **about) -> pd.DataFrame:
    """Every problem is a base of one family and weighs the same, unless `about` says otherwise."""
    known = pd.DataFrame({"origin": "placed", "size_class": "7-12", "family": "", "base": times.index.astype(str),
                          "weight": 1.0}, index=times.index)
    return pairwise.compare_pairs(times, known.assign(**about))


class Example(unittest.TestCase):
    """p: a twice as fast; q: a four times as slow; r: only a; s: only b; t: neither; u: a eight times as fast."""

    TIMES = pd.DataFrame({"a": [1.0, 8.0, 1.0, INF, INF, 1.0], "b": [2.0, 2.0, INF, 1.0, INF, 8.0]}, list("pqrstu"))

    def test_counts(self):
        row = pair(compared(self.TIMES), "a", "b")
        counts = ["problems", "both", "a_only", "b_only", "neither", "a_faster", "b_faster"]
        self.assertEqual(list(row[counts]), [6, 3, 1, 1, 1, 2, 1])
        self.assertAlmostEqual(row["ratio"], 1 / 2)  # of 1/8, 1/2, 4
        self.assertEqual(row["verdict"], pairwise.NO_DIFFERENCE)

    def test_the_test_by_hand(self):
        # All six of one sign: the smallest two-sided p-value, 2 / 2^6.
        p, direction = pairwise.signed_rank_test(-np.arange(1, 7.0))
        self.assertAlmostEqual(p, 2 / 64)
        self.assertEqual(direction, -1)

    def test_a_claim_needs_the_test_and_the_interval_on_the_same_side(self):
        for p, direction, low, high, expected in (
                (0.01, -1, 0.8, 0.9, pairwise.A_FASTER), (0.01, 1, 1.1, 1.2, pairwise.B_FASTER),
                (0.01, -1, 0.8, 1.1, pairwise.NO_DIFFERENCE), (0.01, 1, 0.9, 1.2, pairwise.NO_DIFFERENCE),
                (0.01, 1, 0.8, 0.9, pairwise.NO_DIFFERENCE), (0.01, -1, 1.1, 1.2, pairwise.NO_DIFFERENCE),
                (0.01, -1, 0.98, 0.99, pairwise.NO_DIFFERENCE), (0.01, 1, 1.01, 1.02, pairwise.NO_DIFFERENCE),
                (0.06, -1, 0.8, 0.9, pairwise.NO_DIFFERENCE), (math.nan, -1, 0.8, 0.9, pairwise.NO_DIFFERENCE)):
            self.assertEqual(pairwise.verdict(p, direction, low, high), expected, (p, direction, low, high))

    def test_exchanging_a_and_b_changes_nothing_else(self):
        times = median_times(np.random.default_rng(1), {"a": 1.0, "b": 1.02, "c": 3.0}, 40)
        times.iloc[:5, 0] = INF
        given = compared(times)
        exchanged = compared(times[["c", "b", "a"]])
        for row in given.itertuples():
            other = pair(exchanged, row.a, row.b)
            for column in pairwise.COLUMNS[3:]:
                value, expected = getattr(row, column), other[column]
                if column in ("ratio_low", "ratio_high"):  # percentiles of a resample that is mirrored
                    self.assertAlmostEqual(value, expected, delta=0.01 * expected)
                elif isinstance(value, str):
                    self.assertEqual(value, expected, column)
                else:
                    self.assertAlmostEqual(value, expected, msg=column)

    def test_pairs_shared_by_processes_are_the_same_table(self):
        rng = np.random.default_rng(3)
        times = pd.DataFrame(rng.lognormal(size=(12, 5)), list("pqrstuvwxyzo"), list("abcde"))
        alone = compared(times)
        with mock.patch.object(pairwise, "_MANY_PAIRS", 1), \
                mock.patch.object(pairwise.os, "sched_getaffinity", return_value={0, 1, 2}):
            shared = compared(times)
        pd.testing.assert_frame_equal(shared, alone, check_exact=True)

    def test_equal_times_and_nothing_in_common_are_no_difference(self):
        times = pd.DataFrame({"a": [1.0, 2.0], "b": [1.0, 2.0], "c": [INF, INF]})
        table = compared(times)
        self.assertEqual(set(table["verdict"]), {pairwise.NO_DIFFERENCE})
        self.assertTrue(table.loc[table["b"] == "c", "wilcoxon_p"].isna().all())
        self.assertEqual(pair(table, "a", "c")["a_only"], 2)

    def test_where_problems_do_not_count_failures_do_not_either(self):
        table = pairwise.pairwise_table(cells_of(self.TIMES, counts=False, set="engine"))
        row = pair(table, "a", "b")
        self.assertEqual((row["set"], row["problems"], row["a_only"], row["neither"]), ("engine", 3, 0, 0))

    def test_a_failure_is_no_time(self):
        """Who fails on all that is hard is not the faster one."""
        times = median_times(np.random.default_rng(2), {"a": 1.0, "b": 0.8}, 60)
        times.iloc[30:, 1] = INF
        row = pair(compared(times), "a", "b")
        self.assertEqual(row["verdict"], pairwise.B_FASTER)  # where both answer
        self.assertEqual(row["a_only"], 30)  # and yet a wins half of all problems


class Bases(unittest.TestCase):
    def test_variants_of_one_base_are_one_witness(self):
        """Forty variants of one base on which a is faster, and three other bases on which b is."""
        times = pd.DataFrame({"a": [1.0] * 40 + [4.0] * 3, "b": [2.0] * 40 + [1.0] * 3})
        row = pair(compared(times, base=["one"] * 40 + ["x", "y", "z"], weight=[1 / 40] * 40 + [1.0] * 3), "a", "b")
        self.assertEqual((row["both"], row["bases"], row["ratio"]), (43, 4, 4.0))
        blind = pair(compared(times), "a", "b")
        self.assertEqual(blind["verdict"], pairwise.A_FASTER)
        self.assertEqual(row["verdict"], pairwise.NO_DIFFERENCE)

    def test_the_same_solver_on_many_variants_is_no_difference(self):
        """Each base has a difference of its own, none on average, which all of its variants share."""
        alarms = 0
        for seed in range(SAME_SEEDS // 2):
            rng = np.random.default_rng([13, seed])
            bases = np.repeat(np.arange(20), 8)
            times = pd.DataFrame({"a": np.exp(rng.normal(0, 1, 160))})
            times["b"] = times["a"] * np.exp(rng.normal(0, 0.3, 20)[bases] + rng.normal(0, 0.02, 160))
            alarms += pair(compared(times, base=bases.astype(str), weight=1 / 8), "a", "b")["verdict"] != \
                pairwise.NO_DIFFERENCE
        self.assertLessEqual(alarms / (SAME_SEEDS // 2), 0.06)


class Holm(unittest.TestCase):
    def test_by_hand(self):
        np.testing.assert_allclose(holm([0.01, 0.04, 0.03, 0.005]), [0.03, 0.06, 0.06, 0.02])
        np.testing.assert_allclose(holm([0.6, 0.5]), [1.0, 1.0])

    def test_what_was_not_tested_does_not_count(self):
        np.testing.assert_allclose(holm([math.nan, 0.02, math.nan, 0.03]), [math.nan, 0.04, math.nan, 0.04])
        self.assertEqual(len(holm([])), 0)

    def test_it_lies_between_the_raw_value_and_bonferronis(self):
        p = np.random.default_rng(3).random(50) ** 3
        adjusted = holm(p)
        self.assertTrue((adjusted >= p).all() and (adjusted <= np.minimum(50 * p, 1)).all())
        self.assertTrue((np.diff(adjusted[np.argsort(p)]) >= 0).all())


class Truth(unittest.TestCase):
    def test_no_difference_is_found_where_there_is_none(self):
        """Without the margin too, which hides no fault of the tests, of the intervals or of Holm's correction."""
        two = {"first": 1.0, "second": 1.0}
        for why, factors, margin, seeds, most, more in (
                ("one solver under two names", two, pairwise.MARGIN, SAME_SEEDS, 0.05, {}),
                ("without the margin", two, 1.0, SAME_SEEDS, 0.05, {}),
                ("15 pairs each", dict.fromkeys("abcdef", 1.0), 1.0, SAME_SEEDS // 4, 0.08, {"problems": 40}),
                ("noise comes in passes", two, 1.0, SAME_SEEDS // 2, 0.06, {"noise": Noise(0.02, 0.05, passes=3)}),
                # Seen on real machines with one binary run twice: sure, small and without a meaning.
                ("a per cent less for all problems", two | {"second": 0.99}, pairwise.MARGIN, SAME_SEEDS // 4, 0, {}),
                ("a per cent more for all problems", two | {"second": 1.01}, pairwise.MARGIN, SAME_SEEDS // 4, 0, {})):
            with self.subTest(why), mock.patch.object(pairwise, "MARGIN", margin):
                alarms = self._alarms(factors, seeds, **more)
                self.assertLessEqual(alarms / seeds, most)
                self.assertTrue(alarms or margin > 1 or more)  # the tests are not blind

    def test_ten_per_cent_more_time_are_found(self):
        found = 0
        for seed in range(SLOWER_SEEDS):
            times = median_times(np.random.default_rng([11, seed]), {"quick": 1.0, "slow": 1.1})
            found += pair(compared(times), "quick", "slow")["verdict"] == pairwise.A_FASTER
        self.assertGreaterEqual(found / SLOWER_SEEDS, 0.95)

    def test_the_interval_holds_the_true_ratio(self):
        """One that depends on the problem, with a median of 1.25: so that there is something to be unsure of."""
        held = 0
        for seed in range(INTERVAL_SEEDS):
            rng = np.random.default_rng([12, seed])
            times = median_times(rng, {"quick": 1.0, "slow": 1.25}, 60)
            times["slow"] *= np.exp(rng.normal(0, 0.3, len(times)))
            row = pair(compared(times), "slow", "quick")
            held += row["ratio_low"] <= 1.25 <= row["ratio_high"]
        self.assertTrue(0.88 <= held / INTERVAL_SEEDS <= 0.99, held / INTERVAL_SEEDS)

    def _alarms(self, factors: dict, seeds: int, problems: int = 100, noise: Noise | None = None) -> int:
        """Seeds with a claim of a difference."""
        return sum(bool((compared(median_times(np.random.default_rng([10, seed]), factors, problems, noise))["verdict"]
                         != pairwise.NO_DIFFERENCE).any()) for seed in range(seeds))
