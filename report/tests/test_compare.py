"""Two campaigns: is told what differs, and only that?"""

import itertools
import math

import numpy as np

from lcpbench_report.statistics import changes
from lcpbench_report.statistics.load import load_campaign
from .cases import FolderCase, edit_info, edit_lines, run
from .synthetic_campaign import Noise, exclude, fail, only, slower, write_campaign

FACTORS = {"auto": 1.0, "pgs": 3.0, "ode-dantzig": 2.0, "peer-portfolio": 1.5}
PEERS = ("ode-dantzig", "peer-portfolio")
VICTIM = "piles-50-0"  # a problem
CELLS = 25 * len(FACTORS)


class Compare(FolderCase):
    def setUp(self):
        super().setUp()
        self.old, self.new = self.write("old"), self.write("new")

    def write(self, name: str, **arguments):
        return write_campaign(self.folder / name, FACTORS, tiers=(1e-6,), copies=2, peers=PEERS,
                              noise=Noise(problem=0.01, passes=10), **arguments)

    def compared(self) -> changes.Comparison:
        return changes.compare(load_campaign(self.old), load_campaign(self.new))

    def expect(self, status: int, *words: str, more: tuple = ()) -> str:
        """What the command tells of `old` and `new` has these words."""
        found, text, error = run("compare", self.old, self.new, *more)
        self.assertEqual((found, error), (status, ""), text)
        for part in words:
            self.assertIn(part, text)
        return text

    def test_equal_campaigns_differ_in_nothing(self):
        text = self.expect(0, "**They agree**: 0 lost answers, 0 new false successes, 0 published values that moved.",
                           f"Of {CELLS} cells that both have, {CELLS} are the same")
        for title in ("verified before", "verified now", "false successes:", "only one has", "differences of", "**no**"):
            self.assertNotIn(title, text)
        self.assertEqual(run("compare", self.old, self.new, "-o", self.folder / "text.md"), (0, "", ""))
        self.assertEqual((self.folder / "text.md").read_text(encoding="utf-8"), text)

    def test_two_runs_agree_and_what_became_slower_does_not(self):
        self.new = self.write("new", run=1)
        self.expect(0, "0 are beyond both", "`auto / peer-portfolio`", "`auto / fastest`", "`ode-dantzig`", "101–300",
                    more=("--show", "99"))
        self.new = self.write("new", run=1, change=only("auto", "-50-", lambda record: slower(record, 1.5)))
        text = self.expect(1, "0 lost answers", more=("--show", "0"))
        self.assertRegex(text, r"\| 31–100 \| `auto / peer-portfolio` \| .* \+\d\d\.\d % \| \*\*no\*\* \|")

    def test_answers_that_are_lost_found_or_newly_false(self):
        row = f"| `{VICTIM}` | `pgs` | 1e-6 |"
        for status, before, now, *words in (
                (1, None, fail, "**They do not agree**: 1 lost answer,", "1 verified before and not now:",
                 f"{row} verified | failed: iteration limit |", f"{CELLS - 1} are the same"),
                (1, None, lambda record: fail(record, "solved"), "1 new false success", f"{row} verified | false success |"),
                (1, fail, lambda record: fail(record, "solved"), "0 lost answers", "1 new false successes:"),
                (1, None, lambda record: exclude(record, "out of time at 1e-3"), "| out of time: out of time at 1e-3 |"),
                (0, fail, None, "1 verified now and not before:"),
                (0, None, lambda record: exclude(record, "task budget"), "| old | `pgs` | 1 |"),
                (0, fail, lambda record: fail(record, "time_limit"), f"{CELLS - 1} are the same")):
            with self.subTest(words=words):
                self.old, self.new = (self.write(name, change=only("pgs", VICTIM, change or (lambda record: record)))
                                      for name, change in (("old", before), ("new", now)))
                self.expect(status, *words)
        self.old, self.new = self.write("old"), self.write("new", change=only("pgs", "", fail))
        self.expect(1, "25 lost answers", "... and 22 more.", more=("--show", "3"))

    def test_other_plans_are_compared_where_they_meet(self):
        """What only one has is listed, and moves nothing."""
        first, *others = edit_info(self.new)["solvers"]
        edit_info(self.new, seed=2, tiers=[1e-6, 1e-9], environment={"git_commit": "abc"},
                  solvers=[first | {"settings": {"sweep": "forward"}}, *others])
        edit_lines(self.new / "streams.jsonl", lambda line: None if line["solver"] == "pgs" else line)
        for folder, part in ((self.old, "piles-50-"), (self.new, "chains-")):
            edit_lines(folder / "problems.jsonl", lambda about, part=part: about | ({"weight": 0.5} if part in about["problem"] else {}))
        self.expect(0, "| old | `pgs` | 25 |", "| seed | 1 | 2 |", "| tiers | [1e-06] | [1e-06, 1e-09] |",
                    "| environment.git_commit | – | abc |", "| solvers.auto.settings.sweep | – | forward |",
                    f"| {VICTIM}.weight | 0.5 | 1.0 |", more=("--show", "99"))

    def test_the_values_by_hand(self):
        self.new = self.write("new", change=lambda record: slower(record, 1.02))
        table = self.compared().values
        medians, ratios = (table[table["what"].str.contains("/") == of] for of in (False, True))
        np.testing.assert_allclose(medians["moved"], 0.02)
        np.testing.assert_allclose(ratios["moved"], 0, atol=1e-12)
        self.assertLess(0.02, changes.REACH)
        self.assertTrue(table["agrees"].all())
        self.assertEqual(len(medians), len(FACTORS) * 5)

    def test_a_failure_in_one_run_does_not_agree_and_in_both_does(self):
        self.new = self.write("new", change=only("pgs", "-50-", fail))
        table = self.compared().values
        row = table[(table["what"] == "pgs") & (table["size_class"] == "31-100")].iloc[0]
        self.assertEqual((row["new"], row["agrees"]), (math.inf, False))
        self.old = self.new
        self.assertTrue(self.compared().agrees)

    def test_a_median_that_is_infinite_in_one_run_only_does_not_agree(self):
        def some(of_20: int):
            count = itertools.count()
            return lambda record: fail(record) if record["solver"] == "pgs" and 7 * next(count) % 20 < of_20 else record

        self.old, self.new = (self.write(name, change=some(of_20)) for name, of_20 in (("old", 6), ("new", 14)))
        table = self.compared().values
        mixed = table[np.isinf(table["old"]) != np.isinf(table["new"])]
        self.assertGreater(len(mixed), 0)
        self.assertFalse(mixed["agrees"].any())

    def test_campaigns_without_anything_in_common_and_missing_folders_are_refused(self):
        for folder, of_pgs in ((self.old, False), (self.new, True)):
            edit_lines(folder / "streams.jsonl", lambda line, of_pgs=of_pgs: line if (line["solver"] == "pgs") == of_pgs else None)
        self.assert_refused("compare", self.old, self.new, told=("no cell in common",))
        self.assert_refused("compare", self.old, self.folder / "nowhere", told=("nowhere",))
