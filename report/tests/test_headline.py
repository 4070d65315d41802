"""The headline: which solver is bold and shown, its Markdown, and its way into a file; the summary in Markdown."""

import math
import xml.etree.ElementTree
from pathlib import Path

import numpy as np

from lcpbench_report import formats, markdown, shown_tables, summary
from lcpbench_report.headline_table import headline, not_won, verdicts
from lcpbench_report.inputs import load_inputs
from lcpbench_report.sentences import say
from lcpbench_report.statistics.rivals import DOMINATES, FASTER, FASTEST, PORTFOLIO
from .cases import SharedFolderCase, edit_info, inputs_of, run
from .synthetic_campaign import CLASSES, TIME_LIMIT, exclude, fail, only, slower, write_campaign
from .synthetic_report import ENVIRONMENT, FAILING, MANY, NEXT, OWN, write_problems, write_steps

COLUMN = 2  # of problems with 31 to 100 rows


class Headline(SharedFolderCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.folder = write_problems(cls.path / "standard", tiers=(1e-6,))
        cls.inputs = load_inputs([cls.folder])
        cls.found = headline(cls.inputs)
        cls.text = markdown.full_headline(cls.inputs, cls.found)

    def of(self, change) -> tuple:
        """(inputs, headline) of a campaign with other outcomes."""
        inputs = inputs_of(write_problems, change, (1e-6,))
        return inputs, headline(inputs)

    def best(self, found) -> list[set[str]]:
        return [{solver for solver, entry in row.entries.items() if entry.best} for row in found.classes]

    def test_bold_is_who_no_other_is_better_than_in_both(self):
        for claim in ("iteration_limit", "solved"):  # false successes are failures too
            _, found = self.of(only(FAILING, "piles-50-1", lambda record: fail(record, claim)))
            self.assertEqual(self.best(found), [{FAILING, NEXT} if k == COLUMN else {FAILING} for k in range(len(found.classes))])
            self.assertAlmostEqual(found.classes[COLUMN].entries[FAILING].share, 5 / 6)
        _, found = self.of(only(NEXT, "piles-50-1", fail))
        self.assertEqual(self.best(found)[COLUMN], {FAILING})

    def test_failing_on_hard_problems_does_not_make_a_solver_faster(self):
        _, complete = self.of(lambda record: record)
        for failures in ("piles-50-1", "-50-1"):
            _, found = self.of(only("pgs", failures, fail))
            self.assertGreaterEqual(found.classes[COLUMN].entries["pgs"].time_s,
                                    complete.classes[COLUMN].entries["pgs"].time_s)

    def test_ratios_are_ours_over_theirs_and_the_losses_are_told_last(self):
        _, found = self.of(lambda record: record)
        for row in found.classes:
            self.assertEqual((found.own, list(row.rivals)), ("auto", [NEXT, FASTEST]))
            self.assertAlmostEqual(row.rivals[NEXT].ratio.median, 1 / 0.6, delta=0.2)
            self.assertEqual(row.rivals[NEXT].relation, DOMINATES)
        self.assertRegex(summary.peers(found), r"We lose to the fastest peer of each problem at .*; to single peers that are "
                         r"faster and at least as often right `ode-lemke` at 7–12 rows \(1\.[567]")

        _, found = self.of(lambda record: slower(record, 4) if record["solver"] == NEXT and "-50-" not in record["problem"]
                           and "-100-" not in record["problem"] else record)
        row = found.classes[COLUMN]
        self.assertGreater(row.rivals[FASTEST].ratio.low, 1)
        text = summary.peers(found)
        self.assertRegex(text, r"^Against the fastest peer of each problem we win at 7–12 rows")
        self.assertRegex(text, r"We lose to the fastest peer of each problem at 31–100 rows \(1\.[67]")
        rows = {row[0]: row for row in shown_tables.short(found).rows}
        self.assertRegex(rows["31–100"][3], r"^`ode-lemke` \(\d")
        self.assertRegex(rows["31–100"][4], r"^1\.[67]")
        # On every problem a peer is faster, and where ours wins on none.
        self.assertEqual([rows[of][-1][:3] for of in ("31–100", "7–12")], ["100", "0\u202f%"])
        self.assertRegex(say("not_won", rows=not_won(found)), r"^At 31–100 rows `ode-lemke` is faster: 1\.[67]")

    def test_a_faster_peer_that_is_less_often_right_is_told_as_such(self):
        _, found = self.of(only(NEXT, "piles-50-1", fail))
        self.assertEqual(found.classes[COLUMN].rivals[NEXT].relation, FASTER)
        self.assertRegex(summary.losses(found), "though less often right, `ode-lemke` at 31–100 rows")
        self.assertIn("83\u202f%", shown_tables.front(found).markdown())

    def test_the_portfolio_is_the_rival_where_there_is_one(self):
        found = headline(inputs_of(
            write_campaign, {"auto": 1.0, "slow": 2.0, "bullet-dantzig": 0.9}, tiers=(1e-6,), peers=("slow", "bullet-dantzig"),
            info={"portfolio": dict.fromkeys((key for key, *_ in CLASSES), ["slow"])},
            change_problem=lambda of: of | {"origin": "recorded" if of["family"] == "chains" else "motion"}))
        self.assertEqual(found.rival, PORTFOLIO)
        lost, undecided, won = verdicts(found)
        self.assertEqual((lost, undecided, len(won)), ([], [], 5))
        text = shown_tables.classes(found).markdown()
        for column in ("ours / portfolio", "own scenes", "engines", "ours / fastest peer of each problem", "launches", "peers"):
            self.assertIn(f" {column} |", text)
        self.assertIn("`peer-portfolio`", shown_tables.front(found).markdown())
        self.assertEqual(not_won(found), [(row, [row.rivals["bullet-dantzig"]]) for row in found.classes])
        self.assertRegex(summary.peers(found), r"^Against the portfolio of peers we win at .*We lose to the portfolio of peers at no size; to the "
                         r"fastest peer of each problem at 7–12 rows")

    def test_the_portfolio_is_made_of_the_records_of_its_codes(self):
        """Half of the problems cost both turns; the codes have shares and times of their own beside it."""
        def write(folder, change=lambda of: of):
            return write_campaign(folder, {"auto": 1.0, "quick": 2.0, "sure": 4.0}, tiers=(1e-6,), peers=("quick", "sure"),
                                  change=lambda of: change(only("quick", "piles", lambda of: fail(of) | {"first_s": 3e-4})(of)),
                                  change_problem=lambda of: of | {"check_s": 1e-4},
                                  info={"portfolio": {"31-100": ["quick", "sure"], "7-12": ["sure"]}})
        inputs = inputs_of(write)
        found = headline(inputs)
        rows = {row.size_class: row for row in found.classes}
        self.assertEqual([size for size, row in rows.items() if PORTFOLIO in row.rivals], ["7-12", "31-100"])
        row, cells = rows["31-100"].rivals[PORTFOLIO], inputs.counted[inputs.counted["size_class"] == "31-100"]
        times = cells.pivot(index="problem", columns="solver", values="time_s")
        of = times["quick"].where(np.isfinite(times["quick"]), 3e-4 + 1e-4 + times["sure"]) + 1e-4
        self.assertAlmostEqual(row.time_s, of.median(), places=9)
        self.assertEqual((row.share, row.launches), (1, 5))
        self.assertTrue(0 < row.ratio.low <= row.ratio.median <= row.ratio.high < 1)
        self.assertGreater(row.check_share, 0.1)
        self.assertRegex(shown_tables.short(found).rows[2][6], r"^0\.\d\d \(")
        late = inputs_of(write, lambda of: of | {"first_s": 2 * TIME_LIMIT})
        self.assertEqual(headline(late).classes[0].entries["auto"].share, 0)  # never in time

    def test_at_equal_flags_there_is_a_row_per_instruction_set_and_else_nothing_is_said(self):
        factors = {"auto": 1.0, "auto-baseline": 2.0, "auto-v3": 1.5, "ode-dantzig": 3.0, "ode-dantzig-native": 2.5}
        build = {"origin": "external", "base": "auto"}
        inputs = inputs_of(write_campaign, factors, tiers=(1e-6,), peers=("ode-dantzig", "ode-dantzig-native"),
                           solvers={"auto-baseline": build, "auto-v3": build})
        self.assertEqual((inputs.ours, inputs.peers), ("auto", ["ode-dantzig", "ode-dantzig-native"]))
        self.assertEqual(headline(inputs).solvers, ["auto", "ode-dantzig-native"])
        rows = shown_tables.equal_flags(inputs).rows
        self.assertEqual([row[:2] for row in rows], [["any x86-64", "`auto-baseline` / `ode-dantzig`"],
                                                     ["x86-64-v3", "`auto-v3` / `ode-dantzig-native`"],
                                                     ["the machine's", "`auto` / `ode-dantzig-native`"]])
        for row, ratio in zip(rows, ("0.6", "0.6", "0.[34]")):
            self.assertRegex(row[2], rf"^{ratio}\d \(")
        self.assertIn("At equal flags", markdown.full_headline(inputs, headline(inputs)))
        self.assertNotIn("At equal flags", self.text)

    def test_literature_stands_in_a_table_of_its_own(self):
        inputs = inputs_of(write_campaign, {"auto": 1.0, "clp": 2.0}, tiers=(1e-6,), change_problem=lambda of: of | (
            {"origin": "literature", "set": "literature", "counts": False} if of["family"] == "chains" else {}))
        self.assertEqual(set(inputs.counted["family"]), {"piles"})
        table = shown_tables.literature(inputs)
        self.assertEqual((table.columns, [row[0] for row in table.rows]), (["solver", "literature (24)"], ["`auto`", "`clp`"]))
        self.assertIn("## Literature", markdown.render(inputs, []))
        self.assertNotIn("## Literature", markdown.render(self.inputs, []))

    def test_a_class_whose_interval_holds_1_is_undecided(self):
        _, found = self.of(only(NEXT, "", lambda record: slower(record, 1 / 0.6 * (
            1.1 if record["problem"].endswith("-1") else 1 / 1.1))))
        self.assertRegex(say("not_won", rows=not_won(found)), r"rows `ode-lemke` and ours are not told apart: (0\.9|1\.0)")
        self.assertIn("Undecided, because the interval contains 1", summary.peers(found))

    def test_without_a_peer_the_report_says_how_to_get_one_and_not_that_none_is_right(self):
        def write(folder: Path, change: dict) -> Path:
            write_campaign(folder, dict.fromkeys(OWN, 1.0), tiers=(1e-6,), copies=1)
            *run, absent = edit_info(folder)["solvers"]
            edit_info(folder, solvers=[*run, absent | change])
            return folder
        for change, words in (({"origin": "peer"}, "no peer in this build: `make peers`"), ({}, "no peer was run")):
            inputs = inputs_of(write, change)
            self.assertIn(words, markdown.render(inputs, summary.summary_lines(inputs)))
            self.assertIn(words, markdown.full_headline(inputs, headline(inputs)))
        self.assertNotIn("no peer", markdown.render(self.inputs, summary.summary_lines(self.inputs)).lower())

    def test_what_a_solver_does_not_take_has_a_mark_of_its_own_and_is_in_no_share(self):
        """As bullet-si and mujoco, which need factors: the best peer here takes a part of a class, or none of it."""
        _, before = self.of(lambda record: record)
        for peer, parts in (("ode-lemke", ("-50-1", "-100-")), ("clp", ("piles-50-1",))):
            for part in parts:
                _, found = self.of(only(peer, part, lambda record: fail(record, "unsupported")))
                row, entry = found.classes[COLUMN], found.classes[COLUMN].entries[peer]
                whole = before.classes[COLUMN].entries[peer]
                self.assertEqual(entry.problems + entry.not_asked, whole.problems)
                self.assertGreater(entry.not_asked, 0)
                self.assertEqual((entry.share, entry.attempted), (1, entry.problems))
                self.assertTrue(math.isfinite(entry.time_s))
                text = shown_tables.cell(entry, row.problems)
                self.assertIn(f"of {entry.problems}", text)
                self.assertNotIn("✗", text)
                if peer in row.rivals:  # what it does not take is not right on the front
                    self.assertLess(row.rivals[peer].share, 1)
            inputs, found = self.of(only(peer, "", lambda record: fail(record, "unsupported")))
            self.assertRegex(markdown.render(inputs, summary.summary_lines(inputs)), rf"\| `{peer}` \| ○ \d+ \|")
            cells = {shown_tables.cell(row.entries[peer], row.problems) for row in found.classes}
            self.assertEqual(cells, {shown_tables.NOT_ASKED_MARK})

    def test_excluded_columns_are_a_dash_and_never_bold(self):
        _, found = self.of(only(FAILING, "-10-", exclude))
        self.assertEqual(shown_tables.cell(found.classes[0].entries[FAILING], found.classes[0].problems), formats.DASH)
        self.assertNotIn(FAILING, self.best(found)[0])

    def test_pathological_problems_do_not_count(self):
        standard = [about for about in self.inputs.problems.values() if about["set"] == "standard"]
        self.assertEqual(sum(row.problems for row in self.found.classes), len(standard))

    def test_of_a_library_the_best_is_shown_and_where_it_is_excluded_another_one(self):
        self.assertLess({"ode-dantzig", "ode-lemke", "clp"}, set(self.found.solvers))  # the first for the large problems
        self.assertNotIn("clp-default", self.found.solvers)
        self.assertEqual(self.found.left_out, ["clp-default"])

    def test_there_is_a_row_for_every_class_and_one_for_every_solver(self):
        by_class, by_solver = shown_tables.classes(self.found).markdown(), shown_tables.by_solver(self.found).markdown()
        self.assertEqual([line.split("|")[1].strip() for line in by_class.splitlines()],
                         ["rows", "---", "7–12", "13–30", "31–100", "101–300", "301–1000"])
        shown = [key for key in MANY if key != "clp-default"]
        self.assertEqual([line.split("|")[1].strip(" `") for line in by_solver.splitlines()], ["solver", "---", *shown])
        for text in (by_class, by_solver):
            self.assertIn(text, self.text)
            self.assertEqual(len({line.count("|") for line in text.splitlines()}), 1)

    def test_machine_commit_and_date_are_named_where_they_are_known(self):
        for word in (ENVIRONMENT["cpu"], ENVIRONMENT["git_commit"][:12], "2026-01-02"):
            self.assertIn(word, self.text)
        bare, found = self.of(None)
        bare.campaigns[0].info["environment"] = {}
        bare.campaigns[0].info.pop("started")
        self.assertNotIn("()", say("caption", inputs=bare, found=found))

    def test_a_first_look_names_the_commands_that_narrow_its_intervals(self):
        self.assertNotIn("make report", say("caption", inputs=self.inputs, found=self.found))
        few, found = self.of(None)
        few.campaigns[0].info["name"] = "quick"
        self.assertIn("launches of a solver make wide intervals: `make report RUN", say("caption", inputs=few, found=found))

    def test_a_share_below_all_is_never_shown_as_all(self):
        self.assertEqual([*map(formats.share_of, (0.999, 1, 0.001))], ["99\u202f%", "100\u202f%", "<1\u202f%"])

    def update(self, *files) -> tuple[int, str, str]:
        return run("headline", self.folder, "--root", self.path, "--update", *files)

    def test_update_writes_the_blocks_of_all_files_and_draws_the_figure(self):
        readme, figure = self.path / "README.md", self.path / "report" / "reference" / "headline.svg"
        page, bare = self.path / "docs" / "results.md", self.path / "docs" / "bare.md"
        page.parent.mkdir()
        bare.write_text("no blocks\n", encoding="utf-8")
        readme.write_text("before\n<!-- numbers:headline -->\nstale text\n<!-- end -->\n<!-- numbers:limits -->99<!-- end -->, <!-- numbers:streams --><!-- end -->\n",
                          encoding="utf-8")
        page.write_text("<!-- numbers:headline -->\nstale text\n<!-- end -->\n\n<!-- numbers:headline-details -->\n<!-- end -->\n",
                        encoding="utf-8")
        seen = set()
        for _ in range(2):  # the second time changes nothing more
            self.assertEqual(self.update(readme, page, bare)[0], 0)
            text, more = readme.read_text(encoding="utf-8"), page.read_text(encoding="utf-8")
            self.assertTrue(text.startswith("before\n"))
            self.assertIn("](report/reference/headline.svg)", text)
            self.assertIn("](../report/reference/headline.svg)", more)
            self.assertIn("1000 problems up to 30 rows, 256 problems up to 100 rows and 64 problems up to 1000 rows", text)
            self.assertNotIn("stale text", text + more)
            self.assertEqual(bare.read_text(encoding="utf-8"), "no blocks\n")
            xml.etree.ElementTree.parse(figure)
            seen.add((text, more, figure.read_bytes()))
        self.assertEqual(len(seen), 1)

    def test_the_short_headline_and_the_details_are_all_of_the_long_one(self):
        by_class, by_solver = shown_tables.classes(self.found).markdown(), shown_tables.by_solver(self.found).markdown()
        readme = self.path / "short.md"
        readme.write_text("<!-- numbers:headline -->\n<!-- end -->\n", encoding="utf-8")
        self.assertEqual(self.update(readme)[0], 0)
        short, details = readme.read_text(encoding="utf-8"), markdown.full_headline(self.inputs, self.found, "details")
        table = shown_tables.short(self.found).markdown()
        self.assertIn(table + "\n" + say("not_won", rows=not_won(self.found)) + "\n\n![", short)
        self.assertNotIn(by_class, short)
        # What we lose stands directly below the table.
        self.assertIn(by_class + "\n" + summary.peers(self.found), self.text)
        self.assertIn(by_solver, details)
        self.assertIn("False successes", details)
        for part in (by_class, details, say("caption", inputs=self.inputs, found=self.found)):
            self.assertIn(part, self.text)

    def test_files_without_blocks_or_with_an_unknown_one_are_refused_before_anything_is_written(self):
        good, bad = self.path / "good.md", self.path / "bad.md"
        stale = "<!-- numbers:limits -->99<!-- end -->"
        good.write_text(stale, encoding="utf-8")
        for text, files in (("no blocks", [bad]), ("<!-- numbers:nonsense -->1<!-- end -->", [good, bad])):
            bad.write_text(text, encoding="utf-8")
            self.assert_refused("headline", self.folder, "--root", self.path, "--update", *files)
            self.assertEqual(bad.read_text(encoding="utf-8"), text)
        self.assertEqual(good.read_text(encoding="utf-8"), stale)

    def test_the_summary_holds_its_lines_and_tables(self):
        inputs = load_inputs([self.folder, write_steps(self.path / "sequences")])
        text = markdown.render(inputs, ["A first finding.", "A second one."])
        for part in ("- A first finding.\n- A second one.", shown_tables.classes(headline(inputs)).markdown(),
                     "## Verified and false", "## Sequences of motions", ENVIRONMENT["cpu"]):
            self.assertIn(part, text)
        false = inputs.analysis["coverage"].query("solver == @FAILING and tier == 1e-6 and set == 'counted'",
                                                  local_dict={"FAILING": FAILING})["false_successes"].iloc[0]
        row = next(line for line in text.splitlines()[text.splitlines().index("## Verified and false"):]
                   if line.startswith(f"| `{FAILING}`"))
        self.assertIn(f"✗ {false}", row)

    def test_a_summary_of_sequences_alone_has_no_table_of_times(self):
        inputs = load_inputs([write_steps(self.path / "alone")])
        text = markdown.render(inputs, [])
        self.assertNotIn("## Times", text)
        self.assertIn("## Sequences of motions", text)
