"""Every committed summary has the tables that the code makes of its folder today.

The tables that are compared: times by class, the front, all solvers by size, coverage, origins, literature, problems that
break something, sequences, friction. Not compared, because they take minutes: which backend (means of every class), and the
sentences, of which one needs all pairs of solvers.
"""

import unittest

from lcpbench_report import shown_tables
from lcpbench_report.headline_table import headline
from .reference import FOLDER, SUMMARIES, inputs_of

_TABLES = (shown_tables.coverage, shown_tables.origins, shown_tables.literature, shown_tables.robustness, shown_tables.sequences,
           shown_tables.friction, shown_tables.friction_classes, shown_tables.friction_errors)
_OF_HEADLINE = (shown_tables.classes, shown_tables.front, shown_tables.by_solver)


class CommittedSummaries(unittest.TestCase):
    def test_every_summary_is_one_that_is_made(self):
        self.assertEqual({path.name for path in FOLDER.glob("*summary.md")}, set(SUMMARIES))

    def test_every_table_is_that_of_the_folder(self):
        for name, folders in SUMMARIES.items():
            text = (FOLDER / name).read_text(encoding="utf-8")
            inputs = inputs_of(*folders)
            tables = [make(inputs) for make in _TABLES if len(inputs.cells) or make is shown_tables.sequences]
            if len(inputs.cells) and headline(inputs).classes:
                tables += [make(headline(inputs)) for make in _OF_HEADLINE]
            for table in filter(None, tables):
                with self.subTest(name, columns=table.columns[:4]):
                    missing = [line for line in table.markdown().splitlines() if line not in text]
                    self.assertEqual(missing, [], "make reference-report writes it")
