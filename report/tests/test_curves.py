"""The curves of `solver_curves`: what is read, which peers a figure shows, and what the page says."""

import math
import unittest

import pandas as pd

from lcpbench_report import peers, studies
from lcpbench_report.charts import curves, drawing
from lcpbench_report.compact import compact
from lcpbench_report.errors import ReportError
from lcpbench_report.inputs import load_inputs
from .cases import FolderCase, inputs_of, page_of
from .synthetic_report import write_cells


def write_curves(folder, *names):
    folder.mkdir(parents=True, exist_ok=True)
    rows = {
        studies.MASS_RATIO: [{"scene": scene, "rows": 60, "mass_ratio": ratio, "budget_s": 0.01, "solver": solver,
                             "origin": origin, "asked": 1e-9, "rho": rho * ratio, "seconds": 1e-3, "status": "solved"}
                            for scene in ("pile", "wall") for ratio in (1.0, 1e4, 1e8)
                            for solver, origin, rho in (("auto", "own", 1e-16), ("ode-dantzig", "peer", 1e-12),
                                                        ("ode-lemke", "peer", 1e-14), ("scs-dual", "peer", math.inf))],
        studies.REGULARIZATION: [{"scene": "pile", "rows": 60, "solver": solver, "origin": "peer",
                                 "regularization": shift, "rho": shift or 1e-16, "violation": shift or 0,
                                 "seconds": 1e-4, "status": "solved"}
                                for solver, shift in (("ode-dantzig", ""), ("ode-dantzig-cfm", 1e-12), ("ode-dantzig-cfm", 1e-2))],
        studies.SWEEPS: [{"scene": "pile", "rows": 60, "step_s": 0.01, "solver": "bullet-si-1000", "sweeps": sweeps,
                         "rho": 1e-2, "penetration": 1e-3, "joint_error": 0, "seconds_per_step": 1e-4, "steps": 100,
                         "stopped": ""} for sweeps in ("", 1, 10)],
        studies.PRECISION: [{"scene": "pile", "rows": 60, "method": method, "precision": kind, "sweeps": sweeps,
                            "mass_ratio": 1, "rho": 1e-6, "seconds": 1e-4}
                           for method, sweeps in (("gauss-seidel", 1), ("gauss-seidel", 10), ("tableau", ""))
                           for kind in ("single", "double")],
    }
    for name in names or rows:
        pd.DataFrame(rows[name], columns=list(studies.CURVES[name])).to_csv(folder / studies.file_of(name), index=False)
    return folder


class Curves(FolderCase):
    def test_those_that_are_there_are_read(self):
        self.assertEqual(set(studies.read_curves(write_curves(self.folder / "all"))), set(studies.CURVES))
        self.assertEqual(set(studies.read_curves(write_curves(self.folder / "one", studies.SWEEPS))), {studies.SWEEPS})
        with self.assertRaisesRegex(ReportError, "has none of mass-ratio.csv"):
            studies.read_curves(self.folder)

    def test_what_does_not_fit_is_told(self):
        write_curves(self.folder, studies.SWEEPS)
        path = self.folder / studies.file_of(studies.SWEEPS)
        path.write_text(path.read_text().replace("0.001", "deep", 1))
        with self.assertRaisesRegex(ReportError, "sweeps.csv: line 2, column 'penetration' is 'deep'"):
            studies.read_curves(self.folder)

    def test_an_archive_is_read_the_same(self):
        write_curves(self.folder / "made")
        compact(self.folder / "made", self.folder / "kept")
        made, kept = studies.read_curves(self.folder / "made"), studies.read_curves(self.folder / "kept")
        for name, table in made.items():
            self.assertTrue(table.equals(kept[name]), name)

    def test_of_a_library_the_best_is_shown_and_no_answer_counts_as_one(self):
        table = studies.read_curves(write_curves(self.folder))[studies.MASS_RATIO]
        self.assertEqual(curves.best_of_libraries(table[table["origin"] == "peer"]), ["ode-lemke", "scs-dual"])
        self.assertEqual(list(curves.bounded([math.inf, math.nan, 0, 1e-3])), [1, 1, 1e-17, 1e-3])

    def test_every_curve_is_a_figure_and_stands_on_the_page(self):
        inputs = load_inputs([write_cells(self.folder / "campaign")], curves=write_curves(self.folder / "curves"))
        for figure in curves.figures(inputs):
            drawing.write(figure.views[()](), self.folder / f"{figure.name}.svg")
            self.assertIn("</svg>", (self.folder / f"{figure.name}.svg").read_text(encoding="utf-8"))
        text = page_of(inputs)
        for name in studies.CURVES:
            self.assertEqual(text.count(f'id="figure-curve-{name}"'), 1)
        without = load_inputs([self.folder / "campaign"])
        self.assertEqual(list(curves.figures(without)), [])


class Peers(unittest.TestCase):
    def test_the_page_has_every_peer_and_says_who_is_left_out(self):
        text = page_of(inputs_of(write_cells))
        section = text[text.index('<section id="peers">'):]
        section = section[:section.index("</section>")]
        self.assertGreater(len(peers.facts()["peers"]), 50)
        for peer in peers.facts()["peers"]:
            self.assertIn(f"<code>{peer['key']}</code>", section)
        for name in ("PATH", "MOSEK", "Gurobi", "PhysX", "Jolt", "Box2D 3", "Rapier", "--external"):
            self.assertIn(name, section)

    def test_a_tolerance_is_told_by_tier(self):
        rules = {peer["key"]: peers.rule(peer) for peer in peers.facts()["peers"]}
        self.assertEqual(rules["clp"], "1e-3, 1e-6, 1e-9")
        self.assertEqual((rules["clp-default"], rules["ode-dantzig"]), ("its library's own", "has none"))
