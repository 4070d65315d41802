"""QPS and npz files: round trips bit for bit, what is refused, and that nothing of an npz file is unpickled."""

import io
import pickle
import zipfile

import numpy as np
import scipy.sparse
from stored_problems import FormatError, FormatTest, StoredProblem, difference, formats, generated, quadratic, refusals


def _npz(**arrays):
    stream = io.BytesIO()
    np.savez(stream, **{name: np.array(values, dtype=object if values is None else None) for name, values in arrays.items()})
    return stream.getvalue()


def _qps(*lines):
    return "\n".join(["NAME x", "ROWS", " N obj", "COLUMNS", " f1 obj -1", " f2 obj 2", "RHS", *lines, "ENDATA"]) + "\n"


class QuadraticPrograms(FormatTest):
    def load(self, name, content, **options):
        path = self.folder / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return formats.load(path, **options)[0]

    def assertRefused(self, name, content, words):
        self.assertRefusal(f"{self.folder / name}:", words, self.load, name, content)

    def test_problems_come_back_bit_for_bit(self):
        random = np.random.default_rng(5)
        for problem in generated(40):
            unilateral = np.setdiff1d(np.arange(len(problem.b)), problem.bilateral)[::2]
            if unilateral.size:
                lower = np.where(random.random(unilateral.size) < 0.3, -np.inf, -random.random(unilateral.size))
                upper = np.where((random.random(unilateral.size) < 0.3) & np.isfinite(lower), np.inf, random.random(unilateral.size))
                problem.bounded = {"row": unilateral, "lower": lower, "upper": upper}
            A = problem.entries()
            for name in ("p.npz", "p.qps", "p.MPS", "p.qps.gz"):
                with self.subTest(problem.id, name=name):
                    formats.save(problem, self.folder / name)
                    back = formats.load(self.folder / name)[0]
                    self.assertTrue(np.array_equal(back.entries().toarray(), A.toarray()))
                    same = StoredProblem(problem.id, problem.b, A=back.A, bilateral=problem.bilateral, bounded=problem.bounded)
                    self.assertEqual(difference(back, same), "")

    def test_the_text_has_the_lower_triangle_and_free_joints(self):
        A = np.array([[0.1, -1, 0], [-1, 3, 2], [0, 2, 4]])
        self.assertEqual(quadratic.write_qps(StoredProblem("a b\n", np.array([-1, 0, 0.1]), A=A, bilateral=np.array([1]))).decode(),
                         "NAME a_b_\nROWS\n N obj\nCOLUMNS\n f1 obj -1\n f2 obj 0\n f3 obj 0.10000000000000001\nRHS\nBOUNDS\n"
                         " FR bounds f2\nQUADOBJ\n f1 f1 0.10000000000000001\n f1 f2 -1\n f2 f2 3\n f2 f3 2\n f3 f3 4\nENDATA\n")
        bounded = {"row": np.array([0, 1, 3]), "lower": np.array([-1, -np.inf, 1]), "upper": np.array([0.5, -2, np.inf])}
        text = quadratic.write_qps(StoredProblem("p", np.zeros(4), A=np.eye(4), bounded=bounded)).decode()
        self.assertIn("BOUNDS\n LO bounds f1 -1\n UP bounds f1 0.5\n MI bounds f2\n UP bounds f2 -2\n LO bounds f4 1\nQUADOBJ\n", text)

    def test_what_is_no_qp_is_not_written(self):
        unsymmetric = StoredProblem("u", np.ones(2), A=np.array([[1.0, 2], [3, 1]]))
        friction = StoredProblem("f", np.ones(2), A=np.eye(2), friction={"row": np.array([1]), "normal": np.array([0]), "mu": np.array([0.5])})
        bounded = {"row": np.array([1]), "lower": np.array([-1e20]), "upper": np.array([1.0])}
        far = StoredProblem("b", np.ones(2), A=np.eye(2), bounded=bounded)
        for write in (quadratic.write_qps, quadratic.write_npz):
            with self.assertRaisesRegex(FormatError, r"problem 'b': expected bounds below 1e\+20, from which on .*, found -1e\+20"):
                write(far)
            with self.assertRaisesRegex(FormatError, "problem 'u': expected a symmetric matrix, as that of a QP is, found an asymmetry of 1; --sym"):
                write(unsymmetric)
            with self.assertRaisesRegex(FormatError, "problem 'f' has friction rows, which the format has no place for; expected JSON lines"):
                write(friction)

    def test_reads_what_others_write(self):
        problem = self.load("p.qps", _qps(" RHS obj -3", "* a remark", "BOUNDS", " UP B f1 4", " FX B f2 1", "QUADOBJ", " f1 f1 2 f2 -1", " f2 f2 3"))
        self.assertEqual(problem.entries().toarray().tolist(), [[2, -1], [-1, 3]])
        self.assertEqual((problem.b.tolist(), problem.bounded["lower"].tolist(), problem.bounded["upper"].tolist()), ([-1, 2], [0, 1], [4, 1]))
        whole = self.load("p.mps", _qps("BOUNDS", " FR f2", "QMATRIX", " f1 f1 2", " f1 f2 -1", " f2 f1 -1", " f2 f2 3"))
        self.assertEqual((whole.entries().toarray().tolist(), whole.bilateral.tolist()), ([[2, -1], [-1, 3]], [1]))
        P = np.array([[2.0, -1], [-1, 3]])
        none = dict.fromkeys("GhAb")
        for order in "CF":
            for kind in ("<f8", ">f8"):
                problem = self.load("p.npz", _npz(P=np.array(P, dtype=kind, order=order), q=[1.0, 2], lb=[0.0, -np.inf], ub=None, **none))
                self.assertEqual((problem.A.tolist(), problem.bilateral.tolist(), problem.bounded), (P.tolist(), [1], None))
        # No bounds at all, as for qpsolvers: all free.
        self.assertEqual(self.load("p.npz", _npz(P=P, q=[1.0, 2])).bilateral.tolist(), [0, 1])

    def assertBounds(self, lines, lower, upper):
        with self.subTest(lines):
            problem = self.load("p.qps", _qps("BOUNDS", *lines, "QUADOBJ", " f1 f1 1"))
            self.assertEqual(tuple(bounds.tolist() for bounds in quadratic._bounds(problem)), (lower, upper))

    def test_the_first_set_of_bounds_counts(self):
        inf = np.inf
        self.assertBounds([" UP B1 f2 0.5", " UP B2 f2 0.25", " FR B2 f1", " MI B2 f9"], [0, 0], [inf, 0.5])
        self.assertBounds([" FX B2 f1 3", " LO B1 f1 4", " UP B2 f2 1"], [3, 0], [3, 1])
        self.assertBounds([" UP f2 0.5", " LO f1 -1"], [-1, 0], [inf, 0.5])  # sets without names

    def test_numbers_behind_bounds_without_a_value_mean_nothing(self):
        inf = np.inf
        self.assertBounds([" FR B f1 0", " MI B f2 1e30"], [-inf, -inf], [inf, inf])
        self.assertBounds([" UP B f1 3", " PL B f1 7", " UP B f2 3", " PL B f2"], [0, 0], [inf, inf])
        self.assertBounds([" FR f1 0", " MI f2"], [-inf, -inf], [inf, inf])
        for kind, upper in (("FR f1 %s", inf), ("UP f1 %s 4", 4)):  # a set that is named as a column
            self.assertBounds([" " + kind % "f2"], [0, -inf if upper == inf else 0], [inf, upper])
            self.assertBounds([" " + kind % "f3"], [0, 0, -inf if upper == inf else 0], [inf, inf, upper])

    def test_bounds_of_1e20_and_beyond_are_infinite(self):
        inf, below = np.inf, float(np.nextafter(1e20, 0))
        for size in ("1e20", "1e30", "1E+300"):
            self.assertBounds([f" LO B f1 -{size}", f" UP B f2 {size}"], [-inf, 0], [inf, inf])
            self.assertBounds([f" LO B f1 -{size}", " UP B f1 -1", " LO B f2 -2", f" UP B f2 {size}"], [-inf, -2], [-1, inf])
            for bound in (f"LO B f1 {size}", f"FX B f1 {size}", f"FX B f1 -{size}"):
                self.assertRefused("p.qps", _qps("BOUNDS", " " + bound), "bounds with a number between them")
        self.assertBounds([f" LO B f1 {-below!r}", f" UP B f2 {below!r}"], [-below, 0], [inf, below])
        for kind in (float, np.float32):
            lower, upper = (np.array(bounds, dtype=kind) for bounds in ([-1e20, 0, -1e30, -1], [1e30, 1e20, 2, 1e30]))
            problem = self.load("p.npz", _npz(P=np.eye(4), q=np.ones(4), lb=lower, ub=upper))
            self.assertEqual([bounds.tolist() for bounds in quadratic._bounds(problem)], [[-inf, 0, -inf, -1], [inf, inf, 2, inf]])
            self.assertEqual((problem.bilateral.tolist(), problem.bounded["row"].tolist()), ([0], [2, 3]))
            self.assertRefused("p.npz", _npz(P=np.eye(4), q=np.ones(4), ub=-upper), "bounds with a number between them")

    def test_columns_may_stand_in_bounds_alone(self):
        self.assertBounds([" LO B f3 1", " UP B f4 2", " UP B f3 5"], [0, 0, 1, 0], [np.inf, np.inf, 5, 2])
        problem = self.load("p.qps", _qps("BOUNDS", " LO B x 1", "QUADOBJ", " f1 f1 2 x -1", " x x 2"))
        self.assertEqual((problem.b.tolist(), problem.entries().toarray().tolist()), ([-1, 2, 0], [[2, 0, -1], [0, 0, 0], [-1, 0, 2]]))

    def test_pairs_stand_in_either_triangle(self):
        for lines in ([" f1 f1 2 f2 -1", " f2 f2 3 x 4", " x f1 5"], [" x f2 4", " f1 x 5 f2 -1", " f2 f2 3", " f1 f1 2"]):
            problem = self.load("p.qps", _qps("BOUNDS", " FR B x", "QUADOBJ", *lines))
            self.assertEqual(problem.entries().toarray().tolist(), [[2, -1, 5], [-1, 3, 4], [5, 4, 0]])

    def test_asymmetric_matrices_are_read_where_that_is_asked_for(self):
        P = np.array([[4, 1 + 2.0**-10], [1, 9]])
        text = _qps("QMATRIX", *(f" f{i + 1} f{j + 1} {P[i, j]:.17g}" for i in range(2) for j in range(2)))
        for name, content, place in (("p.qps", text, ":13: "), ("p.npz", _npz(P=P, q=np.ones(2)), ": P: ")):
            for most in (0.0, 2.0**-10 / 6 * (1 - 1e-12)):
                self.assertRefusal(f"{self.folder / name}{place}", "expected a symmetric matrix, as that of a QP is, found an asymmetry of 0.0001627",
                                   self.load, name, content, most_asymmetry=most)
            for most in (2.0**-10 / 6, 1):
                self.assertEqual(self.load(name, content, most_asymmetry=most).entries().toarray().tolist(), P.tolist())

    def test_further_free_rows_mean_nothing(self):
        text = ("ROWS\n N obj\n N other\n N third\nCOLUMNS\n f1 obj -1 other 5\n f2 third 7\n f2 other 3 obj 2\n f3 other 1\n"
                "RHS\n RHS obj 1 other 4\nENDATA\n")
        self.assertEqual(self.load("p.qps", text).b.tolist(), [-1, 2, 0])

    def test_the_sense_is_that_of_a_least_value(self):
        for sense in ("OBJSENSE\n    MIN", "OBJSENSE MIN", "OBJSENSE\n Minimize", "OBJSENSE"):
            self.assertEqual(self.load("p.qps", sense + "\n" + _qps("QUADOBJ", " f1 f1 1")).b.tolist(), [-1, 2])

    def test_what_is_wrong_with_a_qps_file_is_told_with_its_line(self):
        for lines, words in refusals("qps"):
            with self.subTest(lines):
                self.assertRefused("p.qps", _qps(*lines.split(r"\n")), words)
        self.assertRefused("p.qps", _qps().replace("ENDATA\n", ""), ":7: expected ENDATA, found the end of the file")
        self.assertRefused("p.qps", _qps().replace(" N obj", " N obj\n L c1"), "rows N, of which the first is the objective, and no constraints")
        self.assertRefused("p.qps", _qps().replace(" N obj", " N obj\n N obj"), ":4: expected every row once, found 'obj'")
        self.assertRefused("p.qps", _qps().replace("f2 obj", "f1 obj 3\n f2 obj 4\n f1 obj"), "all entries of a column together")
        self.assertRefused("p.qps", b"", "p.qps:1: expected ENDATA, found the end of the file")
        self.assertRefused("p.qps.gz", b"\x1f\x8bno gzip", "damaged or incomplete")

    def test_what_is_wrong_with_an_npz_file_is_told_with_its_array(self):
        P, q = np.eye(2), np.ones(2)
        for arrays, words in (({"P": P}, "q: expected an array of numbers, none"), ({"q": q}, "P: expected an array of numbers, found none"),
                              ({"P": np.eye(3), "q": q}, "P: expected 2 x 2 numbers, found 3 x 3"), ({"P": q, "q": q}, "P: expected 2 dimensions"),
                              ({"P": P, "q": np.array(["a", "b"])}, f"q: expected {quadratic._NUMBERS}, found <U1"),
                              ({"P": P.astype(complex), "q": q}, "numbers of at most 64 bits, found complex128"),
                              ({"P": P.astype(np.longdouble), "q": q}, "numbers of at most 64 bits, found float"), ({"P": P * np.nan, "q": q}, "P: expected finite numbers"),
                              ({"P": P, "q": q, "lb": np.full(2, np.nan)}, "lb: expected numbers, found others"),
                              ({"P": P, "q": q, "lb": np.ones(3)}, "lb: expected 2 numbers, found 3"),
                              ({"P": P, "q": q, "lb": q, "ub": -q}, "bounds with a number between them"),
                              ({"P": P, "q": q, "G": P, "h": q}, "G: expected None, as an LCP has no constraints but bounds"),
                              ({"P": np.array([[1.0, 2], [3, 1]]), "q": q}, "P: expected a symmetric matrix")):
            with self.subTest(words):
                self.assertRefused("p.npz", _npz(**arrays), words.replace(", none", ", found none"))
        self.assertRefused("p.npz", b"PK no zip", "expected an npz file (zip)")
        whole = _npz(P=P, q=q)
        for k in range(1, 20):
            self.assertRefused("p.npz", whole[:len(whole) * k // 20], "")

    def test_numbers_that_doubles_hold_are_read(self):
        P, q = [[2, 1], [1, 3]], [1, 0]
        for kind in ("?", "<i1", "<u2", ">i4", "<i8", ">u8", "<f2", "<f4", ">f4"):
            matrix = np.array(P, dtype=kind)
            problem = self.load("p.npz", _npz(P=matrix, q=np.array(q, dtype=kind), lb=np.array([0, 1], dtype=kind)))
            self.assertEqual((problem.A.tolist(), problem.b.tolist()), (matrix.astype(float).tolist(), q), kind)
            self.assertEqual((problem.A.dtype, problem.bounded["lower"].tolist()), (np.float64, [1]))
        for value in (-2**63, 2**53, -2**53 - 2, 2**62 + 2**10):
            self.assertEqual(self.load("p.npz", _npz(P=P, q=[1, value])).b.tolist(), [1, value])
        self.assertEqual(self.load("p.npz", _npz(P=P, q=np.array([0, 2**63], dtype=np.uint64))).b.tolist(), [0, 2**63])
        for values in ([1, 2**53 + 1], [-2**53 - 1, 0], [2**63 - 1, 0], np.array([0, 2**64 - 1], dtype=np.uint64)):
            value = next(value for value in np.array(values).tolist() if abs(value) > 1)
            self.assertRefused("p.npz", _npz(P=P, q=values), f"q: expected integers that are exact in doubles, found {value}")

    def test_matrices_of_scipy_are_named(self):
        for kind in ("csr", "csc", "coo", "bsr", "dia"):
            stream = io.BytesIO()
            scipy.sparse.save_npz(stream, scipy.sparse.eye(3, format=kind))
            self.assertRefused("p.npz", stream.getvalue(), "p.npz: expected the arrays P and q of a program, found a matrix, as scipy.sparse.save_npz")

    def test_byte_order_marks_are_named(self):
        for name, text in (("p.qps", _qps()), ("p.mps", ""), ("p.dat", "1 0 1 1 1 1 2 -1")):
            for coding, mark in (("UTF-8", "utf-8-sig"), ("UTF-16", "utf-16"), ("UTF-16", "utf-16-be")):
                content = (text if mark != "utf-16-be" else "\ufeff" + text).encode(mark)
                self.assertRefused(name, content, f"{name}:1: expected text without a byte order mark, found one of {coding}")

    def test_nothing_is_unpickled(self):
        ran = self.folder / "ran"

        class Hostile:
            def __reduce__(self):
                return open, (str(ran), "w")
        for name, content in (("G", Hostile()), ("P", {}), ("h", [None])):
            stream = io.BytesIO()
            with zipfile.ZipFile(stream, "w") as archive:
                for member, values in {"P": np.eye(1), "q": np.ones(1), name: None}.items():
                    with archive.open(f"{member}.npy", "w") as file:
                        if values is None:
                            np.lib.format.write_array_header_1_0(file, {"descr": "|O", "fortran_order": False, "shape": ()})
                            file.write(pickle.dumps(content, protocol=3))
                        else:
                            np.lib.format.write_array(file, values)
            self.assertRefused("p.npz", stream.getvalue(), f"{name}: expected ")
        self.assertFalse(ran.exists())

    def test_promises_of_an_npz_file_are_not_believed(self):
        for shape in ((10**6, 10**6), (-1, 2), (2**63, 2), (2, 2, 2), ()):
            stream = io.BytesIO()
            with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
                with archive.open("q.npy", "w") as file:
                    np.lib.format.write_array(file, np.ones(10**6))
                with archive.open("P.npy", "w") as file:
                    np.lib.format.write_array_header_2_0(file, {"descr": "<f8", "fortran_order": False, "shape": shape})
                    file.write(bytes(1000))
            self.assertRefused("p.npz", stream.getvalue(), "P: expected")
