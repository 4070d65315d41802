"""What a user pays by size class, the ratio to the peers, ablations: true ratios found, false ones not."""

import math
import unittest

import numpy as np
import pandas as pd

from lcpbench_report.inputs import load_inputs
from lcpbench_report.statistics.cells import cell_table
from lcpbench_report.statistics.class_times import ablation_table, class_table, peer_ratio_table
from lcpbench_report.statistics.load import load_campaign
from .cases import SharedFolderCase
from .synthetic_campaign import AGAIN, COPIES, FAMILIES, FIRST, cells_of, fail, write_campaign

INF, NAN = math.inf, math.nan


class PeerRatio(unittest.TestCase):
    # s: only the own one; t: only a peer; u: neither.
    TIMES = pd.DataFrame({"own": [1.0, 3.0, 2.0, 1.0, INF, INF], "quick": [2.0, 1.0, INF, INF, 1.0, INF],
                          "sure": [4.0, 4.0, 4.0, INF, 9.0, INF]}, list("pqrstu"))

    def row(self, cells: pd.DataFrame) -> pd.Series:
        table = peer_ratio_table(cells, {"own"})
        self.assertEqual(set(table["solver"]), {"own"})
        return table.set_index("size_class").loc["all"]

    def test_by_hand(self):
        row = self.row(cells_of(self.TIMES))
        self.assertEqual(row["no_peer"], 2)
        self.assertAlmostEqual(row["ratio"], (0.5 + 3.0) / 2)  # of 1/2, 3/1, 2/4 and a failure
        self.assertEqual(row["peer"], "")  # quick is right on half of them, sure on two thirds
        self.assertTrue(math.isnan(row["peer_ratio"]))

    def test_the_best_single_peer_is_right_nearly_always(self):
        times = pd.DataFrame({"own": np.full(300, 2.0), "sure": np.full(300, 4.0), "quick": np.full(300, 1.0)})
        times.loc[:2, "quick"] = INF  # 99 %: enough
        row = self.row(cells_of(times))
        self.assertEqual((row["peer"], row["peer_ratio"]), ("quick", 2.0))
        times.loc[3, "quick"] = INF
        row = self.row(cells_of(times))
        self.assertEqual((row["peer"], row["peer_ratio"]), ("sure", 0.5))
        self.assertEqual(row["ratio"], 2.0)  # the fastest one that is verified, where it is

    def test_a_peer_that_is_right_is_a_rival_also_where_it_was_not_asked(self):
        cells = cells_of(self.TIMES)
        cells["asked"] = cells["solver"] != "quick"
        self.assertEqual(self.row(cells)["ratio"], self.row(cells_of(self.TIMES))["ratio"])

    def test_variants_of_a_base_weigh_what_one_does(self):
        times = pd.DataFrame({"own": [1.0] * 12, "peer": [10.0] * 10 + [0.5] * 2})
        cells = cells_of(times)
        self.assertAlmostEqual(self.row(cells)["ratio"], 0.1)
        many = cells["problem"] < 10
        cells.loc[many, "base"], cells.loc[many, "weight"] = "one", 0.1
        self.assertAlmostEqual(self.row(cells)["ratio"], 2.0)

    def test_the_interval_holds_the_true_ratio(self):
        """Families have ratios of their own around 0.25: what another collection would give is to be in it."""
        held, runs = 0, 25
        for seed in range(runs):
            rng = np.random.default_rng([50, seed])
            families = np.repeat(np.arange(12), 20)
            own = np.exp(rng.normal(0, 1, 240))
            ratio = 0.25 * np.exp(rng.normal(0, 0.5, 12)[families] + rng.normal(0, 0.3, 240))
            cells = cells_of(pd.DataFrame({"own": own, "peer": own / ratio}))
            cells["family"] = cells["problem"].map(lambda problem: f"f{families[problem]}")
            row = self.row(cells)
            held += row["ratio_low"] <= 0.25 <= row["ratio_high"]
        self.assertGreaterEqual(held, 21)

    def test_a_class_of_a_thousand_problems_has_a_p99(self):
        times = pd.DataFrame({"own": np.arange(1.0, 1001), "peer": np.arange(2.0, 1002)})
        found = class_table(cells_of(times)).set_index(["size_class", "solver"])["p99_s"]
        self.assertEqual((found["all", "own"], found["all", "peer"]), (990.5, 991.5))
        self.assertTrue(class_table(cells_of(times.iloc[:999]))["p99_s"].isna().all())

    def test_without_peers_there_is_no_ratio(self):
        row = self.row(cells_of(self.TIMES[["own"]]))
        self.assertEqual((row["no_peer"], row["peer"]), (6, ""))
        self.assertTrue(math.isnan(row["ratio"]))


class ClassTimes(unittest.TestCase):
    def test_medians_are_of_the_class_and_failures_are_infinite(self):
        times = pd.DataFrame({"a": [1.0, 2.0, INF, 5.0], "b": [INF, INF, 1.0, 1.0]})
        cells = cells_of(times)
        cells.loc[~cells["passes"], "again_s"] = 9.0
        table = class_table(cells).set_index(["size_class", "solver"])
        self.assertEqual(list(table.loc[("7-12", "a"), ["median_s", "again_s"]]), [3.5, 2.0])  # again: of the verified
        self.assertEqual(table.loc[("7-12", "b"), "median_s"], INF)


class Folder(SharedFolderCase):
    """All of it, from files."""

    FACTORS = {"own": 1.0, "peer": 4.0, "bare": 0.9, "checked": 5.0}

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        write_campaign(cls.path, cls.FACTORS, tiers=(1e-6,), change=cls.change,
                       solvers={"peer": {"origin": "peer"}, "bare": {"ablation": "no-self-check", "base": "own"},
                                "checked": {"ablation": "checked", "base": "peer", "origin": "peer"}})
        cls.campaign, cls.inputs = load_campaign(cls.path), load_inputs([cls.path])
        cls.cells, cls.ablated = cell_table(cls.campaign), cell_table(cls.campaign, True)

    # The bare one claims too much on one copy of four.
    change = staticmethod(lambda record: fail(record, "solved") if record["solver"] == "bare"
                          and record["problem"].endswith("-0") else record)

    def test_ablations_are_in_their_table_and_nowhere_else(self):
        self.assertEqual(set(self.cells["solver"]), {"own", "peer"})
        self.assertEqual(set(self.ablated["solver"]), {"bare", "checked"})
        self.assertEqual(self.inputs.keys, ["own", "peer"])
        for name, table in self.inputs.analysis.items():
            if name != "ablation" and "solver" in table:
                self.assertLessEqual(set(table["solver"]), {"own", "peer"}, name)
        self.assertEqual(set(self.inputs.analysis["ablation"]["solver"]), {"bare", "checked"})

    def test_the_ablation_table_finds_the_true_ratios_and_what_went_wrong(self):
        table = ablation_table(self.cells, self.ablated, self.campaign.info["solvers"]).set_index(["solver", "size_class"])
        problems = len(FAMILIES) * 6 * COPIES
        bare, checked = table.loc[("bare", "all")], table.loc[("checked", "all")]
        self.assertEqual((bare["base"], bare["ablation"], bare["problems"]), ("own", "no-self-check", problems))
        self.assertEqual((bare["both"], bare["false_successes"], bare["base_false_successes"]),
                         (problems * 3 // 4, problems // 4, 0))
        self.assertAlmostEqual(bare["verified_share"], 3 / 4)
        for row, ratio in ((bare, 0.9), (checked, 1.25)):
            self.assertAlmostEqual(row["ratio"], ratio, delta=0.03)
            self.assertTrue(row["ratio_low"] <= ratio <= row["ratio_high"])
        self.assertEqual(len(table.loc["bare"]), 6)  # five classes and all

    def test_times_by_class(self):
        table = class_table(self.cells).set_index(["size_class", "solver"])
        self.assertEqual(list(dict.fromkeys(table.index.get_level_values(0))),
                         ["7-12", "13-30", "31-100", "101-300", "301-1000", "all"])
        for size in ("7-12", "301-1000"):
            own = table.loc[(size, "own")]
            self.assertAlmostEqual(table.loc[(size, "peer"), "median_s"] / own["median_s"], 4, delta=0.2)
            self.assertAlmostEqual(own["again_s"] / own["median_s"], AGAIN, delta=0.05)
            self.assertAlmostEqual(own["first_s"] / own["median_s"], FIRST, delta=0.3)
