"""Are two campaigns called the same when, and only when, nothing but times differs?"""

import json


from lcpbench_report.statistics import same
from .cases import FolderCase, run
from .synthetic_campaign import METRICS, TIERS, exclude, fail, write_campaign, write_lines

FACTORS = {"a": 1.0, "b": 2.0}
CELLS = 13 * len(FACTORS)  # of one tier
VICTIM = "piles-50-0"


def _is_victim(cell: dict) -> bool:
    return (cell["problem"], cell["solver"]) == (VICTIM, "a")


class SameResults(FolderCase):
    def setUp(self):
        super().setUp()
        self.a, self.b = (write_campaign(self.folder / str(run), FACTORS, tiers=TIERS[:1], copies=1, run=run)
                          for run in range(2))

    def test_other_times_rounds_and_machines_are_the_same(self):
        self._edit_plan(environment={"cpu": "another"}, environment_hash="1")
        self._edit_lines("problems.jsonl", lambda p: p | {"oracle_s": 1.0})
        lines = [json.loads(line) | {"environment": "1"} for line in self._lines("streams.jsonl")]
        kept = [line for line in lines if line["pass"] < 2][::-1]  # in another order, and one timed pass only
        write_lines(self.b / "streams.jsonl", kept)
        status, out, _ = self._run()
        self.assertEqual(status, 0, out)
        self.assertIn(f"cells: {CELLS}, all the same", out)

    def test_every_field_of_a_cell_counts(self):
        changes = {"excluded": exclude, "claim": lambda c: c | {"claim": "iteration_limit"},
                   "passes": lambda c: c | {"passes": False}, "best_tier": lambda c: c | {"best_tier": None},
                   "at_floor": lambda c: c | {"at_floor": True}, "iterations": lambda c: c | {"iterations": 8},
                   "false_success": lambda c: c | {"false_success": True},
                   "false_infeasible": lambda c: c | {"false_infeasible": True},
                   "proved_infeasible": lambda c: c | {"proved_infeasible": True},
                   "rho": lambda c: c | {"rho": c["rho"] * (1 + 2**-52)}}
        changes |= {name: lambda c, name=name: c | {name: 0.25} for name in METRICS if name not in changes}
        self.assertEqual(set(changes), set(same.CELL_FIELDS))
        for name, change in changes.items():
            with self.subTest(field=name):
                self._write_b(lambda c, change=change: change(c) if _is_victim(c) else c)
                status, out, _ = self._run()
                self.assertEqual(status, 1)
                self.assertIn("1 differ;", out)
                self.assertIn(name, out)
                self.assertIn(f"solve/{VICTIM}/a/0.001", out)

    def test_missing_cells_are_told_from_either_side(self):
        self._edit_lines("streams.jsonl", lambda line: None if line["solver"] == "b" and line["size_class"] == "7-12"
                         else line)
        status, out, _ = self._run()
        self.assertEqual(status, 1)
        self.assertIn(f"cells: {CELLS - 2} in both, 0 differ; 2 in A only, 0 in B only", out)
        self.assertIn("A only: solve/piles-10-0/b/0.001", out)
        self.a, self.b = self.b, self.a
        self.assertIn("0 in A only, 2 in B only", self._run()[1])

    def test_solvers_of_ablations_count_too(self):
        bare = {"b": {"ablation": "no-self-check", "base": "a"}}
        write_campaign(self.a, FACTORS, tiers=TIERS[:1], copies=1, solvers=bare)
        write_campaign(self.b, FACTORS, tiers=TIERS[:1], copies=1, solvers=bare,
                       change=lambda c: fail(c) if c["solver"] == "b" else c)
        self.assertIn(f"{CELLS} in both, {CELLS // 2} differ", self._run()[1])

    def test_long_lists_are_cut_and_counted(self):
        self._write_b(lambda c: fail(c, "time_limit"))
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

    def _write_b(self, change) -> None:
        write_campaign(self.b, FACTORS, tiers=TIERS[:1], copies=1, run=1, change=change)

    def _run(self, *more: str) -> tuple[int, str, str]:
        return run("same", self.a, self.b, *more)

    def _lines(self, name: str) -> list[str]:
        return (self.b / name).read_text(encoding="utf-8").splitlines()

    def _edit_lines(self, name: str, edit) -> None:
        records = [edit(json.loads(line)) for line in self._lines(name)]
        (self.b / name).write_text("".join(json.dumps(r) + "\n" for r in records if r is not None), encoding="utf-8")

    def _edit_plan(self, **values) -> None:
        path = self.b / "campaign.json"
        path.write_text(json.dumps(json.loads(path.read_text(encoding="utf-8")) | values), encoding="utf-8")
