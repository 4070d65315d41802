"""Formats of import and export: FCLib's HDF5 files, Siconos' text files, and quadratic programs as QPS and npz.

    problems = load("pile.hdf5")        # a list of StoredProblem, plain arrays
    save(problems, "pile.dat")

What a file has that a format, or a problem, does not is refused by a FormatError (a ValueError) of one line: the file,
the line or the field, what was expected, what was found. docs/formats.md describes the formats. `lcpbench convert`,
`solve` and the other commands that take files call this package as a program (__main__.py), which reads every file in a
process of its own, with limits of memory and time; load() has no such limits.

It needs NumPy and SciPy, for HDF5 h5py, and nothing of the package around it.
"""

import gzip
import importlib
import os
import tempfile
import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from .contacts import Tangents
from .problem import FormatError, StoredProblem

__all__ = ["FormatError", "StoredProblem", "load", "save"]


@dataclass(frozen=True)
class _Format:
    name: str
    endings: tuple[str, ...]
    module: str  # imported when it is needed: h5py may be absent
    read: str
    write: str
    is_text: bool  # may be compressed by gzip, with .gz behind the ending
    options: tuple[str, ...] = ()  # that `read` takes

    def function(self, name: str) -> Callable:
        try:
            return getattr(importlib.import_module(f".{self.module}", __name__), name)
        except ImportError as error:
            raise FormatError(f"files of {self.name} need the Python package '{error.name}', which is not installed (Debian: "
                              f"python3-{error.name})") from error


_FORMATS = (
    _Format("hdf5", (".hdf5", ".h5"), "fclib", "read", "write", False, ("fclib_triplets", "tangents")),
    _Format("dat", (".dat",), "siconos", "read", "write", True, ("tangents",)),
    _Format("qps", (".qps", ".mps"), "quadratic", "read_qps", "write_qps", True, ("most_asymmetry",)),
    _Format("npz", (".npz",), "quadratic", "read_npz", "write_npz", False, ("most_asymmetry",)),
)


def format_of(path: Path) -> tuple[_Format, str, bool]:
    """By the ending, whatever its case: the format, the name without it, and whether it is compressed."""
    is_gzip = path.suffix.lower() == ".gz"
    plain = path.with_suffix("") if is_gzip else path
    for one in _FORMATS:
        if plain.suffix.lower() in one.endings:
            if is_gzip and not one.is_text:
                raise FormatError(f"{path}: files of {one.name} are not compressed by gzip, expected a name like {plain.name}")
            return one, os.fsencode(plain.stem).decode(errors="replace"), is_gzip  # a name may be any bytes
    endings = ", ".join(ending for one in _FORMATS for ending in one.endings)
    raise FormatError(f"{path}: expected a name that ends in one of {endings}, of text also with .gz")


def _tangents(box_friction: bool, without_friction: bool) -> Tangents:
    return Tangents.NONE if without_friction else Tangents.BOX if box_friction else Tangents.ONE


def load(path: str | os.PathLike, *, fclib_triplets: str | None = None, box_friction: bool = False,
         without_friction: bool = False, most_asymmetry: float = 0.0) -> list[StoredProblem]:
    """The problems of a file, whose ending tells the format: one of .hdf5, .h5, .dat, .qps, .mps, .npz.

    @param fclib_triplets    what the list p of FCLib's triplets has: "rows-first" (fclib.h), "columns-first" (Siconos);
           None: what the ranges of the indices allow; refused where both fit
    @param box_friction      bounds the force of each tangent of contacts in space, whose friction is that of a disc
    @param without_friction  of contacts the normal rows alone
    @param most_asymmetry    of the matrix of a quadratic program, which is read as it stands: docs/formats.md has the measure
    @raise FormatError  where the file holds no problem of this format
    @raise MemoryError  where the problem does not fit into memory
    """
    path = Path(path)
    one, id, is_gzip = format_of(path)
    if fclib_triplets not in (None, "rows-first", "columns-first"):
        raise FormatError(f"fclib_triplets: expected rows-first, columns-first or None, found {fclib_triplets!r}")
    options = {"fclib_triplets": fclib_triplets, "tangents": _tangents(box_friction, without_friction),
               "most_asymmetry": most_asymmetry}
    options = {name: value for name, value in options.items() if name in one.options}
    read = one.function(one.read)
    try:
        if not one.is_text:
            return [read(path, id, **options)]
        with path.open("rb") as file:
            is_packed = file.peek(2)[:2] == b"\x1f\x8b"  # whatever its name
            return [read(gzip.GzipFile(fileobj=file) if is_packed else file, str(path), id, **options)]
    except (gzip.BadGzipFile, EOFError, zlib.error) as error:
        raise FormatError(f"{path}: damaged or incomplete gzip data: {error}") from error
    except OSError as error:
        raise FormatError(f"{path}: cannot be opened: {error.strerror}") from error


def to_bytes(problem: StoredProblem, name: str) -> bytes:
    """The file of a problem. @param name  of the format: hdf5, dat, qps or npz"""
    one = next(one for one in _FORMATS if one.name == name)
    return one.function(one.write)(problem)


def save(problems: StoredProblem | Sequence[StoredProblem], path: str | os.PathLike) -> None:
    """Writes a file of one problem; its ending tells the format. A file of this name is replaced when the new one is whole.

    @raise FormatError  where the format cannot hold the problem; OSError where the file cannot be written
    """
    path = Path(path)
    one, _, is_gzip = format_of(path)
    problems = [problems] if isinstance(problems, StoredProblem) else list(problems)
    if len(problems) != 1:
        raise FormatError(f"{path}: expected one problem, as files of {one.name} hold one, found {len(problems)}")
    content = to_bytes(problems[0], one.name)
    content = gzip.compress(content, mtime=0) if is_gzip else content
    target = path.resolve()
    descriptor, beside = tempfile.mkstemp(prefix=".lcpbench-", dir=target.parent)
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(content)
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(beside, target.stat().st_mode & 0o7777 if target.exists() else 0o666 & ~mask)
        os.replace(beside, target)
    except BaseException:
        os.unlink(beside)
        raise
