"""Text files of Siconos' numerics (.dat).  Linear complementarity problems (LCP) and mixed ones (MLCP), as
linearComplementarity_newFromFile and mixedLinearComplementarity_newFromFile read them (Siconos 4.4); contacts with
friction by their Delassus matrix (frictionContact_newFromFile) or, with a diagonal mass matrix, by bodies and contacts
(globalFrictionContact_newFromFile), which are read and not written. docs/formats.md has the layout. Our bilateral rows
are the equations; blocks keep the order of rows.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import csr_array

from .contacts import Tangents, contact_rows, global_problem, inverse_of_diagonal
from .problem import StoredProblem, refuse_rows, sparse
from .words import Words, number

_MOST = 2**31 - 2
_DENSE, _BLOCKS, _SPARSE = 0, 1, 2
_TRIPLETS, _COLUMNS = 1, 2  # forms of _SPARSE
_MANY = 1 << 12  # lines that are read at a time


@dataclass
class _Matrix:
    """Dense, or the entries of a sparse one in the order of the file."""

    rows: int
    columns: int
    dense: np.ndarray | None = None
    row: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    column: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    value: np.ndarray = field(default_factory=lambda: np.zeros(0))

    def entries(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of a dense one all."""
        if self.dense is None:
            return self.row, self.column, self.value
        row, column = np.divmod(np.arange(self.dense.size), max(self.columns, 1))
        return row, column, self.dense.ravel()

    def compressed(self, place: str) -> csr_array:
        return sparse(place, (self.rows, self.columns), *self.entries())


_Problem = tuple[_Matrix, np.ndarray, np.ndarray]  # M, q, the rows of equations


def _sparse_header(words: Words, matrix: _Matrix, origin: int) -> int:
    """@return how many entries follow"""
    words.expect(b"")
    words.require_line("a line 'CSparse ...'")
    words.expect(b"CSparse")
    words.require_line("a line 'R-by-C, nzmax: N nnz: N'")
    if origin == _TRIPLETS:
        words.expect(b"triplet:")
    words.expect(b"%d-by-%d," % (matrix.rows, matrix.columns))
    words.expect(b"nzmax:")
    words.integer(0, _MOST, "a number of places")
    words.expect(b"nnz:")
    word = words.word()
    # "4, 1-norm: 2": the norm is not needed.
    count = words.integer(0, _MOST, "a number of entries", word.removesuffix(b",") if origin == _COLUMNS else word)
    if origin == _TRIPLETS:
        words.expect(b"")
    words.skip_line()
    return count


def _read_many_triplets(words: Words, matrix: _Matrix, count: int, row: list, column: list, value: list) -> bool:
    """Entries of many lines at once.

    @return False, with nothing done, where none is left or one is not as it should be
    """
    lines = words.lines_ahead(min(count - len(row), _MANY))
    found = b"".join(lines).split()
    if not lines or len(found) != 4 * len(lines) or any(colon != b":" for colon in found[2::4]):
        return False
    try:
        rows, columns = (np.array([int(word) if word.isdigit() else -1 for word in found[k::4]]) for k in (0, 1))
    except (ValueError, OverflowError):
        return False
    values = [number(word) for word in found[3::4]]
    if not ((rows >= 0) & (rows < matrix.rows) & (columns >= 0) & (columns < matrix.columns)).all() or None in values:
        return False
    row += rows.tolist()
    column += columns.tolist()
    value += values
    words.skip_lines(len(lines))
    return True


def _read_sparse(words: Words, matrix: _Matrix, origin: int) -> None:
    count = _sparse_header(words, matrix, origin)
    row, column, value = [], [], []

    def read_entry(of_column: int) -> None:
        words.require_line(f"entry {len(row) + 1} of {count}")
        row.append(words.integer(0, matrix.rows - 1, "a row"))
        column.append(words.integer(0, matrix.columns - 1, "a column") if origin == _TRIPLETS else of_column)
        words.expect(b":")
        value.append(words.number())
        words.expect(b"")
    if origin == _TRIPLETS:
        while _read_many_triplets(words, matrix, count, row, column, value):
            pass
        while len(row) < count:
            read_entry(0)
    else:
        for k in range(matrix.columns):
            words.require_line(f"column {k} of {matrix.columns}")
            words.expect(b"col")
            words.integer(k, k, "the number of a column")
            for word in (b":", b"locations"):
                words.expect(word)
            words.integer(len(row), len(row), "a first location")
            words.expect(b"to")
            last = words.integer(len(row) - 1, count - 1, "a last location")
            words.expect(b"")
            while len(row) <= last:
                read_entry(k)
        if len(row) != count:
            words.reject(f"{count} entries in all columns", len(row))
    matrix.row, matrix.column = np.array(row, dtype=np.int64), np.array(column, dtype=np.int64)
    matrix.value = np.array(value)


def _ends(words: Words, count: int, end: int) -> list[int]:
    """The ends of the rows, or columns, of `count` blocks, of which the last is `end`."""
    ends = [0]
    for k in range(count):
        ends.append(words.integer_of_any_line(end if k + 1 == count else ends[-1], end, "the end of a block"))
    return ends


def _read_blocks(words: Words, matrix: _Matrix) -> None:
    """Blocks that are dense, column by column, with the number of each before it."""
    count = words.integer_of_any_line(0, _MOST, "a number of blocks")
    if count == 0:
        return  # Siconos' files say nothing more of a matrix 0
    block_rows = words.integer_of_any_line(1, _MOST, "a number of rows of blocks")
    block_columns = words.integer_of_any_line(1, _MOST, "a number of columns of blocks")
    row_ends, column_ends = _ends(words, block_rows, matrix.rows), _ends(words, block_columns, matrix.columns)
    starts = words.integer_of_any_line(2, block_rows + 1, "one more than the rows up to the last block,")
    words.integer_of_any_line(count, count, "the number of blocks again")
    first_blocks = []
    for k in range(starts):
        least = 0 if k == 0 else count if k + 1 == starts else first_blocks[-1]
        first_blocks.append(words.integer_of_any_line(least, 0 if k == 0 else count, "the first block of a row"))
    columns = [words.integer_of_any_line(0, block_columns - 1, "the column of a block") for _ in range(count)]
    parts, row = [], 0
    for k, column in enumerate(columns):
        while first_blocks[row + 1] <= k:
            row += 1
        words.integer_of_any_line(k, k, "the number of a block")
        height, width = row_ends[row + 1] - row_ends[row], column_ends[column + 1] - column_ends[column]
        values = words.numbers_of_any_line(height * width, "a block")
        j, i = np.divmod(np.arange(len(values)), max(height, 1))
        parts.append((row_ends[row] + i, column_ends[column] + j, values))
    if parts:
        matrix.row, matrix.column, matrix.value = map(np.concatenate, zip(*parts, strict=True))


def _read_matrix(words: Words, storage: int, rows: int, columns: int) -> _Matrix:
    """What follows storage and shape."""
    matrix = _Matrix(rows, columns)
    if storage == _DENSE:
        words.integer_of_any_line(rows, rows, "a number of rows")
        words.integer_of_any_line(columns, columns, "a number of columns")
        matrix.dense = words.numbers_of_any_line(rows * columns, "a matrix").reshape((rows, columns), order="F")
    elif storage == _BLOCKS:
        _read_blocks(words, matrix)
    elif storage == _SPARSE:
        origin = words.integer_of_any_line(_TRIPLETS, _COLUMNS,
                                           "a sparse form, triplets (1) or compressed columns (2),")
        _read_sparse(words, matrix, origin)
    else:
        words.reject("a matrix of storage 0 (dense), 1 (sparse blocks) or 2 (sparse)", storage)
    return matrix


def _equations(words: Words, equations: int, size: int) -> list[tuple[int, int]]:
    """First and last row + 1 of the blocks of equations: promises until that many rows stand in the file."""
    ends = [words.integer_of_any_line(0, 0, "the first row of the first block")]
    while ends[-1] < size:
        ends.append(words.integer_of_any_line(ends[-1], size, "the first row of the next block"))
    kinds = [words.integer_of_any_line(0, 1, "the kind of a block") for _ in ends[1:]]
    blocks = [(begin, end) for begin, end, kind in zip(ends, ends[1:], kinds, strict=False) if kind == 0]
    count = sum(end - begin for begin, end in blocks)
    if count != equations:
        words.reject(f"blocks of {equations} equations", count)
    return blocks


def _parts(words: Words, n: int, m: int) -> tuple[np.ndarray, np.ndarray]:
    """M = [A C; D B] and q = [a; b], equations first."""
    def read(rows: int, columns: int, name: str) -> np.ndarray:
        return words.numbers_of_any_line(rows * columns, name).reshape(rows, columns)
    A, B, C, D = read(n, n, "A"), read(m, m, "B"), read(n, m, "C"), read(m, n, "D")
    q = np.concatenate([words.numbers_of_any_line(n, "a"), words.numbers_of_any_line(m, "b")])
    return np.block([[A, C], [D, B]]), q


def _require_same(words: Words, matrix: _Matrix, q: np.ndarray, parts: tuple[np.ndarray, np.ndarray], first: int,
                  rows: np.ndarray, columns: np.ndarray) -> None:
    """M and q, and the parts that the file has besides, must agree. What Siconos prints of A, C and a is of n
    equations, whatever M has.

    @param first  row of the parts; the others are those of `rows` of M and q, in their order
    """
    if matrix.dense is not None:
        M = matrix.dense[rows][:, columns]
    else:
        M = matrix.compressed(words.place)[rows][:, columns].toarray()
    of_parts = parts[0][first:, :len(columns)]
    for i, j in np.argwhere(M != of_parts)[:1]:
        words.reject(f"A to b as M and q have them, {M[i, j]:.17g} in row {rows[i]} and column {columns[j]}",
                     f"{of_parts[i, j]:.17g}")
    known = rows < len(q)
    for i in np.flatnonzero(q[rows[known]] != parts[1][first:][known])[:1]:
        row = rows[known][i]
        words.reject(f"A to b as M and q have them, {q[row]:.17g} in row {row}", f"{parts[1][first + i]:.17g}")


def _made_square(matrix: _Matrix, q: np.ndarray, n: int, m: int) -> _Problem:
    """Rows and columns 0 beside the n free unknowns, or below the equations, until there is one equation for each: an
    equation 0 = 0, or an unknown that acts on nothing. Sparse, whatever n is: most of it may be 0."""
    equations = matrix.rows - m
    free = max(equations, n)
    row, column, value = matrix.entries()
    square = _Matrix(free + m, free + m, None, np.where(row < equations, row, row - equations + free),
                     np.where(column < n, column, column - n + free), value)
    made = np.zeros(free + m)
    rows = np.arange(matrix.rows)
    made[np.where(rows < equations, rows, rows - equations + free)] = q[:matrix.rows]
    return square, made, np.arange(free)


def _rectangular(words: Words, matrix: _Matrix, equations: list[tuple[int, int]], has_parts: bool, n: int,
                 m: int) -> _Problem:
    """M has n + m columns and another number of rows: the equations, and the m complementarity rows last. Siconos
    prints n + m numbers of q whatever its rows are; the last m are also b."""
    if matrix.rows < m:
        words.reject(f"a matrix of at least {m} complementarity rows", matrix.rows)
    if any(begin < end and end > n for begin, end in equations):
        words.reject("all equations before all complementarity rows, as M is not square", "another order of blocks")
    q = words.numbers_of_any_line(n + m, "q")
    if matrix.rows > n + m and (not has_parts or matrix.rows - m > n + m):
        words.reject(f"q of {matrix.rows} rows, in q and b together", f"{n + m}{' and b' if has_parts else ''}")
    if has_parts:
        parts = _parts(words, n, m)
        known = min(n + m, matrix.rows)
        _require_same(words, matrix, q, parts, n, np.arange(matrix.rows - m, matrix.rows), np.arange(n + m))
        of_b = parts[1][len(parts[1]) - (matrix.rows - known):] if matrix.rows > known else np.zeros(0)
        q = np.concatenate([q[:known], of_b])
    return _made_square(matrix, q, n, m)


def _mixed(words: Words, has_M: bool, has_parts: bool, n: int, m: int) -> _Problem:
    size = n + m
    if size > _MOST:
        words.reject(f"at most {_MOST} rows", size)
    if not has_M and not has_parts:
        words.reject("M and q, or A to b, or both", "0 0")
    if not has_M:
        dense, q = _parts(words, n, m)
        return _Matrix(size, size, dense), q, np.arange(n)
    equations = _equations(words, n, size)
    storage = words.integer_of_any_line(0, _MOST, "a storage")
    rows = words.integer_of_any_line(0, _MOST - size, "a number of rows")
    words.integer_of_any_line(size, size, "a number of columns")
    matrix = _read_matrix(words, storage, rows, size)
    if rows != size:
        return _rectangular(words, matrix, equations, has_parts, n, m)
    q = words.numbers_of_any_line(size, "q")
    bilateral = np.concatenate([np.arange(0), *(np.arange(begin, end) for begin, end in equations)])
    if has_parts:
        # The row of M for every row of the parts.
        order = np.concatenate([bilateral, np.setdiff1d(np.arange(size), bilateral)])
        _require_same(words, matrix, q, _parts(words, n, m), 0, order, order)
    return matrix, q, bilateral


def _is_global(words: Words, dimension: int, contacts: int, rows: int) -> bool:
    """Behind the first matrix: whether a second one of so many rows follows, and not q, mu and perhaps a number."""
    alone = rows + contacts + 1
    ahead = words.ahead(max(alone + 1, 5))
    if rows == dimension * contacts and (ahead[:1] not in ([b"0"], [b"1"], [b"2"]) or
                                         ahead[1:3] != [b"%d" % rows, b"%d" % (dimension * contacts)]):
        return False
    return (rows != dimension * contacts or ahead[4:5] == [b"CSparse"]
            or (len(ahead) > alone and None not in map(number, ahead)))


def _contacts(words: Words, id: str, head: list[int], tangents: Tangents) -> StoredProblem:
    """Contacts by W, q, mu; or by M, H, q, b, mu: M v = q + H r, u = H^T v + b."""
    dimension, contacts, storage, rows = head
    words.integer_of_any_line(rows, rows, "a number of columns")
    matrix = _read_matrix(words, storage, rows, rows)
    H = None
    if _is_global(words, dimension, contacts, rows):
        storage = words.integer_of_any_line(0, _MOST, "a storage")
        words.integer_of_any_line(rows, rows, "a number of rows")
        columns = words.integer_of_any_line(dimension * contacts, dimension * contacts, "a number of columns")
        masses = inverse_of_diagonal(words.place, rows, *matrix.entries())
        H = _read_matrix(words, storage, rows, columns)
        loads = words.numbers_of_any_line(rows, "q")
    q = words.numbers_of_any_line(dimension * contacts, "q" if H is None else "b")
    mu = words.numbers_of_any_line(contacts, "friction coefficients")
    row, friction = contact_rows(dimension, mu, tangents, words.rejected)
    is_read = row >= 0
    if H is not None:
        body, column, value = H.entries()
        kept = is_read[column]
        _require_end(words, 1)
        factors = row[column[kept]], body[kept], value[kept]
        return global_problem(words.place, id, int(is_read.sum()), factors, masses, loads,
                              q[is_read], friction=friction)
    _require_end(words, 1)
    if matrix.dense is not None:
        A = matrix.dense[is_read][:, is_read]
    else:
        kept = is_read[matrix.row] & is_read[matrix.column]
        size = int(is_read.sum())
        A = sparse(words.place, (size, size), row[matrix.row[kept]], row[matrix.column[kept]], matrix.value[kept])
    return StoredProblem(id=id, b=q[is_read], A=A, friction=friction)


def _require_end(words: Words, most_numbers: int) -> None:
    """Words may follow, and behind an MLCP a known answer, as in Siconos' own collection; more numbers are too many."""
    count = 0
    while (word := words.peek_of_any_line()) and word[:1] in b"0123456789+-.":
        if count == most_numbers:
            words.reject("the end of the file or a remark in words after the last number", word)
        words.numbers_of_any_line(1, "a known answer")
        count += 1


def read(lines: Iterable[bytes], name: str, id: str, *, tangents: Tangents = Tangents.ONE) -> StoredProblem:
    """Dense storage gives a dense problem, sparse storage and sparse blocks a sparse one.

    @param name  for error texts
    """
    words = Words(lines, name)
    head = [words.integer_of_any_line(0, _MOST, "a size, a storage or a flag") for _ in range(4)]
    # LCP: n, storage, n, n. MLCP: flag, flag, n, m. Contacts: rows of each (2 or 3), contacts, storage, rows.
    n, storage, rows, columns = head
    may_be_lcp = rows == columns == n
    following = words.ahead(1)
    # An LCP and an MLCP of one row differ in the next word only: the first row of a block is 0, and no storage has
    # shape 0.
    if n <= 1 and storage <= 1 and (not may_be_lcp or (n == 1 and following == [b"0"])):
        matrix, q, bilateral = _mixed(words, n == 1, storage == 1, rows, columns)
        _require_end(words, rows + 2 * columns)
    elif n in (2, 3) and rows <= _SPARSE and not may_be_lcp and following == [b"%d" % columns]:
        return _contacts(words, id, head, tangents)
    else:
        if not may_be_lcp:
            words.reject(f"a matrix of {n} x {n} entries", f"{rows} x {columns}")
        matrix = _read_matrix(words, storage, n, n)
        q, bilateral = words.numbers_of_any_line(n, "q"), np.zeros(0, dtype=np.int64)
        _require_end(words, 0)
    A = matrix.dense if matrix.dense is not None else matrix.compressed(name)
    return StoredProblem(id=id, b=q, A=A, bilateral=bilateral)


def _matrix_text(problem: StoredProblem) -> list[str]:
    A, n = problem.matrix(), len(problem.b)
    if isinstance(A, np.ndarray):
        columns = (" ".join(f"{value:.17g}" for value in column) for column in A.T.tolist())
        return [str(_DENSE), str(n), str(n), f"{n}\t{n}", *columns]
    row = np.repeat(np.arange(n), np.diff(A.indptr)).tolist()
    entries = (f"    {i} {j} : {value:.17g}"
               for i, j, value in zip(row, A.indices.tolist(), A.data.tolist(), strict=True))
    head = f"triplet: {n}-by-{n}, nzmax: {A.nnz} nnz: {A.nnz}"
    return [str(_SPARSE), str(n), str(n), str(_TRIPLETS), "CSparse", head, *entries]


def write(problem: StoredProblem) -> bytes:
    """An LCP, or where there are bilateral rows an MLCP of M and q alone with its blocks in the order of our rows (some
    of Siconos' MLCP solvers want the equations first). Dense problems as dense matrices, sparse ones as triplets with
    all stored entries: both are read back bit for bit. Of factors the rounded A is written: the format has no place for
    J."""
    refuse_rows(problem, takes_bounded=False)
    n, equations = len(problem.b), len(problem.bilateral)
    lines = [str(n)]
    if equations:
        kinds = np.ones(n, dtype=int)
        kinds[problem.bilateral] = 0
        last = np.flatnonzero(np.r_[kinds[1:] != kinds[:-1], True])
        lines = ["1", "0", str(equations), str(n - equations), " ".join(map(str, [0, *(last + 1)])),
                 "".join(f"{kind} " for kind in kinds[last])]
    lines += [*_matrix_text(problem), *([" ".join(f"{value:.17g}" for value in problem.b.tolist())] if n else [])]
    return ("\n".join(lines) + "\n").encode()
