"""What motion.csv says, in words."""

from types import SimpleNamespace

from lcpbench_report import shown_tables, studies, summary
from lcpbench_report.errors import ReportError
from .cases import FolderCase
from .synthetic_report import LEVEL, SCENE, SLIPPING, write_friction_motion, write_motion


class Motion(FolderCase):
    def setUp(self):
        super().setUp()
        write_motion(self.folder)

    def test_the_table_takes_the_worst_values_and_the_last_counts(self):
        ((scene, level, table),) = shown_tables.motions(studies.read_motion(self.folder))
        self.assertEqual((scene, level, len(table.rows)), (SCENE, LEVEL, 3))
        rows = {tuple(row[:2]): dict(zip(table.columns, row)) for row in table.rows}
        full, stopped = rows["`auto`", "1e-6"], rows["`pgs`", "1e-3"]
        self.assertEqual((full["energy error"], full["penetration [m]"], full["solves"]), ("9.9e-8", "6.0e-9", 99))
        self.assertEqual((stopped["energy error"], stopped["solves"], stopped["stopped"]), ("4.9e-3", 49, "not finite, too late"))

    def test_drivers_of_scenes_with_friction_are_told_apart(self):
        motion = studies.read_motion(write_friction_motion(self.folder / "slipping"))
        tables = shown_tables.motions(motion, friction=True)
        self.assertEqual([scene for scene, *_ in tables], list(SLIPPING))
        for *_, table in tables:
            rows = [dict(zip(table.columns, row)) for row in table.rows]
            self.assertEqual([row["solver"] for row in rows], ["`auto`", "`pgs@10`", "`pgs@10@cold`"])
            self.assertEqual([row["creep [m]"] for row in rows], ["0", "1.9e-2", "1.9e-1"])
            self.assertEqual([row["lost gap [m]"] for row in rows], ["0", "1.0e-4", "1.0e-3"])

    def test_one_percent_of_error_is_a_share_of_a_bodys_width(self):
        motion = studies.read_motion(write_friction_motion(self.folder / "slipping"))
        # The worst distance is 1.9 % of a width in both scenes, and 0.95 % in one of bodies that are twice as wide.
        for widths, words in (((1, 1), "needs more than 10 in "), ((1, 2), "needs 10 sweeps in "), ((2, 2), "needs 10 sweeps in ")):
            table = motion.assign(width=motion["scene"].map(dict(zip(SLIPPING, widths))))
            sentence = " ".join(summary.friction_motion(SimpleNamespace(friction_motion=table)).split())
            self.assertIn("`auto` (Coulomb) at 1e-6 in 2,", sentence)
            self.assertIn("`pgs` (Coulomb) " + words, sentence)
            self.assertEqual("more than 10 in" in sentence, 1 in widths)

    def test_a_scene_is_in_one_folder(self):
        with self.assertRaisesRegex(ReportError, "scene 'disc-pile' is in another folder too"):
            studies.read_motion(self.folder, self.folder)

    def test_what_does_not_fit_is_told_by_line_and_column(self):
        path = self.folder / studies.MOTION_FILE
        text = path.read_text()
        for wrong, words in (
                (text.replace("pgs,0.001,7,", "pgs,0.001,seven,"),
                 "motion.csv: line 109, column 'step' is 'seven'; expected a whole"),
                (text.replace("penetration", "depth", 1), "column 'penetration' is missing"),
                (text.splitlines()[0] + "\n", "no rows")):
            path.write_text(wrong)
            with self.assertRaisesRegex(ReportError, words):
                studies.read_motion(self.folder)
