"""What the committed campaign `core` gives (`make test-long`): its summary, and all blocks of numbers of README.md and docs/.
The smaller campaigns, and the blocks that need no times, are in test_committed_summaries.py and test_readme.py."""

import unittest

from lcpbench_report import readme_blocks
from lcpbench_report.headline_table import headline
from .reference import PAGES, ROOT, SUMMARIES, check_tables, inputs_of


class CommittedResults(unittest.TestCase):
    def test_the_summary_has_the_tables_of_its_folders(self):
        check_tables(self, "summary.md")

    def test_the_blocks_are_those_of_the_committed_results(self):
        inputs = inputs_of(*SUMMARIES["summary.md"])  # sequences change nothing in the blocks
        for path, text in PAGES.items():
            with self.subTest(path.relative_to(ROOT)):
                filled = readme_blocks.fill(text, readme_blocks.Page(inputs, headline(inputs), ROOT, path))
                self.assertEqual(text.splitlines(), filled.splitlines(), "make reference-report writes them")
