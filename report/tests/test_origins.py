"""What the tables say of problems of several origins."""

import math
import re
import unittest

import numpy as np
import pandas as pd

from lcpbench_report.shown_tables import origins, sealed, sealed_apart
from lcpbench_report.statistics.origins import origin_table
from .cases import inputs_of
from .synthetic_campaign import cells_of, fail, write_campaign

FACTORS = {"first": 1.0, "second": 2.0, "third": 4.0, "fourth": 8.0}


def _cells(of_placed: dict[str, float], of_recorded: dict[str, float], problems: int = 40) -> pd.DataFrame:
    """Times are exact multiples of the first's."""
    rng = np.random.default_rng(7)
    parts = []
    for origin, factors in (("placed", of_placed), ("recorded", of_recorded)):
        times = pd.DataFrame(np.exp(rng.normal(0, 1, (problems, 1))) * np.array(list(factors.values())),
                             index=[f"{origin}-{k}" for k in range(problems)], columns=list(factors))
        parts.append(cells_of(times, origin=origin, family=f"{origin} scenes"))
    return pd.concat(parts, ignore_index=True)


class Shares(unittest.TestCase):
    def test_ratios_and_shares_are_by_origin(self):
        cells = _cells(FACTORS, FACTORS | {"third": math.inf})
        by = origin_table(cells).set_index(["origin", "solver"])
        self.assertAlmostEqual(by.loc[("placed", "fourth"), "ratio"], 8)
        self.assertEqual(by.loc[("placed", "third"), "verified_share"], 1)
        self.assertEqual(by.loc[("recorded", "third"), "verified_share"], 0)
        self.assertEqual(by.loc[("recorded", "third"), "ratio"], math.inf)

    def test_weights_count(self):
        cells = _cells(FACTORS, FACTORS)
        light = cells["problem"].str.endswith(("-0", "-1", "-2"))
        cells.loc[(cells["solver"] == "first") & light, ["time_s", "verdict"]] = [math.inf, "failed:time_limit"]
        cells.loc[light, "weight"] = 0.0
        by = origin_table(cells).set_index(["origin", "solver"])
        self.assertEqual(by.loc[("placed", "first"), "verified_share"], 1)


_ENGINES = ("-0", "-1")  # of four copies


def of_engines(solver: str, change):
    """`change` for the cells of a solver on problems of engines."""
    return lambda record: (change(record) if record["solver"] == solver and record["problem"].endswith(_ENGINES)
                           else record)


class Said(unittest.TestCase):
    def _inputs(self, change=lambda record: record, what: dict = {"origin": "recorded"}, **more):  # noqa: B006
        """@param what  what is known of problems of engines"""
        return inputs_of(write_campaign, FACTORS, tiers=(1e-6,), change=change, change_problem=lambda of: of | (
            what if of["problem"].endswith(_ENGINES) else {}), **more)

    def test_sealed_problems_stand_beside_the_open_ones(self):
        inputs = self._inputs(of_engines("second", fail), {"family": "engine a"}, peers=("second", "third"), info={"sealed": ["engine"]})
        text = sealed(inputs).markdown()
        self.assertIn("sealed: problems", text)
        row = [cell.strip() for cell in text.splitlines()[2].strip("|").split("|")]
        self.assertEqual([row[1], row[2], row[4], row[5]], ["4", "100\u202f%"] * 2)
        for cell, ratio in ((row[3], 0.5), (row[6], 0.25)):
            value, low, high = map(float, re.findall(r"[0-9.]+", cell))
            self.assertAlmostEqual(value, ratio, delta=ratio / 10)
            self.assertTrue(low <= value <= high)
        self.assertIn("in 5 of 5 size classes: 7–12, 13–30", sealed_apart(inputs))
        alike = self._inputs(what={"family": "engine a"}, peers=("second", "third"), info={"sealed": ["engine"]})
        self.assertIn("does not overlap that of open problems in none of 5 size classes.", sealed_apart(alike))
        self.assertIsNone(sealed(self._inputs()))
        self.assertEqual(sealed_apart(self._inputs()), "")

    def test_the_table_has_a_column_for_every_origin(self):
        text = origins(self._inputs(of_engines("second", fail))).markdown()
        self.assertIn("own scenes (24)", text)
        self.assertIn("engines (24)", text)
        self.assertRegex(text.replace("\u202f", " "), r"\| `second` \| 100 % · (1\.9|2\.0)\d× \| 0 % · ✗ \|")

    def test_one_origin_has_no_such_table(self):
        inputs = inputs_of(write_campaign, FACTORS, tiers=(1e-6,))
        self.assertIsNone(origins(inputs))
