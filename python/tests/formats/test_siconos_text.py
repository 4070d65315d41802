"""Siconos' text files: round trips bit for bit, and one line for whatever is wrong with a file."""

import codecs

import numpy as np
from stored_problems import FormatError, FormatTest, StoredProblem, difference, formats, generated, refusals, siconos

_TANGENTS = formats.Tangents


def parse(text, tangents=_TANGENTS.ONE):
    data = text if isinstance(text, bytes) else text.encode()
    return siconos.read(data.splitlines(keepends=True), "file.dat", "id", tangents=tangents)


def dense(problem):
    return problem.entries().toarray()


class SiconosText(FormatTest):
    def assertRefused(self, text, words, tangents=_TANGENTS.ONE):
        self.assertRefusal("file.dat:", words, parse, text, tangents)

    def test_problems_come_back_bit_for_bit(self):
        for problem in generated(60):
            with self.subTest(problem.id):
                back = parse(siconos.write(problem))
                if problem.J is not None:  # factors are written as their rounded matrix
                    problem = StoredProblem(problem.id, problem.b, A=problem.A, bilateral=problem.bilateral)
                self.assertEqual(difference(back, problem), "")

    def test_without_rows_or_unsymmetric_the_problem_comes_back_too(self):
        self.assertEqual(len(parse(siconos.write(StoredProblem("none", np.zeros(0), A=np.zeros((0, 0))))).b), 0)
        for bilateral in ([], [0, 1]):
            A = np.array([[1, -0.0], [5e-324, -1.7976931348623157e308]])
            problem = StoredProblem("ends", np.array([-0.0, 0.1]), A=A, bilateral=np.array(bilateral, dtype=int))
            self.assertEqual(difference(parse(siconos.write(problem)), problem), "")

    def test_reads_what_the_library_writes(self):
        # By columns, and a remark behind.
        problem = parse("2\n0\n2\n2\n2\t2\n1 2\n3 4\n-1 1\n\nRemark 4 of a book\n")
        self.assertEqual(problem.A.tolist(), [[1, 3], [2, 4]])
        self.assertEqual(problem.b.tolist(), [-1, 1])
        columns = parse("2\n2\n2\n2\n2\nCSparse Version 3.2.0, Sept 12, 2017.\n2-by-2, nzmax: 3 nnz: 3, 1-norm: 3.25\n"
                        "    col 0 : locations 0 to 1\n      1 : 2\n      0 : 1.25\n    col 1 : locations 2 to 2\n      1 : 3\n1 1\n")
        self.assertEqual(dense(columns).tolist(), [[1.25, 0], [2, 3]])
        summed = parse("1\n2\n1\n1\n1\nCSparse\ntriplet: 1-by-1, nzmax: 2 nnz: 2\n 0 0 : 1\n 0 0 : 2\n1\n")
        self.assertEqual(dense(summed).tolist(), [[3]])
        # A, C, D, B and their vectors alone, row by row: equations come first.
        parts = parse("0 1 1 2   9   1 2 3 4   5 6   7 8   -1   -2 -3")
        self.assertEqual(parts.A.tolist(), [[9, 5, 6], [7, 1, 2], [8, 3, 4]])
        self.assertEqual((parts.b.tolist(), parts.bilateral.tolist()), ([-1, -2, -3], [0]))
        # Both storages, the equation in the middle; a known answer behind.
        both = "1 1 1 2\n0 1 2 3\n1 0 1\n0 3 3 3 3\n4 1 0\n1 3 0\n0 0 2\n-1 1 -2\n3  4 0 0 2  1 0  1 0  1  -1 -2"
        self.assertEqual(parse(both).bilateral.tolist(), [1])
        self.assertEqual(len(parse(both + "   1 2 3 4 5").b), 3)
        self.assertRefused(both + "   1 2 3 4 5 6", "expected the end of the file")
        self.assertRefused(both + "   1 2 3e999", "a known answer to be finite")
        # Sparse blocks of 1 and 2 rows, column by column; rows of blocks at the end may have none.
        blocks = parse("3 1 3 3  3  2 2  1 3  1 3  3 3  0 2 3  0 1 1  0 4  1 5 6  2 1 2 3 4  -1 -2 -3")
        self.assertEqual(dense(blocks).tolist(), [[4, 5, 6], [0, 1, 3], [0, 2, 4]])
        self.assertEqual(dense(parse("2 1 2 2  1  2 2  1 2  1 2  2 1  0 1  1  0 7  1 2")).tolist(), [[0, 7], [0, 0]])
        self.assertEqual(dense(parse("2 1 2 2  0  1 2")).tolist(), [[0, 0], [0, 0]])
        mixed = parse("1 0 1 1  0 1 2  0 1  1 2 2  1 1 1 2 2 2 1 0 1 0  0 1 2 3 4  -1 -2")
        self.assertEqual((dense(mixed).tolist(), mixed.bilateral.tolist()), ([[1, 3], [2, 4]], [0]))
        # One row: an LCP or an MLCP.
        self.assertEqual(parse("1 0 1 1 1 1 2 -1").bilateral.tolist(), [])
        self.assertEqual(parse("1 0 1 1  0 1 2  0 1  0 2 2 2 2  1 0 0 1  -1 -2").bilateral.tolist(), [0])
        self.assertEqual(parse("1 1 1 0  0 1  0  0 1 1 1 1  2 -1  2 -1").bilateral.tolist(), [0])

    def test_many_entries_are_read_as_few(self):
        random = np.random.default_rng(3)
        n, count = 300, 20_000  # of which many are of one place
        row, column, value = random.integers(0, n, count), random.integers(0, n, count), random.normal(size=count)
        lines = [f" {i} {j} : {x!r}" for i, j, x in zip(row.tolist(), column.tolist(), value.tolist(), strict=True)]
        head = [str(n), "2", str(n), str(n), "1", "CSparse", f"triplet: {n}-by-{n}, nzmax: {count} nnz: {count}"]
        expected = np.zeros((n, n))
        for i, j, x in zip(row, column, value, strict=True):
            expected[i, j] += x
        self.assertTrue(np.array_equal(dense(parse("\n".join([*head, *lines, "1 " * n]))), expected))
        for wrong, words in (("1 1 1", "expected ':', found '1'"), (f"{n} 0 : 1", "expected a row from 0 to 299"), ("0 0 : nan", "a finite number"),
                             ("0 0 : 1_0", "a finite number"), ("+0 0 : 1", "expected a row")):
            changed = [*lines[:9000], wrong, *lines[9001:]]
            self.assertRefused("\n".join([*head, *changed, "1 " * n]), words)

    def test_other_numbers_of_equations_than_of_free_unknowns_are_made_square(self):
        # u - v = 0, -u - v + 1 = 0, 0 <= v, u + v - 1 >= 0: an unknown that acts on nothing beside u.
        more = parse("1 1 1 1  0 1 2  0 1  0 3 2 3 2  1 -1 1  -1 -1 1  0 1  1 1 -1 1  0 -1  9 9 9")
        self.assertEqual(dense(more).tolist(), [[1, 0, -1], [-1, 0, -1], [1, 0, 1]])
        self.assertEqual((more.b.tolist(), more.bilateral.tolist()), ([0, 1, -1], [0, 1]))
        # No equation: 0 = 0 for u. What Siconos prints of q beyond its rows means nothing.
        fewer = parse("1 0 1 1  0 1 2  0 1  2 1 2  1\nCSparse\ntriplet: 1-by-2, nzmax: 1 nnz: 1\n 0 1 : 5\n -2 8")
        self.assertEqual((dense(fewer).tolist(), fewer.b.tolist(), fewer.bilateral.tolist()), ([[0, 0], [0, 5]], [0, -2], [0]))
        # A promise of many equations costs nothing.
        self.assertRefused("1 0 2000000000 0  0 2000000000  0  0 0 2000000000 0 2000000000", "of q, found the end")

    def test_of_contacts_normal_rows_are_read_and_with_friction_tangents(self):
        W = "2 2 0 4 4 4 4  4 9 1 9  9 9 9 9  1 9 3 9  9 9 9 9  -1 8 -2 8  "
        problem = parse(W + "0 0 1")
        self.assertEqual((problem.A.tolist(), problem.b.tolist(), problem.friction), ([[4, 1], [1, 3]], [-1, -2], None))
        friction = parse(W + "0 0.5")
        self.assertEqual(friction.A.tolist(), [[4, 1, 9], [1, 3, 9], [9, 9, 9]])
        self.assertEqual({key: values.tolist() for key, values in friction.friction.items()}, {"row": [2], "normal": [1], "mu": [0.5]})
        with self.assertRaises(FormatError):
            siconos.write(friction)
        self.assertRefused(W + "0 -0.5", "expected friction coefficients >= 0, found '-0.5'")
        self.assertRefused(W + "0", "number 2 of the 2 of friction coefficients")
        self.assertRefused(W + "0 0 1 1", "the end of the file")
        space = "3 2 1 6 6  2 2 2 3 6 3 6 3 2 0 1 2 0 1  0 5 1 1 1 1 1 1 1 1  1 6 1 1 1 1 1 1 1 1  -1 7 7 -2 7 7  0.7 0"
        self.assertRefused(space, "of contacts with two tangents, or `lcpbench convert --box-friction`")
        box = parse(space, _TANGENTS.BOX)
        self.assertEqual((box.b.tolist(), box.friction["row"].tolist(), box.friction["normal"].tolist()), ([-1, 7, 7, -2], [1, 2], [0, 0]))
        normal = parse(space, _TANGENTS.NONE)
        self.assertEqual((dense(normal).tolist(), normal.b.tolist()), ([[5, 0], [0, 6]], [-1, -2]))
        # What is a problem of contacts and an LCP by its first words is an LCP.
        self.assertEqual(len(parse("2 1 2 2  1 1 1 2 2 2 1 0 1 0  0 1 2 3 4  -1 -2").b), 2)

    def test_contacts_of_bodies_are_read_by_factors(self):
        # Two discs of mass 2 and 4 without turning, on each other and on the ground: J = (1 0; -1 1) normal, mu = 0.5.
        M = "{d} {nc} 0 4 4 4 4  2 0 0 0  0 2 0 0  0 0 4 0  0 0 0 4  "
        normal, tangent = [[0, 1, 0, 0], [0, -1, 0, 1]], [[1, 0, 0, 0], [-1, 0, 1, 0]]
        H = np.array([normal[0], tangent[0], normal[1], tangent[1]]).T
        numbers = " ".join(str(x) for x in H.T.ravel())  # by columns
        rest = " 1 -19.62 2 -39.24   0.5 0.25 0 0   0.5 0"
        for storage in (f"0 4 4 4 4 {numbers}",
                        "2 4 4 1\nCSparse\ntriplet: 4-by-4, nzmax: 6 nnz: 6\n" + "".join(f"{i} {j} : {H[i, j]}\n" for i, j in np.argwhere(H)),
                        f"1 4 4 1 1 1 4 4 2 1 0 1 0 0 {numbers}"):
            problem = parse(M.format(d=2, nc=2) + storage + rest)
            self.assertEqual(problem.J.toarray().tolist(), [normal[0], tangent[0], normal[1]])
            self.assertEqual(problem.inverse_mass.tolist(), [0.5, 0.5, 0.25, 0.25])
            # b = H^T M^-1 q + b
            self.assertEqual(problem.b.tolist(), [-9.81 + 0.5, 0.5 + 0.25, 0.0])
            self.assertEqual({key: values.tolist() for key, values in problem.friction.items()}, {"row": [1], "normal": [0], "mu": [0.5]})
        # Without contacts, in compressed columns of which there are none.
        none = parse("2 0 0 3 3 3 3 1 0 0 0 1 0 0 0 1  2 3 0 2\nCSparse\n3-by-0, nzmax: 1 nnz: 0, 1-norm: 0\n1 2 3\n\n\n")
        self.assertEqual((len(none.b), none.J.shape), (0, (0, 3)))
        self.assertRefused(M.format(d=2, nc=2).replace("2 0 0 0", "2 1 0 0", 1) + f"0 4 4 4 4 {numbers}" + rest, "expected a diagonal matrix")
        self.assertRefused(M.format(d=2, nc=2).replace("2 0 0 0", "-2 0 0 0", 1) + f"0 4 4 4 4 {numbers}" + rest, "expected masses > 0")
        self.assertRefused(M.format(d=2, nc=2) + f"0 4 4 4 4 {numbers}" + " 1 2 3", "number 4 of the 4 of q")
        # As many numbers of bodies as of contacts: W, q, mu where nothing follows.
        self.assertEqual(len(parse(M.format(d=2, nc=2) + "0 4 4 4  0 0").b), 2)

    def test_what_is_wrong_is_one_line_with_its_place(self):
        cases = refusals("siconos_text")
        self.assertGreater(len(cases), 50)
        for text, words in cases:
            with self.subTest(text):
                self.assertRefused(codecs.decode(text.strip() and text, "unicode_escape"), words)

    def test_what_the_format_cannot_hold_is_not_written(self):
        from scipy.sparse import csr_array
        with self.assertRaisesRegex(FormatError, "problem 'overflow': expected factors whose product is finite"):
            siconos.write(StoredProblem("overflow", np.ones(1), J=csr_array(np.array([[1e200, 0, 0]])), inverse_mass=np.ones(3)))
        bounded = {"row": np.array([0]), "lower": np.array([-1.0]), "upper": np.array([1.0])}
        with self.assertRaisesRegex(FormatError, "problem 'b' has bounded rows, which the format has no place for; expected JSON lines"):
            siconos.write(StoredProblem("b", np.ones(1), A=np.ones((1, 1)), bounded=bounded))
