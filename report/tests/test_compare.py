"""Two campaigns of one plan: is a regression told when there is one, and only then?"""

import unittest
from pathlib import Path
from unittest import mock

import numpy as np

from lcpbench_report.errors import ReportError
from lcpbench_report.statistics import changes, pairwise
from lcpbench_report.statistics.intervals import holm
from lcpbench_report.statistics.load import load_campaign
from lcpbench_report.statistics.model import Campaign
from .cases import FolderCase, campaign_of, edit_info, edit_lines, run
from .synthetic_campaign import COPIES, FAMILIES, TIERS, Noise, exclude, fail, only, slower, write_campaign

FACTORS = {"a": 1.0, "b": 2.0, "c": 3.0}
# Passes have levels of their own, as on real machines.
NOISE = Noise(problem=0.02, level=0.02, passes=3)
SAME_SEEDS, SLOWER_SEEDS = 10, 6
TIER = TIERS[1]
CLASSES = 5  # of the problems that count
VICTIM = "piles-50-0"  # a problem


def drop(folder: Path, gone) -> None:
    """Whole tasks."""
    edit_lines(folder / "streams.jsonl", lambda line: None if gone(line) else line)


class Truth(unittest.TestCase):
    """Seeded campaigns in which it is known what changed."""

    def test_two_runs_of_one_binary_are_silent(self):
        """Also without the margin, which hides no fault of the tests or of Holm's correction."""
        pairs = self._pairs(SAME_SEEDS, copies=2)
        for margin, most in ((pairwise.MARGIN, 1), (1.0, 0.1 * SAME_SEEDS)):
            with mock.patch.object(pairwise, "MARGIN", margin):
                found = [changes.compare_campaigns(*pair) for pair in pairs]
            self.assertLessEqual(sum(c.regressed or not c.faster.empty for c in found), most)

    def test_what_the_machine_does_meanwhile_is_no_regression(self):
        """A neighbour during two of three launches, seen on a real machine: the medians of all problems move alike."""
        def change(record):
            if record["solver"] != "b":
                return record
            quiet, *busy = record["fresh_s"]
            return record | {"fresh_s": [quiet, *(1.35 * time for time in busy)]}

        found = self._many(SLOWER_SEEDS // 2, change)
        for c in found:
            row = c.speeds[(c.speeds["solver"] == "b") & (c.speeds["family"] == changes.ALL)
                           & (c.speeds["size_class"] == changes.ALL)].iloc[0]
            self.assertGreater(row["ratio"], 1.2)
            self.assertLess(row["ratio_low"], 1)
            self.assertFalse(c.regressed)

    def test_all_comparisons_are_adjusted_together(self):
        families = []
        with mock.patch.object(changes, "holm", side_effect=lambda p: families.append(p) or holm(p)):
            found = self._many(1)[0]
        # All, by class, by family, and the engine's problem, which is one.
        comparisons = len(FACTORS) * (1 + CLASSES + len(FAMILIES) + 1)
        self.assertEqual([len(p) for p in families], [comparisons])
        self.assertEqual([np.count_nonzero(~np.isnan(p)) for p in families], [comparisons - len(FACTORS)])
        self.assertEqual(len(found.speeds), comparisons)

    def test_ten_per_cent_more_time_of_one_solver_are_found(self):
        found = self._many(SLOWER_SEEDS, only("b", "", lambda record: slower(record, 1.1)))
        hits = [c for c in found if ("b", changes.ALL, changes.ALL) in
                zip(c.slower["solver"], c.slower["family"], c.slower["size_class"])]
        self.assertGreaterEqual(len(hits), 0.95 * SLOWER_SEEDS)
        self.assertTrue(all(c.regressed for c in hits))
        self.assertLessEqual(sum(set(c.slower["solver"]) > {"b"} for c in found), 1)
        for c in hits:
            row = c.slower.iloc[0]
            self.assertAlmostEqual(row["ratio"], 1.1, delta=0.04)
            self.assertTrue(row["ratio_low"] < row["ratio"] < row["ratio_high"])
        self.assertEqual(sum(len(c.faster) for c in found), 0)

    def test_what_is_slow_on_one_family_or_size_class_is_found_there(self):
        for column, there, elsewhere, parts in (("family", "chains", "piles", ("chains",)),
                                                ("size_class", "31-100", "301-1000", ("-50-", "-100-"))):
            for c in self._many(SLOWER_SEEDS // 2, lambda record: slower(record, 1.3) if record["solver"] == "c"
                                and any(part in record["problem"] for part in parts) else record):
                self.assertIn(("c", there), set(zip(c.slower["solver"], c.slower[column])))
                self.assertNotIn(elsewhere, set(c.slower[column]))

    def _many(self, seeds: int, change=lambda record: record) -> list[changes.Changes]:
        return [changes.compare_campaigns(*pair) for pair in self._pairs(seeds, change)]

    def _pairs(self, seeds: int, change=lambda record: record, copies: int = COPIES) -> list[tuple[Campaign, Campaign]]:
        return [tuple(campaign_of(write_campaign, FACTORS, seed, (TIER,), NOISE, copies, run=run,
                                  change=change if run else lambda record: record)
                      for run in range(2)) for seed in range(seeds)]


class Summary(FolderCase):
    """Two small campaigns, and one thing that changed."""

    def setUp(self):
        super().setUp()
        self.old = self._write("old")
        self.new = self._write("new", run=1)

    def test_nothing_new(self):
        self.expect("changes", 0, "**No regression** in 147 cells.", "No cell lost its verified answer", "same environment")
        self.assertNotIn("Only in one", run("compare", self.old, self.new)[1])

    def test_a_new_false_success_is_a_regression_however_it_was_before(self):
        for before in (lambda record: record, fail):
            with self.subTest(before=before):
                self.old = self._write("old", change=only("b", VICTIM, before))
                self.new = self._write("new", change=only("b", VICTIM, lambda record: fail(record, "solved")))
                self.expect("changes", 1, "1 new false success", f"`solve/{VICTIM}/b/1e-06`")
        self.old = self._write("old", change=only("b", VICTIM, lambda record: fail(record, "solved")))
        self.expect("changes", 0)  # it lied before

    def test_what_one_change_is_told_as(self):
        for status, change, *words in (
                (1, only("b", VICTIM, fail), "1 cell verified before and not now",
                 "| verified | failed: iteration limit |"),
                (1, only("b", VICTIM, lambda record: exclude(record, "out of time at 1e-3")),
                 "| excluded: out of time at 1e-3 |"),  # by a rule
                (0, only("b", VICTIM, lambda record: exclude(record, "task budget")), "| `b` | OLD | 1 |"),  # no turn
                (1, only("c", "", lambda record: slower(record, 1.5)), "| `c` | all | all |  | 1e-6 | 48 | 1."),
                (1, only("a", "", fail), "49 cells verified before and not now", "... and 29 more.")):
            with self.subTest(words=words):
                self.new = self._write("new", change=change)
                self.expect("changes", status, *words)

    def test_an_answer_that_is_found_is_no_regression(self):
        self.old = self._write("old", change=only("b", VICTIM, fail))
        self.expect("changes", 0, "Verified now, and not before")

    def test_what_only_one_has_is_told_and_judged_by_nothing(self):
        drop(self.new, lambda record: record["solver"] == "c")
        drop(self.old, lambda record: record["size_class"] == "7-12" and record["solver"] == "a")
        self.expect("changes", 0, "| `c` | OLD | 49 |", "| `a` | NEW | 8 |", "in 90 cells")

    def test_other_builds_of_one_plan_are_compared_and_named(self):
        first, *others = edit_info(self.new, environment_hash="1", environment={
            "git_commit": "abc", "libraries": {"Eigen": "3.4.1"}})["solvers"]
        edit_info(self.new, solvers=[first | {"library_version": "2.0"}, *others, first | {"key": "newcomer"}])
        self.expect("changes", 0, "| git_commit |  | abc |")

    def test_how_a_setting_is_called_may_differ(self):
        first, *others = edit_info(self.new)["solvers"]
        # Older folders lack the last two.
        edit_info(self.new, solvers=[first | {"setting": "default", "base": "", "settings": {}}, *others])
        self.expect("changes", 0)

    def test_mixed_plans_are_refused_in_one_line(self):
        info = edit_info(self.new)
        solvers = [info["solvers"][0] | {"base": "b", "settings": {"sweep": "forward"}}, *info["solvers"][1:]]
        for values in ({"tiers": [TIER, 1e-9]}, {"manifests": [{"name": "other"}]}, {"passes": 7},
                       {"limits": info["limits"] | {"most_s": 1.0}}, {"seed": 9}, {"solvers": solvers}):
            with self.subTest(values=values):
                edit_info(self.new, **info | values)
                self._expect_refused("campaign.json", "'a'" if "solvers" in values else f"'{next(iter(values))}'")
        edit_info(self.new, **info)
        edit_lines(self.new / "problems.jsonl", lambda problem: problem | ({"rows": 51} if problem["rows"] == 50 else {}))
        self._expect_refused("problems.jsonl", "'rows'", " 50 ")

    def test_nothing_in_common_and_missing_folders_are_refused(self):
        drop(self.new, lambda record: record["solver"] != "c")
        drop(self.old, lambda record: record["solver"] == "c")
        self._expect_refused("no cell in common")
        self.new = self.folder / "nowhere"
        self._expect_refused("nowhere")

    def test_the_summary_goes_into_a_file(self):
        out = run("compare", self.old, self.new)[1]
        self.assertEqual(run("compare", self.old, self.new, "-o", self.folder / "summary.md"), (0, "", ""))
        self.assertEqual((self.folder / "summary.md").read_text(encoding="utf-8"), out)

    def _write(self, name: str, **arguments) -> Path:
        return write_campaign(self.folder / name, FACTORS, tiers=(TIER,), noise=NOISE, **arguments)

    def _expect_refused(self, *words: str) -> None:
        self.assert_refused("compare", self.old, self.new, told=words)
        with self.assertRaises(ReportError):
            changes.compare_campaigns(load_campaign(self.old), load_campaign(self.new))
