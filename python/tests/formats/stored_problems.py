"""The package of formats as its program has it, without the package around it; problems for tests, and their equality."""

import importlib.util
import runpy
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
from scipy.sparse import csr_array

if importlib.util.find_spec("h5py") is None:
    raise unittest.SkipTest("h5py is not installed")

ROOT = Path(__file__).resolve().parents[3]
CORPUS = Path(__file__).resolve().parent / "corpus"

program = runpy.run_path(str(ROOT / "python/lcpbench/formats/__main__.py"))["_package"]("lcpbench_formats")
formats = sys.modules["lcpbench_formats"]
fclib, hdf5, quadratic, siconos = (__import__(f"lcpbench_formats.{name}", fromlist=["*"])
                                   for name in ("fclib", "hdf5", "quadratic", "siconos"))
StoredProblem, FormatError = formats.StoredProblem, formats.FormatError


class FormatTest(unittest.TestCase):
    """Every test has a new `folder`."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def assertRefusal(self, place, words, call, *arguments, **options):
        """The call raises a FormatError of one line that begins with the place and has the words."""
        with self.assertRaises(FormatError) as caught:
            call(*arguments, **options)
        said = str(caught.exception)
        self.assertTrue(said.startswith(place), said)
        self.assertIn(words, said)
        self.assertNotIn("\n", said)


def refusals(name: str) -> list[tuple[str, str]]:
    """The lines of tests/data/refusals: what is wrong, and what the refusal says."""
    lines = (ROOT / "tests/data/refusals" / f"{name}.txt").read_text().splitlines()
    cases = [(" " * line.startswith("=>") + line).partition(" => ") for line in lines if line and not line.startswith("#")]
    return [(wrong, said) for wrong, _, said in cases]


def generated(count: int, seed: int = 1):
    """Problems of every form, with and without bilateral rows: numbers of all sizes, zeros that are stored."""
    random = np.random.default_rng(seed)
    for k in range(count):
        n, bodies = int(random.integers(1, 12)), int(random.integers(1, 6))
        J = random.normal(size=(n, 3 * bodies)) * (random.random((n, 3 * bodies)) < 0.6) * 10.0 ** random.integers(-8, 8)
        J = csr_array(J)
        J.sort_indices()
        inverse_mass = random.random(3 * bodies) * (random.random(3 * bodies) < 0.9)
        bilateral = np.flatnonzero(random.random(n) < 0.3) if k % 2 else np.zeros(0, dtype=np.int64)
        problem = StoredProblem(f"generated {k}", random.normal(size=n), J=J, inverse_mass=inverse_mass, bilateral=bilateral)
        problem.matrix()
        if k % 3 == 1:
            problem = StoredProblem(problem.id, problem.b, A=problem.A, bilateral=bilateral)
        if k % 3 == 2:
            problem = StoredProblem(problem.id, problem.b, A=problem.A.toarray(), bilateral=bilateral)
        yield problem


def difference(a, b) -> str:
    """What differs between two problems' numbers, bit by bit; "" for nothing."""
    def same(x, y) -> bool:
        if x is None or y is None:
            return x is y
        if isinstance(x, np.ndarray):
            return np.asarray(x).shape == np.asarray(y).shape and np.array_equal(x, y) and np.array_equal(np.signbit(x), np.signbit(y))
        return x.shape == y.shape and all(same(np.asarray(p), np.asarray(q)) for p, q in zip((x.indptr, x.indices, x.data),
                                                                                            (y.indptr, y.indices, y.data), strict=True))
    for name in ("b", "bilateral", "J", "inverse_mass"):
        if not same(getattr(a, name), getattr(b, name)):
            return f"another {name}"
    if a.J is None and (isinstance(a.A, np.ndarray) != isinstance(b.A, np.ndarray) or not same(a.A, b.A)):
        return "another A"
    for name in ("friction", "bounded"):
        p, q = getattr(a, name), getattr(b, name)
        if (p is None) != (q is None):
            return f"{name} in one"
        for key in p or ():
            if not same(np.asarray(p[key]), np.asarray(q[key])):
                return f"another {name}.{key}"
    return ""
