"""Campaigns that are kept: small, and read like any other."""

import json
import lzma


from lcpbench_report import motion
from lcpbench_report.archive import archive
from lcpbench_report.errors import ReportError
from lcpbench_report.statistics.cells import cell_table
from lcpbench_report.statistics.load import load_campaign
from .cases import FolderCase, run
from .synthetic_report import write_cells, write_motion, write_steps


class Archive(FolderCase):
    def test_verdicts_are_kept_and_times_to_their_digits(self):
        folder = write_cells(self.folder / "campaign")
        archive(folder, self.folder / "kept")
        key = ["problem", "solver", "tier"]
        before = cell_table(load_campaign(folder)).sort_values(key).reset_index(drop=True)
        after = cell_table(load_campaign(self.folder / "kept")).sort_values(key).reset_index(drop=True)
        for column in (*key, "verdict", "timed", "claim", "excluded", "time_limit_s", "weight"):
            self.assertEqual(list(before[column]), list(after[column]), column)
        solved = before["passes"].astype(bool)
        self.assertLess((after["fresh_s"] / before["fresh_s"] - 1)[solved].abs().max(), 6e-4)
        self.assertLess((after["rho"] / before["rho"] - 1)[solved].abs().max(), 6e-3)
        self.assertGreater((after["fresh_s"] / before["fresh_s"] - 1)[solved].abs().max(), 0)

    def test_it_is_smaller(self):
        folder = write_cells(self.folder / "campaign")
        written = archive(folder, self.folder / "kept")
        self.assertLess(10 * sum(written.values()), sum(path.stat().st_size for path in folder.iterdir()))

    def test_sequences_are_kept(self):
        folder = write_steps(self.folder / "steps")
        archive(folder, self.folder / "kept")
        before, after = load_campaign(folder).passes, load_campaign(self.folder / "kept").passes
        self.assertEqual(sorted(before), sorted(after))
        for key, runs in before.items():
            for index, once in runs.rounds.items():
                self.assertLess(abs(after[key].rounds[index].latency_s / once.latency_s - 1).max(), 6e-3)

    def test_motions_are_kept_as_they_are(self):
        folder = write_motion(self.folder / "motion")
        archive(folder, self.folder / "kept")
        self.assertTrue(motion.read(self.folder / "kept").equals(motion.read(folder)))
        self.assertFalse((self.folder / "kept" / motion.FILE).exists())

    def test_the_same_campaign_gives_the_same_bytes(self):
        folder = write_cells(self.folder / "campaign")
        for name in ("a", "b"):
            archive(folder, self.folder / name)
        for path in (self.folder / "a").iterdir():
            self.assertEqual(path.read_bytes(), (self.folder / "b" / path.name).read_bytes())

    def test_what_does_not_fit_is_told(self):
        folder = write_cells(self.folder / "campaign")
        archive(folder, self.folder / "kept")
        with self.assertRaisesRegex(ReportError, "already"):
            archive(folder, self.folder / "kept")
        with self.assertRaisesRegex(ReportError, "campaign.json"):
            archive(self.folder, self.folder / "other")
        whole = (self.folder / "kept" / "streams.jsonl.xz").read_bytes()
        (self.folder / "kept" / "streams.jsonl.xz").write_bytes(whole[:len(whole) // 2])
        with self.assertRaisesRegex(ReportError, "streams.jsonl.xz"):
            load_campaign(self.folder / "kept")

    def test_the_script_ends_with_status_2_for_a_mistake(self):
        self.assertEqual(run("archive", self.folder, self.folder / "x")[0], 2)

    def test_numbers_stay_numbers(self):
        archive(write_cells(self.folder / "campaign"), self.folder / "kept")
        with lzma.open(self.folder / "kept" / "streams.jsonl.xz", "rt") as lines:
            first = json.loads(next(iter(lines)))
        self.assertIsInstance(first["first_s"][0], float)
        self.assertGreater(first["first_s"][0], 0)
