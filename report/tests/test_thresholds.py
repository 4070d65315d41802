"""Trials of the limits of auto: what is tried, what is asked, and which value may take the default's place."""

import json
import unittest
from pathlib import Path

import numpy as np

from lcpbench_report.errors import ReportError
from lcpbench_report.statistics.jsonl import write_object
from lcpbench_report.tuning import thresholds
from lcpbench_report.tuning.campaign import Command
from .cases import FolderCase
from .synthetic_campaign import cells_of, median_times

DATA = Path(__file__).resolve().parents[2] / "data"


class Trials(FolderCase):
    def test_every_limit_is_tried_in_two_values_to_four(self):
        for trial in thresholds.load_trials(DATA / "limits.json", None):
            self.assertIn(len(set(trial.values)), (2, 3, 4), trial.limit)
            self.assertLessEqual(trial.rows[0], trial.rows[1], trial.limit)

    def test_a_name_without_trials_is_refused(self):
        self.assertEqual([of.limit for of in thresholds.load_trials(DATA / "limits.json", "exact_rows,step_rows")],
                         ["exact_rows", "step_rows"])
        with self.assertRaisesRegex(ReportError, "'rows' has no trial"):
            thresholds.load_trials(DATA / "limits.json", "rows")
        path = Path(self.folder) / "limits.json"
        write_object(path, {"schema": thresholds.SCHEMA, "trials": [{"limit": "exact_rows"}]})
        with self.assertRaisesRegex(ReportError, "values"):
            thresholds.load_trials(path, None)


class Rule(unittest.TestCase):
    def _row(self, factor, **verdicts):
        times = median_times(np.random.default_rng(3), {"auto": 1.0, "auto-try1": factor}, 64)
        cells = cells_of(times)
        for key, verdict in verdicts.items():
            lost = cells["solver"] == key.replace("_", "-")
            cells.loc[lost & (cells["problem"] == times.index[0]), ["verdict", "time_s"]] = verdict, np.inf
        return {"differ": 64, "lost": 0} | thresholds.compare(cells, "auto-try1")

    def test_a_faster_value_that_is_right_as_often_may_replace_the_default(self):
        row = self._row(0.8)
        self.assertEqual((row["timed"], row["right"], row["right_default"]), (64, 64, 64))
        self.assertAlmostEqual(row["ratio"], 0.8, delta=0.08)
        self.assertTrue(thresholds.may_replace(row))
        self.assertTrue(thresholds.may_replace(self._row(0.8, auto="failed: time limit")))

    def test_one_that_is_wrong_once_more_or_not_faster_may_not(self):
        self.assertFalse(thresholds.may_replace(self._row(0.8, auto_try1="failed: time limit")))
        self.assertFalse(thresholds.may_replace(self._row(1.0)))
        self.assertFalse(thresholds.may_replace(self._row(1.2)))
        self.assertFalse(thresholds.may_replace({"value": "1", "differ": 0, "lost": 0}))
        for of_all in ({"lost": 1}, {"timed": thresholds.LEAST - 1}):
            self.assertFalse(thresholds.may_replace(self._row(0.8) | of_all))

    def test_the_table_names_what_is_chosen(self):
        rows = [{"limit": "a", "default": "1", "value": "2", "differ": 0, "lost": 0, "chosen": False},
                {"limit": "b", "default": "1", "value": "2", "differ": 9, "lost": 0, "timed": 27, "right": 27, "right_default": 26,
                 "ratio": 0.5, "ratio_low": 0.4, "ratio_high": 0.6, "chosen": True},
                {"limit": "b", "default": "1", "value": "3", "differ": 9, "lost": 0, "timed": 27, "right": 0, "right_default": 26,
                 "ratio": None, "ratio_low": None, "ratio_high": None, "chosen": False}]
        found = [line.split(" | ") for line in thresholds.table({"trials": rows}).markdown().splitlines()[2:]]
        self.assertEqual([line[-1] for line in found], ["default |", "**this** |", " |"])
        self.assertIn("27 of 27, default 26", found[1])


class Asked(FolderCase):
    def test_problems_whose_answers_are_the_same_are_not_timed(self):
        class Command_(Command):
            def output(self, *arguments, statuses=(0,)):
                if arguments[0] == "run":
                    return "solve/disc-pile-n40-s1/auto/1e-3\nsolve/discs-in-v-n1-s1/auto/1e-3\n"
                steps = 7 if "--set" in arguments and arguments[arguments.index("--set") + 1] == "mode_steps=9" else 6
                return json.dumps({"id": "disc-pile-n40-s1", "iterations": steps, "detail": "rows",
                                   "verdict": {"passes": steps == 6}}) + "\n"

            def run(self, *arguments, output=None):
                asked.append(arguments[3:])
                output.write(b'{"id": "disc-pile-n40-s1"}\n')

        asked = []
        options = type("Options", (), {"data": DATA, "folder": Path(self.folder), "time_limit": 1})
        answers = thresholds.Answers(Command_(Path("lcpbench")), options)
        trial = thresholds.Trial("mode_steps", ["8", "9"], "core", [2, 50])
        self.assertEqual(answers.differing(trial, "1e-06"), [(set(), set()), ({"disc-pile-n40-s1"}, {"disc-pile-n40-s1"})])
        trial.after = "rows|band"
        self.assertEqual(answers.differing(trial, "1e-06"), [(set(), set())] * 2)
        self.assertEqual(asked, [("disc-pile-n40-s1",)])  # once, and not what has too few rows
