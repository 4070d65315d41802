"""Which backend the report names, and what its summary says."""

import unittest

import pandas as pd

from lcpbench_report import choice, fairness, summary
from lcpbench_report.compact import compact
from lcpbench_report.errors import ReportError
from lcpbench_report.inputs import load_inputs
from .cases import FolderCase, edit_lines, inputs_of
from .synthetic_campaign import Noise as NoiseOf
from .synthetic_campaign import cells_of, fail, write_campaign
from .synthetic_report import whole_inputs, write_all
from .synthetic_steps import STEPS

INF = float("inf")


class Contenders(unittest.TestCase):
    def ranked(self, times: dict[str, list[float]]) -> list[str]:
        table = pd.DataFrame(times, index=[f"p{i}" for i in range(len(next(iter(times.values()))))])
        return [found.solver for found in choice.contenders(cells_of(table), list(times))]

    def test_the_fastest_of_those_that_verify_all_and_nobody_wins_by_failing(self):
        self.assertEqual(self.ranked({"slow": [2e-3] * 10, "fast": [1e-3] * 10}), ["fast", "slow"])
        self.assertEqual(self.ranked({"sound": [2e-3] * 10, "hasty": [1e-6] * 9 + [INF]}), ["sound"])
        self.assertEqual(self.ranked({"only": [INF, INF]}), [])

    def test_one_failure_in_a_hundred_is_entered_with_its_limit(self):
        times = {"sound": [2e-3] * 100, "hasty": [1e-3] * 99 + [INF]}
        self.assertEqual(self.ranked(times), ["hasty", "sound"])
        self.assertEqual(self.ranked({"sound": [1.05e-3] * 100, "hasty": [1e-3] * 99 + [INF]}), ["sound", "hasty"])

    def test_problems_that_some_have_not_reached_do_not_count(self):
        # The campaign was stopped: `late` had its turn on the first problem only.
        times = {"early": [1e-3, 5.0, 5.0], "late": [2e-3, float("nan"), float("nan")]}
        ranked = choice.contenders(cells_of(pd.DataFrame(times, index=["a", "b", "c"])), list(times))
        self.assertEqual([(found.solver, found.problems) for found in ranked], [("early", 1), ("late", 1)])


class WholeReport(unittest.TestCase):
    def setUp(self):
        self.inputs = whole_inputs()

    def test_every_class_names_the_fastest_of_ours(self):
        choices = choice.by_class(self.inputs)
        self.assertEqual({of.tier for of in choices}, set(self.inputs.tiers))
        self.assertEqual({of.own[0].solver for of in choices}, {"auto"})
        for of in choices:
            self.assertNotIn("ode-dantzig", [found.solver for found in of.own])

    def test_the_peer_is_no_contender_where_it_was_refuted(self):
        strictest = [c for c in choice.by_class(self.inputs) if c.tier < 1e-8 and c.size_class == "301-1000"]
        self.assertEqual([found.solver for found in strictest[0].everyone], ["auto"])

    def test_of_equals_within_the_deadline_the_one_with_the_least_percentile(self):
        found = choice.by_deadline(self.inputs)
        self.assertEqual([row["size"] for row in found][-3:], ["12", "40", "all"])
        for row in found:
            for of in row["choices"]:
                self.assertEqual((of["solver"], of["missed"], of["next"][2]), ("auto", 0, "pgs"))
                self.assertAlmostEqual(of["next"][0], 1 / STEPS)

    def test_gains_of_warm_starts(self):
        gains = {row["solver"]: row["warm_gain"] for row in choice.passes(self.inputs, 1e-6).to_dict("records")}
        self.assertAlmostEqual(gains["auto"], 2.0, places=6)
        self.assertAlmostEqual(gains["pgs"], 8 / 6, places=6)

    def test_a_few_lines_with_the_figures_of_the_data(self):
        lines = summary.summary_lines(self.inputs)
        self.assertLessEqual(len(lines), summary.MOST_LINES)
        text = "\n".join(lines)
        cells = self.inputs.cells
        false = int((cells["verdict"] == "false success").sum())
        self.assertGreater(false, 0)
        self.assertIn(f"0 in {int(cells[cells['solver'].isin(self.inputs.own)].shape[0])} solves of ours, {false} in", text)
        self.assertIn("verified at every tier by `auto`.", text)
        self.assertIn("`auto`, 10.0 µs (median 10.0 µs".replace(" µs", "\u202fµs"), text)
        self.assertIn("Fastest over all sizes at 1e-6: `auto`", text)
        self.assertNotIn("nan", text)

    def test_limitations_say_what_holds_here(self):
        found = dict(fairness.limitations(self.inputs))
        self.assertIn("absent", found["Not in this build"])
        self.assertIn("rows > 100", found["Excluded by rule"])
        self.assertIn("-march=native", found["Compiler flags"])
        self.assertNotIn("Uncommitted changes", found)
        self.assertNotIn("Direct methods", found)
        self.assertIn("one interval from the caller's arrays", found["Fresh times"])
        self.assertNotIn("External programs of protocol 1", found)


class Noise(FolderCase):
    def test_levels_flags_and_rounds_are_told_from_the_records(self):
        """The third launch of one solver takes 1.3 times as long; the fourth is the repetition; another solver begins 40 s later."""
        def change(record):
            first, second, third, fourth = record["fresh_s"]
            return record | {"fresh_s": [first, second, third * (1.3 if record["solver"] == "auto" else 1), fourth]}

        write_campaign(self.folder, {"auto": 1.0, "clp": 2.0}, tiers=(1e-6,), copies=10, change=change, noise=NoiseOf(0.001, passes=4),
                       peers=("clp",), info={"passes": 3})
        edit_lines(self.folder / "streams.jsonl", lambda line: line | (
            {"began_s": line["began_s"] + 40} if line["kind"] == "fresh" and line["solver"] == "clp" else {}))
        for folder in (self.folder, self.folder / "kept"):
            if folder != self.folder:
                compact(self.folder, folder)
            text = dict(fairness.limitations(load_inputs([folder])))["Noise"].replace("\u202f", " ")
            self.assertRegex(text, r"^40 launches have levels from [+-]0 % to \+30 % of the median")
            self.assertIn("5 are flagged, being off by more than 10 %", text)
            self.assertIn("5 of 20 rounds at the main tier are repetitions", text)
            self.assertIn("took 40.0 s in the median and 40.0 s at most", text)


class Parts(FolderCase):
    def test_what_was_never_asked_is_below_the_tier_and_no_false_success(self):
        inputs = inputs_of(write_campaign, {"auto": 1.0, "clp": 2.0, "clp-default": 2.0}, copies=1,
                           change=lambda record: record if record["solver"] == "auto" else fail(record, "solved"),
                           peers=("clp", "clp-default"), solvers={"clp-default": {"tolerance": "default"}})
        text = summary.false_successes(inputs)
        each = len(inputs.problems) * len(inputs.tiers)
        self.assertIn(f"0 in {each} solves of ours, {each} in {each} of other projects' solvers that were asked", text)
        self.assertIn(f"end below it in {each} of {each} solves", text)

    def test_a_problem_in_two_folders_is_told(self):
        (standard, sequences), (motion, _) = write_all(self.folder)
        with self.assertRaisesRegex(ReportError, "is in .* too"):
            load_inputs([standard, standard])
        with self.assertRaisesRegex(ReportError, "motion.csv"):
            load_inputs([standard], [sequences])
        (motion / "motion.csv").write_text((motion / "motion.csv").read_text().replace("0.01,", "soon,", 1))
        with self.assertRaisesRegex(ReportError, "line 3, column 'time' is 'soon'"):
            load_inputs([standard], [motion])
