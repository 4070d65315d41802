"""HDF5 files of the Friction Contact Library's problems (FCLib 3.1, fclib.h there).

Local ones (group fclib_local):

  u = W r + V l + q,   V^T r + R l + s = 0,   every contact's u and r in the cones of its friction coefficient mu,

u, r of spacedim (2 or 3) rows per contact, the first of them normal. Contacts are our unilateral rows and, where mu is
not 0, friction rows; l are the forces of bilateral rows: R = A_BB, V = A_CB, s = b_B, W and q hold A_CC and b_C. With
mu = 0 the cones say that r is normal and 0 <= r_N, u_N, r_N u_N = 0. Global ones (group fclib_global) are read where M
is diagonal, and not written:

  M v = H r + G l + f,   u = H^T v + w,   G^T v + b = 0:   J = (H G)^T, inverse masses 1 / M, b = J M^-1 f + (w, b).

Where r_T = 0, tangential columns act on nothing, and tangential rows give nothing but u_T, which nothing asks for. So
tangential entries of contacts of mu = 0 are written as none, and passed over by the reader, which loses nothing of the
forces.

The group lcpbench beside it, which fclib passes over, keeps what the format has no place for: the problem's id, for
every contact (its normal, then its tangent) and then every bilateral row its row in the problem (row_order), and where
there are factors J and inverse_mass, which then win over W, V and R. Matrices are {nzmax, m, n, nz, p, i, x} as in
fclib.h: triplets, compressed columns or rows; entries of one place add up.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.sparse import csc_array, csr_array

from .contacts import Tangents, contact_rows, global_problem, inverse_of_diagonal
from .hdf5 import Datasets, image
from .problem import FormatError, StoredProblem, mismatch, sparse, summed

_LOCAL, _GLOBAL = "/fclib_local", "/fclib_global"
_MOST = 2**31 - 2  # rows
_COMPRESSED_COLUMNS, _COMPRESSED_ROWS = -1, -2  # of nz; others are numbers of triplets
_TRIPLETS = ("rows-first", "columns-first")


@dataclass
class _Matrix:
    """The entries. Its sizes are promises until something of that length stands beside them."""

    name: str
    rows: int
    columns: int
    row: np.ndarray
    column: np.ndarray
    value: np.ndarray
    is_ambiguous: bool = False  # triplets whose indices fit both ways: the entries have p as rows

    def placed(self, rows: np.ndarray | None, columns: np.ndarray | None, swapped: bool) -> tuple[np.ndarray, ...]:
        """Entries at new places of rows and columns, without those of place -1; None: they stay."""
        row, column = (self.column, self.row) if swapped else (self.row, self.column)
        row = row if rows is None else rows[row]
        column = column if columns is None else columns[column]
        kept = (row >= 0) & (column >= 0)
        return row[kept], column[kept], self.value[kept]


def _require_indices(file: Datasets, name: str, indices: np.ndarray, end: int) -> None:
    wrong = indices[(indices < 0) | (indices >= end)]
    if wrong.size:
        raise file.mismatch(name, f"indices from 0 to {end - 1}", wrong[0])


def _require_shape(file: Datasets, matrix: _Matrix, rows: int, columns: int) -> None:
    if (matrix.rows, matrix.columns) != (rows, columns):
        raise file.mismatch(matrix.name, f"{rows} x {columns} entries", f"{matrix.rows} x {matrix.columns}")


def _same_sums(a: tuple[np.ndarray, ...], b: tuple[np.ndarray, ...]) -> bool:
    """Whether entries are those of one matrix, whatever zeros are stored."""
    a, b = [[part[sums[2] != 0] for part in sums] for sums in (summed(*a), summed(*b))]
    return all(map(np.array_equal, a, b))


class _Matrices:
    """The matrices of one file. One program wrote it, so that p has the rows, or the columns, of all its triplets."""

    def __init__(self, file: Datasets, triplets: str | None):
        self._file = file
        self._triplets = triplets  # None until some matrix of the file tells

    def read(self, name: str) -> _Matrix:
        file = self._file
        rows, columns, places = (file.integer(f"{name}/{part}", 0, _MOST) for part in ("m", "n", "nzmax"))
        form = file.integer(f"{name}/nz", _COMPRESSED_ROWS, _MOST)
        count = places if form < 0 else form
        p, i = file.integers(f"{name}/p"), file.integers(f"{name}/i")
        x = file.reals(f"{name}/x", count)
        file.integers(f"{name}/i", count)
        if form >= 0:
            file.integers(f"{name}/p", count)
            return self._of_triplets(_Matrix(name, rows, columns, p, i, x))
        outer, inner = (columns, rows) if form == _COMPRESSED_COLUMNS else (rows, columns)
        lengths = self._lengths(f"{name}/p", file.integers(f"{name}/p", outer + 1), len(x))
        outer_index, inner_index = np.repeat(np.arange(outer), lengths), i[:p[-1]]
        _require_indices(file, f"{name}/i", inner_index, inner)
        if form == _COMPRESSED_COLUMNS:
            return _Matrix(name, rows, columns, inner_index, outer_index, x[:p[-1]])
        return _Matrix(name, rows, columns, outer_index, inner_index, x[:p[-1]])

    def _lengths(self, name: str, p: np.ndarray, most: int) -> np.ndarray:
        before = np.r_[0, p[:-1]]
        ends = np.r_[0, np.full(len(p) - 1, most)]
        for k in np.flatnonzero((p < before) | (p > ends))[:1]:
            raise self._file.mismatch(name, f"a place from {before[k]} to {ends[k]}", f"{p[k]} at {k}")
        return np.diff(p)

    def _of_triplets(self, matrix: _Matrix) -> _Matrix:
        p, i = matrix.row, matrix.column

        def fit(rows: int, columns: int) -> bool:
            return bool(((p >= 0) & (p < rows)).all() and ((i >= 0) & (i < columns)).all())
        by_rows, by_columns = fit(matrix.rows, matrix.columns), fit(matrix.columns, matrix.rows)
        if self._triplets is None and by_rows != by_columns:
            self._triplets = _TRIPLETS[0 if by_rows else 1]
        swapped = self._triplets == "columns-first"
        if not (by_columns if swapped else by_rows):
            _require_indices(self._file, f"{matrix.name}/p", p, matrix.columns if swapped else matrix.rows)
            _require_indices(self._file, f"{matrix.name}/i", i, matrix.rows if swapped else matrix.columns)
        matrix.is_ambiguous = by_rows and by_columns
        if swapped and not matrix.is_ambiguous:
            matrix.row, matrix.column = i, p
        return matrix

    def entries(self, matrix: _Matrix, rows: np.ndarray | None = None, columns: np.ndarray | None = None) -> tuple[np.ndarray, ...]:
        """What the problem needs of a matrix, see _Matrix.placed; all of the file's are to be read before."""
        by_rows = matrix.placed(rows, columns, False)
        if not matrix.is_ambiguous or self._triplets == "rows-first":
            return by_rows
        by_columns = matrix.placed(rows, columns, True)
        if self._triplets == "columns-first":
            return by_columns
        if _same_sums(by_rows, by_columns):
            return by_rows
        raise self._file.mismatch(
            matrix.name, "triplets of which one reading is possible, or `lcpbench convert --fclib-triplets rows-first` (as "
            "fclib.h has it) or columns-first (as Siconos writes them)", "some that can be read both ways")


def _row_order(file: Datasets, n: int) -> np.ndarray:
    """For every row of contacts that is read, and then every bilateral row, its row in the problem."""
    name = "/lcpbench/row_order"
    if not file.has(name):
        return np.arange(n)
    rows = file.integers(name, n)
    _require_indices(file, name, rows, n)
    if len(np.unique(rows)) != n:
        raise file.mismatch(name, "every row once", "one twice")
    return rows.astype(np.int64)


@dataclass
class _Rows:
    """Contacts and bilateral rows of a file, and the rows of the problem that they are."""

    count: int
    of_contacts: np.ndarray  # -1: a tangent that is not read
    of_bilateral: np.ndarray
    friction: dict[str, np.ndarray] | None

    def merged(self, contacts: np.ndarray, bilateral: np.ndarray) -> np.ndarray:
        """Numbers of contacts and of bilateral rows, by the rows of the problem."""
        merged = np.zeros(self.count)
        is_read = self.of_contacts >= 0
        merged[self.of_contacts[is_read]] = contacts[is_read]
        merged[self.of_bilateral] = bilateral
        return merged

    def laws(self) -> dict:
        return {"bilateral": np.sort(self.of_bilateral), "friction": self.friction}


def _rows(file: Datasets, tangents: Tangents, group: str, dimension: int, of_contacts: _Matrix, bilateral: int) -> _Rows:
    """By the columns of two matrices: spacedim for every contact, one for every bilateral row."""
    mu = f"{group}/vectors/mu"
    if of_contacts.columns % dimension != 0:
        raise file.mismatch(of_contacts.name, f"{dimension} rows for every contact", of_contacts.columns)
    row, friction = contact_rows(dimension, file.reals(mu, of_contacts.columns // dimension), tangents,
                                 lambda expected, found: file.mismatch(mu, expected, found))
    contacts = int((row >= 0).sum())
    order = _row_order(file, contacts + bilateral)
    if friction is not None:
        friction = friction | {"row": order[friction["row"]], "normal": order[friction["normal"]]}
    return _Rows(len(order), np.where(row >= 0, order[row] if len(order) else row, -1), order[contacts:], friction)


def _local(file: Datasets, place: str, id: str, triplets: str | None, tangents: Tangents) -> tuple[StoredProblem, _Rows]:
    matrices = _Matrices(file, triplets)
    dimension = file.integer(f"{_LOCAL}/spacedim", 2, 3)
    W = matrices.read(f"{_LOCAL}/W")
    if W.rows != W.columns or W.rows % dimension != 0:
        raise file.mismatch(W.name, f"a square matrix of {dimension} rows for every contact", f"{W.rows} x {W.columns} entries")
    q = file.reals(f"{_LOCAL}/vectors/q", W.rows)
    nothing = np.zeros(0, dtype=np.int32)
    V = R = _Matrix("", 0, 0, nothing, nothing, np.zeros(0))
    s = np.zeros(0)
    if file.has(f"{_LOCAL}/V/m") or file.has(f"{_LOCAL}/R/m"):
        R = matrices.read(f"{_LOCAL}/R")
        _require_shape(file, R, R.rows, R.rows)
        s = file.reals(f"{_LOCAL}/vectors/s", R.rows)
        V = matrices.read(f"{_LOCAL}/V")
        _require_shape(file, V, W.rows, R.rows)
    rows = _rows(file, tangents, _LOCAL, dimension, W, R.columns)
    problem = StoredProblem(id=id, b=rows.merged(q, s), **rows.laws())
    if file.has("/lcpbench/J/m") or file.has("/lcpbench/inverse_mass"):
        J = matrices.read("/lcpbench/J")
        problem.inverse_mass = file.reals("/lcpbench/inverse_mass")
        _require_shape(file, J, rows.count, len(problem.inverse_mass))
        for k in np.flatnonzero(problem.inverse_mass < 0)[:1]:
            raise file.mismatch("/lcpbench/inverse_mass", "inverse masses >= 0", f"{float(problem.inverse_mass[k])} at {k}")
        problem.J = sparse(place, (J.rows, J.columns), *matrices.entries(J))
        return problem, rows
    v = matrices.entries(V, rows.of_contacts, rows.of_bilateral)
    parts = [matrices.entries(W, rows.of_contacts, rows.of_contacts), v, (v[1], v[0], v[2]),
             matrices.entries(R, rows.of_bilateral, rows.of_bilateral)]
    problem.A = sparse(place, (rows.count, rows.count), *map(np.concatenate, zip(*parts, strict=True)))
    return problem, rows


def _global(file: Datasets, place: str, id: str, triplets: str | None, tangents: Tangents) -> tuple[StoredProblem, _Rows]:
    matrices = _Matrices(file, triplets)
    dimension = file.integer(f"{_GLOBAL}/spacedim", 2, 3)
    H, M = matrices.read(f"{_GLOBAL}/H"), matrices.read(f"{_GLOBAL}/M")
    _require_shape(file, M, H.rows, H.rows)
    loads = file.reals(f"{_GLOBAL}/vectors/f", H.rows)
    w = file.reals(f"{_GLOBAL}/vectors/w", H.columns)
    G, of_bilateral = None, np.zeros(0)
    if file.has(f"{_GLOBAL}/G/m"):
        G = matrices.read(f"{_GLOBAL}/G")
        _require_shape(file, G, H.rows, G.columns)
        of_bilateral = file.reals(f"{_GLOBAL}/vectors/b", G.columns)
    rows = _rows(file, tangents, _GLOBAL, dimension, H, len(of_bilateral))
    parts = [matrices.entries(H, None, rows.of_contacts)]
    if G is not None:
        parts.append(matrices.entries(G, None, rows.of_bilateral))
    row, column, value = map(np.concatenate, zip(*parts, strict=True))
    masses = inverse_of_diagonal(f"{place}: {M.name}", M.rows, *matrices.entries(M))
    return global_problem(place, id, rows.count, (column, row, value), masses, loads, rows.merged(w, of_bilateral),
                          **rows.laws()), rows


def _forces(file: Datasets, rows: _Rows) -> np.ndarray | None:
    """None where the file has no normal forces, or lists that were created and never written."""
    forces = []
    for name, count in (("/solution/r", len(rows.of_contacts)), ("/solution/l", len(rows.of_bilateral))):
        if name == "/solution/r" and not file.has(name):
            return None
        if name == "/solution/l" and count == 0:
            forces.append(np.zeros(0))
        elif count > 0 and len(file.reals(name)) == 0:
            return None
        else:
            forces.append(file.reals(name, count))
    return rows.merged(*forces)


def _provenance(file: Datasets, group: str) -> str:
    """What the file says of itself, where it says so in texts of fixed length."""
    said = []
    for name in ("title", "description"):
        try:
            if file.has(f"{group}/info/{name}"):
                said.append(file.text(f"{group}/info/{name}"))
        except FormatError:
            pass  # a remark of another kind is no reason to refuse the problem
    return "; ".join(said)


def read(path: Path, id: str, *, fclib_triplets: str | None = None, tangents: Tangents = Tangents.ONE) -> StoredProblem:
    """The problem of a file. Without the group lcpbench contacts come first, and the id is that of the name.

    @param fclib_triplets  what the list p of triplets has: fclib.h says their rows (rows-first), Siconos writes their
           columns (columns-first). None: what the ranges of the indices allow, in one matrix of the file at least;
           refused where they allow both and the problem is not the same either way
    """
    file = Datasets(path)
    file.require_one_of([_LOCAL, _GLOBAL])
    if file.has("/lcpbench/id"):
        id = file.text("/lcpbench/id")
    is_global = file.has(_GLOBAL) and not any(file.has(f"{_LOCAL}/{name}") for name in ("spacedim", "W", "V", "R", "vectors"))
    problem, rows = (_global if is_global else _local)(file, str(path), id, fclib_triplets, tangents)
    problem.f = _forces(file, rows)
    problem.provenance = _provenance(file, _GLOBAL if is_global else _LOCAL)
    return problem


def _add_matrix(datasets: dict, name: str, matrix: csr_array | csc_array) -> None:
    """In compressed columns or rows, as it is."""
    def integers(*values: int) -> np.ndarray:
        return np.array(values, dtype=np.int32)
    form = _COMPRESSED_COLUMNS if matrix.format == "csc" else _COMPRESSED_ROWS
    parts = {"nzmax": integers(matrix.nnz), "m": integers(matrix.shape[0]), "n": integers(matrix.shape[1]), "nz": integers(form),
             "p": matrix.indptr.astype(np.int32), "i": matrix.indices.astype(np.int32), "x": matrix.data}
    datasets.update({f"{name}/{part}": values for part, values in parts.items()})


def _friction_of_contacts(problem: StoredProblem) -> dict[int, tuple[int, float]]:
    """By normal row, the tangent row and the coefficient."""
    def refused(what: str) -> FormatError:
        return FormatError(f"{problem.place} has {what}, which FCLib has no place for; expected JSON lines, or --without-friction, "
                           "which drops friction")
    if problem.bounded is not None:
        raise refused("bounded rows")
    friction = {}
    if problem.friction is None:
        return friction
    if np.any(problem.friction.get("slip", 0)):
        raise refused("sliding rows")
    for row, normal, mu in zip(*(problem.friction[key].tolist() for key in ("row", "normal", "mu")), strict=True):
        if mu == 0:
            raise refused("friction rows of mu = 0")
        if normal in friction:
            raise refused("several friction rows of a contact")
        friction[normal] = row, mu
    return friction


def _blocks(problem: StoredProblem, place: np.ndarray, contact_rows: int, is_bilateral: np.ndarray) -> list[csc_array]:
    """W, V and R. @param place  of every row among those of contacts, or of bilateral ones"""
    A = problem.entries()
    row, column = np.repeat(np.arange(A.shape[0]), np.diff(A.indptr)), A.indices
    sizes = (contact_rows, int(is_bilateral.sum()))

    def part(of_rows: int, of_columns: int) -> csc_array:
        kept = (is_bilateral[row] == of_rows) & (is_bilateral[column] == of_columns)
        # By columns: the compressed rows of the transpose.
        return sparse(problem.place, (sizes[of_columns], sizes[of_rows]), place[column[kept]], place[row[kept]], A.data[kept]).T
    W, V, R, V_transposed = part(0, 0), part(0, 1), part(1, 1), part(1, 0).T.tocsc()
    V_transposed.sort_indices()
    same = all(a.tobytes() == b.tobytes() for a, b in ((V.indptr.astype(int), V_transposed.indptr.astype(int)),
                                                       (V.indices.astype(int), V_transposed.indices.astype(int)),
                                                       (V.data, V_transposed.data)))
    if same:
        return [W, V, R]
    raise FormatError(f"{problem.place}: expected the same entries between contacts and bilateral rows in both triangles of A, as "
                      "FCLib keeps one of them, found others")


def write(problem: StoredProblem) -> bytes:
    """spacedim 2, matrices in compressed columns with all stored entries. Read back bit for bit; a dense problem as a
    sparse one."""
    n = len(problem.b)
    if n > _MOST // 2:
        raise mismatch(problem.place, f"at most {_MOST // 2} rows", n)
    friction = _friction_of_contacts(problem)
    is_bilateral = np.zeros(n, dtype=bool)
    is_bilateral[problem.bilateral] = True
    is_tangent = np.zeros(n, dtype=bool)
    is_tangent[[row for row, _ in friction.values()]] = True
    normals = np.flatnonzero(~is_bilateral & ~is_tangent)
    pairs = np.full((len(normals), 2), -1)
    pairs[:, 0] = normals
    mu = np.zeros(len(normals))
    for k, normal in enumerate(normals.tolist()):
        if normal in friction:
            pairs[k, 1], mu[k] = friction[normal]
    of_contacts, of_bilateral = pairs.ravel(), np.flatnonzero(is_bilateral)
    place = np.zeros(n, dtype=np.int64)
    place[of_contacts[of_contacts >= 0]] = np.flatnonzero(of_contacts >= 0)
    place[of_bilateral] = np.arange(len(of_bilateral))
    W, V, R = _blocks(problem, place, len(of_contacts), is_bilateral)
    datasets = {f"{_LOCAL}/spacedim": np.array([2])}
    _add_matrix(datasets, f"{_LOCAL}/W", W)
    if len(of_bilateral):
        _add_matrix(datasets, f"{_LOCAL}/V", V)
        _add_matrix(datasets, f"{_LOCAL}/R", R)
        datasets[f"{_LOCAL}/vectors/s"] = problem.b[of_bilateral]
    datasets[f"{_LOCAL}/vectors/mu"] = mu
    datasets[f"{_LOCAL}/vectors/q"] = np.where(of_contacts >= 0, problem.b[of_contacts] if n else 0.0, 0.0)
    datasets[f"{_LOCAL}/info/title"] = problem.id
    datasets[f"{_LOCAL}/info/description"] = ("Coulomb friction in the plane: a contact's normal, then its tangent" if friction else
                                              "frictionless: a linear complementarity problem in the normal rows")
    datasets["/lcpbench/id"] = problem.id
    datasets["/lcpbench/row_order"] = np.r_[of_contacts[of_contacts >= 0], of_bilateral]
    if problem.J is not None:
        _add_matrix(datasets, "/lcpbench/J", problem.J)
        datasets["/lcpbench/inverse_mass"] = problem.inverse_mass
    return image(datasets)
