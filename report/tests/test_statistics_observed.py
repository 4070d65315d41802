"""Tables of what a campaign observes besides: calibration by variants, delivered precision."""

from lcpbench_report.errors import ReportError
from lcpbench_report.statistics.calibration import calibration_table
from lcpbench_report.statistics.cells import cell_table
from lcpbench_report.statistics.load import load_campaign
from lcpbench_report.statistics.means import delivered_table
from .cases import FolderCase
from .synthetic_campaign import write_campaign

VARIANTS = {"again": {}, "slow": {"slowdown": "1.1"}, "other": {"relaxation": "1.3"}}


class Calibration(FolderCase):
    def campaign(self, factors: dict[str, float]):
        return load_campaign(write_campaign(self.folder / "c", factors, tiers=(1e-6,), solvers={
            key: {"base": "plain", "settings": settings} for key, settings in VARIANTS.items()}))

    def test_truth_is_found(self):
        table = calibration_table(self.campaign({"plain": 1.0, "again": 1.0, "slow": 1.1, "other": 2.0}))
        rows = table.set_index("variant")
        self.assertEqual(sorted(rows.index), ["again", "slow"])  # nobody knows how much another setting should take
        self.assertTrue(rows["right"].all())
        self.assertAlmostEqual(rows.loc["slow", "ratio"], 1.1, delta=0.02)
        self.assertLess(rows.loc["slow", "ratio_low"], rows.loc["slow", "ratio_high"])

    def test_a_false_alarm_and_a_miss_are_wrong(self):
        rows = calibration_table(self.campaign({"plain": 1.0, "again": 1.2, "slow": 1.0})).set_index("variant")
        self.assertFalse(rows.loc["again", "right"].any())
        self.assertFalse(rows.loc["slow", "right"].any())

    def test_campaigns_without_variants_are_refused(self):
        with self.assertRaisesRegex(ReportError, "variant"):
            calibration_table(self.campaign({"plain": 1.0, "other": 2.0}))


class Delivered(FolderCase):
    def test_failures_count_with_their_time(self):
        """Of every third cell the answer is wrong: it is paid for, and its residual is among the quantiles."""
        wrong = iter(range(10**9))

        def spoil(record):
            if next(wrong) % 3 == 0:
                record |= {"passes": False, "claim": "iteration_limit", "rho": 0.5}
            return record

        cells = cell_table(load_campaign(write_campaign(self.folder, {"a": 1.0}, tiers=(1e-3, 1e-6), change=spoil)))
        table = delivered_table(cells[cells["counts"]])
        self.assertEqual(len(table), 2)
        for row in table.itertuples():
            of_tier = cells[cells["counts"] & (cells["tier"] == row.tier)]
            self.assertEqual(row.problems, len(of_tier))
            self.assertAlmostEqual(row.verified_share, (of_tier["verdict"] == "verified").mean())
            self.assertLess(row.verified_share, 1)
            self.assertEqual(row.rho_max, 0.5)
            self.assertGreater(row.mean_s, 0)
