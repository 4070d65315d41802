"""Are two campaigns called the same when, and only when, nothing but times differs?"""

from lcpbench_report.statistics import changes
from lcpbench_report.statistics.model import METRICS
from .cases import FolderCase, edit_info, edit_lines
from .synthetic_campaign import TIERS, fail, only, write_campaign

FACTORS = {"a": 1.0, "b": 2.0}
CELLS = 13 * len(FACTORS)  # of one tier
VICTIM = "piles-50-0"


class SameResults(FolderCase):
    def setUp(self):
        super().setUp()
        self.old, self.new = (write_campaign(self.folder / str(run), FACTORS, tiers=TIERS[:1], copies=1, run=run)
                          for run in range(2))

    def test_other_times_rounds_and_machines_are_the_same(self):
        edit_info(self.new, environment={"cpu": "another"}, environment_hash="1")
        edit_lines(self.new / "problems.jsonl", lambda p: p | {"oracle_s": 1.0})
        # In another order, and one timed pass only.
        edit_lines(self.new / "streams.jsonl", lambda line: line | {"environment": "1"} if line["pass"] < 2 else None)
        lines = (self.new / "streams.jsonl").read_text(encoding="utf-8").splitlines()
        (self.new / "streams.jsonl").write_text("\n".join([*lines[::-1], ""]), encoding="utf-8")
        self.expect("same", 0, f"cells: {CELLS}, all the same")

    def test_every_field_of_a_cell_counts(self):
        values = dict.fromkeys(METRICS, 0.25) | dict.fromkeys((
            "at_floor", "false_success", "false_infeasible", "proved_infeasible", "infeasible_within_rounding"), True) | {
            "excluded": "rows > 100", "claim": "iteration_limit", "passes": False, "best_tier": None, "iterations": 8,
            "rho": TIERS[0] / 3 * (1 + 2**-52)}
        self.assertEqual(set(values), set(changes.CELL_FIELDS))
        for name, value in values.items():
            with self.subTest(field=name):
                self._write_new(only("a", VICTIM, lambda c, name=name, value=value: c | {name: value}))
                self.expect("same", 1, "1 differ;", name, f"solve/{VICTIM}/a/0.001")

    def test_missing_cells_are_told_from_either_side(self):
        edit_lines(self.new / "streams.jsonl", lambda line: None if line["solver"] == "b" and line["size_class"] == "7-12"
                         else line)
        self.expect("same", 1, f"cells: {CELLS - 2} in both, 0 differ; 2 in A only, 0 in B only",
                    "A only: solve/piles-10-0/b/0.001")
        self.old, self.new = self.new, self.old
        self.expect("same", 1, "0 in A only, 2 in B only")

    def test_solvers_of_ablations_count_too(self):
        bare = {"b": {"ablation": "no-self-check", "base": "a"}}
        write_campaign(self.old, FACTORS, tiers=TIERS[:1], copies=1, solvers=bare)
        write_campaign(self.new, FACTORS, tiers=TIERS[:1], copies=1, solvers=bare,
                       change=lambda c: fail(c) if c["solver"] == "b" else c)
        self.expect("same", 1, f"{CELLS} in both, {CELLS // 2} differ")

    def test_long_lists_are_cut_and_counted(self):
        self._write_new(lambda c: fail(c, "time_limit"))
        self.expect("same", 1, f"{CELLS} differ ({CELLS} of them with a solve that a time limit ended)",
                    f"... and {CELLS - 3} more", more=("--show", "3",))

    def test_another_plan_or_problem_of_the_same_name_is_not_the_same(self):
        edit_info(self.new, seed=2, filter="n8")
        edit_lines(self.new / "problems.jsonl", lambda p: p | {"fraction_active": 0.25})
        self.expect("same", 1, "seed 1 | 2", "B only: filter", "fraction_active 0.5 | 0.25")

    def test_mistakes_are_told_in_one_line(self):
        (self.new / "campaign.json").unlink()
        for folder in (self.new, self.new / "nowhere"):
            self.assert_refused("compare", "--by", "same", self.old, folder)

    def _write_new(self, change) -> None:
        write_campaign(self.new, FACTORS, tiers=TIERS[:1], copies=1, run=1, change=change)
