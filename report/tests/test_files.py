"""Files take their place when they are complete, and lost output is told."""

import os
import resource
import subprocess
import sys
from pathlib import Path

from lcpbench_report.files import replaced, write_text
from .cases import FolderCase
from .synthetic_campaign import write_campaign

REPORT = Path(__file__).resolve().parents[1] / "report.py"


def tell(command: str, *words, **settings) -> tuple[int, str]:
    """Exit status and standard error of report.py, run by a shell."""
    done = subprocess.run(["sh", "-c", command, sys.executable, str(REPORT), *map(str, words)], text=True,
                          stderr=subprocess.PIPE, check=False, **settings)
    return done.returncode, done.stderr


class Files(FolderCase):
    def names(self) -> list[str]:
        return sorted(path.name for path in self.folder.iterdir())

    def test_a_file_is_replaced_when_it_is_complete(self):
        path = self.folder / "x.csv"
        path.write_text("old")
        path.chmod(0o600)
        (self.folder / "link.csv").symlink_to("x.csv")
        with self.assertRaises(KeyError), replaced(path) as beside:
            beside.write_text("half")
            raise KeyError
        self.assertEqual((path.read_text(), self.names()), ("old", ["link.csv", "x.csv"]))
        write_text(self.folder / "link.csv", "new")
        self.assertEqual((path.read_text(), self.names()), ("new", ["link.csv", "x.csv"]))
        self.assertEqual(path.stat().st_mode & 0o777, 0o600)
        write_text(path, os.fsdecode(b"r\xe9sum\xc3\xa9"))  # names are any bytes
        self.assertEqual(path.read_text(encoding="utf-8"), "r\\udce9sumé")
        with self.assertRaises(FileNotFoundError) as caught:
            write_text(self.folder / "none" / "x", "")
        self.assertEqual(caught.exception.filename, str(self.folder / "none" / "x"))

    def test_lost_output_is_status_3_and_one_line(self):
        write_campaign(self.folder / "a", {"a": 1.0, "b": 2.0}, copies=2)
        compare = ("compare", self.folder / "a", self.folder / "a")
        for place, reason in (("> /dev/full", "No space left on device"), (">&-", "Bad file descriptor")):
            self.assertEqual(tell(f'"$0" "$@" {place}', *compare),
                             (3, f"compare: error: standard output: {reason}\n"))
            self.assertEqual(tell(f'"$0" "$@" {place}', "compare", "--help"),
                             (3, f"report.py: error: standard output: {reason}\n"))
        self.assertEqual(tell('"$0" "$@" | true', *compare)[1], "")
        output = self.folder / "changes.md"
        output.write_text("old")
        full = tell('exec "$0" "$@"', *compare, "-o", output, stdout=subprocess.DEVNULL,
                    env=os.environ | {"PYTHONDONTWRITEBYTECODE": "1"},
                    preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0)))
        self.assertEqual(full, (3, f"compare: error: {output}: File too large\n"))
        self.assertEqual((output.read_text(), self.names()), ("old", ["a", "changes.md"]))
