"""Campaigns that are kept: small, and read like any other."""

import json
import sys
import tempfile
import unittest
from pathlib import Path

_REPORT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(_REPORT), str(_REPORT / "tests")]

import report  # noqa: E402
from lcpbench_report import motion  # noqa: E402
from lcpbench_report.archive import archive  # noqa: E402
from lcpbench_report.errors import ReportError  # noqa: E402
from lcpbench_report.statistics.cells import cell_table  # noqa: E402
from lcpbench_report.statistics.load import load_campaign  # noqa: E402
from synthetic_report import write_cells, write_motion, write_steps  # noqa: E402


class Archive(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.root = Path(self.temporary.name)
        self.addCleanup(self.temporary.cleanup)

    def test_verdicts_are_kept_and_times_to_their_digits(self):
        folder = write_cells(self.root / "campaign")
        archive(folder, self.root / "kept")
        key = ["problem", "solver", "tier"]
        before = cell_table(load_campaign(folder)).sort_values(key).reset_index(drop=True)
        after = cell_table(load_campaign(self.root / "kept")).sort_values(key).reset_index(drop=True)
        for column in (*key, "verdict", "timed", "claim", "excluded", "time_limit_s", "weight"):
            self.assertEqual(list(before[column]), list(after[column]), column)
        solved = before["passes"].astype(bool)
        self.assertLess((after["fresh_s"] / before["fresh_s"] - 1)[solved].abs().max(), 6e-4)
        self.assertLess((after["rho"] / before["rho"] - 1)[solved].abs().max(), 6e-3)
        self.assertGreater((after["fresh_s"] / before["fresh_s"] - 1)[solved].abs().max(), 0)

    def test_it_is_smaller(self):
        folder = write_cells(self.root / "campaign")
        written = archive(folder, self.root / "kept")
        self.assertLess(10 * sum(written.values()), sum(path.stat().st_size for path in folder.iterdir()))

    def test_sequences_are_kept(self):
        folder = write_steps(self.root / "steps")
        archive(folder, self.root / "kept")
        before, after = load_campaign(folder).passes, load_campaign(self.root / "kept").passes
        self.assertEqual(sorted(before), sorted(after))
        for key, runs in before.items():
            for index, once in runs.rounds.items():
                self.assertLess(abs(after[key].rounds[index].latency_s / once.latency_s - 1).max(), 6e-3)

    def test_motions_are_kept_as_they_are(self):
        folder = write_motion(self.root / "motion")
        archive(folder, self.root / "kept")
        self.assertTrue(motion.read(self.root / "kept").equals(motion.read(folder)))
        self.assertFalse((self.root / "kept" / motion.FILE).exists())

    def test_the_same_campaign_gives_the_same_bytes(self):
        folder = write_cells(self.root / "campaign")
        for name in ("a", "b"):
            archive(folder, self.root / name)
        for path in (self.root / "a").iterdir():
            self.assertEqual(path.read_bytes(), (self.root / "b" / path.name).read_bytes())

    def test_what_does_not_fit_is_told(self):
        folder = write_cells(self.root / "campaign")
        archive(folder, self.root / "kept")
        with self.assertRaisesRegex(ReportError, "already"):
            archive(folder, self.root / "kept")
        with self.assertRaisesRegex(ReportError, "campaign.json"):
            archive(self.root, self.root / "other")
        whole = (self.root / "kept" / "streams.jsonl.xz").read_bytes()
        (self.root / "kept" / "streams.jsonl.xz").write_bytes(whole[:len(whole) // 2])
        with self.assertRaisesRegex(ReportError, "streams.jsonl.xz"):
            load_campaign(self.root / "kept")

    def test_the_script_ends_with_status_2_for_a_mistake(self):
        self.assertEqual(report.main(["archive", str(self.root), str(self.root / "x")]), 2)


class ReadBack(unittest.TestCase):
    def test_numbers_stay_numbers(self):
        with tempfile.TemporaryDirectory() as folder:
            kept = Path(folder) / "kept"
            archive(write_cells(Path(folder) / "campaign"), kept)
            import lzma

            with lzma.open(kept / "streams.jsonl.xz", "rt") as lines:
                first = json.loads(next(iter(lines)))
            self.assertIsInstance(first["first_s"][0], float)
            self.assertGreater(first["first_s"][0], 0)


if __name__ == "__main__":
    unittest.main()
