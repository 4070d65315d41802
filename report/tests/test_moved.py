"""Two runs of the same: what moved, and whether the intervals said so."""

import itertools
import math

import numpy as np

from lcpbench_report.statistics.load import load_campaign
from lcpbench_report.statistics.changes import REACH, moved_table
from .cases import FolderCase, edit_lines, run
from .synthetic_campaign import Noise, fail, only, slower, write_campaign

FACTORS = {"auto": 1.0, "pgs": 3.0, "ode-dantzig": 2.0, "peer-portfolio": 1.5}
PEERS = ("ode-dantzig", "peer-portfolio")


class Moved(FolderCase):
    def write(self, name: str, **arguments):
        return write_campaign(self.folder / name, FACTORS, tiers=(1e-6,), copies=2, peers=PEERS,
                              noise=Noise(problem=0.01, passes=10), **arguments)

    def test_two_runs_agree_and_what_became_slower_does_not(self):
        self.old, self.new = self.write("old"), self.write("new", run=1)
        self.expect("moved", 0, "0 are beyond both", "`auto / peer-portfolio`", "`auto / fastest`", "`ode-dantzig`", "101–300")
        slow = self.write("slow", run=1, change=only("auto", "-50-", lambda record: slower(record, 1.5)))
        status, text, _ = run("compare", "--by", "moved", self.old, slow)
        self.assertEqual(status, 1)
        self.assertRegex(text, r"\| 31–100 \| `auto / peer-portfolio` \| .* \+\d\d\.\d % \| \*\*no\*\* \|")

    def test_the_table_by_hand(self):
        old, new = self.write("old"), self.write("new", change=lambda record: slower(record, 1.02))
        table, alone = moved_table(load_campaign(old), load_campaign(new))
        medians, ratios = (table[table["what"].str.contains("/") == of] for of in (False, True))
        np.testing.assert_allclose(medians["moved"], 0.02)
        np.testing.assert_allclose(ratios["moved"], 0, atol=1e-12)
        self.assertLess(0.02, REACH)
        self.assertTrue(table["agrees"].all())
        self.assertEqual((len(medians), alone), (len(FACTORS) * 5, []))

    def test_a_failure_in_one_run_does_not_agree_and_in_both_does(self):
        old, new = self.write("old"), self.write("new", change=only("pgs", "-50-", fail))
        edit_lines(new / "streams.jsonl", lambda line: None if line["solver"] == "ode-dantzig" else line)
        table, alone = moved_table(load_campaign(old), load_campaign(new))
        row = table[(table["what"] == "pgs") & (table["size_class"] == "31-100")].iloc[0]
        self.assertEqual((row["new"], row["agrees"]), (math.inf, False))
        self.assertEqual(len(alone), 5)
        table, _ = moved_table(load_campaign(new), load_campaign(new))
        self.assertTrue(table["agrees"].all())

    def test_a_median_that_is_infinite_in_one_run_only_does_not_agree(self):
        def some(of_20: int):
            count = itertools.count()
            return lambda record: fail(record) if record["solver"] == "pgs" and 7 * next(count) % 20 < of_20 else record

        table, _ = moved_table(*(load_campaign(self.write(name, change=some(of_20))) for name, of_20 in (("old", 6), ("new", 14))))
        mixed = table[np.isinf(table["old"]) != np.isinf(table["new"])]
        self.assertGreater(len(mixed), 0)
        self.assertFalse(mixed["agrees"].any())

    def test_runs_without_anything_in_common_are_refused(self):
        old, new = self.write("old"), self.write("new")
        for folder, of_pgs in ((old, False), (new, True)):
            edit_lines(folder / "streams.jsonl", lambda line, of_pgs=of_pgs: line if (line["solver"] == "pgs") == of_pgs else None)
        self.assert_refused("compare", "--by", "moved", old, new, told=("in common",))
