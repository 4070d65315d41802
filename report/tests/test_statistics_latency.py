"""Tables of steps: quantiles that are known, and what is refused."""

import numpy as np
import pandas as pd

from lcpbench_report.statistics.latency import deadline_table, latency_by_solver_table
from lcpbench_report.statistics.load import load_campaign
from lcpbench_report.statistics.tables import FOLDER, STEP_TABLES
from .cases import FolderCase, run
from .synthetic_campaign import write_campaign
from .synthetic_steps import STEPS, TIERS, exclude, one_pass, write_sequences

RISING = [1e-6 * (k + 1) for k in range(STEPS)]  # 1 us to 101 us: median 51, 99 % 100


class StepTables(FolderCase):
    def load(self, passes: list[dict]):
        return load_campaign(write_sequences(self.folder, passes))

    def test_quantiles_are_of_single_solves_and_wrong_answers_take_for_ever(self):
        for failed, p99, worst in (((), 100e-6, 101e-6), ([7], 101e-6, np.inf)):
            row = latency_by_solver_table(self.load([one_pass("pile-12", "quick", "cold", RISING, failed=failed)])).iloc[0]
            self.assertEqual((row["size"], row["steps"], row["verified"]), ("12", STEPS, STEPS - len(failed)))
            np.testing.assert_allclose(row[["p99", "max"]].tolist(), [p99, worst])
        np.testing.assert_allclose(row["p50"], 52e-6)

    def test_every_round_counts_also_where_the_machine_did_something_else(self):
        disturbed = [*RISING[:-1], 4e-3]
        passes = [one_pass("pile-12", "quick", "cold", times, index=index, preempted=[STEPS - 1] * (times is disturbed))
                  for index, times in enumerate([RISING, disturbed, RISING])]
        row = latency_by_solver_table(self.load(passes)).iloc[0]
        np.testing.assert_allclose(row[["p50", "max"]].tolist(), [51e-6, 4e-3])
        self.assertEqual(row["preempted"], 1)

    def test_steps_that_were_not_reached_take_for_ever(self):
        row = latency_by_solver_table(self.load([one_pass("pile-12", "quick", "warm", RISING[:60])])).iloc[0]
        self.assertEqual(row["verified"], 60)
        self.assertTrue(np.isclose(row["p50"], 51e-6) and np.isinf(row["p99"]) and np.isinf(row["max"]))

    def test_a_sequence_with_a_step_that_a_solver_does_not_take_is_not_asked_of_it(self):
        for refused in (1, 40, STEPS):
            partly = one_pass("pile-12", "peer", "cold", RISING, failed=range(refused))
            partly["claims"] = {"unsupported": refused} | ({"solved": STEPS - refused} if refused < STEPS else {})
            campaign = self.load([partly, partly | {"round": 1}, one_pass("chain-12", "peer", "cold", RISING),
                                  one_pass("pile-12", "quick", "cold", RISING)])
            found = {(sequence, solver): runs.excluded for (sequence, solver, *_), runs in campaign.passes.items()}
            self.assertEqual(found, {("pile-12", "peer"): "not asked", ("chain-12", "peer"): "", ("pile-12", "quick"): ""})
            by_solver = latency_by_solver_table(campaign).set_index(["solver", "size"])
            row = by_solver.loc[("peer", "all")]
            self.assertEqual((row["sequences"], row["excluded"], row["verified_share"]), (1, 1, 1))

    def test_a_direct_solver_has_a_row_at_every_tier_that_it_is_judged_at(self):
        campaign = self.load([one_pass("pile-12", "quick", mode, RISING, judged=TIERS) for mode in ("cold", "warm")])
        self.assertEqual(set(latency_by_solver_table(campaign)["tier"]), set(TIERS))

    def test_sizes_are_pooled(self):
        slow = [10 * time for time in RISING]
        campaign = self.load([one_pass("pile-12", "quick", "cold", RISING), one_pass("chain-12", "quick", "cold", slow),
                              exclude(one_pass("pile-40", "quick", "cold", []))])
        table = latency_by_solver_table(campaign).set_index("size")
        self.assertEqual(table.index.tolist(), ["12", "40", "all"])
        self.assertAlmostEqual(table.loc["12", "p50"], np.median(RISING + slow))
        self.assertEqual(table.loc["12", "steps"], 2 * STEPS)
        self.assertEqual(table["excluded"].tolist(), [0, 1, 1])
        self.assertTrue(np.isnan(table.loc["40", "p50"]))

    def test_the_gain_is_the_median_of_cold_by_warm_where_both_are_verified(self):
        passes = []
        for sequence, factor in (("pile-12", 2.0), ("chain-12", 3.0), ("pile-40", 3.0)):
            passes.append(one_pass(sequence, "quick", "cold", [factor * time for time in RISING], failed=range(50)))
            # Where the cold answer is wrong the warm one is a hundred times faster: that must not count.
            warm = [time / 100 if k < 50 else time for k, time in enumerate(RISING)]
            passes.append(one_pass(sequence, "quick", "warm", warm))
        table = latency_by_solver_table(self.load(passes))
        row = table[(table["mode"] == "warm") & (table["size"] == "all")].iloc[0]
        np.testing.assert_allclose(row[["warm_gain", "warm_gain_low", "warm_gain_high"]].tolist(), [3, 2, 3])
        self.assertTrue(table.loc[table["mode"] == "cold", "warm_gain"].isna().all())

    def test_deadlines_tell_who_was_late_and_how_wrong_the_others_are(self):
        rho = [1e-9 * (k + 1) for k in range(STEPS)]  # 1e-9 to 1.01e-7
        rounds = [one_pass("pile-12", "quick", "deadline-1ms", RISING, index=index, late=late, failed=[3], rho=rho,
                           judged=TIERS)
                  for index, late in enumerate([[], [100]])]
        table = deadline_table(self.load(rounds))
        self.assertEqual(table["size"].tolist(), ["12", "12", "all", "all"])
        self.assertEqual(table["tier"].tolist(), [1e-3, 1e-6] * 2)
        row = table.iloc[1]
        self.assertEqual((row["steps"], row["in_time"], row["verified"]), (2 * STEPS, 2 * STEPS - 1, 2 * STEPS - 3))
        answered = rho + rho[:-1]
        np.testing.assert_allclose(row[["rho_p50", "rho_p99", "rho_max", "w_error_max"]].tolist(),
                                   [np.median(answered), np.quantile(answered, 0.99), 1.01e-7, 2e-9])
        self.assertLess(row["verified_low"], row["verified_share"])

    def test_an_answer_in_time_that_is_not_finite_has_an_infinite_error(self):
        rho = [None, *[1e-9] * (STEPS - 1)]
        table = deadline_table(self.load([one_pass("pile-12", "quick", "deadline-1ms", RISING, rho=rho, failed=[0])]))
        self.assertTrue(np.isinf(table["rho_max"]).all())
        self.assertEqual(table["in_time"].iloc[0], STEPS)

    def test_a_campaign_of_sequences_alone_has_their_tables_alone(self):
        write_sequences(self.folder, [one_pass("pile-12", "quick", "warm", RISING)])
        for empty in (False, True):
            if empty:
                for name in ("problems.jsonl", "streams.jsonl"):
                    (self.folder / name).touch()
            self.assertEqual(run("analyse", self.folder)[0], 0)
            written = {path.stem for path in (self.folder / FOLDER).iterdir()}
            self.assertEqual(written, set(STEP_TABLES))
        self.assertEqual(len(pd.read_csv(self.folder / FOLDER / "latency_by_solver.csv")), 2)

    def test_a_campaign_of_cells_alone_has_no_tables_of_steps(self):
        write_campaign(self.folder, {"a": 1.0, "b": 2.0}, copies=1)
        self.assertEqual(run("analyse", self.folder)[0], 0)
        self.assertFalse((self.folder / FOLDER / "latency_by_solver.csv").exists())
        self.assertTrue((self.folder / FOLDER / "cells.csv").exists())

    def test_without_passes_there_are_headers(self):
        campaign = self.load([])
        for table in STEP_TABLES.values():
            self.assertTrue(table(campaign).empty)


class Refusals(FolderCase):
    def setUp(self):
        super().setUp()
        self.line = one_pass("pile-12", "quick", "cold", RISING)

    def refuse(self, lines: list[dict], text: str):
        write_sequences(self.folder, lines)
        self.assert_refused("analyse", self.folder, told=(text,))

    def test_every_key_is_missed(self):
        for key in self.line:
            if key != "environment":
                self.refuse([{k: v for k, v in self.line.items() if k != key}], key)

    def test_values_that_do_not_fit_are_refused(self):
        for change, text in (({"sequence": "other"}, "sequence"), ({"solver": "absent"}, "solver"),
                             ({"tier": 1e-4}, "tier"), ({"latency_s": RISING[1:]}, "latency_s"),
                             ({"latency_s": None}, "latency_s"), ({"latency_s": [-1.0] * STEPS}, "latency_s"), ({"late": [STEPS]}, "late"),
                             ({"rho": ["x"] * STEPS}, "rho"), ({"outcome": "fine"}, "outcome"),
                             ({"steps": 7}, "steps"), ({"verdicts": []}, "verdict")):
            self.refuse([self.line | change], text)
        verdict = self.line["verdicts"][0]
        self.refuse([self.line | {"verdicts": [verdict | {"failed_steps": [1]}]}], "passed")

    def test_a_pass_that_is_there_twice_or_lacks_its_first_round_is_refused(self):
        self.refuse([self.line, self.line], "twice")
        self.refuse([self.line | {"round": 1}], "round 0")
