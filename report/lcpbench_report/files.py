"""Files that take their place when they are complete."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def replaced(path: Path) -> Iterator[Path]:
    """A path beside this one, to be written there, which takes its place afterwards; nothing stays after an exception.

    It ends as the path does, and has the permissions of the file that it replaces. Pipes and devices are written
    directly, and of a symbolic link the file that it leads to is meant.
    @throws OSError with the name that was asked for
    """
    if path.exists() and not path.is_file() or path.absolute().is_relative_to("/dev"):
        yield path
        return
    target = path.resolve()
    mask = os.umask(0)
    os.umask(mask)
    try:
        descriptor, name = tempfile.mkstemp(prefix=".lcpbench-", suffix="".join(target.suffixes), dir=target.parent)
        os.close(descriptor)
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(path)) from error
    beside = Path(name)
    try:
        beside.chmod(target.stat().st_mode & 0o7777 if target.exists() else 0o666 & ~mask)
        yield beside
        beside.replace(target)
    except OSError as error:
        if error.filename in (None, name):
            raise OSError(error.errno, error.strerror, str(path)) from error
        raise
    finally:
        beside.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """In UTF-8. Bytes of names that are no UTF-8 are written as in Python's strings: \\udce9."""
    with replaced(path) as beside:
        beside.write_text(text, encoding="utf-8", errors="backslashreplace")
