"""Are two campaigns called the same when, and only when, nothing but times differs?"""

import contextlib
import io
import json
import sys
import tempfile
import unittest
from pathlib import Path

_REPORT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(_REPORT), str(_REPORT / "tests")]

import same_results  # noqa: E402
from lcpbench_report.statistics import same  # noqa: E402
from synthetic_campaign import TIERS, exclude, fail, write_campaign  # noqa: E402

FACTORS = {"a": 1.0, "b": 2.0}
CELLS = 13 * len(FACTORS)  # of one tier


class SameResults(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.a, self.b = (write_campaign(Path(folder.name) / str(run), FACTORS, tiers=TIERS[:1], copies=1, run=run)
                          for run in range(2))

    def test_other_times_rounds_and_machines_are_the_same(self):
        self._edit_plan(environment={"cpu": "another"}, environment_hash="1")
        self._edit_lines("problems.jsonl", lambda p: p | {"oracle_s": 1.0})
        later = lambda c: c | {"setup_s": [1.0], "convert_s": [1.0], "peak_bytes": 5, "environment": "1"}  # noqa: E731
        self._edit_lines("cells.jsonl", later)
        lines = self._lines("cells.jsonl")
        kept = [line for line in lines if json.loads(line)["round"] == 0][::-1]  # in another order, and one round only
        (self.b / "cells.jsonl").write_text("\n".join(kept) + "\n", encoding="utf-8")
        status, out, _ = self._run()
        self.assertEqual(status, 0, out)
        self.assertIn(f"cells: {CELLS}, all the same", out)

    def test_every_field_of_a_cell_counts(self):
        changes = {"excluded": lambda c: exclude(c), "claim": lambda c: c | {"claim": "iteration_limit"},
                   "passes": lambda c: c | {"passes": False}, "best_tier": lambda c: c | {"best_tier": None},
                   "at_floor": lambda c: c | {"at_floor": True}, "iterations": lambda c: c | {"iterations": 8},
                   "false_success": lambda c: c | {"false_success": True},
                   "false_infeasible": lambda c: c | {"false_infeasible": True},
                   "metrics.rho": lambda c: c | {"metrics": c["metrics"] | {"rho": c["metrics"]["rho"] * (1 + 2**-52)}},
                   "metrics.gap": lambda c: c | {"metrics": c["metrics"] | {"gap": None}}}
        self.assertEqual({name.split(".")[0] for name in changes}, set(same.CELL_FIELDS))
        whole = self._lines("cells.jsonl")
        for name, change in changes.items():
            with self.subTest(field=name):
                record = json.loads(whole[0])
                (self.b / "cells.jsonl").write_text("\n".join([json.dumps(change(record)), *whole[1:]]) + "\n",
                                                    encoding="utf-8")
                status, out, _ = self._run()
                self.assertEqual(status, 1)
                self.assertIn("1 differ;", out)
                self.assertIn(name, out)
                self.assertIn(f"solve/{record['problem']}/a/0.001 (cold)", out)

    def test_missing_cells_are_told_from_either_side(self):
        gone = lambda c: None if c["solver"] == "b" and c["problem"].startswith("piles-10-") else c  # noqa: E731
        self._edit_lines("cells.jsonl", gone)
        status, out, _ = self._run()
        self.assertEqual(status, 1)
        self.assertIn(f"cells: {CELLS - 1} in both, 0 differ; 1 in A only, 0 in B only", out)
        self.assertIn("A only: solve/piles-10-0/b/0.001 (cold)", out)
        self.a, self.b = self.b, self.a
        self.assertIn("0 in A only, 1 in B only", self._run()[1])

    def test_long_lists_are_cut_and_counted(self):
        self._edit_lines("cells.jsonl", lambda c: fail(c, "time_limit"))
        status, out, _ = self._run("--show", "3")
        self.assertEqual(status, 1)
        self.assertIn(f"{CELLS} differ ({CELLS} of them with a solve that a time limit ended)", out)
        self.assertIn(f"... and {CELLS - 3} more", out)

    def test_another_plan_is_not_the_same(self):
        self._edit_plan(seed=2, filter="n8")
        status, out, _ = self._run()
        self.assertEqual(status, 1)
        self.assertIn("seed 1 | 2", out)
        self.assertIn("B only: filter", out)

    def test_another_problem_of_the_same_name_is_not_the_same(self):
        self._edit_lines("problems.jsonl", lambda p: p | {"fraction_active": 0.25})
        status, out, _ = self._run()
        self.assertEqual(status, 1)
        self.assertIn("fraction_active 0.5 | 0.25", out)

    def test_mistakes_are_told_in_one_line(self):
        (self.b / "campaign.json").unlink()
        for folder in (self.b, self.b / "nowhere"):
            self.b = folder
            status, out, error = self._run()
            self.assertEqual((status, out, error.count("\n")), (2, "", 1), error)

    def _run(self, *more: str) -> tuple[int, str, str]:
        out, error = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(error):
            status = same_results.main([str(self.a), str(self.b), *more])
        return status, out.getvalue(), error.getvalue()

    def _lines(self, name: str) -> list[str]:
        return (self.b / name).read_text(encoding="utf-8").splitlines()

    def _edit_lines(self, name: str, edit) -> None:
        records = [edit(json.loads(line)) for line in self._lines(name)]
        (self.b / name).write_text("".join(json.dumps(r) + "\n" for r in records if r is not None), encoding="utf-8")

    def _edit_plan(self, **values) -> None:
        path = self.b / "campaign.json"
        path.write_text(json.dumps(json.loads(path.read_text(encoding="utf-8")) | values), encoding="utf-8")


if __name__ == "__main__":
    unittest.main()
