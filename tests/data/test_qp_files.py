"""Quadratic programs that `lcpbench convert` writes, as numpy and scipy read and solve them."""

import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

try:
    import numpy
    import scipy.optimize
except ImportError:
    numpy = None

_COMMAND = os.environ.get("LCPBENCH_COMMAND")
_ABSENT = ["G", "h", "A", "b", "ub"]


def _run(*words, text=""):
    return subprocess.run([_COMMAND, *words], input=text, capture_output=True, text=True, check=True).stdout


def _qps(text):
    """P, q and lb of a QPS file in free format, section by section."""
    sections, name = {}, ""
    for line in text.splitlines():
        if line.startswith(" "):
            sections[name].append(line.split())
        else:
            name = line.split()[0]
            sections[name] = []
    order = {column: k for k, (column, _, _) in enumerate(sections["COLUMNS"])}
    q = [float(value) for _, _, value in sections["COLUMNS"]]
    lb = [0.0] * len(q)
    for kind, _, column in sections.get("BOUNDS", []):
        assert kind == "FR"
        lb[order[column]] = -float("inf")
    P = numpy.zeros((len(q), len(q)))
    for column, row, value in sections["QUADOBJ"]:
        assert P[order[column], order[row]] == 0
        P[order[column], order[row]] = P[order[row], order[column]] = float(value)
    return P, q, lb


@unittest.skipUnless(_COMMAND, "LCPBENCH_COMMAND is not set")
@unittest.skipUnless(numpy, "numpy or scipy is not installed")
class QpFiles(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def test_both_are_the_problem_bit_for_bit(self):
        for scene in ["disc-pile", "gear-train", "rockers"]:
            with self.subTest(scene):
                line = _run("generate", scene, "--size", "12", "--seed", "3")
                # The entries that a sparse A has; J M^-1 J^T is rounded in C++ alone.
                _run("convert", "-", "-o", str(self.folder / "a.mtx"), text=line)
                for part in ["J", "invM"]:
                    (self.folder / f"a_{part}.mtx").unlink()
                problem = json.loads(_run("convert", str(self.folder / "a.mtx")))
                A = numpy.zeros((problem["n"], problem["n"]))
                A[problem["A"]["row"], problem["A"]["col"]] = problem["A"]["val"]
                lb = numpy.zeros(problem["n"])
                lb[problem["bilateral"]] = -numpy.inf
                _run("convert", "-", "-o", str(self.folder / "p.npz"), text=line)
                _run("convert", "-", "-o", str(self.folder / "p.qps"), text=line)
                with numpy.load(self.folder / "p.npz", allow_pickle=False) as data:
                    self.assertEqual(sorted(data.files), sorted(["P", "q", "lb", *_ABSENT]))
                    read = data["P"], data["q"], data["lb"]
                    for name in _ABSENT:  # by this error qpsolvers' Problem.load knows what is not there
                        with self.assertRaises(ValueError):
                            _ = data[name]
                with numpy.load(self.folder / "p.npz", allow_pickle=True) as data:
                    for name in _ABSENT:
                        self.assertIsNone(data[name].item())
                for P, q, lower in [read, _qps((self.folder / "p.qps").read_text())]:
                    self.assertTrue(numpy.array_equal(P, A))
                    self.assertTrue(numpy.array_equal(q, problem["b"]))
                    self.assertTrue(numpy.array_equal(lower, lb))

    def test_the_optimum_is_the_answer(self):
        line = json.dumps({"id": "three", "A": [[4, 1, -2], [1, 3, 0], [-2, 0, 2]], "b": [-1, 2, 3], "bilateral": [2]})
        _run("convert", "-", "-o", str(self.folder / "p.npz"), text=line)
        with numpy.load(self.folder / "p.npz") as data:
            P, q, lb = data["P"], data["q"], data["lb"]
        found = scipy.optimize.minimize(lambda f: f @ P @ f / 2 + q @ f, numpy.zeros(3), jac=lambda f: P @ f + q, method="L-BFGS-B",
                                        bounds=[(low, None) for low in lb], options={"ftol": 1e-15, "gtol": 1e-12})
        answer = json.loads(_run("solve", "--solver", "dantzig", "-", text=line))
        self.assertTrue(numpy.allclose(found.x, answer["f"], atol=1e-6))

    def test_what_is_no_qp_is_refused(self):
        line = json.dumps({"id": "u", "A": [[1, 2], [3, 1]], "b": [1, 1]})
        for name in ["p.qps", "p.npz"]:
            done = subprocess.run([_COMMAND, "convert", "-", "-o", str(self.folder / name)], input=line, capture_output=True, text=True)
            self.assertEqual(done.returncode, 2)
            self.assertIn("problem 'u': expected a symmetric matrix", done.stderr)
            self.assertFalse((self.folder / name).exists())


if __name__ == "__main__":
    unittest.main()
