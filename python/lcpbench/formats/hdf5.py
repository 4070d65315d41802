"""Datasets of an HDF5 file that may be hostile: what they promise is compared with what the file holds before it is read.

Refused are datasets of other types and ranks, in chunks, compressed, virtual or stored in other files, links that are
not hard, and values that the file does not hold or that several datasets share. libhdf5 itself crashes on some files:
program.py reads each in a process of its own, with limits.
"""

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py
import numpy as np
from h5py import h5d, h5f, h5l, h5o, h5p, h5s, h5t

from .problem import FormatError, mismatch

_LONGEST_LIST = 300  # of names in a refusal
_TYPES = {
    "32-bit integers": (np.int32, (h5t.STD_I32LE, h5t.STD_I32BE)),
    "64-bit IEEE numbers": (np.float64, (h5t.IEEE_F64LE, h5t.IEEE_F64BE)),
    "a text of fixed length": (np.bytes_, ()),
}


def _is_of_type(found: h5t.TypeID, expected: str) -> bool:
    if expected == "a text of fixed length":
        return found.get_class() == h5t.STRING and not found.is_variable_str()
    return any(found.equal(one) for one in _TYPES[expected][1])


class Datasets:
    """The datasets of one file by their paths, each read once."""

    def __init__(self, path: Path):
        self._path = path
        status = os.stat(path)
        if not stat.S_ISREG(status.st_mode):
            raise FormatError(f"{path}: not a regular file")
        self.file_size = self._left = status.st_size
        with self._libhdf5(str(path), "an HDF5 file"):
            self._file = h5f.open(os.fsencode(path), h5f.ACC_RDONLY)
        self._read = {}

    def mismatch(self, name: str, expected: str, found: object) -> FormatError:
        return mismatch(f"{self._path}: {name}", expected, found)

    @contextmanager
    def _libhdf5(self, place: str, expected: str) -> Iterator[None]:
        """h5py has an exception of its own for every kind of failure of libhdf5."""
        try:
            yield
        except (FormatError, MemoryError):
            raise
        except Exception as error:
            raise mismatch(place, f"{expected} that libhdf5 can read", "one that it refuses") from error

    def has(self, name: str) -> bool:
        """Whether there is such an object; only hard links lead to it."""
        parts = name.strip("/").split("/")
        for k in range(len(parts)):
            part = "/" + "/".join(parts[:k + 1])
            with self._libhdf5(f"{self._path}: {part}", "a link"):
                if not self._file.links.exists(part.encode()):
                    return False
                if self._file.links.get_info(part.encode()).type != h5l.TYPE_HARD:
                    raise self.mismatch(part, "a hard link", "another")
                is_group = h5o.get_info(self._file, part.encode()).type == h5o.TYPE_GROUP
            if k + 1 < len(parts) and not is_group:
                raise self.mismatch(part, "a group", "another object")
        return True

    def require_one_of(self, groups: list[str]) -> None:
        if any(self.has(group) for group in groups):
            return
        with self._libhdf5(str(self._path), "a file"):
            found = ", ".join(name.decode(errors="replace") for name in self._names()) or "nothing"
        expected = " or ".join(("a group " if k == 0 else "") + group.strip("/") for k, group in enumerate(groups))
        raise mismatch(str(self._path), expected, found if len(found) <= _LONGEST_LIST else found[:_LONGEST_LIST - 3] + "...")

    def _names(self) -> list[bytes]:
        names = []

        def add(name: bytes) -> bool | None:
            names.append(name)
            return True if sum(map(len, names)) > _LONGEST_LIST else None
        self._file.links.iterate(add)
        return names

    def text(self, name: str) -> str:
        value = self._values(name, "a text of fixed length")
        if len(value) != 1:
            raise self.mismatch(name, "a dataset of a text of fixed length", f"{len(value)} texts")
        return bytes(value[0]).split(b"\0")[0].decode(errors="replace")

    def integers(self, name: str, count: int | None = None) -> np.ndarray:
        return self._counted(name, self._values(name, "32-bit integers"), count)

    def integer(self, name: str, least: int, most: int) -> int:
        values, expected = self.integers(name), f"one number from {least} to {most}"
        if len(values) != 1:
            raise self.mismatch(name, expected, f"{len(values)} numbers")
        if not least <= values[0] <= most:
            raise self.mismatch(name, expected, values[0])
        return int(values[0])

    def reals(self, name: str, count: int | None = None) -> np.ndarray:
        """Finite numbers, as many as `count` says. A list that was created and never written is empty."""
        values = self._values(name, "64-bit IEEE numbers")
        for k in np.flatnonzero(~np.isfinite(values))[:1]:
            raise self.mismatch(name, "finite numbers", f"{float(values[k])} at {k}")
        return self._counted(name, values, count)

    def _counted(self, name: str, values: np.ndarray, count: int | None) -> np.ndarray:
        if count is not None and len(values) != count:
            raise self.mismatch(name, f"{count} numbers", len(values))
        return values

    def _values(self, name: str, expected: str) -> np.ndarray:
        if name not in self._read:
            if not self.has(name):
                what = {"32-bit integers": "integers", "64-bit IEEE numbers": "numbers"}.get(expected, expected)
                raise self.mismatch(name, f"a dataset of {what}", "none")
            with self._libhdf5(f"{self._path}: {name}", f"a dataset of {expected}"):
                self._read[name] = self._read_dataset(name, expected)
        return self._read[name]

    def _read_dataset(self, name: str, expected: str) -> np.ndarray:
        if h5o.get_info(self._file, name.encode()).type != h5o.TYPE_DATASET:
            raise self.mismatch(name, f"a dataset of {expected}", "another object")
        dataset = h5d.open(self._file, name.encode())
        self._require_stored_here(dataset, name)
        found = dataset.get_type()
        if not _is_of_type(found, expected):
            raise self.mismatch(name, f"a dataset of {expected}", "another type")
        count = self._count(dataset, found.get_size(), name)
        size = count * found.get_size()
        if size > self._left:
            raise self.mismatch(name, "values that no other dataset shares", "shared ones")
        self._left -= size
        dtype = np.dtype((np.bytes_, found.get_size())) if expected == "a text of fixed length" else np.dtype(_TYPES[expected][0])
        values = np.empty(count, dtype=dtype)
        if count:
            dataset.read(h5s.ALL, h5s.ALL, values, found if dtype.kind == "S" else None)
        return values

    def _require_stored_here(self, dataset: h5d.DatasetID, name: str) -> None:
        """Before the dataspace is asked for: that of a virtual dataset opens other files."""
        properties = dataset.get_create_plist()
        if properties.get_layout() not in (h5d.CONTIGUOUS, h5d.COMPACT) or properties.get_nfilters() != 0:
            raise self.mismatch(name, "values in one piece as fclib writes them", "chunks, filters or other datasets")
        if properties.get_external_count() != 0:
            raise self.mismatch(name, "values in the file itself", "names of other files")

    def _count(self, dataset: h5d.DatasetID, value_size: int, name: str) -> int:
        """The number of values, which the file really holds: 0 where they were promised and never written."""
        space = dataset.get_space()
        rank = space.get_simple_extent_ndims()
        if rank not in (0, 1) or space.get_simple_extent_type() == h5s.NULL:
            raise self.mismatch(name, "a list", f"a dataset of rank {rank}")
        points, stored = space.get_simple_extent_npoints(), dataset.get_storage_size()
        if points > 0 and stored == 0:
            return 0
        if points < 0 or value_size == 0 or points > self.file_size // value_size or stored != points * value_size:
            raise self.mismatch(name, f"as many values as the file holds, {stored} bytes of {self.file_size}", f"{points} promised")
        return points


def image(datasets: dict[str, np.ndarray | str]) -> bytes:
    """A new file of these datasets and the groups of their paths, the same bytes for the same values."""
    with h5py.File("image", "w", driver="core", backing_store=False) as file:
        for name, values in datasets.items():
            if isinstance(values, str):
                text = values.encode()
                kind = h5t.C_S1.copy()
                kind.set_size(len(text) + 1)
                group, _, last = name.rpartition("/")
                no_times = h5p.create(h5p.DATASET_CREATE)
                no_times.set_obj_track_times(False)
                dataset = h5d.create(file.require_group(group).id, last.encode(), kind, h5s.create(h5s.SCALAR), no_times)
                dataset.write(h5s.ALL, h5s.ALL, np.array(text, dtype=(np.bytes_, len(text) + 1)), kind)
            else:
                file.create_dataset(name, data=values, dtype="<i4" if values.dtype.kind == "i" else "<f8", track_times=False)
        file.flush()
        return file.id.get_file_image()
