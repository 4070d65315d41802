"""Weights and intervals: of medians of clustered problems, of a cell's time, of shares."""

import math
import unittest
import unittest.mock

import numpy as np
import pandas as pd

from lcpbench_report.statistics import intervals
from lcpbench_report.statistics.cells import measured
from lcpbench_report.statistics.streams import median_of_passes
from lcpbench_report.statistics.intervals import Bootstrap, interval_of, share_interval
from lcpbench_report.statistics.launches import Levels, flagged
from lcpbench_report.statistics.weighted import quantiles, weighted_median, weighted_quantiles
from .cases import campaign_of
from .synthetic_campaign import Noise, fail, launches_of, write_campaign

INF, NAN = math.inf, math.nan


def problems_of(families: list[int], bases: list[int]) -> pd.DataFrame:
    return pd.DataFrame({"problem": range(len(families)), "origin": "placed", "family": families, "base": bases})


class Weights(unittest.TestCase):
    def test_equal_weights_give_the_usual_median(self):
        for count in (1, 2, 5, 30, 31):
            values = np.random.default_rng(count).normal(size=count)
            self.assertAlmostEqual(weighted_median(values, np.full(count, 1 / 3)), np.median(values))

    def test_k_variants_of_a_base_weigh_what_one_does(self):
        self.assertEqual(weighted_median([1, 2, 9, 9, 9, 9], [1, 1, 0.25, 0.25, 0.25, 0.25]), 2)
        self.assertEqual(weighted_median([1, 9, 9, 9, 9], [1, 0.25, 0.25, 0.25, 0.25]), 5)  # exactly half on each side

    def test_failures_are_infinite_and_not_left_out(self):
        self.assertEqual(weighted_median([1, 2, INF], [1, 1, 1]), 2)
        self.assertEqual(weighted_median([1, INF], [1, 1]), INF)
        self.assertEqual(weighted_median([1, INF], [1.01, 1]), 1)
        self.assertEqual(weighted_median([1, 2, INF, INF], [1] * 4), INF)
        self.assertEqual(weighted_median([1, 2, 4, INF], [1] * 4), 3)
        self.assertEqual(weighted_median([1, 2, 4, INF], [1, 0.1, 0.1, 0.1]), 1)

    def test_quantiles_by_hand(self):
        found = quantiles([5.0, 1.0, NAN, 3.0, 2.0, 4.0])
        self.assertEqual([found[k] for k in ("min", "p25", "median", "p75", "max")], [1, 2, 3, 4, 5])
        self.assertEqual(weighted_quantiles(range(1, 1001), np.ones(1000), [0.99]), [990.5])
        self.assertEqual(quantiles([1, 2, 3], weights=[1, 1, 8])["p25"], 3)
        self.assertTrue(all(map(math.isnan, quantiles([NAN]).values())))


class Clusters(unittest.TestCase):
    def test_the_interval_holds_the_median_where_families_differ(self):
        """Ten families of fifteen bases, of which some have four variants: to take problems for independent ones would
        give intervals that are far too short."""
        held = naive = 0
        runs = 150
        for seed in range(runs):
            rng = np.random.default_rng([40, seed])
            families, bases, values, weights = [], [], [], []
            for family in range(10):
                level = rng.normal(0, 1)
                for base in range(15):
                    variants = 4 if base % 3 == 0 else 1
                    value = level + rng.normal(0, 1)
                    families += [family] * variants
                    bases += [base] * variants
                    values += list(value + rng.normal(0, 0.1, variants))
                    weights += [1 / variants] * variants
            for clustered in (True, False):
                about = problems_of(families, bases) if clustered else problems_of([0] * len(values),
                                                                                  list(range(len(values))))
                low, high = Bootstrap(about).median(range(len(values)), values, weights)
                held += clustered and low <= 0 <= high
                naive += not clustered and low <= 0 <= high
        self.assertTrue(0.86 <= held / runs <= 0.99, held / runs)  # ten families are few
        self.assertLess(naive / runs, 0.7)

    def test_so_it_does_where_they_do_not(self):
        runs = 200
        for families in (1, 8):
            held = 0
            for seed in range(runs):
                values = np.random.default_rng([41, seed]).normal(0, 1, 96)
                about = problems_of([k % families for k in range(96)], list(range(96)))
                low, high = Bootstrap(about).median(range(96), values, np.ones(96))
                held += low <= 0 <= high
            # Two stages draw what differs within families twice: never too short.
            self.assertGreaterEqual(held / runs, 0.91, families)
            self.assertLessEqual(held / runs, 1.0)

    def test_what_only_the_middle_is_looked_at_for_is_the_same(self):
        rng = np.random.default_rng(7)
        about = problems_of([k % 7 for k in range(700)], [k // 14 for k in range(700)])
        values, weights = np.exp(rng.normal(0, 2, 700)), rng.choice([0.25, 1.0], 700)
        quick = Bootstrap(about).median(range(700), values, weights)
        with unittest.mock.patch.object(intervals, "_MANY", 10**9):
            self.assertEqual(Bootstrap(about).median(range(700), values, weights), quick)

    def test_medians_of_resamples_are_weighted_medians(self):
        bootstrap = Bootstrap(problems_of([k % 4 for k in range(40)], list(range(40))))
        values, weights = np.arange(40.0), np.random.default_rng(6).choice([0.25, 1.0], 40)
        expected = [weighted_median(values[often > 0], (weights * often)[often > 0]) for often in bootstrap._drawn.T]
        np.testing.assert_allclose(bootstrap._medians(values, weights.astype(np.float32), np.arange(40)), expected)

    def test_the_mean_has_the_interval_of_its_standard_error(self):
        values = np.random.default_rng(8).normal(3, 1, 400)
        low, high = Bootstrap(problems_of([0] * 400, list(range(400)))).mean(range(400), values, np.ones(400))
        self.assertAlmostEqual((high - low) / 2, 1.96 * values.std() / 20, delta=0.02)
        self.assertAlmostEqual((high + low) / 2, values.mean(), delta=0.02)

    def test_drawn_together_what_is_common_cancels(self):
        values = np.random.default_rng(9).normal(0, 3, 50)
        low, high = Bootstrap(problems_of([0] * 50, list(range(50)))).mean(
            range(50), values + math.log(0.8), np.ones(50), np.exp, over=values)
        self.assertAlmostEqual(low, 0.8, delta=1e-4)
        self.assertAlmostEqual(high, 0.8, delta=1e-4)

    def test_it_is_the_same_every_time_and_one_base_has_none(self):
        about = problems_of([0, 0, 1], [0, 1, 0])
        self.assertEqual(Bootstrap(about).median([0, 1, 2], [1.0, 2.0, 3.0], [1, 1, 1]),
                         Bootstrap(about).median([0, 1, 2], [1.0, 2.0, 3.0], [1, 1, 1]))
        self.assertEqual(Bootstrap(about).median([0, 2], [2.0, 2.0], [1, 1]), (2.0, 2.0))
        self.assertTrue(all(map(math.isnan, Bootstrap(about).median([0], [1.0], [1]))))
        same = problems_of([0, 0], [5, 5])
        self.assertTrue(all(map(math.isnan, Bootstrap(same).median([0, 1], [1.0, 2.0], [1, 1]))))


    def test_strata_keep_their_weight(self):
        """Engines' problems take ten times as long: were they drawn with the others, the median would jump."""
        about = problems_of([k // 5 for k in range(40)], list(range(40))).assign(origin=["placed"] * 15 + ["recorded"] * 25)
        values = np.where(np.arange(40) < 15, 1.0, 10.0)
        self.assertEqual(Bootstrap(about).median(range(40), values, np.ones(40)), (10.0, 10.0))
        low, high = Bootstrap(about.assign(origin="placed")).median(range(40), values, np.ones(40))
        self.assertEqual((low, high), (1.0, 10.0))


class Launches(unittest.TestCase):
    def test_intervals_of_few_launches_hold_the_truth(self):
        """Lognormal levels, and ones with long tails; the estimate is of the median launch."""
        runs = 400
        draws = {"normal": lambda rng, n: rng.normal(0, 0.1, n), "tails": lambda rng, n: 0.1 * rng.standard_t(3, n)}
        for count in (2, 3, 10):
            for name, draw in draws.items():
                tried = {f"{name}-{seed}": draw(np.random.default_rng([70, count, seed]), count) for seed in range(runs)}
                levels = Levels(pd.concat([launches_of(of - np.median(of), key) for key, of in tried.items()]))
                ends = [interval_of(np.median(of) + levels.draws(key, "7-12", 1e-6)) for key, of in tried.items()]
                held = sum(low <= 0 <= high for low, high in ends) / runs
                self.assertTrue(0.91 <= held <= 0.985, (count, name, held))

    def test_flagged_launches_are_left_out_and_one_alone_tells_nothing(self):
        def draws(levels, off):
            return Levels(launches_of(levels, flagged=off)).draws("a", "7-12", 1e-6)
        np.testing.assert_array_equal(draws([0.0, 0.01, 0.0, 0.7], [3]), draws([0.0, 0.01, 0.0], []))
        np.testing.assert_array_equal(draws([0.0, 0.01, 0.7], [2]), draws([0.0, 0.01, 0.7], []))  # too many to tell
        for levels in (launches_of([0.3]), None):
            self.assertEqual(Levels(levels).draws("a", "7-12", 1e-6), 0)

    def test_of_two_states_of_a_machine_the_faster_is_the_calm_one_also_where_it_is_the_rarer(self):
        rng = np.random.default_rng(11)
        for slow in range(9):  # of 13 launches
            levels = rng.permutation(np.repeat([math.log(1.5), 0.0], [slow, 13 - slow])) + rng.normal(0, 0.01, 13)
            levels -= np.median(levels)
            np.testing.assert_array_equal(flagged(levels), levels > np.sort(levels)[12 - slow] + 0.2)

    def test_solvers_and_campaigns_are_drawn_apart_and_classes_together(self):
        table = pd.concat([launches_of([-0.1, 0.0, 0.1], solver) for solver in "ab"])
        levels = Levels(pd.concat([table, table.assign(size_class="2-3")]))
        a, b = (levels.draws(solver, "7-12", 1e-6) for solver in "ab")
        self.assertLess(abs(np.corrcoef(a, b)[0, 1]), 0.15)
        self.assertLess(abs(np.corrcoef(a, Levels(table, "new").draws("a", "7-12", 1e-6))[0, 1]), 0.15)
        np.testing.assert_array_equal(levels.shift("a", pd.Series(["7-12", "2-3"]), 1e-6, [1, 3]), a)
        np.testing.assert_allclose(levels.shift(np.array(["a", "b"], dtype=object), pd.Series(["7-12", "2-3"]), 1e-6, [1, 3]), (a + 3 * b) / 4)

    def test_levels_and_quantiles_are_found(self):
        """From files: the second of three launches takes 1.2 times as long, and a tenth of the answers are wrong."""
        def change(record):
            first, second, third = record["fresh_s"]
            record |= {"fresh_s": [first, 1.2 * second, third]}
            return fail(record) if record["problem"] in ("piles-10-0", "chains-20-0") else record

        campaign = campaign_of(write_campaign, {"a": 1.0}, tiers=(1e-6,), copies=10, change=change, noise=Noise(0.001, passes=3))
        table = measured(campaign).launches.set_index(["size_class", "launch"])
        np.testing.assert_allclose([table.loc[("7-12", k), "level"] for k in (1, 2, 3)], [0, math.log(1.2), 0], atol=3e-3)
        cells = measured(campaign).cells
        times = cells[cells["size_class"] == "7-12"]["fresh_s"]
        for launch, factor in ((1, 1.0), (2, 1.2), (0, 1.0)):
            row = table.loc[("7-12", launch)]
            np.testing.assert_allclose(row["p50_s"], factor * times.median(), rtol=0.05)
            self.assertEqual((row["p99_s"], row["max_s"]), (INF, INF))  # one of twenty is wrong
        self.assertLess(table.loc[("7-12", 0), "p90_s"], INF)
        self.assertGreater(table.loc[("7-12", 0), "p90_s"], table.loc[("7-12", 1), "p90_s"])
        self.assertTrue(np.isfinite(table.loc[("31-100", 0), "p99_s"]))


class Shares(unittest.TestCase):
    def test_it_is_wilsons_of_nothing_unknown_and_none_of_many_is_not_none(self):
        for share, count, expected in ((NAN, 0, (NAN, NAN)), (0, 100, (0, 1.96**2 / (100 + 1.96**2))),
                                       (0.3, 50, (0.1910, 0.4375))):
            np.testing.assert_allclose(share_interval(share, count), expected, atol=5e-5)
        self.assertEqual(share_interval(0, 100)[0], 0)


class Passes(unittest.TestCase):
    def test_the_median_is_of_what_is_there(self):
        times = np.array([[1, NAN, 4, 1], [3, NAN, NAN, 2], [2, NAN, 6, NAN]])
        np.testing.assert_array_equal(median_of_passes(times), [2, NAN, 5, 1.5])
        self.assertTrue(np.isnan(median_of_passes(np.empty((0, 3)))).all())
