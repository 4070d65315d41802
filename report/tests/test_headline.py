"""Run: /usr/bin/python3 -m unittest discover -s report/tests

The headline: which solver is bold and shown, its Markdown, and its way into a file; the summary in Markdown.
"""

import contextlib
import io
import math
import sys
import tempfile
import unittest
import xml.etree.ElementTree
from pathlib import Path

_REPORT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(_REPORT), str(_REPORT / "tests")]

import headline as script  # noqa: E402
from lcpbench_report import choice, formats, markdown_headline, markdown_summary  # noqa: E402
from lcpbench_report.errors import ReportError  # noqa: E402
from lcpbench_report.headline_table import headline  # noqa: E402
from lcpbench_report.inputs import load_inputs  # noqa: E402
from report_inputs import ENVIRONMENT, FACTORS, FAILING, NEXT, write_problems, write_steps  # noqa: E402
from synthetic_campaign import exclude, fail  # noqa: E402

COLUMN = 2  # of problems with 31 to 100 rows


class Headline(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls._folder = tempfile.TemporaryDirectory()
        cls.path = Path(cls._folder.name)
        cls.folder = write_problems(cls.path / "standard")
        cls.inputs = load_inputs([cls.folder])
        cls.found = headline(cls.inputs)
        cls.text = markdown_headline.render(cls.inputs, cls.found)

    @classmethod
    def tearDownClass(cls):
        cls._folder.cleanup()

    def of(self, change) -> tuple:
        """(inputs, headline) of a campaign with other outcomes."""
        with tempfile.TemporaryDirectory() as folder:
            inputs = load_inputs([write_problems(Path(folder), change)])
            return inputs, headline(inputs)

    def best(self, found) -> list[set[str]]:
        return [{solver for solver, entries in found.rows.items() if entries[k] and entries[k].best}
                for k in range(len(found.columns))]

    def test_a_solver_that_fails_is_not_bold_though_it_is_the_fastest(self):
        _, found = self.of(lambda record: fail(record) if record["solver"] == FAILING
                           and record["problem"] == "piles-50-1" else record)
        self.assertEqual(self.best(found), [{NEXT} if k == COLUMN else {FAILING} for k in range(len(found.columns))])
        entry = found.rows[FAILING][COLUMN]
        self.assertEqual(entry.problems - entry.verified, 1)

    def test_false_successes_are_failures_too(self):
        _, found = self.of(lambda record: fail(record, "solved") if record["solver"] == FAILING
                           and record["problem"] == "piles-50-1" else record)
        self.assertEqual(self.best(found)[COLUMN], {NEXT})
        self.assertEqual(found.rows[FAILING][COLUMN].false_successes, 1)

    def test_where_nobody_verifies_everything_the_fastest_of_those_that_verify_most_is_bold(self):
        def change(record):
            hard = record["problem"] == "piles-50-1"
            harder = record["problem"] == "chains-50-1" and record["solver"] == FAILING
            return fail(record) if hard or harder else record

        _, found = self.of(change)
        self.assertEqual(self.best(found)[COLUMN], {NEXT})

    def test_failing_on_hard_problems_does_not_make_a_solver_faster(self):
        _, complete = self.of(lambda record: record)
        for failures in (1, 2):
            def change(record):
                names = [f"{family}-50-1" for family in ("piles", "chains")][:failures]
                return fail(record) if record["solver"] == "pgs" and record["problem"] in names else record

            _, found = self.of(change)
            self.assertGreaterEqual(found.rows["pgs"][COLUMN].time_s, complete.rows["pgs"][COLUMN].time_s)

    def test_a_solver_that_fails_on_half_has_no_time(self):
        self.assertEqual(choice.median_time([1.0, 2.0, math.inf, math.inf]), math.inf)
        self.assertEqual(choice.median_time([3.0, 1.0, math.inf]), 3.0)
        self.assertEqual(choice.median_time([1.0, 2.0, 4.0, math.inf]), 3.0)

    def test_excluded_columns_are_a_dash_and_never_bold(self):
        _, found = self.of(lambda record: exclude(record) if record["solver"] == FAILING and "-10-" in record["problem"]
                           else record)
        self.assertEqual(markdown_headline.cell(found.rows[FAILING][0]), formats.DASH)
        self.assertNotIn(FAILING, self.best(found)[0])

    def test_pathological_problems_and_islands_do_not_count(self):
        standard = [about for about in self.inputs.problems.values() if about["set"] == "standard"]
        self.assertEqual(sum(problems for _, problems in self.found.columns), len(standard))

    def test_of_a_library_the_best_is_shown_and_where_it_is_excluded_another_one(self):
        self.assertIn("ode-dantzig", self.found.rows)  # for the large problems
        self.assertIn("ode-lemke", self.found.rows)
        self.assertIn("clp", self.found.rows)
        self.assertNotIn("clp-default", self.found.rows)
        self.assertEqual(self.found.left_out, ["clp-default"])

    def test_there_is_a_row_for_every_solver_and_a_column_for_every_size_class(self):
        rows = [line for line in self.text.splitlines() if line.startswith("|")]
        shown = [key for key in FACTORS if key != "clp-default"]
        self.assertEqual([row.split("|")[1].strip(" `") for row in rows], ["solver", "---", *shown, "problems"])
        for row in rows:
            self.assertEqual(row.count("|"), len(self.found.columns) + 2)

    def test_machine_commit_and_date_are_named_where_they_are_known(self):
        for word in (ENVIRONMENT["cpu"], ENVIRONMENT["git_commit"][:12], "2026-01-02"):
            self.assertIn(word, self.text)
        bare, found = self.of(None)
        bare.campaigns[0].info["environment"] = {}
        bare.campaigns[0].info.pop("started")
        self.assertNotIn("()", markdown_headline.caption(bare, found))

    def test_a_share_below_all_is_never_shown_as_all(self):
        self.assertEqual(formats.share(999, 1000), "99\u202f%")
        self.assertEqual(formats.share(1000, 1000), "100\u202f%")
        self.assertEqual(formats.share(1, 1000), "<1\u202f%")

    def test_update_replaces_what_stands_between_the_markers_and_draws_the_figure(self):
        readme, figure = self.path / "README.md", self.path / "pictures" / "headline.svg"
        readme.write_text(f"before\n{markdown_headline.BEGIN}\nstale text\n{markdown_headline.END}\nafter\n",
                          encoding="utf-8")
        seen = set()
        for _ in range(2):  # the second time changes nothing more
            arguments = [str(self.folder), "--update", str(readme), "--figure", str(figure)]
            self.assertEqual(script.main(arguments), 0)
            text = readme.read_text(encoding="utf-8")
            self.assertTrue(text.startswith("before\n") and text.endswith("after\n"))
            self.assertIn(self.text, text)
            self.assertIn("](pictures/headline.svg)", text)
            self.assertNotIn("stale text", text)
            xml.etree.ElementTree.parse(figure)
            seen.add(figure.read_bytes())
        self.assertEqual(len(seen), 1)

    def test_a_file_without_markers_is_refused_before_anything_is_written(self):
        readme, figure = self.path / "bare.md", self.path / "never.svg"
        readme.write_text("no markers", encoding="utf-8")
        with contextlib.redirect_stderr(io.StringIO()) as error:
            self.assertEqual(script.main([str(self.folder), "--update", str(readme), "--figure", str(figure)]), 2)
        self.assertEqual(error.getvalue().count("\n"), 1)
        self.assertFalse(figure.exists())
        with self.assertRaises(ReportError):
            markdown_headline.replace_between_markers("no markers", "", "x.md")

    def test_a_missing_folder_is_one_line_and_status_two(self):
        with contextlib.redirect_stderr(io.StringIO()) as error:
            self.assertEqual(script.main([str(self.path / "nowhere")]), 2)
        self.assertEqual(error.getvalue().count("\n"), 1)

    def test_the_summary_holds_its_lines_tables_and_how_to_compare(self):
        inputs = load_inputs([self.folder, write_steps(self.path / "sequences")])
        text = markdown_summary.render(inputs, ["A first finding.", "A second one."])
        for part in ("- A first finding.\n- A second one.", markdown_headline.table(headline(inputs)),
                     "## Verified and false", "## Sequences of motions", ENVIRONMENT["cpu"],
                     "lcpbench compare OLD NEW"):
            self.assertIn(part, text)
        false = inputs.analysis["coverage"].query("solver == @FAILING and tier == 1e-6 and set == 'counted'",
                                                  local_dict={"FAILING": FAILING})["false_successes"].iloc[0]
        row = next(line for line in text.splitlines()[text.splitlines().index("## Verified and false"):]
                   if line.startswith(f"| `{FAILING}`"))
        self.assertIn(f"✗ {false}", row)

    def test_a_summary_of_sequences_alone_has_no_table_of_times(self):
        inputs = load_inputs([write_steps(self.path / "alone")])
        text = markdown_summary.render(inputs, [])
        self.assertNotIn("## Times", text)
        self.assertIn("## Sequences of motions", text)


if __name__ == "__main__":
    unittest.main()
