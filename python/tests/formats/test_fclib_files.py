"""FCLib's HDF5 files: round trips bit for bit, what leads out of a file, and one line for whatever is wrong."""

import h5py
import numpy as np
from scipy.sparse import csr_array
from stored_problems import FormatError, FormatTest, StoredProblem, difference, fclib, formats, generated, hdf5, refusals

_W, _V, _R = "/fclib_local/W", "/fclib_local/V", "/fclib_local/R"
_Q = "/fclib_local/vectors/q"


def _integers(*values):
    return np.array(values, dtype=np.int32)


def _reals(*values):
    return np.array(values, dtype=np.float64)


def _matrix(contents, name, rows, columns, form, p, i, x):
    contents.update({f"{name}/nzmax": _integers(len(x)), f"{name}/m": _integers(rows), f"{name}/n": _integers(columns),
                     f"{name}/nz": _integers(form), f"{name}/p": _integers(*p), f"{name}/i": _integers(*i), f"{name}/x": _reals(*x)})


def _example():
    """Two contacts in the plane and a bilateral row, in three forms of matrices, with tangential entries:
    A = [4 1 5; 1 3 0; 5 0 2], b = (-1, -2, -3)."""
    contents = {"/fclib_local/spacedim": _integers(2)}
    _matrix(contents, _W, 4, 4, -1, [0, 3, 4, 6, 6], [0, 1, 2, 3, 0, 2], [4, 0.5, 1, 9, 1, 3])
    _matrix(contents, _V, 4, 1, 2, [0, 3], [0, 0], [5, 7])
    _matrix(contents, _R, 1, 1, -2, [0, 1], [0], [2])
    return contents | {_Q: _reals(-1, 0.25, -2, 0), "/fclib_local/vectors/mu": _reals(0, 0), "/fclib_local/vectors/s": _reals(-3)}


class FclibFiles(FormatTest):
    def setUp(self):
        super().setUp()
        self.path = self.folder / "p.hdf5"

    def read(self, contents, **options):
        self.path.write_bytes(hdf5.image(contents))
        return formats.load(self.path, **options)[0]

    def assertRefused(self, words, contents=None, **options):
        if contents is not None:
            self.path.write_bytes(hdf5.image(contents))
        self.assertRefusal(f"{self.path}: ", words, formats.load, self.path, **options)

    def test_problems_come_back_bit_for_bit(self):
        random = np.random.default_rng(7)
        for problem in generated(60):
            with self.subTest(problem.id):
                unilateral = random.permutation(np.setdiff1d(np.arange(len(problem.b)), problem.bilateral))
                if len(unilateral) > 3:  # in any order of rows, and contacts that have none
                    order = np.sort(unilateral[0:len(unilateral) // 3])
                    problem.friction = {"row": order, "normal": unilateral[len(order):2 * len(order)], "mu": random.random(len(order)) + 0.1}
                formats.save(problem, self.path)
                back = formats.load(self.path)[0]
                if isinstance(problem.A, np.ndarray):
                    problem.A = csr_array(problem.A)
                if problem.friction is not None:  # in the order of the file
                    for rows in (problem.friction, back.friction):
                        by_row = np.argsort(rows["row"])
                        rows.update({key: values[by_row] for key, values in rows.items()})
                self.assertEqual(difference(back, problem), "")
                self.assertEqual((back.id, back.f), (problem.id, None))
                self.assertEqual(fclib.write(problem), fclib.write(problem))

    def test_an_id_may_be_any_text(self):
        for name in ("", "an id\nof two lines", "ä\u2028"):
            self.path.write_bytes(fclib.write(StoredProblem(name, np.ones(1), A=csr_array(np.eye(1)))))
            self.assertEqual(formats.load(self.path)[0].id, name)

    def test_what_the_format_cannot_hold_is_not_written(self):
        def refused(words, A, **laws):
            with self.assertRaisesRegex(FormatError, f"problem 'p'.*{words}"):
                fclib.write(StoredProblem("p", np.ones(len(A)), A=csr_array(np.array(A, dtype=float)), **laws))

        def friction(row, normal, mu, **slip):
            return {"friction": {"row": np.array(row), "normal": np.array(normal), "mu": np.array(mu)} | slip}
        refused("expected the same entries between contacts and bilateral rows", [[1, 2], [3, 1]], bilateral=np.array([1]))
        refused("has several friction rows of a contact", np.eye(3), **friction([1, 2], [0, 0], [0.5, 0.5]))
        refused("has sliding rows", np.eye(3), **friction([1], [0], [0.5], slip=np.array([1])))
        refused("has friction rows of mu = 0", np.eye(3), **friction([1], [0], [0.0]))
        refused("has bounded rows, which FCLib has no place for", np.eye(1), bounded={"row": np.array([0])})

    def test_the_normal_part_is_the_problem(self):
        problem = self.read(_example())
        self.assertEqual(problem.id, "p")
        self.assertEqual(problem.A.toarray().tolist(), [[4, 1, 5], [1, 3, 0], [5, 0, 2]])
        self.assertEqual((problem.b.tolist(), problem.bilateral.tolist()), ([-1, -2, -3], [2]))
        # Three rows a contact; no bilateral rows.
        contents = {"/fclib_local/spacedim": _integers(3), _Q: _reals(-1, 8, 8, -2, 8, 8), "/fclib_local/vectors/mu": _reals(0, -0.0),
                    "/solution/r": _reals(1, 8, 8, 2, 8, 8)}
        _matrix(contents, _W, 6, 6, 5, [0, 3, 0, 3, 4], [0, 3, 3, 0, 5], [1, 2, 3, 4, 5])
        problem = self.read(contents, fclib_triplets="rows-first")
        self.assertEqual((problem.A.toarray().tolist(), problem.b.tolist(), problem.f.tolist()), ([[1, 3], [4, 2]], [-1, -2], [1, 2]))
        contents["/fclib_local/vectors/mu"] = _reals(0.5, 0)
        self.assertRefused("contacts with two tangents, or `lcpbench convert --box-friction`", contents, fclib_triplets="rows-first")
        box = self.read(contents, fclib_triplets="rows-first", box_friction=True)
        self.assertEqual({key: values.tolist() for key, values in box.friction.items()}, {"row": [1, 2], "normal": [0, 0], "mu": [0.5, 0.5]})
        self.assertEqual(self.read(contents, fclib_triplets="rows-first", without_friction=True).b.tolist(), [-1, -2])

    def test_triplets_are_read_by_rows_or_by_columns_and_never_transposed_in_silence(self):
        told = "triplets of which one reading is possible, or `lcpbench convert --fclib-triplets rows-first`"
        A, turned = [[4, 7, 5], [1, 3, 0], [5, 0, 2]], [[4, 1, 5], [7, 3, 0], [5, 0, 2]]
        contents = _example()

        def read(triplets=None):
            return self.read(contents, fclib_triplets=triplets).A.toarray().tolist()
        # p rows, i columns.
        _matrix(contents, _W, 4, 4, 4, [0, 0, 2, 2], [0, 2, 0, 2], [4, 7, 1, 3])
        _matrix(contents, _V, 4, 1, -1, [0, 1], [0], [5])
        self.assertRefused("/fclib_local/W: expected " + told, contents)
        self.assertEqual((read("rows-first"), read("columns-first")), (A, turned))
        # One program wrote the file: what V says holds for W.
        _matrix(contents, _V, 4, 1, 2, [3, 0], [0, 0], [8, 5])
        self.assertEqual((read(), read("rows-first")), (A, A))
        self.assertRefused("V/p: expected indices from 0 to 0, found 3", contents, fclib_triplets="columns-first")
        _matrix(contents, _V, 4, 1, 2, [0, 0], [3, 0], [8, 5])
        self.assertEqual(read(), turned)
        self.assertRefused("V/i: expected indices from 0 to 0, found 3", contents, fclib_triplets="rows-first")
        # Symmetric where it counts: tangential entries, their order, sums and zeros do not matter.
        _matrix(contents, _V, 4, 1, -1, [0, 1], [0], [5])
        _matrix(contents, _W, 4, 4, 7, [2, 0, 0, 2, 0, 1, 2], [0, 0, 2, 2, 2, 0, 3], [7, 4, 3, 3, 4, 9, 0])
        self.assertEqual(read(), [[4, 7, 5], [7, 3, 0], [5, 0, 2]])

    def test_global_problems_of_a_diagonal_mass_are_read_by_factors(self):
        """Two contacts of two bodies of one coordinate, and a joint."""
        at, vectors = "/fclib_global", "/fclib_global/vectors"
        contents = {f"{at}/spacedim": _integers(2), f"{vectors}/f": _reals(-2, 8), f"{vectors}/w": _reals(0.5, 7, 0.25, 7),
                    f"{vectors}/b": _reals(3), f"{vectors}/mu": _reals(0.5, 0.5), "/solution/r": _reals(1, 8, 2, 8), "/solution/l": _reals(-1)}
        _matrix(contents, f"{at}/M", 2, 2, 2, [0, 1], [0, 1], [2, 4])
        _matrix(contents, f"{at}/H", 2, 4, 4, [0, 2, 2, 3], [0, 0, 1, 1], [1, -1, 1, 9])  # columns first, as Siconos
        _matrix(contents, f"{at}/G", 2, 1, -1, [0, 1], [1], [1])
        problem = self.read(contents)
        self.assertEqual(problem.J.toarray().tolist(), [[1, 0], [0, 0], [-1, 1], [0, 9], [0, 1]])
        self.assertEqual(problem.b.tolist(), [-0.5, 7, 3.25, 25, 5])
        self.assertEqual({key: values.tolist() for key, values in problem.friction.items()},
                         {"row": [1, 3], "normal": [0, 2], "mu": [0.5, 0.5]})
        self.assertEqual((problem.bilateral.tolist(), problem.f.tolist()), ([4], [1, 8, 2, 8, -1]))
        normal = self.read(contents, without_friction=True)
        self.assertEqual((normal.J.toarray().tolist(), normal.inverse_mass.tolist()), ([[1, 0], [-1, 1], [0, 1]], [0.5, 0.25]))
        self.assertEqual((normal.b.tolist(), normal.bilateral.tolist(), normal.f.tolist()), ([-0.5, 3.25, 5], [2], [1, 2, -1]))
        _matrix(contents, f"{at}/M", 2, 2, 3, [0, 1, 0], [0, 1, 1], [2, 4, 1])
        self.assertRefused("M: expected a diagonal matrix, others are not supported, found an entry in row 1 and column 0", contents)
        _matrix(contents, f"{at}/M", 2, 2, 2, [0, 0], [0, 0], [2, 4])
        self.assertRefused("M: expected masses > 0 on the diagonal, found 0.0 at 1", contents)
        _matrix(contents, f"{at}/M", 3, 3, 0, [], [], [])
        self.assertRefused("M: expected 2 x 2 entries, found 3 x 3", contents)

    def test_a_file_of_other_groups_is_told_what_it_has(self):
        for other in ("fclib_global_rolling", "fclib_local_rolling", "FCLIB_LOCAL", "a group"):
            contents = {f"/{other}/spacedim": _integers(5)}
            self.assertRefused(f"expected a group fclib_local or fclib_global, found {other}", contents)
            self.assertRefused(f"fclib_global, found {other}, solution", contents | {"/solution/r": _reals(1)})
        self.assertRefused("found group0, group1, group10", {f"/group{k}/n": _integers(k) for k in range(100)})
        self.assertRefused("found nothing", {})
        contents = {}
        _matrix(contents, "/fclib_global/M", 1, 1, 1, [0], [0], [2])
        self.assertRefused("/fclib_global/spacedim: expected a dataset of integers, found none", contents)

    def test_forces_that_were_never_written_are_none(self):
        for name, contents in (("/solution/r", _example()), ("/solution/l", _example() | {"/solution/r": _reals(1, 8, 2, 8)})):
            self.path.write_bytes(hdf5.image(contents | {"/solution/u": _reals(1, 2, 3, 4)}))
            with h5py.File(self.path, "r+") as file:
                file.create_dataset(name, shape=(4 if name.endswith("r") else 1,), dtype="<f8")
            problem = formats.load(self.path)[0]
            self.assertEqual((len(problem.b), problem.f), (3, None))

    def test_what_is_wrong_is_one_line_with_its_dataset(self):
        cases = refusals("fclib")
        self.assertGreater(len(cases), 40)
        for change, words in cases:
            kind, name, *numbers = change.split()
            name = name if name.startswith("/") else f"/fclib_local/{name}"
            contents = _example()
            contents.pop(name, None)
            if kind != "without":
                contents[name] = _integers(*map(int, numbers)) if kind == "integers" else _reals(*map(float, numbers))
            with self.subTest(change):
                self.assertRefused(words, contents)
        for rows, mass, words in ((2, 1, "/lcpbench/J: expected 3 x 3 entries, found 2 x 3"), (3, -1, "inverse_mass: expected inverse masses >= 0")):
            contents = _example() | {"/lcpbench/inverse_mass": _reals(1, mass, 1)}
            _matrix(contents, "/lcpbench/J", rows, 3, 0, [], [], [])
            self.assertRefused(words, contents)
        contents = _example()
        _matrix(contents, _R, 1, 1, 2, [0, 0], [0, 0], [1e308, 1e308])
        self.assertRefused("finite", contents)
        contents = _example()
        contents[f"{_W}/m/m"] = contents.pop(f"{_W}/m")
        self.assertRefused("W/m: expected a dataset of 32-bit integers, found another object", contents)
        self.assertRefused("/fclib_local: expected a group, found another object", {"/fclib_local": _integers(1)})

    def test_what_is_no_file_of_this_kind_is_refused(self):
        self.assertRefused("cannot be opened: No such file")
        for content in (b"", b"this is no HDF5 file at all"):
            self.path.write_bytes(content)
            self.assertRefused("expected an HDF5 file that libhdf5 can read, found one that it refuses")
        self.path = self.folder / "folder.h5"
        self.path.mkdir()
        self.assertRefused("not a regular file")

    def test_what_leads_out_of_the_file_is_refused(self):
        other, values = self.folder / "other.h5", self.folder / "values"
        other.write_bytes(hdf5.image(_example()))
        values.write_bytes(bytes(32))

        def virtual(file):
            layout = h5py.VirtualLayout(shape=(4,), dtype="<f8")
            layout[:] = h5py.VirtualSource(str(other), _Q, shape=(4,))
            file.create_virtual_dataset(_Q, layout)

        def shared(file):
            file[_Q] = file["/elsewhere"]
            for matrix in (_W, _R):  # 2000 entries in one place
                for part, values in (("nzmax", _integers(2000)), ("nz", _integers(-1)), ("x", np.ones(2000)), ("i", np.zeros(2000, dtype="<i4")),
                                     ("p", _integers(*([0, 2000] if matrix == _R else [0, 2000, 2000, 2000, 2000])))):
                    del file[f"{matrix}/{part}"]
                    file[f"{matrix}/{part}"] = file[f"{_W}/{part}"] if matrix == _R and len(values) == 2000 else values

        def soft(file):
            file[_Q] = h5py.SoftLink("/elsewhere")

        def external(file):
            file[_Q] = h5py.ExternalLink(str(other), _Q)
        in_one_piece = "q: expected values in one piece as fclib writes them, found chunks, filters or other datasets"
        for change, words in ((soft, "q: expected a hard link, found another"), (external, "q: expected a hard link, found another"),
                              (lambda file: file.create_dataset(_Q, (4,), "<f8", external=[(str(values), 0, 32)]),
                               "q: expected values in the file itself, found names of other files"),
                              (virtual, in_one_piece), (lambda file: file.create_dataset(_Q, data=np.ones(4), chunks=(2,), compression=9), in_one_piece),
                              (lambda file: file.create_dataset(_Q, (10**12,), "<f8"), "q: expected 4 numbers, found 0"),
                              (shared, "expected values that no other dataset shares, found shared ones")):
            with self.subTest(words):
                contents = _example() | {"/elsewhere": _reals(-1, 0, -2, 0)}
                del contents[_Q]
                self.path.write_bytes(hdf5.image(contents))
                with h5py.File(self.path, "r+") as file:
                    change(file)
                self.assertRefused(words)

    def test_promises_are_not_believed(self):
        """Headers whose sizes promise what the file does not hold."""
        count, promised = 1237, 10**12  # a number that stands nowhere else
        content = hdf5.image(_example() | {_Q: np.ones(count)})
        for sizes in ((count,), (count, 8 * count)):
            changed = content
            for size in sizes:
                old, new = size.to_bytes(8, "little"), (size // count * promised).to_bytes(8, "little")
                self.assertIn(old, changed)
                changed = changed.replace(old, new)
            self.path.write_bytes(changed)
            self.assertRefused("")

    def test_truncated_files_are_refused_in_one_line(self):
        whole = fclib.write(next(generated(1)))
        for k in range(40):
            self.path.write_bytes(whole[:len(whole) * k // 40])
            self.assertRefused("expected")
