"""The quadratic program whose optimality conditions are the LCP of a symmetric positive semidefinite A,

    minimize 1/2 f^T A f + b^T f,   f_i >= 0 on unilateral rows, free on bilateral ones, in the bounds of bounded ones,

as a QPS file [Maros, Meszaros, A repository of convex quadratic programming problems, 1999] and as the npz file that
qpsolvers' Problem.save writes. Programs with constraints other than bounds are refused: they are no LCP of this form.
"""

import codecs
import io
import pickle
import pickletools
import zipfile
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
from numpy.lib import format as npy
from scipy.sparse import coo_array, csr_array

from .problem import FormatError, StoredProblem, mismatch, refuse_rows, sparse
from .words import Words, number

_MOST_NPZ_ROWS = 23_000  # 4 GB of P, the most that zip has without extensions
_INFINITE = 1e20  # bounds of this size and beyond
_ABSENT = "GhAb"  # constraints
_NUMBERS = "integers, truth values or IEEE numbers of at most 64 bits"
_OF_SAVE_NPZ = {"format", "shape", "data"}  # of scipy.sparse.save_npz, whatever the format
_EXACT = 2.0**53  # integers up to it are doubles
codecs.lookup("cp437")  # of names in archives: a process that reads can import nothing more


def with_infinities(bounds: np.ndarray) -> np.ndarray:
    """Bounds of 1e20 and beyond are infinite, for which programs' tools have no other word."""
    return np.where(np.abs(bounds) >= _INFINITE, np.copysign(np.inf, bounds), bounds)


def _require_qp(problem: StoredProblem) -> None:
    refuse_rows(problem, takes_bounded=True)
    bounds = np.concatenate(_bounds(problem))
    for bound in bounds[bounds != with_infinities(bounds)][:1]:
        raise mismatch(problem.place, f"bounds below {_INFINITE:g}, from which on they are infinite; JSON lines have larger ones", float(bound))
    if problem.J is None:
        _require_symmetry(problem.place, problem.matrix(), 0.0)


def _require_symmetry(place: str, A: np.ndarray | csr_array, most: float) -> None:
    """@param most  of the asymmetry as docs/formats.md has it"""
    diagonal = np.sqrt(np.abs(A.diagonal()))
    with np.errstate(over="ignore"):
        difference = coo_array(A - A.T)
        scale = diagonal[difference.row] * diagonal[difference.col]
        asymmetry = np.max(np.abs(difference.data) / np.where(scale > 0, scale, 1.0), initial=0.0)
    if asymmetry > most:
        raise mismatch(place, "a symmetric matrix, as that of a QP is", f"an asymmetry of {asymmetry:.17g}; --symmetrize makes a small one 0")


def _bounds(problem: StoredProblem) -> tuple[np.ndarray, np.ndarray]:
    lower, upper = np.zeros(len(problem.b)), np.full(len(problem.b), np.inf)
    lower[problem.bilateral] = -np.inf
    if problem.bounded is not None:
        lower[problem.bounded["row"]], upper[problem.bounded["row"]] = problem.bounded["lower"], problem.bounded["upper"]
    return lower, upper


def _problem(place: str, id: str, A: np.ndarray | csr_array, b: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> StoredProblem:
    """A program's bounds are kinds of rows."""
    lower, upper = with_infinities(lower), with_infinities(upper)
    for k in np.flatnonzero((lower > upper) | (lower == np.inf) | (upper == -np.inf))[:1]:
        raise mismatch(place, "bounds with a number between them", f"{float(lower[k])} and {float(upper[k])} of variable {k + 1}")
    is_above_free = upper == np.inf
    is_bilateral = is_above_free & (lower == -np.inf)
    bounded = np.flatnonzero(~(is_bilateral | (is_above_free & (lower == 0))))
    laws = {"row": bounded, "lower": lower[bounded], "upper": upper[bounded]} if bounded.size else None
    return StoredProblem(id=id, b=b, A=A, bilateral=np.flatnonzero(is_bilateral), bounded=laws)


def write_qps(problem: StoredProblem) -> bytes:
    """Columns f1 to fn, b in the objective row, the lower triangle of A without zeros in QUADOBJ, FR for bilateral rows,
    LO or MI and UP for bounded ones. Free format: numbers have 17 significant digits, which read back to the same bits,
    and names no spaces."""
    _require_qp(problem)
    A, n = problem.entries(), len(problem.b)
    name = "".join(c if "!" <= c <= "~" else "_" * len(c.encode()) for c in problem.id) or "_"
    lines = [f"NAME {name}", "ROWS", " N obj", "COLUMNS"]
    lines += [f" f{i + 1} obj {value:.17g}" for i, value in enumerate(problem.b.tolist())]
    lines.append("RHS")
    if len(problem.bilateral) or problem.bounded is not None:
        lines.append("BOUNDS")
    lines += [f" FR bounds f{i + 1}" for i in problem.bilateral.tolist()]
    if problem.bounded is not None:
        for row, lower, upper in zip(*(problem.bounded[key].tolist() for key in ("row", "lower", "upper")), strict=True):
            lines.append(f" LO bounds f{row + 1} {lower:.17g}" if np.isfinite(lower) else f" MI bounds f{row + 1}")
            if np.isfinite(upper):
                lines.append(f" UP bounds f{row + 1} {upper:.17g}")
    lines.append("QUADOBJ")
    row = np.repeat(np.arange(n), np.diff(A.indptr))
    kept = (A.indices >= row) & (A.data != 0)
    lines += [f" f{i + 1} f{j + 1} {value:.17g}" for i, j, value in zip(row[kept].tolist(), A.indices[kept].tolist(), A.data[kept].tolist(),
                                                                      strict=True)]
    return ("\n".join([*lines, "ENDATA"]) + "\n").encode()


class _Qps:
    """A program as it is read, section by section."""

    _CONSTRAINTS = "no constraints but bounds, as an LCP has none"

    def __init__(self, words: Words, id: str, most_asymmetry: float):
        self._words = words
        self._id = id
        self._most_asymmetry = most_asymmetry
        self._rows: dict[bytes, int] = {}  # the objective, and free ones that mean nothing
        self._columns: dict[bytes, int] = {}
        self._b: list[float] = []
        self._bounds: dict[int, tuple[float, float]] = {}
        self._bound_set: bytes | None = None  # the first; b"" where sets have no names
        self._entries: list[tuple[int, int, float]] = []

    def read(self) -> StoredProblem:
        sections = {b"NAME": None, b"OBJSENSE": self._sense, b"ROWS": self._row, b"COLUMNS": self._column,
                    b"RHS": self._right_side, b"RANGES": None, b"BOUNDS": self._bound, b"QUADOBJ": self._quadratic,
                    b"QMATRIX": self._quadratic}
        words, section, seen = self._words, b"", set()
        while words.next_line():
            line = words.line.split()
            if not line or words.line.startswith(b"*"):
                continue
            if words.line[:1].isspace():
                if sections.get(section) is None:
                    words.reject(self._CONSTRAINTS if section == b"RANGES" else "a section", words.line.strip())
                sections[section](line)
                continue
            section = line[0]
            if section == b"ENDATA":
                return self._problem(b"QMATRIX" not in seen)
            if section not in sections:
                words.reject(f"a section {', '.join(map(bytes.decode, sections))} or ENDATA", section)
            if section in seen or section in (b"QUADOBJ", b"QMATRIX") and seen & {b"QUADOBJ", b"QMATRIX"}:
                words.reject("every section once", section)
            seen.add(section)
            if section == b"OBJSENSE" and line[1:]:
                self._sense(line[1:])
        words.reject_end("ENDATA")

    def _sense(self, line: list[bytes]) -> None:
        if len(line) != 1 or line[0].upper() not in (b"MIN", b"MINIMIZE"):
            self._words.reject("MIN or MINIMIZE, as an LCP is that of a least value", b" ".join(line))

    def _row(self, line: list[bytes]) -> None:
        if len(line) != 2 or line[0] != b"N":
            self._words.reject(f"rows N, of which the first is the objective, and {self._CONSTRAINTS}", b" ".join(line))
        if line[1] in self._rows:
            self._words.reject("every row once", line[1])
        self._rows[line[1]] = len(self._rows)

    def _values(self, line: list[bytes]) -> float:
        """The sum of those of the objective, of pairs of a row and a value."""
        total = 0.0
        for row, value in zip(line[::2], line[1::2], strict=True):
            if row not in self._rows:
                self._words.reject("a row of the section ROWS", row)
            total += self._words.number(value) if self._rows[row] == 0 else 0.0
        return total

    def _new_column(self, name: bytes) -> int:
        self._b.append(0.0)
        return self._columns.setdefault(name, len(self._b) - 1)

    def _column(self, line: list[bytes]) -> None:
        if len(line) < 3 or len(line) % 2 == 0:
            self._words.reject("a column, and rows with their values", b" ".join(line))
        index = self._columns[line[0]] if line[0] in self._columns else self._new_column(line[0])
        if index != len(self._b) - 1:
            self._words.reject("all entries of a column together", line[0])
        self._b[index] += self._values(line[1:])

    def _right_side(self, line: list[bytes]) -> None:
        """Constants of rows N, which change no solution."""
        self._values(line[len(line) % 2:])

    def _is_value(self, word: bytes) -> bool:
        return word not in self._columns and number(word) is not None

    def _bound(self, line: list[bytes]) -> None:
        """Of the first set. A column without cost may stand here for the first time."""
        kind, rest = line[0], line[1:]
        has_value = kind in (b"LO", b"UP", b"FX")
        if not has_value and kind not in (b"FR", b"MI", b"PL"):
            self._words.reject("a bound LO, UP, FX, FR, MI or PL", kind)
        form = "a bound's kind, set, column" + (" and value" if has_value else "")
        if not 1 + has_value <= len(rest) <= 3:
            self._words.reject(form, b" ".join(line))
        value = 0.0
        if has_value:
            value = self._words.number(rest.pop())
        elif len(rest) == 3 or (rest[0] in self._columns and self._is_value(rest[-1])):
            rest.pop()  # means nothing
        if self._is_value(rest[-1]):
            self._words.reject(form, b" ".join(line))
        name = rest[0] if len(rest) == 2 else b""
        self._bound_set = name if self._bound_set is None else self._bound_set
        if bool(name) != bool(self._bound_set):
            self._words.reject("the name of a set in every bound, or in none", b" ".join(line))
        if name == self._bound_set:
            self._set_bound(kind, self._columns[rest[-1]] if rest[-1] in self._columns else self._new_column(rest[-1]), value)

    def _set_bound(self, kind: bytes, index: int, value: float) -> None:
        lower, upper = self._bounds.get(index, (0.0, np.inf))
        if kind == b"UP" and value < 0 and lower == 0:
            self._words.reject("a lower bound before an upper one below 0", self._words.line.strip())
        self._bounds[index] = {b"LO": (value, upper), b"UP": (lower, value), b"FX": (value, value), b"FR": (-np.inf, np.inf),
                               b"MI": (-np.inf, upper), b"PL": (lower, np.inf)}[kind]

    def _index(self, name: bytes) -> int:
        index = self._columns.get(name)
        return self._words.reject("a column of the sections COLUMNS or BOUNDS", name) if index is None else index

    def _quadratic(self, line: list[bytes]) -> None:
        if len(line) < 3 or len(line) % 2 == 0:
            self._words.reject("a column, and columns with their values", b" ".join(line))
        for other, value in zip(line[1::2], line[2::2], strict=True):
            self._entries.append((self._index(line[0]), self._index(other), self._words.number(value)))

    def _problem(self, is_triangle: bool) -> StoredProblem:
        n = len(self._b)
        row, column, value = (np.array([entry[k] for entry in self._entries], dtype=kind) for k, kind in enumerate((int, int, float)))
        if is_triangle:  # of a pair either entry
            other = row != column
            row, column, value = np.r_[row, column[other]], np.r_[column, row[other]], np.r_[value, value[other]]
            places, names = np.sort(row * n + column), list(self._columns)
            for twice in places[1:][places[1:] == places[:-1]][:1]:
                self._words.reject("every pair of columns once in QUADOBJ", names[twice // n] + b" " + names[twice % n])
        A = sparse(self._words.place, (n, n), row, column, value)
        _require_symmetry(self._words.place, A, self._most_asymmetry)
        lower, upper = np.zeros(n), np.full(n, np.inf)
        for index, (low, high) in self._bounds.items():
            lower[index], upper[index] = low, high
        b = np.array(self._b)
        if not np.isfinite(b).all():
            self._words.reject("entries of one place whose sum is finite", "an overflow")
        return _problem(self._words.place, self._id, A, b, lower, upper)


def read_qps(lines: Iterable[bytes], name: str, id: str, most_asymmetry: float = 0.0) -> StoredProblem:
    """Free format: no spaces in names. The problem is sparse. Rows N behind the first, sets of bounds behind the first and
    a number that a kind of bound does not use mean nothing, as for other readers. An upper bound below 0 beside no lower
    one is refused, as programs take it for different things."""
    return _Qps(Words(lines, name), id, most_asymmetry).read()


def _instructions(pickled: bytes) -> list[tuple]:
    """Of a pickle, without running it and without its length; numpy's core has had two names."""
    return [(code.name, argument.replace("numpy._core", "numpy.core") if isinstance(argument, str) else argument)
            for code, argument, _ in pickletools.genops(pickled) if code.name != "FRAME"]


# None alone, as files of ours have it, and as an array without dimensions, as numpy writes it: before 2.4 by protocol 3.
_NOTHING = [_instructions(pickle.dumps(nothing, protocol))
            for protocol in (3, 4) for nothing in (None, np.array(None, dtype=object))]


class _Archive:
    """The arrays of an npz file. Memory is in proportion to what the file unpacks to, whatever it promises."""

    def __init__(self, path: Path):
        self._path = path
        try:
            self._zip = zipfile.ZipFile(path)
        except (zipfile.BadZipFile, NotImplementedError, ValueError, EOFError) as error:
            raise mismatch(str(path), "an npz file (zip)", f"one that cannot be unpacked: {error}") from error

    def require_program(self) -> None:
        """@raise FormatError  for the file of a sparse matrix alone"""
        if _OF_SAVE_NPZ <= {name.removesuffix(".npy") for name in self._zip.namelist()}:
            raise mismatch(str(self._path), "the arrays P and q of a program", "a matrix, as scipy.sparse.save_npz writes it")

    def mismatch(self, name: str, expected: str, found: object) -> FormatError:
        return mismatch(f"{self._path}: {name}", expected, found)

    def array(self, name: str, dimensions: int) -> np.ndarray | None:
        """Doubles; None where there is no such array, or None in the file."""
        names = [found for found in self._zip.namelist() if found == f"{name}.npy"]
        if not names:
            return None
        if len(names) > 1:
            raise self.mismatch(name, "every array once", len(names))
        try:
            with self._zip.open(names[0]) as member:
                return self._read(member, name, dimensions)
        except FormatError:
            raise
        except Exception as error:  # zipfile, zlib, lzma, bz2 and numpy have one each for damaged data
            raise self.mismatch(name, "an array that numpy can read", f"one that it refuses: {error}") from error

    def _read(self, member: zipfile.ZipExtFile, name: str, dimensions: int) -> np.ndarray | None:
        version = npy.read_magic(member)
        if version not in ((1, 0), (2, 0)):
            raise self.mismatch(name, "an array of numpy's format 1.0 or 2.0", ".".join(map(str, version)))
        shape, by_columns, dtype = (npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0)(member)
        if dtype.hasobject:
            if shape == () and _instructions(member.read(1 << 16)) in _NOTHING:
                return None
            raise self.mismatch(name, f"{_NUMBERS}, or None", "other objects of Python, which are not unpickled")
        if dtype.kind not in "biuf" or dtype.itemsize > 8:
            raise self.mismatch(name, _NUMBERS, dtype)
        if len(shape) != dimensions or min(shape) < 0:
            raise self.mismatch(name, f"{dimensions} dimensions", shape)
        count = int(np.prod([int(length) for length in shape], dtype=object))
        parts, left = [], count * dtype.itemsize
        while left > 0:  # by pieces: a size may be a promise
            part = member.read(min(left, 1 << 24))
            if not part:
                raise self.mismatch(name, f"{count} numbers", count - -(-left // dtype.itemsize))
            parts.append(part)
            left -= len(part)
        if member.read(1):
            raise self.mismatch(name, f"{count} numbers", "more")
        found = np.frombuffer(b"".join(parts), dtype=dtype)
        values = found.astype(np.float64)
        if dtype.kind in "iu":
            is_large = np.abs(values) >= _EXACT
            for value in [value for value in found[is_large].tolist() if int(float(value)) != value][:1]:
                raise self.mismatch(name, "integers that are exact in doubles", value)
        return values.reshape(shape, order="F" if by_columns else "C")

    def reals(self, name: str, shape: tuple[int, ...] | None, may_be_infinite: bool = False) -> np.ndarray | None:
        values = self.array(name, 2 if name == "P" else 1)
        if values is None:
            return None
        if shape is not None and values.shape != shape:
            raise self.mismatch(name, " x ".join(map(str, shape)) + " numbers", " x ".join(map(str, values.shape)))
        if np.isnan(values).any() or not (may_be_infinite or np.isfinite(values).all()):
            raise self.mismatch(name, "numbers" if may_be_infinite else "finite numbers", "others")
        return values


def read_npz(path: Path, id: str, most_asymmetry: float = 0.0) -> StoredProblem:
    """The problem is dense. Where there are no lower bounds, or no upper ones, they are infinite, as for qpsolvers."""
    archive = _Archive(path)
    archive.require_program()
    q = archive.reals("q", None)
    if q is None:
        raise archive.mismatch("q", "an array of numbers", "none")
    n = len(q)
    P = archive.reals("P", (n, n))
    if P is None:
        raise archive.mismatch("P", "an array of numbers", "none")
    _require_symmetry(f"{path}: P", P, most_asymmetry)
    for name in _ABSENT:
        if archive.array(name, 2 if name in "GA" else 1) is not None:
            raise archive.mismatch(name, "None, as an LCP has no constraints but bounds", "an array")
    lower, upper = archive.reals("lb", (n,), True), archive.reals("ub", (n,), True)
    return _problem(str(path), id, P, q, np.full(n, -np.inf) if lower is None else lower, np.full(n, np.inf) if upper is None else upper)


def write_npz(problem: StoredProblem) -> bytes:
    """Arrays of 64-bit numbers P (n x n, dense), q (n), lb (n: 0 on unilateral rows, -inf on bilateral ones, bounds of
    bounded ones), where there are bounded rows ub (n), else None as G, h, A and b are, as Problem.save of qpsolvers 2 and
    later writes it: an array of Python's objects, which numpy.load reads with allow_pickle only and Problem.load takes
    for "not there". The same problem gives the same bytes."""
    _require_qp(problem)
    if len(problem.b) > _MOST_NPZ_ROWS:
        raise mismatch(problem.place, f"at most {_MOST_NPZ_ROWS} rows, for the 4 GB of the format", len(problem.b))
    A = problem.matrix()
    lower, upper = _bounds(problem)
    arrays = {"P": A if isinstance(A, np.ndarray) else A.toarray(), "q": problem.b, **dict.fromkeys(_ABSENT), "lb": lower,
              "ub": None if problem.bounded is None else upper}
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        for name, values in arrays.items():
            info = zipfile.ZipInfo(f"{name}.npy")  # of no time
            info.compress_type = zipfile.ZIP_DEFLATED
            with archive.open(info, "w", force_zip64=True) as member:
                npy.write_array(member, np.array(values, dtype=object if values is None else np.float64))
    return stream.getvalue()
