"""The law of fuzz.py for the seeds and some changes of them, the same ones every time."""

import random
import tempfile
import unittest
from pathlib import Path

import fuzz


class MutatedFiles(unittest.TestCase):
    def assertLaw(self, kind, count):
        corpus, chance, read = fuzz.seeds(kind), random.Random(1), 0
        with tempfile.TemporaryDirectory() as name:
            for content in corpus:
                broken, _ = fuzz.broken_law(Path(name), kind, content, {})
                self.assertEqual(broken, "")
            for k in range(count):
                content = fuzz.mutated(kind, corpus, chance)
                broken, is_read = fuzz.broken_law(Path(name), kind, content, fuzz.options_for(kind, chance))
                self.assertEqual(broken, "", f"{k}: {content!r}")
                read += is_read
        self.assertGreater(read, count // 100)
        self.assertLess(read, count)

    def test_hdf5(self):
        self.assertLaw("hdf5", 100)  # a process each

    def test_siconos(self):
        self.assertLaw("dat", 1000)

    def test_qps(self):
        self.assertLaw("qps", 1000)

    def test_npz(self):
        self.assertLaw("npz", 500)


if __name__ == "__main__":
    unittest.main()
