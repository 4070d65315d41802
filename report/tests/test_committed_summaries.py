"""Every committed summary has the tables that the code makes of its folder today. That of the campaign `core`, which
takes a minute, is in long_committed_results.py."""

import unittest

from .reference import FOLDER, SUMMARIES, check_tables


class CommittedSummaries(unittest.TestCase):
    def test_every_summary_is_one_that_is_made(self):
        self.assertEqual({path.name for path in FOLDER.glob("*summary.md")}, set(SUMMARIES))

    def test_every_table_is_that_of_the_folder(self):
        for name in SUMMARIES:
            if name != "summary.md":
                check_tables(self, name)
