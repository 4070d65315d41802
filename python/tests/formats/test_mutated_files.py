"""The law of fuzz.py for the seeds and some changes of them, the same ones every time."""

import random

import fuzz
from stored_problems import FormatTest


class MutatedFiles(FormatTest):
    def test_the_law_holds(self):
        for kind, count in (("hdf5", 100), ("dat", 1000), ("qps", 1000), ("npz", 500)):  # of the first each has a process
            corpus, chance, read = fuzz.seeds(kind), random.Random(1), 0
            with self.subTest(kind):
                for content in corpus:
                    self.assertEqual(fuzz.broken_law(self.folder, kind, content, {})[0], "")
                for k in range(count):
                    content = fuzz.mutated(kind, corpus, chance)
                    broken, is_read = fuzz.broken_law(self.folder, kind, content, fuzz.options_for(kind, chance))
                    self.assertEqual(broken, "", f"{k}: {content!r}")
                    read += is_read
                self.assertGreater(read, count // 100)
                self.assertLess(read, count)
