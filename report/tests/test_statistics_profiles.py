"""Shifted means and coverage: against values worked out by hand, and their laws."""

import math
import unittest

import numpy as np
import pandas as pd

from lcpbench_report.statistics import means
from lcpbench_report.statistics.coverage import coverage_table
from lcpbench_report.statistics.intervals import share_interval
from .synthetic_campaign import TIME_LIMIT, cells_of

INF = math.inf
# Best: a on p (1), b on q (2), nobody on r.
EXAMPLE = pd.DataFrame({"a": [1.0, 6.0, INF], "b": [4.0, 2.0, INF]}, index=["p", "q", "r"])


def random_times(seed: int) -> pd.DataFrame:
    rng = np.random.default_rng(seed)
    times = pd.DataFrame(np.exp(rng.normal(0, 2, (30, 4))), columns=list("abcd"))
    return times.mask(rng.random(times.shape) < 0.2, INF)


class Means(unittest.TestCase):
    def test_the_formula_by_hand(self):
        self.assertAlmostEqual(means.shifted_geometric_mean([1.0, 7.0], 1.0), 3.0)  # sqrt(2 * 8) - 1
        self.assertAlmostEqual(means.shifted_geometric_mean([2.0, 8.0], 0.0), 4.0)
        self.assertAlmostEqual(means.shifted_geometric_mean([2.0, 8.0, 8.0], 0.0, [1, 0.5, 0.5]), 4.0)
        self.assertTrue(math.isnan(means.shifted_geometric_mean([], 1.0)))

    def test_the_shift_lies_below_the_smallest_median(self):
        for size in (3e-8, 2e-7, 1e-3, 0.5):
            cells = cells_of(size * pd.DataFrame({"a": [1.0, 2.0, INF], "b": [50.0, 60.0, 70.0]}))
            shift = means.shift_of(cells)  # of a's median, 1.5
            self.assertAlmostEqual(math.log10(shift), round(math.log10(shift)))
            self.assertTrue(0.15 * size / 4 < shift < 0.15 * size * 4)
        self.assertTrue(math.isnan(means.shift_of(cells_of(pd.DataFrame({"a": [INF]})))))

    def test_failures_enter_with_the_limit(self):
        rows = means.mean_table(cells_of(EXAMPLE)).set_index("solver")
        shift = rows["shift"].iloc[0]
        self.assertEqual(shift, 0.1)  # the medians of what is finite are 3.5 and 3
        for solver, times in {"a": (1.0, 6.0, TIME_LIMIT), "b": (4.0, 2.0, TIME_LIMIT)}.items():
            expected = math.prod(t + shift for t in times) ** (1 / 3) - shift
            self.assertAlmostEqual(rows.loc[solver, "mean"], expected)
            self.assertEqual(rows.loc[solver, "penalised"], 1)
        self.assertEqual(rows.loc["a", "over_best"], 1)
        self.assertGreater(rows.loc["b", "over_best"], 1)

    def test_the_mean_lies_in_its_interval(self):
        for seed in range(10):
            times = np.exp(np.random.default_rng(seed).normal(-5, 2, (40, 1)))
            row = means.mean_table(cells_of(pd.DataFrame(times, columns=["a"]))).iloc[0]
            self.assertTrue(times.min() < row["mean_low"] < row["mean"] < row["mean_high"] < times.max())


class Coverage(unittest.TestCase):
    def test_every_cell_is_counted_once(self):
        cells = cells_of(random_times(6))
        failed = cells.index[~cells["passes"]]
        cells.loc[cells.index[cells["passes"]][:5], "at_floor"] = True
        cells.loc[failed[:3], ["verdict", "claim"]] = ["false success", "solved"]
        cells.loc[failed[3:7], ["verdict", "claim"]] = ["excluded", ""]
        cells.loc[failed[7:9], "below_floor"] = True
        table = coverage_table(cells)
        total = table[["verified", "false_successes", "failed", "out_of_time", "excluded"]].sum(axis=1)
        self.assertEqual(list(total), list(table["problems"]))
        self.assertEqual(table["false_successes"].sum(), 3)
        self.assertEqual(table["excluded"].sum(), 4)
        self.assertEqual(table["at_floor"].sum(), 5)
        self.assertEqual(table["below_floor"].sum(), 2)  # of the failed: no share is better for it
        self.assertEqual(table["verified"].sum(), cells["passes"].sum())

    def test_wrong_claims_of_who_was_not_asked_are_a_figure_of_their_own(self):
        cells = cells_of(pd.DataFrame({"asked": [1.0, 1.0, INF, INF], "default": [1.0, INF, INF, INF]}))
        wrong = ~cells["passes"]
        cells.loc[wrong, "false_success"] = True
        cells["asked"] = cells["solver"] == "asked"
        cells.loc[wrong, "verdict"] = np.where(cells["asked"][wrong], "false success", "below the tier")
        table = coverage_table(cells).set_index("solver")
        self.assertEqual(list(table["false_successes"]), [2, 0])
        self.assertEqual(list(table["below_tier"]), [0, 3])
        self.assertEqual(list(table["false_share"]), [0.5, 0])
        self.assertEqual(list(table["below_tier_share"]), [0, 0.75])
        self.assertEqual(list(table["false_of_claims"]), [0.5, 0.75])

    def test_shares_are_of_the_weight_and_bases_are_what_is_observed(self):
        cells = cells_of(pd.DataFrame({"a": [1.0, 1.0, INF]})).assign(weight=[0.5, 0.5, 1.0])
        row = coverage_table(cells).iloc[0]
        self.assertEqual((row["verified"], row["problems"], row["verified_share"]), (2, 3, 0.5))
        # Three bases of weights 1/2, 1/2 and 1 are worth 2^2 / 1.5 alike ones (Kish).
        self.assertEqual(row["n_eff"], 4 / 1.5)
        self.assertEqual((row["verified_share_low"], row["verified_share_high"]), share_interval(0.5, 4 / 1.5))
        row = coverage_table(cells.assign(base=["one", "one", "other"])).iloc[0]
        self.assertEqual((row["verified_share_low"], row["verified_share_high"]), share_interval(0.5, 2))

    def test_shares_lie_in_their_intervals(self):
        table = coverage_table(cells_of(random_times(7)))
        for share in ("verified_share", "verified_of_attempted", "false_share", "false_of_claims", "attempted_share"):
            self.assertTrue((table[f"{share}_low"] <= table[share]).all())
            self.assertTrue((table[share] <= table[f"{share}_high"]).all())
        self.assertTrue((table["false_share_high"] > 0).all())  # none seen is not none
