"""Campaigns that are kept: small, and read like any other."""

import json
import lzma
import shutil
from pathlib import Path

import numpy as np
import pandas as pd

from lcpbench_report import studies
from lcpbench_report.compact import compact
from lcpbench_report.errors import ReportError
from lcpbench_report.inputs import load_inputs
from lcpbench_report.statistics import records
from lcpbench_report.statistics.cells import CHANGED, cell_table, measured
from lcpbench_report.statistics.load import load_campaign
from .cases import SharedFolderCase, edit_lines, run
from .synthetic_campaign import Noise, write_campaign
from .synthetic_report import MANY, OWN, fail_some, write_motion, write_steps

# What no table but that of cells is made of.
_LEFT_OUT = {"best_tier", "iterations", "backward_error", "f_error", "factor_share", "first_s", "problem_s", "prepare_s",
             "convert_s", "solve_s", "peak_bytes"}
_STEP = 0.011  # of times of single solves, half of it, relative; ratios have two


def _of_engines(problem: dict) -> dict:
    return problem | ({"origin": "recorded"} if problem["family"] == "chains" else {})


class Compact(SharedFolderCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.campaign, cls.kept = cls.path / "campaign", cls.path / "kept"
        write_campaign(cls.campaign, MANY, copies=2, tiers=(1e-6, 1e-9), change=fail_some, change_problem=_of_engines, noise=Noise(level=0.02),
                       peers=set(MANY) - set(OWN))
        first = iter([True])
        edit_lines(cls.campaign / "streams.jsonl", lambda line: line | (
            {"failed": [1]} if line["kind"] == "fresh" and line["solver"] == "auto" and next(first, False) else {}))
        cls.written = compact(cls.campaign, cls.kept)

    def test_tables_are_the_same_to_the_steps_of_times(self):
        before, after = (load_inputs([folder]).analysis for folder in (self.campaign, self.kept))
        self.assertEqual(list(before), list(after))
        for name, table in before.items():
            with self.subTest(name):
                keys = [key for key in ("solver", "tier", "problem", "size_class", "launch", "a", "b") if key in table]
                one, two = (of.sort_values(keys, kind="stable", ignore_index=True) for of in (table, after[name]))
                self.assertEqual(len(one), len(two))
                for column in one.columns.difference(_LEFT_OUT if name == "cells" else set()):
                    self._assert_alike(column, one[column], two[column])

    def _assert_alike(self, column: str, one: pd.Series, two: pd.Series) -> None:
        if one.dtype.kind in "biO" or column in ("weight", "tier"):
            self.assertEqual(one.tolist(), two.tolist(), column)
            return
        residual = column.startswith(("rho", "w_error"))  # a tenth of a decade more at most
        rough = column.endswith(("_low", "_high"))  # ends of intervals are times of single problems
        # p-values depend on ranks, and exponents on logarithms.
        reach = {"atol": 0.15} if "wilcoxon" in column else {"rtol": 0.27 if residual else 6e-2 if rough else 3 * _STEP, "atol": 5e-3}
        if column.endswith("_s"):
            reach["atol"] = 0
        np.testing.assert_allclose(two, one, **{"rtol": 0} | reach, err_msg=column)

    def test_an_answer_that_changed_in_a_launch_is_told(self):
        for folder in (self.campaign, self.kept):
            cells = cell_table(load_campaign(folder))
            self.assertEqual(cells.loc[cells["verdict"] == CHANGED, "solver"].unique().tolist(), ["auto"])

    def test_the_report_and_the_headline_can_be_made_of_it(self):
        found = [run("headline", folder)[1] for folder in (self.campaign, self.kept)]
        self.assertEqual(*(text.count("|") for text in found))
        self.assertEqual(run("compare", self.campaign, self.kept)[0], 0)
        self.assertEqual(run("analyse", self.kept)[0], 0)

    def test_a_compact_folder_is_made_of_itself_again(self):
        compact(self.kept, self.path / "twice")
        key = ["problem", "solver", "tier"]
        one, two = (cell_table(load_campaign(folder)).sort_values(key, ignore_index=True) for folder in (self.kept, self.path / "twice"))
        pd.testing.assert_frame_equal(one, two)

    def test_it_is_smaller(self):
        self.assertLess(10 * sum(self.written.values()), sum(path.stat().st_size for path in self.campaign.iterdir()))

    def test_times_and_residuals_are_rounded_to_their_steps(self):
        times = pd.Series([1e-9, 3.33e-7, 12.5, np.inf, np.nan])
        steps = np.array(records.times_to_steps(times), dtype=float)
        self.assertTrue(all(type(step) is int for step in records.times_to_steps(times)[:4]))
        np.testing.assert_allclose(records._times(steps), times, rtol=0.0026)
        values = pd.Series([1.0, 9.96e-13, 0.0, 3.349e-7, 123.0, 1e-6, 1.0000001e-6, 1e-300, np.nan, np.inf])
        codes = np.array(records.residuals_to_codes(values), dtype=float)
        np.testing.assert_array_equal(records._residuals(codes),
                                      [1.0, 1e-12, 0.0, 4e-7, 125.0, 1e-6, 1.25e-6, 1e-40, np.nan, np.nan])
        np.testing.assert_array_equal(records.residuals_to_codes(pd.Series(records._residuals(codes))).astype(float), codes)

    def test_times_of_launches_are_kept_to_half_a_step_and_refused_where_they_do_not_fit(self):
        one, two = (measured(load_campaign(folder)).times for folder in (self.campaign, self.kept))
        self.assertEqual({key for key, of in one.items() if len(of.columns)}, set(two))  # all took part in rounds
        for key, times in two.items():
            verified = times.notna().any(axis=1)
            np.testing.assert_allclose(times[verified], one[key].loc[times.index][verified], rtol=_STEP)
        self.assertTrue(any(times.notna().any(axis=None) for times in two.values()))
        lines = lzma.decompress((self.kept / "records.jsonl.xz").read_bytes()).decode("utf-8").splitlines(keepends=True)
        folder = self.path / "misfit"
        shutil.copytree(self.kept, folder)
        (folder / "records.jsonl.xz").unlink()
        last = json.loads(lines[-1])
        for wrong, words in ((json.dumps(last | {"fresh": last["fresh"][1:]}) + "\n", "characters"), (lines[-1] * 2, "one such line")):
            (folder / "records.jsonl").write_text("".join(lines[:-1]) + wrong, encoding="utf-8")
            with self.assertRaisesRegex(ReportError, words):
                load_campaign(folder)

    def test_sequences_are_kept(self):
        folder = write_steps(self.path / "steps")
        compact(folder, self.path / "kept-steps")
        before, after = load_campaign(folder).passes, load_campaign(self.path / "kept-steps").passes
        self.assertEqual(sorted(before), sorted(after))
        for key, runs in before.items():
            for index, once in runs.rounds.items():
                self.assertLess(abs(after[key].rounds[index].latency_s / once.latency_s - 1).max(), 1.5e-2)

    def test_motions_are_kept_in_few_digits(self):
        folder, kept = write_motion(self.path / "motion"), self.path / "kept-motion"
        (folder / "motion.json").write_text('{"steps": 7}')
        compact(folder, kept)
        pd.testing.assert_frame_equal(studies.read_motion(kept), studies.read_motion(folder), rtol=5e-3)
        self.assertEqual((kept / "motion.json").read_text(), '{"steps": 7}')
        self.assertFalse((kept / studies.MOTION_FILE).exists())

    def test_the_same_campaign_gives_the_same_bytes(self):
        compact(self.campaign, self.path / "again")
        for path in filter(Path.is_file, self.kept.iterdir()):
            self.assertEqual(path.read_bytes(), (self.path / "again" / path.name).read_bytes())

    def test_what_does_not_fit_is_told(self):
        self.assert_refused("compact", self.campaign, "-o", self.kept, told=("already",))
        self.assert_refused("compact", self.path, "-o", self.path / "other", told=("campaign.json",))
        torn = self.path / "torn"
        compact(self.campaign, torn)
        whole = (torn / "records.jsonl.xz").read_bytes()
        (torn / "records.jsonl.xz").write_bytes(whole[:len(whole) // 2])
        with self.assertRaisesRegex(ReportError, "records.jsonl.xz"):
            load_campaign(torn)
