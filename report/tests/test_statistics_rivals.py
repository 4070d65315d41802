"""What a user pays by size class, the rivals, other builds of ours: true ratios found, false ones not."""

import math
import unittest

import numpy as np
import pandas as pd

from lcpbench_report.inputs import load_inputs
from lcpbench_report.statistics.cells import measured
from lcpbench_report.statistics.class_times import class_table
from lcpbench_report.statistics.launches import Levels
from lcpbench_report.statistics.load import load_campaign
from lcpbench_report.statistics.portfolio import best_order, portfolio_rows
from lcpbench_report.statistics.rivals import (DOMINATED, DOMINATES, FASTER, FASTEST, PORTFOLIO, SLOWER, UNDECIDED, flag_table,
                                               pareto_front, relation, rival_table)
from .cases import SharedFolderCase
from .synthetic_campaign import AGAIN, FIRST, cells_of, launches_of, write_campaign

INF, NAN = math.inf, math.nan


def rivals(cells: pd.DataFrame, levels: Levels = Levels(), portfolio: dict[str, list[str]] = {}) -> pd.DataFrame:
    return rival_table(cells, {"own"}, "own", levels, portfolio).set_index(["rival", "origin"]).sort_index()


class Rivals(unittest.TestCase):
    # s: only the own one; t: only a peer; u: neither.
    TIMES = pd.DataFrame({"own": [1.0, 3.0, 2.0, 1.0, INF, INF], "quick": [2.0, 1.0, INF, 1.5, 1.0, INF],
                          "sure": [4.0, 4.0, 4.0, INF, 9.0, 8.0], "slow": [9.0, 9.0, 9.0, INF, INF, 9.0]}, list("pqrstu"))

    def test_by_hand(self):
        table = rivals(cells_of(self.TIMES))
        self.assertEqual(set(table.index.get_level_values(0)), {"quick", "sure", FASTEST})  # slow is dominated by sure
        row = table.loc[(FASTEST, "all")]
        # 1/2, 3/1, 2/4, 1/1.5, and two failures of ours.
        self.assertAlmostEqual(row["ratio"], (1 / 1.5 + 3.0) / 2)
        self.assertEqual((row["peers"], row["problems"], row["rival_share"], row["own_share"]), (3, 6, 1, 4 / 6))
        self.assertEqual(row["peer_faster"], 3 / 6)  # on q, t and u
        self.assertTrue(0 < row["peer_faster_low"] < 0.5 < row["peer_faster_high"] < 1)
        near = cells_of(pd.DataFrame({"own": [1.0] * 4, "peer": [0.985, 0.97, 1.0, 1.5]}))  # 2 % are none
        self.assertEqual(rivals(near).loc[(FASTEST, "all"), "peer_faster"], 1 / 4)
        quick = table.loc[("quick", "all")]
        self.assertEqual((quick["front"], quick["rival_s"], quick["rival_share"]), (True, 1.75, 4 / 6))
        self.assertAlmostEqual(quick["ratio"], (1 / 1.5 + 3.0) / 2)  # of 1/2, 3, 1/1.5 and inf: where quick is right

    def test_the_portfolio_is_a_rival_whether_on_the_front_or_not_and_by_origin(self):
        times = pd.DataFrame({"own": [1.0] * 40, "slow": [4.0] * 20 + [2.0] * 20, "better": [1.5] * 40})
        cells = cells_of(times)
        cells["origin"] = np.where(cells["problem"] < 20, "motion", "recorded")
        table = rivals(cells, portfolio={"7-12": ["slow"]})
        self.assertFalse(table.loc[(PORTFOLIO, "all"), "front"])
        self.assertEqual([table.loc[(PORTFOLIO, origin), "ratio"] for origin in ("own scenes", "engines")], [0.25, 0.5])
        self.assertEqual(table.loc[(PORTFOLIO, "all"), "relation"], DOMINATED)
        self.assertNotIn(("better", "engines"), table.index)

    def test_ratios_are_formed_round_by_round(self):
        """The machine slows every solver by the same in a round: medians of few launches, and draws of either side's, see
        that, and ratios within rounds do not. A flagged launch is in no ratio; of the fastest each problem has its own."""
        rng, names, numbers = np.random.default_rng(4), range(60), range(1, 5)
        machine = np.exp([0.0, 0.09, -0.09, 0.02])
        base = np.exp(rng.normal(0, 1, 60))
        factors = {"own": np.ones(60), "even": np.where(np.arange(60) % 2, 4.0, 2.0), "odd": np.where(np.arange(60) % 2, 2.0, 4.0)}
        noise = {key: np.exp(rng.normal(0, 0.004, (60, 4))) for key in factors}
        times = {(key, "7-12", 1e-6): pd.DataFrame(noise[key] * machine * (base * of)[:, np.newaxis], names, numbers)
                 for key, of in factors.items()}
        times["own", "7-12", 1e-6][4] *= 1.5  # and flagged
        launches = pd.concat([launches_of([0.0, 0.09, -0.09, 0.02], key, flagged=[3] * (key == "own")) for key in factors])
        cells = cells_of(pd.DataFrame({key: base * of * np.exp(rng.normal(0, 0.1, 60)) for key, of in factors.items()}))
        apart, together = (rivals(cells, Levels(launches, times=of)) for of in (None, times))
        row, before = together.loc[(FASTEST, "all")], apart.loc[(FASTEST, "all")]
        self.assertGreater(before["ratio_high"] / before["ratio_low"], 1.15)
        self.assertAlmostEqual(row["ratio"], 0.5, delta=0.002)
        self.assertLess(row["ratio_high"] - row["ratio_low"], 0.02)
        alone = {key: of[[1]] for key, of in times.items()}  # one round is none
        pd.testing.assert_frame_equal(rivals(cells, Levels(launches, times=alone)), apart)

    def test_intervals_of_few_rounds_hold_the_truth(self):
        held, runs = 0, 200
        for seed in range(runs):
            rng, sides = np.random.default_rng([71, seed]), {}
            for key in ("own", "peer"):
                times = np.exp(rng.normal(0, 0.02, (40, 3)) + rng.normal(0, 0.03, 3))
                sides[key, "7-12", 1e-6] = pd.DataFrame(times, range(40), [1, 2, 3])
            cells = cells_of(pd.DataFrame({key: of.median(axis=1) for (key, *_), of in sides.items()}))
            row = rivals(cells, Levels(salt=str(seed), times=sides)).loc[("peer", "all")]
            held += row["ratio_low"] <= 1 <= row["ratio_high"]
        self.assertTrue(0.9 <= held / runs <= 0.99, held / runs)

    def test_the_portfolio_asks_codes_in_turn_until_one_is_right(self):
        times = pd.DataFrame({"own": [1.0] * 5, "quick": [2.0, INF, INF, INF, INF], "sure": [4.0, 4.0, INF, 4.0, 4.0]})
        cells = cells_of(times, check_s=0.5)
        failed = (cells["solver"] == "quick") & ~cells["passes"]
        # Wrong after 3 s; beyond the limit; killed without a time; left out by a rule of time; not taken.
        cells.loc[failed, "first_s"] = [3.0, 99.0, NAN, NAN]
        cells.loc[failed, "verdict"] = ["failed:iteration_limit", "out of time", "out of time", "not asked"]
        cells.loc[failed, "excluded"] = ["", "", "out of time at the looser tier 1e-3", ""]
        table = rival_table(cells, {"own"}, "own", Levels(), {"7-12": ["quick", "sure", "absent"]}).set_index(["rival", "origin"])
        row = table.loc[(PORTFOLIO, "all")]
        expected = [2.5, 3.5 + 4.5, INF, 4.5, 4.5]
        self.assertEqual((row["rival_s"], row["rival_share"]), (np.median(expected), 0.8))
        self.assertAlmostEqual(row["check_share"], np.median([0.5 / 2.5, 1 / 8, 0.5 / 4.5, 0.5 / 4.5]))
        self.assertAlmostEqual(row["ratio"], np.median([1 / of for of in expected if of < INF]))
        self.assertNotIn(PORTFOLIO, rival_table(cells, {"own"}, "own", Levels())["rival"].tolist())
        # By rounds: the sum of the turns' times of a round.
        rounds = {(key, "7-12", 1e-6): pd.DataFrame(np.outer([1.0] * 5, of), range(5), [1, 2, 3])
                  for key, of in (("own", [1, 2, 1]), ("quick", [2, 3, 2]), ("sure", [4, 4, 5]))}
        levels = Levels(times=rounds)
        rows, found = portfolio_rows(cells, ["quick", "sure"], 1e-6, levels)
        np.testing.assert_array_equal(found.loc[0], [2.5, 3.5, 2.5])
        np.testing.assert_array_equal(found.loc[[1, 3]], [[7, 8, 8], [4.5, 4.5, 5.5]])
        self.assertTrue(found.loc[2].isna().all())
        np.testing.assert_array_equal(found.loc[4], [4.5, 4.5, 5.5])
        self.assertEqual(rows["solver"][[0, 1, 4]].tolist(), ["quick", "sure", "sure"])

    def test_the_order_of_the_portfolio_is_the_one_that_takes_least(self):
        even = np.arange(40) % 2 == 0
        cells = cells_of(pd.DataFrame({"half": np.where(even, 1.0, INF), "other": np.where(even, INF, 1.2), "sure": [5.0] * 40,
                                       "worse": [6.0] * 40, "never": [INF] * 40}), check_s=0.01)
        cells["first_s"] = cells["first_s"].fillna(0.5)
        keys = ["never", "worse", "sure", "other", "half"]
        order = best_order(cells, keys)
        self.assertEqual((sorted(order[:2]), order[2:]), (["half", "other"], ["sure", "worse"]))  # those add nothing here
        self.assertEqual(best_order(cells[cells["solver"] != "half"], keys[:-1]), ["other", "sure", "worse"])
        of_one = cells.assign(solver=cells["solver"].replace({"sure": "half-sure", "worse": "half-worse"}))
        self.assertEqual(sorted(best_order(of_one, list(dict.fromkeys(of_one["solver"])))), ["half", "other"])
        self.assertEqual(best_order(cells, ["never"]), [])

    def test_what_a_peer_does_not_take_is_not_right(self):
        cells = cells_of(pd.DataFrame({"own": [1.0] * 40, "picky": [0.5] * 40, "sure": [2.0] * 40}))
        unasked = (cells["solver"] == "picky") & (cells["problem"] >= 24)
        cells.loc[unasked, ["verdict", "claim", "passes", "time_s"]] = ["not asked", "unsupported", False, INF]
        row = rivals(cells).loc[("picky", "all")]
        self.assertEqual((row["rival_share"], row["ratio"], row["relation"]), (0.6, 2.0, FASTER))
        cells.loc[(cells["solver"] == "picky") & (cells["problem"] >= 16), ["verdict", "passes", "time_s"]] = ["not asked", False, INF]
        self.assertNotIn(("picky", "all"), rivals(cells).index)  # it takes less than half

    def test_the_front_by_hand(self):
        points = {"a": (3.0, 0.9), "b": (1.0, 0.5), "c": (2.0, 0.5), "d": (4.0, 0.9), "e": (5.0, 1.0), "f": (INF, 1.0)}
        self.assertEqual(pareto_front(points), ["b", "a", "e"])
        self.assertEqual(pareto_front({"f": (INF, 1.0)}), [])

    def test_nobody_off_the_front_is_better_than_one_on_it(self):
        for seed in range(200):
            rng = np.random.default_rng([60, seed])
            points = {k: (float(rng.choice([1, 2, 3, 4, INF])), float(rng.choice([0.5, 0.8, 0.9, 1]))) for k in range(8)}
            front = pareto_front(points)
            for key, (time, share) in points.items():
                covered = any(points[other][0] <= time and points[other][1] >= share for other in front)
                self.assertEqual(covered, math.isfinite(time) or covered)
                if key in front:
                    self.assertFalse(any((t <= time and s > share) or (t < time and s >= share) for t, s in points.values()))

    def test_who_dominates_whom(self):
        for low, high, own, share, expected in ((0.5, 0.9, 1, 0.9, DOMINATED), (0.5, 0.9, 0.9, 0.9, DOMINATED),
                                                (0.5, 0.9, 0.8, 0.9, SLOWER), (1.1, 1.3, 0.9, 0.9, DOMINATES),
                                                (1.1, 1.3, 0.9, 0.8, FASTER), (0.9, 1.3, 1, 0, UNDECIDED),
                                                (NAN, NAN, 1, 0, UNDECIDED)):
            self.assertEqual(relation(low, high, own, share), expected)

    def test_variants_of_a_base_weigh_what_one_does(self):
        cells = cells_of(pd.DataFrame({"own": [1.0] * 12, "peer": [10.0] * 10 + [0.5] * 2}))
        self.assertAlmostEqual(rivals(cells).loc[("peer", "all"), "ratio"], 0.1)
        many = cells["problem"] < 10
        cells.loc[many, "base"], cells.loc[many, "weight"] = "one", 0.1
        row = rivals(cells).loc[("peer", "all")]
        self.assertAlmostEqual(row["ratio"], 2.0)
        self.assertAlmostEqual(row["n_eff"], 3)

    def test_the_interval_holds_the_true_ratio_over_families_and_launches(self):
        """Families have ratios of their own around 0.25, launches of either solver levels of their own: what another
        collection and other launches would give is to be in it."""
        held, naive, runs = 0, 0, 40
        for seed in range(runs):
            rng = np.random.default_rng([50, seed])
            families = np.repeat(np.arange(12), 10)
            logs = {"own": rng.normal(0, 1, 120)}
            logs["peer"] = logs["own"] - math.log(0.25) - rng.normal(0, 0.15, 12)[families] - rng.normal(0, 0.3, 120)
            rows, levels = [], {}
            for key in logs:
                of_launches = rng.normal(0, 0.3, 10)
                levels[key] = float(np.median(of_launches))
                rows.append(launches_of(of_launches - levels[key], key))
            cells = cells_of(pd.DataFrame({key: np.exp(logs[key] + levels[key]) for key in logs}))
            cells["family"] = cells["problem"].map(lambda problem: f"f{families[problem]}")
            for drawn in (Levels(pd.concat(rows)), Levels()):
                row = rivals(cells, drawn).loc[("peer", "all")]
                holds = row["ratio_low"] <= 0.25 <= row["ratio_high"]
                held, naive = (held + holds, naive) if drawn.count("own", "7-12", 1e-6) else (held, naive + holds)
        self.assertGreaterEqual(held, 0.9 * runs)
        self.assertLess(naive, 0.85 * runs)  # problems alone do not see what launches have in common

    def test_without_peers_there_are_no_rows(self):
        self.assertTrue(rivals(cells_of(self.TIMES[["own"]])).empty)

    def test_at_equal_flags_a_build_for_less_stands_against_what_is_built_for_no_more(self):
        cells = cells_of(pd.DataFrame({"auto": [1.0] * 30, "auto-baseline": [3.0] * 30, "auto-v3": [2.0] * 30,
                                       "ode-dantzig": [4.0] * 30, "ode-dantzig-native": [2.5] * 30}))
        found = {(of["flags"], of["own"], of["rival"]): of["ratio"] for of in flag_table(cells, Levels()).to_dict("records")}
        self.assertEqual(found, {("any x86-64", "auto-baseline", "ode-dantzig"): 0.75,
                                 ("x86-64-v3", "auto-v3", "ode-dantzig-native"): 0.8,
                                 ("the machine's", "auto", "ode-dantzig-native"): 0.4})
        self.assertTrue(flag_table(cells[cells["solver"].isin(["auto", "ode-dantzig"])], Levels()).empty)


class ClassTimes(unittest.TestCase):
    def test_medians_are_of_the_class_and_failures_are_infinite(self):
        times = pd.DataFrame({"a": [1.0, 2.0, INF, 5.0], "b": [INF, INF, 1.0, 1.0]})
        table = class_table(cells_of(times), Levels()).set_index(["size_class", "solver"])
        self.assertEqual(table.loc[("7-12", "a"), "median_s"], 3.5)
        self.assertEqual(table.loc[("7-12", "b"), "median_s"], INF)


class Folder(SharedFolderCase):
    """All of it, from files."""

    FACTORS = {"own": 1.0, "peer": 4.0, "auto-v3": 0.9}

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        write_campaign(cls.path, cls.FACTORS, tiers=(1e-6,), peers=("peer",), solvers={"auto-v3": {"origin": "external"}})
        cls.campaign, cls.inputs = load_campaign(cls.path), load_inputs([cls.path])
        cls.cells, launches = measured(cls.campaign)[:2]
        cls.levels = Levels(launches)

    def test_other_builds_of_ours_are_in_no_table_but_of_flags_and_of_all_cells(self):
        self.assertEqual(self.inputs.keys, ["own", "peer"])
        for name, table in self.inputs.analysis.items():
            if name not in ("cells", "launches", "equal_flags") and "solver" in table:
                self.assertLessEqual(set(table["solver"]), {"own", "peer"}, name)

    def test_times_by_class(self):
        table = class_table(self.cells, self.levels).set_index(["size_class", "solver"])
        self.assertEqual(list(dict.fromkeys(table.index.get_level_values(0))),
                         ["7-12", "13-30", "31-100", "101-300", "301-1000", "all"])
        for size in ("7-12", "301-1000"):
            own = table.loc[(size, "own")]
            self.assertAlmostEqual(table.loc[(size, "peer"), "median_s"] / own["median_s"], 4, delta=0.2)
            self.assertAlmostEqual(own["again_s"] / own["median_s"], AGAIN, delta=0.05)
            self.assertAlmostEqual(own["first_s"] / own["median_s"], FIRST, delta=0.3)
