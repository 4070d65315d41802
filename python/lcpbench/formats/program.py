"""The package as a program that the command lcpbench starts: requests on standard input, answers on standard output.

A request is a line of JSON: {"read": length, "options": {...}} with the options of load(), before so many bytes of a
path; or {"write": format, "is_dense": ..., "problem": {...}} with the problem as the command writes it, A also where
there are factors. An answer is a byte, 8 bytes of a length (little-endian), and what it counts: `+` and the problem as
JSON, or the file; `-` and why it is refused, in one line.

Every file is read by a forked process, which may open one file and write none, and whose memory and processor time are
limited in proportion to the file's size: libhdf5 was not made for hostile files, it crashes on some and allocates what
others promise.
"""

import json
import os
import resource
import signal
import struct
import sys
from collections.abc import Callable, Iterable
from pathlib import Path

from . import FormatError, StoredProblem, format_of, load, to_bytes
from .problem import from_record, json_pieces

_HDF5 = (".hdf5", ".h5")
_LEAST_MEMORY = 256 << 20  # beyond what the process is born with
_HDF5_MEMORY_PER_BYTE = 16
_LEAST_SECONDS = 20
_BYTES_PER_SECOND = 1 << 20
_PACKED_BYTES_PER_SECOND = 1 << 16  # of what unpacks to more
_SECONDS_TO_ANSWER = 600


def _available_memory() -> int:
    with open("/proc/meminfo", encoding="ascii") as file:
        return next(int(line.split()[1]) << 10 for line in file if line.startswith("MemAvailable:"))


def _memory_limit(path: Path, size: int) -> int:
    """Text and archives may unpack to much: half of what there is."""
    if path.suffix.lower() in _HDF5:
        return _LEAST_MEMORY + _HDF5_MEMORY_PER_BYTE * size
    return max(_LEAST_MEMORY, _available_memory() // 2)


def _limit(what: int, soft: int, hard: int) -> None:
    """Below what the process has been limited to already, as the workers of a campaign are."""
    most = resource.getrlimit(what)[1]
    if most != resource.RLIM_INFINITY:
        soft, hard = min(soft, most), min(hard, most)
    resource.setrlimit(what, (soft, hard))


def _confine(path: Path) -> None:
    """Limits this process, which is to read the file. A crash is its own alone: no core file, no message."""
    size = path.stat().st_size if path.exists() else 0
    seconds = _LEAST_SECONDS + size // (_PACKED_BYTES_PER_SECOND if path.suffix.lower() in (".gz", ".npz") else _BYTES_PER_SECOND)
    with open("/proc/self/statm", encoding="ascii") as file:
        used = int(file.read().split()[0]) * os.sysconf("SC_PAGE_SIZE")
    memory = used + _memory_limit(path, size)
    nowhere = os.open(os.devnull, os.O_RDWR)
    os.dup2(nowhere, 0)
    os.dup2(nowhere, 2)
    os.close(nowhere)  # the one number that is left
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))
    _limit(resource.RLIMIT_CPU, seconds, seconds + _SECONDS_TO_ANSWER)
    _limit(resource.RLIMIT_AS, memory, memory)
    _limit(resource.RLIMIT_NOFILE, nowhere + 1, nowhere + 1)


def _result(path: Path, read: Callable[[], StoredProblem]) -> tuple[bytes, list[bytes]]:
    try:
        return b"+", [piece.encode() for piece in json_pieces(read())]
    except FormatError as error:
        return b"-", [str(error).encode()]
    except MemoryError:
        return b"-", [f"{path}: expected a file that fits into memory, found a larger one".encode()]


def confined(path: Path, read: Callable[[], StoredProblem], answer: Callable[[bytes, list[bytes]], None]) -> str | None:
    """Lets a forked process answer with what `read` reads of a file, or with its refusal.

    @return how the process ended where it has answered nothing
    """
    child = os.fork()
    if child == 0:
        status = 1  # a defect, of which nothing is told here
        try:
            _confine(path)
            result = _result(path, read)
            resource.setrlimit(resource.RLIMIT_CPU, (resource.getrlimit(resource.RLIMIT_CPU)[1],) * 2)
            answer(*result)
            status = 0
        finally:
            os._exit(status)  # closing a malformed file is one more chance to crash
    status = os.waitpid(child, 0)[1]
    if os.WIFSIGNALED(status):
        number = os.WTERMSIG(status)
        return "did not end in time" if number == signal.SIGXCPU else f"was killed by signal {number} ({signal.strsignal(number)})"
    return f"ended with exit status {os.WEXITSTATUS(status)}" if status != 0 else None


def _answer(kind: bytes, pieces: Iterable[bytes]) -> None:
    pieces = list(pieces)
    sys.stdout.buffer.write(kind + struct.pack("<Q", sum(map(len, pieces))))
    sys.stdout.buffer.writelines(pieces)
    sys.stdout.buffer.flush()


def _read(path: Path, options: dict) -> None:
    kind = format_of(path)[0]
    kind.function(kind.read)  # imported here: the forked process can open nothing but the file
    end = confined(path, lambda: load(path, **options)[0], _answer)
    if end is not None:
        what = "an HDF5 file that libhdf5 can read" if kind.name == "hdf5" else "a file that can be read"
        raise FormatError(f"{path}: expected {what}, found one on which it {end}")


def _written(request: dict) -> bytes:
    problem = from_record(request["problem"])
    if request["is_dense"]:
        problem.A = problem.A.toarray()
    return to_bytes(problem, request["write"])


def main() -> int:
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    os.environ["HDF5_PLUGIN_PRELOAD"] = "::"  # libhdf5 loads no plug-ins
    for line in sys.stdin.buffer:
        request = json.loads(line)
        try:
            if "read" in request:
                _read(Path(os.fsdecode(sys.stdin.buffer.read(request["read"]))), request["options"])
            else:
                _answer(b"+", [_written(request)])
        except FormatError as error:
            _answer(b"-", [str(error).encode()])
        except MemoryError:
            _answer(b"-", [b"expected a problem that fits into memory, found a larger one"])
    return 0
