"""Campaigns that are kept: small, and read like any other."""

import json
import lzma

from lcpbench_report import studies
from lcpbench_report.archive import archive
from lcpbench_report.errors import ReportError
from lcpbench_report.statistics.cells import cell_table
from lcpbench_report.statistics.load import load_campaign
from .cases import SharedFolderCase
from .synthetic_report import write_cells, write_motion, write_steps


class Archive(SharedFolderCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.campaign, cls.kept = write_cells(cls.path / "campaign"), cls.path / "kept"
        cls.written = archive(cls.campaign, cls.kept)

    def test_verdicts_are_kept_and_times_to_their_digits(self):
        key = ["problem", "solver", "tier"]
        before, after = (cell_table(load_campaign(folder)).sort_values(key).reset_index(drop=True)
                         for folder in (self.campaign, self.kept))
        for column in (*key, "verdict", "timed", "claim", "excluded", "time_limit_s", "weight"):
            self.assertEqual(list(before[column]), list(after[column]), column)
        solved = before["passes"].astype(bool)
        self.assertLess((after["fresh_s"] / before["fresh_s"] - 1)[solved].abs().max(), 6e-3)
        self.assertLess((after["rho"] / before["rho"] - 1)[solved].abs().max(), 6e-2)
        self.assertGreater((after["fresh_s"] / before["fresh_s"] - 1)[solved].abs().max(), 0)

    def test_it_is_smaller_and_numbers_stay_numbers(self):
        self.assertLess(10 * sum(self.written.values()), sum(path.stat().st_size for path in self.campaign.iterdir()))
        with lzma.open(self.kept / "streams.jsonl.xz", "rt") as lines:
            first = json.loads(next(iter(lines)))
        self.assertIsInstance(first["first_s"][0], float)
        self.assertGreater(first["first_s"][0], 0)

    def test_sequences_are_kept(self):
        folder = write_steps(self.path / "steps")
        archive(folder, self.path / "kept-steps")
        before, after = load_campaign(folder).passes, load_campaign(self.path / "kept-steps").passes
        self.assertEqual(sorted(before), sorted(after))
        for key, runs in before.items():
            for index, once in runs.rounds.items():
                self.assertLess(abs(after[key].rounds[index].latency_s / once.latency_s - 1).max(), 6e-3)

    def test_motions_are_kept_as_they_are(self):
        folder, kept = write_motion(self.path / "motion"), self.path / "kept-motion"
        archive(folder, kept)
        self.assertTrue(studies.read_motion(kept).equals(studies.read_motion(folder)))
        self.assertFalse((kept / studies.MOTION_FILE).exists())

    def test_the_same_campaign_gives_the_same_bytes(self):
        archive(self.campaign, self.path / "again")
        for path in self.kept.iterdir():
            self.assertEqual(path.read_bytes(), (self.path / "again" / path.name).read_bytes())

    def test_what_does_not_fit_is_told(self):
        self.assert_refused("archive", self.campaign, self.kept, told=("already",))
        self.assert_refused("archive", self.path, self.path / "other", told=("campaign.json",))
        torn = self.path / "torn"
        archive(self.campaign, torn)
        whole = (torn / "streams.jsonl.xz").read_bytes()
        (torn / "streams.jsonl.xz").write_bytes(whole[:len(whole) // 2])
        with self.assertRaisesRegex(ReportError, "streams.jsonl.xz"):
            load_campaign(torn)
