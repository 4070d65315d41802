"""Problems with friction: how they are counted, and that they stand in a section of their own alone."""

import numpy as np
import pandas as pd

from lcpbench_report import choice, formats, markdown, shown_tables, summary
from lcpbench_report.compact import compact
from lcpbench_report.inputs import load_inputs
from lcpbench_report.statistics.cells import EXCLUDED, VERIFIED
from lcpbench_report.statistics.coverage import coverage_table
from lcpbench_report.statistics.friction import friction_table, refusers
from lcpbench_report.statistics.model import ERROR_PARTS, TASK_BUDGET
from lcpbench_report.statistics.means import mean_table
from .cases import SharedFolderCase, inputs_of, page_of
from .synthetic_campaign import TIERS, fail, write_campaign

FACTORS = {"pgs": 1.0, "relaxation": 2.0, "dantzig": 3.0}
SET = "friction"
NONE = "piles-10-0"  # a problem without a solution
OF_FRICTION = 24  # piles
PARTS = {"separation": 0.3, "dissipation": 0.1}


def _with_friction(problem: dict) -> dict:
    if problem["family"] != "piles":
        return problem
    return problem | {"set": SET, "counts": False, "friction": problem["rows"] // 2, "bounded": 0,
                      "reference_status": "infeasible" if problem["problem"] == NONE else "solved"}


def _judged(record: dict) -> dict:
    """On piles dantzig is not asked, pgs claims a solution that is none and an infeasibility that is none, and the
    relaxation solves its own model alone but for 10 rows."""
    if "piles" not in record["problem"]:
        return record
    if record["solver"] == "dantzig":
        return fail(record, "unsupported") | {"rho": None}
    record = record | dict.fromkeys(ERROR_PARTS, 0.0)
    if record["problem"] == NONE:
        return fail(record, "iteration_limit") | PARTS
    if record["solver"] == "relaxation":
        relaxed = fail(record, "solved") | {"false_success": False} | PARTS | {"model_rho": 1e-15}
        return record | {"model_rho": 1e-15} if "piles-10-" in record["problem"] else relaxed
    if record["problem"] == "piles-20-0":
        return fail(record, "solved") | {"cone": 2.0}
    return fail(record, "infeasible") | {"false_infeasible": True} if record["problem"] == "piles-20-1" else record


class Friction(SharedFolderCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.folder = write_campaign(cls.path / "c", FACTORS, change=_judged, change_problem=_with_friction)
        cls.inputs = load_inputs([cls.folder])
        cls.table = friction_table(cls.inputs.cells, "pgs").set_index(["solver", "tier"])

    def test_counts(self):
        for tier in TIERS:
            pgs, relaxed, refused = (self.table.loc[(solver, tier)] for solver in FACTORS)
            with self.subTest(tier):
                # The problem without a solution is in no share.
                self.assertEqual((pgs["problems"], pgs["taken"], pgs["solvable"]), (OF_FRICTION, OF_FRICTION, OF_FRICTION - 1))
                self.assertEqual((pgs["right"], pgs["wrong"]), (OF_FRICTION - 3, 2))
                self.assertEqual((pgs["false_successes"], pgs["false_infeasible"]), (1, 1))
                self.assertEqual((relaxed["right"], relaxed["wrong"]), (3, OF_FRICTION - 4))
                self.assertEqual((pgs["lawful_share"], relaxed["lawful_share"]), (pgs["right_share"], 1))
                self.assertEqual((relaxed["false_successes"], relaxed["false_infeasible"]), (0, 0))
                self.assertEqual((refused["taken"], refused["false_successes"], refused["wrong"]), (0, 0, 0))
        self.assertEqual(refusers(self.inputs.cells), ["dantzig"])

    def test_what_was_out_of_time_at_a_looser_tier_is_not_right(self):
        cells = self.inputs.cells.copy()
        excluded = (cells["problem"] == "piles-20-2") & (cells["solver"] == "pgs")
        self.assertTrue((cells.loc[excluded, "verdict"] == VERIFIED).all() and excluded.any())
        cells.loc[excluded, "verdict"], cells.loc[excluded, "time_s"] = EXCLUDED, np.inf
        table = friction_table(cells, "pgs").set_index(["solver", "tier"])
        for tier in TIERS:
            pgs = table.loc[("pgs", tier)]
            self.assertEqual((pgs["solvable"], pgs["right"], pgs["wrong"]), (OF_FRICTION - 1, OF_FRICTION - 4, 3))
            self.assertLess(pgs["right_share"], self.table.loc[("pgs", tier)]["right_share"])

    def test_what_had_no_turn_is_neither_right_nor_wrong(self):
        cells = self.inputs.cells.copy()
        without = (cells["problem"] == "piles-20-2") & (cells["solver"] == "pgs")
        found = friction_table(cells[~without])
        cells.loc[without, "verdict"], cells.loc[without, "time_s"], cells.loc[without, "excluded"] = EXCLUDED, np.inf, TASK_BUDGET
        pd.testing.assert_frame_equal(friction_table(cells), found)

    def test_a_relaxed_answer_has_both_residuals(self):
        relaxed = self.table.loc[("relaxation", min(TIERS))]
        self.assertEqual((relaxed["rho"], relaxed["model_rho"]), (1.0, 1e-15))
        self.assertTrue(np.isnan(self.table.loc[("pgs", min(TIERS)), "model_rho"]))

    def test_parts_are_shares_of_the_sum_of_squares(self):
        shares = self.table[[f"{part}_share" for part in ERROR_PARTS]].dropna()
        np.testing.assert_allclose(shares.sum(axis=1), 1)
        self.assertAlmostEqual(self.table.loc[("relaxation", 1e-6), "separation_share"], 0.9)
        self.assertAlmostEqual(self.table.loc[("pgs", 1e-6), "cone_share"], 1)

    def test_other_tables_are_as_without_these_problems(self):
        cells = self.inputs.cells
        plain = cells[cells["friction"] == 0]
        self.assertLess(len(plain), len(cells))
        pd.testing.assert_frame_equal(coverage_table(cells), coverage_table(plain))
        means = [mean_table(some) for some in (cells, plain)]
        pd.testing.assert_frame_equal(means[0][means[0]["set"] == "counted"], means[1][means[1]["set"] == "counted"])

    def test_the_section_is_there_where_there_are_such_problems(self):
        plain = inputs_of(write_campaign, FACTORS, copies=1)
        for inputs, there in ((self.inputs, True), (plain, False)):
            text, lines = page_of(inputs), markdown.render(inputs, [])
            self.assertEqual(('id="friction"' in text, "## Friction" in lines), (there, there))
            self.assertEqual("Not taken by `dantzig`." in lines, there)
        self.assertEqual([find(plain) for find in (shown_tables.friction_classes, summary.friction)], [None, ""])
        rows = {row[0]: row for row in shown_tables.friction(self.inputs).rows}
        self.assertEqual(list(rows), ["`pgs`", "`relaxation`"])
        self.assertEqual([row[1] for row in rows.values()], ["Coulomb", "relaxed"])
        self.assertTrue(rows["`pgs`"][3].endswith("· ✗ 2"), rows)

    def test_times_are_those_of_the_tables_for_plain_problems(self):
        of = self.inputs.friction
        self.assertEqual(set(of.cells["solver"]), {"pgs", "relaxation"})
        self.assertNotIn(NONE, set(of.cells["problem"]))
        self.assertTrue((of.cells["friction"] > 0).all() and of.cells["counts"].all())
        pgs = choice.table(of, "class_times", 1e-6).set_index(["solver", "size_class"]).loc["pgs"]
        rows = {row[0]: dict(zip(table.columns, row)) for table in [shown_tables.friction_classes(self.inputs)] for row in table.rows}
        self.assertEqual(set(rows), {formats.size_class(key) for key in pgs.index if key != "all"})
        for size, row in rows.items():
            self.assertEqual(row["choose"], "**`pgs`**")
            if size != "13–30":
                self.assertAlmostEqual(float(row["over plain problems"]), 1, delta=0.2)
        self.assertEqual((rows["7–12"]["problems"], rows["7–12"]["right at 1e-6"]), (3, "100\u202f%"))
        self.assertIn(f"right on 91\u202f%, 91\u202f% and 91\u202f% at 1e-3, 1e-6 and 1e-9 of {OF_FRICTION - 1} problems", summary.friction(self.inputs))

    def test_times_of_ours_over_those_of_others_where_these_are_right(self):
        table = self.table.xs(1e-6, level="tier")
        self.assertTrue(np.isnan(table.loc["pgs", "ratio"]))
        self.assertAlmostEqual(table.loc["relaxation", "ratio"], 0.5, delta=0.1)

    def test_the_small_folder_says_the_same(self):
        small = self.path / "small"
        compact(self.folder, small)
        table = friction_table(load_inputs([small]).cells, "pgs").set_index(["solver", "tier"])
        residuals = ["rho", "model_rho"]
        for columns, reach in ((residuals, 0.26), (table.columns.difference(residuals), 0.06)):
            pd.testing.assert_frame_equal(table.sort_index()[columns], self.table.sort_index()[columns], rtol=reach)
