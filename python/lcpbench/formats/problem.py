"""A problem as plain arrays, and what readers and writers of all formats share."""

import json
import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import csr_array

_CHUNK = 1 << 16  # numbers that become text at a time


class FormatError(ValueError):
    """A file, or a problem, that does not fit a format: one line that begins with the place, fit for a terminal."""

    def __init__(self, message: str):
        super().__init__("".join(c if c.isprintable() else repr(c)[1:-1] for c in message))


def mismatch(place: str, expected: str, found: object) -> FormatError:
    """The error of a place (file and line, or file and field, or problem) that has something else than expected."""
    return FormatError(f"{place}: expected {expected}, found {found}")


@dataclass
class StoredProblem:
    """w = A f + b, as a file has it: A, or J (n x m) with m inverse masses and A = J diag(inverse_mass) J^T.

    Unilateral rows: f >= 0, w >= 0, f w = 0; bilateral rows: w = 0, f free; friction and bounded rows as
    docs/friction.md section 1 has them.
    """

    id: str
    b: np.ndarray  # n
    A: np.ndarray | csr_array | None = None  # n x n; beside J its rounded product, or None
    J: csr_array | None = None
    inverse_mass: np.ndarray | None = None
    bilateral: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))  # indices of rows
    friction: dict[str, np.ndarray] | None = None  # row, normal, mu, and slip where rows slide
    bounded: dict[str, np.ndarray] | None = None  # row, lower, upper, which may be infinite
    f: np.ndarray | None = None  # forces that the file gives as the answer; judged by nobody
    provenance: str = ""  # what the file says of itself

    @property
    def place(self) -> str:
        return f"problem '{self.id}'"

    def matrix(self) -> np.ndarray | csr_array:
        """A; of factors their rounded product, symmetric bit for bit. @raise FormatError where that overflows"""
        if self.A is None:
            with np.errstate(over="ignore", invalid="ignore"):
                product = csr_array((self.J * self.inverse_mass[np.newaxis, :]).tocsr() @ self.J.T)
            product.sort_indices()
            row = np.repeat(np.arange(product.shape[0]), np.diff(product.indptr))
            lower = row >= product.indices
            i, j, x = row[lower], product.indices[lower], product.data[lower]
            if np.isfinite(x).all():
                below = i != j
                self.A = sparse(self.place, product.shape, np.r_[i, j[below]], np.r_[j, i[below]], np.r_[x, x[below]])
        if self.A is None or (self.J is not None and not np.isfinite(self.A.data).all()):
            raise mismatch(self.place, "factors whose product is finite", "an overflow")
        return self.A

    def entries(self) -> csr_array:
        """A as compressed rows."""
        return csr_array(self.matrix())


def summed(row: np.ndarray, column: np.ndarray, value: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Entries by row, then column; those of one place added up in the order in which they stand."""
    order = np.lexsort((column, row))
    row, column, value = row[order], column[order], value[order]
    is_first = np.ones(len(row), dtype=bool)
    is_first[1:] = (row[1:] != row[:-1]) | (column[1:] != column[:-1])
    if is_first.all():
        return row, column, value
    sums = value[is_first]
    with np.errstate(over="ignore", invalid="ignore"):
        np.add.at(sums, (np.cumsum(is_first) - 1)[~is_first], value[~is_first])
    return row[is_first], column[is_first], sums


def sparse(place: str, shape: tuple[int, int], row: np.ndarray, column: np.ndarray, value: np.ndarray) -> csr_array:
    """Compressed rows. Memory is in proportion to rows and entries. @raise FormatError where a sum overflows"""
    row, column, value = summed(row, column, value)
    if not np.isfinite(value).all():
        raise mismatch(place, "entries of one place whose sum is finite", "an overflow")
    starts = np.zeros(shape[0] + 1, dtype=np.int64)
    np.cumsum(np.bincount(row, minlength=shape[0]), out=starts[1:])
    return csr_array((value, column, starts), shape=shape)


def refuse_rows(problem: StoredProblem, *, takes_bounded: bool) -> None:
    """What writers call whose format has no place for friction rows, or for bounded ones either."""
    told = f"{problem.place} has %s rows, which the format has no place for; expected JSON lines"
    if problem.friction is not None:
        raise FormatError(told % "friction" + ", FCLib, or --without-friction, which drops them")
    if problem.bounded is not None and not takes_bounded:
        raise FormatError(told % "bounded")


def _list(values: np.ndarray) -> Iterator[str]:
    """Shortest digits that read back to the same bits; null for infinite bounds."""
    is_finite = values.dtype.kind != "f" or bool(np.isfinite(values).all())
    text = repr if is_finite else lambda value: repr(value) if math.isfinite(value) else "null"
    yield "["
    for begin in range(0, len(values), _CHUNK):
        yield ("," if begin else "") + ",".join(map(text, values[begin:begin + _CHUNK].tolist()))
    yield "]"


def _object(members: dict[str, np.ndarray]) -> Iterator[str]:
    for k, (name, values) in enumerate(members.items()):
        yield f'{"," if k else "{"}"{name}":'
        yield from _list(values)
    yield "}"


def _matrix(matrix: np.ndarray | csr_array) -> Iterator[str]:
    if isinstance(matrix, np.ndarray):
        for k, row in enumerate(matrix):
            yield "," if k else "["
            yield from _list(row)
        yield "]" if len(matrix) else "[]"
        return
    row = np.repeat(np.arange(matrix.shape[0]), np.diff(matrix.indptr))
    yield from _object({"shape": np.array(matrix.shape), "row": row, "col": matrix.indices, "val": matrix.data})


def json_pieces(problem: StoredProblem) -> Iterator[str]:
    """A line of docs/formats/problem.schema.json, bit for bit, in pieces: it may be long."""
    yield f'{{"id":{json.dumps(problem.id)},"b":'
    yield from _list(problem.b)
    if problem.J is None:
        yield ',"A":'
        yield from _matrix(problem.A)
    else:
        yield ',"J":'
        yield from _matrix(problem.J)
        yield ',"invM":'
        yield from _list(problem.inverse_mass)
    yield ',"bilateral":'
    yield from _list(problem.bilateral)
    for name, rows in (("friction", problem.friction), ("bounded", problem.bounded)):
        if rows is not None:
            yield f',"{name}":'
            yield from _object(rows)
    yield "}"


def _reals(values: list, missing: float = math.inf) -> np.ndarray:
    return np.array([missing if value is None else value for value in values], dtype=float)


def _matrix_of(matrix: dict | list) -> np.ndarray | csr_array:
    if isinstance(matrix, list):
        return np.array(matrix, dtype=float).reshape(len(matrix), len(matrix))
    starts = np.searchsorted(np.array(matrix["row"], dtype=np.int64), np.arange(matrix["shape"][0] + 1))
    return csr_array((_reals(matrix["val"]), np.array(matrix["col"], dtype=np.int64), starts), shape=matrix["shape"])


def from_record(record: dict) -> StoredProblem:
    """A problem of JSON as json_pieces() and the command write it: sparse matrices by coordinates in order; A also beside
    J."""
    friction, bounded = record.get("friction"), record.get("bounded")
    return StoredProblem(
        id=record["id"], b=_reals(record["b"]), A=_matrix_of(record["A"]) if "A" in record else None,
        J=_matrix_of(record["J"]) if "J" in record else None,
        inverse_mass=_reals(record["invM"]) if "J" in record else None,
        bilateral=np.array(record["bilateral"], dtype=np.int64),
        friction={key: np.array(values) for key, values in friction.items()} if friction else None,
        bounded={"row": np.array(bounded["row"]), "lower": _reals(bounded["lower"], -math.inf),
                 "upper": _reals(bounded["upper"])} if bounded else None)
