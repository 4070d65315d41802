#!/usr/bin/python3
"""Mutated files of all formats: each is a valid problem, which is written and read back bit for bit, or a refusal of one
line that begins with the place; within limits of memory and time.

    python/tests/formats/fuzz.py --seconds 600 [--seed 1] [--formats hdf5 dat qps npz]

Formats take turns. The exit status is 1 where the law is broken; the file is then kept and named.
"""

import argparse
import collections
import fcntl
import io
import json
import math
import os
import random
import resource
import signal
import struct
import sys
import tempfile
import time
import zipfile
from pathlib import Path

import numpy as np
from stored_problems import CORPUS, FormatError, StoredProblem, difference, formats, generated, program

FORMATS = ("hdf5", "dat", "qps", "npz")
_SECONDS = 30  # for one file
_MEMORY = 2 << 30
_INTEGERS = (0, 1, 2, 3, 0xFF, 0xFFFF, 2**31 - 1, 2**31, 2**32 - 2, 2**32 - 1, 2**64 - 1, 10**12)
_REALS = (0.0, -0.0, 1e-3, 1e308, math.inf, math.nan)
_TEXT = b"0123456789-+.eE/%,:[]{}\" \n\r\tnaif"


def _overwritten(content: bytes, chance: random.Random) -> bytes:
    """One to four numbers overwritten where they stand: what is inserted moves all addresses behind it."""
    changed = bytearray(content)
    for _ in range(chance.randint(1, 4)):
        width = chance.choice((1, 2, 4, 4, 8))
        if width > len(changed):
            continue
        at = chance.randrange(len(changed) - width + 1)
        if width >= 4 and chance.random() < 0.75:  # numbers stand at multiples of four mostly
            at -= at % 4
        nearby = int.from_bytes(changed[at:at + width], "little") + chance.randint(-2, 2)
        real = int.from_bytes(struct.pack("<d", chance.choice(_REALS)), "little")
        value = chance.choice((chance.choice(_INTEGERS), real, nearby, chance.getrandbits(64)))
        changed[at:at + width] = (value % 2**64).to_bytes(8, "little")[:width]
    return bytes(changed)


def _edited(content: bytes, chance: random.Random, corpus: list[bytes]) -> bytes:
    """Bytes changed, cut out, doubled, and pieces of another file put in."""
    for _ in range(chance.randint(1, 4)):
        at = chance.randint(0, len(content))
        other = chance.choice((content, chance.choice(corpus)))
        begin = chance.randint(0, len(other))
        piece = other[begin:begin + chance.randint(0, 24)]
        put = chance.choice((bytes([chance.choice(_TEXT)]), bytes([chance.getrandbits(8)]), piece, b""))
        content = content[:at] + put + content[at + chance.choice((0, 0, 1, chance.randint(1, 8))):]
    return content


def _repacked(content: bytes, chance: random.Random, corpus: list[bytes]) -> bytes:
    """An archive with one member changed: changes of packed bytes hardly pass its check sums."""
    stream = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(content)) as old, zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as new:
        victim = chance.choice(old.namelist())
        for name in old.namelist():
            member = old.read(name)
            if name == victim:
                member = _overwritten(member, chance) if chance.random() < 0.5 else _edited(member, chance, corpus)
            if name != victim or chance.random() < 0.95:
                new.writestr(name, member)
    return stream.getvalue()


def seeds(kind: str) -> list[bytes]:
    """Files of ours, and of other writers."""
    if (CORPUS / kind).is_dir():
        return [path.read_bytes() for path in sorted((CORPUS / kind).iterdir())]
    problems = list(generated(6))
    rows = np.flatnonzero(np.isin(np.arange(len(problems[1].b)), problems[1].bilateral, invert=True))[:2]
    problems[1].bounded = {"row": rows, "lower": np.full(len(rows), -1.0), "upper": np.array([np.inf, 2.0])[:len(rows)]}
    return [formats.to_bytes(problem, kind) for problem in problems]


def mutated(kind: str, corpus: list[bytes], chance: random.Random) -> bytes:
    content = chance.choice(corpus)
    if kind == "npz" and chance.random() < 0.7:
        return _repacked(content, chance, corpus)
    return _overwritten(content, chance) if kind in ("hdf5", "npz") else _edited(content, chance, corpus)


def _read_confined(path: Path, options: dict) -> StoredProblem | str:
    """By a process of its own, as the command does."""
    reading, writing = os.pipe()
    fcntl.fcntl(writing, fcntl.F_SETPIPE_SZ, 1 << 20)
    os.set_blocking(writing, False)
    end = program.confined(path, lambda: formats.load(path, **options)[0],
                           lambda kind, pieces: os.write(writing, kind + b"".join(pieces)) and None)
    os.close(writing)
    with os.fdopen(reading, "rb") as pipe:
        answer = pipe.read()
    if end is not None:  # libhdf5 crashes on some files; Python does not
        return f"{path}: expected an HDF5 file, found one on which it {end}"
    return program.from_record(json.loads(answer[1:])) if answer[:1] == b"+" else answer[1:].decode()


def _read(path: Path, kind: str, options: dict) -> StoredProblem | str:
    if kind == "hdf5":
        return _read_confined(path, options)
    signal.alarm(_SECONDS)
    try:
        return formats.load(path, **options)[0]
    except FormatError as error:
        return str(error)
    except MemoryError:
        return f"{path}: expected a file that fits into memory, found a larger one"
    finally:
        signal.alarm(0)


def broken_law(folder: Path, kind: str, content: bytes, options: dict) -> tuple[str, bool]:
    """What is broken, "" for nothing; whether the file was read."""
    path = folder / f"given.{kind}"
    path.write_bytes(content)
    found = _read(path, kind, options)
    if isinstance(found, str):
        is_refusal = found.startswith(f"{path}:") and "\n" not in found and "ended with exit status" not in found
        return "" if is_refusal else f"no refusal of one line with its place: {found}", False
    if not np.isfinite(found.b).all():
        return "b is not finite", True
    if kind == "dat" and (found.friction is not None or found.J is not None):
        return "", True  # read and not written
    if kind == "qps":
        found.A.eliminate_zeros()  # which are not written
    try:
        formats.save(found, folder / f"back.{kind}")
    except FormatError as error:
        overflows = found.J is not None and "factors whose product is finite" in str(error)
        return "" if overflows else f"what was read is not written: {error}", True
    return difference(formats.load(folder / f"back.{kind}")[0], found), True


def limit_memory() -> None:
    resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, resource.getrlimit(resource.RLIMIT_AS)[1]))


def options_for(kind: str, chance: random.Random) -> dict:
    options = {"box_friction": chance.random() < 0.3, "without_friction": chance.random() < 0.3}
    return options | ({"fclib_triplets": chance.choice((None, "columns-first"))} if kind == "hdf5" else {})


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--seed", type=int, default=None, help="[default: of the clock, and told]")
    parser.add_argument("--formats", nargs="+", choices=FORMATS, default=FORMATS)
    options = parser.parse_args()
    seed = time.time_ns() if options.seed is None else options.seed
    chance, corpora, counts = random.Random(seed), {kind: seeds(kind) for kind in options.formats}, collections.Counter()
    limit_memory()
    slowest, end = 0.0, time.monotonic() + options.seconds
    with tempfile.TemporaryDirectory() as name:
        while time.monotonic() < end:
            for kind in options.formats:
                content, begin = mutated(kind, corpora[kind], chance), time.monotonic()
                broken, is_read = broken_law(Path(name), kind, content, options_for(kind, chance))
                slowest = max(slowest, time.monotonic() - begin)
                counts[kind, "read" if is_read else "refused"] += 1
                if broken:
                    kept = Path(tempfile.gettempdir(), f"broken-law-{seed}.{kind}")
                    kept.write_bytes(content)
                    print(f"{kept}: {broken}", file=sys.stderr)
                    return 1
    told = ", ".join(f"{kind} {counts[kind, 'read']} read and {counts[kind, 'refused']} refused" for kind in options.formats)
    memory = max(resource.getrusage(who).ru_maxrss for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)) // 1024
    print(f"formats, seed {seed}: {told}; at most {slowest:.1f} s and {memory} MB")
    return 0


if __name__ == "__main__":
    sys.exit(main())
