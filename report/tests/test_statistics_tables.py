"""From a campaign's folder to its tables: what they hold, and what is refused."""

import csv
import json
import lzma
import re
import unittest
from pathlib import Path

import numpy as np
import pandas as pd

from lcpbench_report.compact import compact
from lcpbench_report.statistics import means
from lcpbench_report.statistics.cells import CAUSES, cell_table
from lcpbench_report.statistics.coverage import coverage_table
from lcpbench_report.statistics.load import load_campaign
from lcpbench_report.statistics.tables import FOLDER, TABLES
from .cases import FolderCase, SharedFolderCase, campaign_of, edit_info, edit_lines, run
from .synthetic_campaign import (COPIES, EXPONENT, FAMILIES, ORACLE_PER_ROW, PARTS, SIZES, TIERS, TIME_LIMIT, exclude, fail,
                                write_campaign)

FACTORS = {"quick": 1.0, "liar": 2.0, "limited": 3.0}
REFUSALS = Path(__file__).parents[2] / "tests/data/refusals"
COUNTED = len(FAMILIES) * len(SIZES) * COPIES


def _change(record: dict) -> dict:
    if record["solver"] == "liar" and record["tier"] == min(TIERS):
        return fail(record, "solved")
    if record["solver"] == "limited" and "-500-" in record["problem"]:
        return exclude(record)
    if record["solver"] == "limited" and "-200-" in record["problem"]:
        return fail(record, "time_limit")
    if record["solver"] == "limited" and "-100-0" in record["problem"]:
        return fail(record, "unsupported")
    return record


def _misfit(field: dict, text: str, missing: list[str]) -> str:
    """Why a value is none of a Table Schema's field; "" where it is."""
    limits = field.get("constraints", {})
    if text in missing:
        return "is missing" if limits.get("required") else ""
    if field["type"] == "boolean":
        return "" if text in ("true", "false") else f"{text} is no boolean"
    if field["type"] == "string":
        return "" if re.fullmatch(limits.get("pattern", ".*"), text) else f"{text} is another text"
    try:
        value = (int if field["type"] == "integer" else float)(text)
    except ValueError:
        return f"{text} is no {field['type']}"
    return "" if value >= limits.get("minimum", value) else f"{text} is too small"


class Tables(SharedFolderCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.folder = write_campaign(cls.path, FACTORS, change=_change)
        cls.status, cls.out, cls.error = run("analyse", cls.folder)
        cls.tables = {name: pd.read_csv(cls.folder / FOLDER / f"{name}.csv") for name in TABLES}

    def test_all_is_written_without_a_word(self):
        self.assertEqual((self.status, self.error), (0, ""))
        for name, table in self.tables.items():
            self.assertEqual(table.empty, name in ("rivals", "equal_flags", "friction"), name)
        line = (self.folder / FOLDER / "cells.csv").read_text(encoding="utf-8").splitlines()[1]
        self.assertEqual(("true" in line.split(","), "True" in line), (True, False))  # booleans are words

    def test_a_cell_is_a_row(self):
        cells = self.tables["cells"]
        self.assertEqual(len(cells), (COUNTED + 1) * len(FACTORS) * len(TIERS))
        self.assertFalse(cells.duplicated(["problem", "solver", "tier"]).any())
        run = cells[cells["verdict"] == "verified"]
        self.assertEqual(set(run["timed"]), {5})
        np.testing.assert_allclose(run["prepare_s"] / run["problem_s"], PARTS["prepare_s"] / PARTS["problem_s"])
        self.assertTrue((run["again_s"] < run["fresh_s"]).all())

    def test_the_long_table_is_as_its_schema_says(self):
        schema = json.loads((Path(__file__).parents[2] / "docs/formats/cells.table.json").read_text(encoding="utf-8"))
        with (self.folder / FOLDER / "cells.csv").open(encoding="utf-8", newline="") as file:
            lines = csv.DictReader(file)
            self.assertEqual(lines.fieldnames, [field["name"] for field in schema["fields"]])
            keys = set()
            for line in lines:
                for field in schema["fields"]:
                    self.assertEqual(_misfit(field, line[field["name"]], schema["missingValues"]), "", field["name"])
                keys.add(tuple(line[name] for name in schema["primaryKey"]))
            self.assertEqual(len(keys), lines.line_num - 1)

    def test_only_what_is_verified_has_a_time(self):
        cells = self.tables["cells"]
        verified = cells["verdict"] == "verified"
        self.assertTrue((cells.loc[verified, "time_s"] == cells.loc[verified, "fresh_s"]).all())
        self.assertTrue(np.isinf(cells.loc[~verified, "time_s"]).all())
        self.assertEqual(set(cells["verdict"]), {"verified", "false success", "out of time", "excluded", "not asked"})

    def test_what_does_not_count_has_tables_of_its_own(self):
        for name in ("means", "coverage"):
            self.assertEqual(set(self.tables[name]["set"]), {"counted"}, name)

    def test_what_a_solver_does_not_take_is_neither_failed_nor_in_its_share(self):
        for row in self.tables["coverage"].to_dict("records"):
            kinds = ("verified", "false_successes", "below_tier", "failed", "out_of_time", "excluded", "not_asked")
            self.assertEqual(sum(row[kind] for kind in kinds), row["problems"])
            self.assertEqual(row["not_asked"], len(FAMILIES) * (row["solver"] == "limited"))
            taken = row["problems"] - row["not_asked"]
            self.assertAlmostEqual(row["verified_share"], row["verified"] / taken, places=5)
            self.assertAlmostEqual(row["taken_share"], taken / row["problems"], places=5)
        of_class = self.tables["class_times"]
        of_class = of_class[(of_class["solver"] == "limited") & (of_class["size_class"] == "31-100")]
        self.assertEqual(set(of_class["not_asked"]), {len(FAMILIES)})
        self.assertEqual(set(of_class["verified_share"]), {1})
        self.assertTrue(np.isfinite(of_class["median_s"]).all())

    def test_scaling_finds_the_exponent(self):
        table = self.tables["scaling"]
        self.assertEqual(set(table["family"]), set(FAMILIES))
        self.assertNotIn(("liar", min(TIERS)), set(zip(table["solver"], table["tier"])))
        self.assertTrue((abs(table["exponent"] - EXPONENT) < 0.1).all())
        self.assertTrue((table["exponent_low"] < table["exponent"]).all())
        self.assertEqual(set(table.loc[table["solver"] == "limited", "rows_max"]), {100})

    def test_oracle_units(self):
        cells = self.tables["cells"]
        row = cells[(cells["solver"] == "quick") & (cells["rows"] == 100)].iloc[0]
        self.assertAlmostEqual(row["oracle_ratio"], row["time_s"] / (100 * ORACLE_PER_ROW), places=5)

    def test_the_same_files_give_the_same_tables(self):
        before = {path.name: path.read_bytes() for path in (self.folder / FOLDER).iterdir()}
        self.assertEqual(run("analyse", self.folder)[0], 0)
        for path in (self.folder / FOLDER).iterdir():
            self.assertEqual(path.read_bytes(), before[path.name], path.name)


class Verdicts(FolderCase):
    """From lines to the verdict and the time that counts, one thing at a time."""

    def cells(self, change=lambda record: record, edit=lambda line: line, **arguments) -> pd.DataFrame:
        write_campaign(self.folder, {"a": 1.0}, tiers=TIERS[:1], copies=2, change=change, **arguments)
        edit_lines(self.folder / "streams.jsonl", edit)
        return cell_table(load_campaign(self.folder)).set_index("problem")

    def test_the_time_that_counts(self):
        times = [5e-3, 1e-3, 3e-3, 2e-3, 9e-3]
        for why, record, expected in (
                ("the median of the launches that are not flagged", {"fresh_s": [3e-3, 2.8e-3, 3.1e-3, 9e-3]},
                 {"time_s": 3e-3, "timed": 4, "flagged": 1}),
                ("of all where there are no others", {"fresh_s": times[:2]}, {"time_s": 3e-3, "flagged": 2}),
                ("a pass without a time is none", {"fresh_s": [None, 4e-3, None, 2e-3]}, {"time_s": 3e-3, "timed": 2}),
                ("of the solve that was judged where no pass has one", {"fresh_s": [None] * 5, "first_s": 7e-3},
                 {"time_s": 7e-3, "timed": 0})):
            found = self.cells(lambda r, record=record: r | record)
            for column, value in expected.items():
                self.assertEqual(set(found[column]), {value}, why)

    def test_out_of_time_is_what_took_longer_or_was_ended_or_left_out_for_it_and_never_right(self):
        late, rule = 2 * TIME_LIMIT, "out of time at the looser tier 1e-3"
        for why, change, out in (("judged", {"first_s": late}, 1), ("timed", {"fresh_s": [late] * 5}, 1), ("at the limit", {"first_s": 1.0}, 0),
                                 ("ended", {"claim": "time_limit", "passes": False}, 1), ("killed", {"claim": "killed", "passes": False}, 1),
                                 ("by rule", {"excluded": rule}, 1), ("another rule", {"excluded": "rows > 100"}, 0),
                                 ("wrong before it is late", {"claim": "solved", "passes": False, "false_success": True, "first_s": late}, 0)):
            found = self.cells(lambda r, change=change: r | change)
            row = coverage_table(found.reset_index()).iloc[0]
            self.assertEqual((row["out_of_time"], row["verified"]), (out * row["problems"], (why == "at the limit") * row["problems"]), why)
            self.assertTrue(np.isfinite(found["time_s"]).all() if why == "at the limit" else np.isinf(found["time_s"]).all(), why)
            compact(self.folder, self.folder / why)  # the time that was judged is not kept
            self.assertEqual(cell_table(load_campaign(self.folder / why))["verdict"].tolist(), found["verdict"].tolist(), why)

    def test_false_successes_have_one_cause_each(self):
        tier = TIERS[0]
        for cause, rho, shifted in (("eta", tier, False), ("near", 10 * tier, False), ("far", 10.1 * tier, False), ("far", None, False),
                                    ("shifted", 10.1 * tier, True), ("shifted", tier, True)):
            found = self.cells(lambda r, rho=rho: fail(r, "solved") | {"rho": rho}, solvers={"a": {"shifted": shifted}})
            row = coverage_table(found.reset_index()).iloc[0]
            self.assertEqual({name: row[f"false_{name}"] for name in CAUSES},
                             dict.fromkeys(CAUSES, 0) | {cause: row["false_successes"]}, (cause, rho))
        self.assertEqual(set(self.cells()["cause"]), {""})

    def test_what_had_no_turn_is_excluded_by_the_budget(self):
        def edit(line):
            if line["kind"] != "judge" or line["size_class"] != "31-100":
                return line
            arrays = {key: value[:3] for key, value in line.items() if isinstance(value, list)}
            return line | arrays | {"attempted": 3}
        found = self.cells(edit=edit)
        self.assertEqual(dict(found["excluded"].value_counts())["task budget"], 6)  # eight and the engine's problem
        self.assertTrue(np.isinf(found.loc[found["excluded"] == "task budget", "time_s"]).all())

    def test_a_rule_may_exclude_one_problem_of_a_task(self):
        def edit(line):
            out = {"at": 1, "claim": "excluded", "passes": False, "reason": "out of time at 1e-3"}
            return line | {"exceptions": [out]} if line["kind"] == "judge" and line["size_class"] == "7-12" else line
        row = self.cells(edit=edit).loc["piles-10-1"]
        self.assertEqual((row["verdict"], row["excluded"], row["claim"]), ("out of time", "out of time at 1e-3", ""))

    def test_an_answer_that_changed_and_is_wrong_in_a_timed_pass_has_failed(self):
        def edit(line):
            return line | {"failed": [1]} if line["kind"] == "fresh" and line["pass"] == 2 else line
        row = self.cells(edit=edit).loc["piles-10-1"]
        self.assertEqual((row["verdict"], row["passes"], row["claim"]), ("failed:changed", False, "solved"))
        self.assertTrue(np.isinf(row["time_s"]))

    def test_another_b_that_is_not_solved_takes_for_ever(self):
        found = self.cells(edit=lambda line: line | {"failed": [0]} if line["kind"] == "again" else line)
        self.assertTrue(np.isinf(found.loc["piles-10-0", "again_s"]))
        self.assertEqual(found.loc["piles-10-0", "verdict"], "verified")

    def test_below_the_floor_is_what_no_solver_passes_and_has_failed_all_the_same(self):
        def change(record):
            if record["problem"] == "piles-10-0" or (record["problem"] == "piles-10-1" and record["solver"] == "a"):
                return fail(record, "numerical_failure") | {"below_floor": True}
            return record
        write_campaign(self.folder, {"a": 1.0, "b": 1.0}, tiers=TIERS[:1], copies=2, change=change)
        found = cell_table(load_campaign(self.folder)).set_index(["problem", "solver"])
        self.assertEqual([found.loc[cell, "below_floor"] for cell in (("piles-10-0", "a"), ("piles-10-0", "b"),
                                                                      ("piles-10-1", "a"), ("piles-10-1", "b"))],
                         [True, True, False, False])
        self.assertEqual(set(found.loc["piles-10-0", "verdict"]), {"failed:numerical_failure"})

    def test_a_stored_campaign_may_lack_what_is_younger(self):
        def edit(line):
            for one in line.get("exceptions", []):
                del one["below_floor"]
            return line
        found = self.cells(lambda r: fail(r, "numerical_failure"), edit=edit)
        self.assertFalse(found["below_floor"].any())

    def test_who_was_not_asked_for_the_tier_answers_below_it(self):
        found = self.cells(lambda r: fail(r, "solved"), solvers={"a": {"tolerance": "default"}})
        self.assertEqual(set(found["verdict"]), {"below the tier"})
        self.assertEqual((set(found["asked"]), set(found["false_success"])), ({False}, {True}))
        found = self.cells(lambda r: fail(r, "solved"), solvers={"a": {"tolerance": "direct"}})
        self.assertEqual((set(found["asked"]), set(found["verdict"])), ({True}, {"false success"}))


class Exponents(unittest.TestCase):
    def test_the_interval_holds_the_true_exponent(self):
        rows, held, seeds = np.repeat(SIZES, 3), 0, 300
        for seed in range(seeds):
            rng = np.random.default_rng([30, seed])
            fit = means.fit_exponent(rows, 1e-7 * rows**2.5 * np.exp(rng.normal(0, 0.4, len(rows))))
            held += fit["exponent_low"] <= 2.5 <= fit["exponent_high"]
        self.assertTrue(0.92 <= held / seeds <= 0.98, held / seeds)


class Files(FolderCase):
    """A small campaign, and one thing wrong with it."""

    def setUp(self):
        super().setUp()
        self._write()

    def test_a_torn_last_line_is_passed_over_with_a_note_and_one_that_only_lacks_its_break_counts(self):
        whole = cell_table(load_campaign(self.folder))
        streams = self.folder / "streams.jsonl"
        text = streams.read_bytes()
        last = text.rstrip(b"\n").rsplit(b"\n", 1)[1]
        for cut in (1, len(last) // 2, len(last) - 1):
            streams.write_bytes(text + last[:cut])
            campaign = load_campaign(self.folder)
            self.assertEqual(len(campaign.notes), 1)
            self.assertIn(f"streams.jsonl:{text.count(10) + 1}:", campaign.notes[0])
            pd.testing.assert_frame_equal(cell_table(campaign), whole)
        streams.write_bytes(text.rstrip(b"\n"))
        campaign = load_campaign(self.folder)
        self.assertEqual(campaign.notes, [])
        pd.testing.assert_frame_equal(cell_table(campaign), whole)

    def test_lines_may_come_in_any_order(self):
        whole = cell_table(load_campaign(self.folder))
        self._set_lines(self._lines("streams.jsonl")[::-1])
        again = cell_table(load_campaign(self.folder))
        key = ["problem", "solver"]
        pd.testing.assert_frame_equal(again.sort_values(key, ignore_index=True), whole.sort_values(key, ignore_index=True))

    def test_anything_else_that_is_not_json_is_refused(self):
        for edit, word in ((lambda line: line[:-9], ""), (lambda line: '{"tier": NaN}', "NaN"),
                           (lambda line: "[1, 2]", "an object")):
            self._write()
            self._edit_line("streams.jsonl", 2, edit)
            self._expect_refused("streams.jsonl:3", word)

    def test_what_does_not_fit_is_refused_with_its_line_and_key(self):
        compact(self.folder, self.folder / "kept")
        records = lzma.decompress((self.folder / "kept/records.jsonl.xz").read_bytes())
        for wrong in (REFUSALS / "campaign_files.txt").read_text(encoding="utf-8").splitlines():
            if wrong.startswith("#"):
                continue
            place, key, value = wrong.split(" ", 2)
            name, _, line = place.partition(":")
            with self.subTest(wrong):
                self._write()
                path = self.folder / "records.jsonl"  # which is read instead of streams where it is there
                path.unlink(missing_ok=True)
                if name == path.name:
                    path.write_bytes(records)
                self._edit_line(name, int(line) - 1, lambda line: json.dumps(json.loads(line) | {key: json.loads(value)}))
                self._expect_refused(place, key)

    def test_every_key_is_missed(self):
        for index in (0, 1, 6, 7):  # judge, fresh, parts, again
            record = json.loads(self._lines("streams.jsonl")[index])
            unread = {"excluded"} if index else set()
            for key in set(record) - unread - ({"failed"} if index == 6 else set()):
                with self.subTest(kind=record["kind"], key=key):
                    self._edit_line("streams.jsonl", index,
                                    lambda line: json.dumps({k: record[k] for k in record if k != key}))
                    self._expect_refused(f"streams.jsonl:{index + 1}", f"'{key}'")
                    self._edit_line("streams.jsonl", index, lambda line: json.dumps(record))

    def test_exceptions_of_earlier_versions_lack_what_is_within_rounding(self):
        known = {"claim": "infeasible", "passes": False, "at_floor": False, "false_success": False,
                 "false_infeasible": False, "proved_infeasible": True, "reason": "", "detail": ""}
        for more, expected in (({}, False), ({"infeasible_within_rounding": False, "force_min": None}, False),
                               ({"infeasible_within_rounding": True, "force_min": 1e14}, True)):
            with self.subTest(more=more):
                self._edit_line("streams.jsonl", 0, lambda line: json.dumps(
                    json.loads(line) | {"exceptions": [{"at": 0} | known | more]}))
                cells = cell_table(load_campaign(self.folder))
                self.assertEqual(cells["proved_infeasible"].sum(), 1)
                self.assertEqual(cells["infeasible_within_rounding"].any(), expected)

    def test_lines_that_say_the_same_thing_twice_or_lack_their_judge_line_are_refused(self):
        for name, index, words in (("streams.jsonl", 0, "judged twice"), ("streams.jsonl", 1, "pass 1"),
                                   ("problems.jsonl", 0, "twice")):
            with self.subTest(name=name):
                self._write()
                lines = self._lines(name)
                (self.folder / name).write_text("\n".join([*lines, lines[index]]) + "\n", encoding="utf-8")
                self._expect_refused(f"{name}:{len(lines) + 1}", words)
        self._write()
        self._set_lines(self._lines("streams.jsonl")[1:])  # a pass of a task that is not judged
        self._expect_refused("streams.jsonl:1", "judge")

    def test_missing_files_and_other_schemas_are_refused(self):
        info = edit_info(self.folder)
        solver = info["solvers"][0]
        for members, word in (({"schema": "lcpbench-campaign/1"}, "schema"), ({"solvers": info["solvers"] * 2}, "'a'"),
                              ({"solvers": [solver | {"tolerance": "own"}]}, "tolerance"),
                              ({"size_classes": info["size_classes"] * 2}, "size_classes")):
            edit_info(self.folder, **info | members)
            self._expect_refused("campaign.json", word)
        for text in ("{", "[]", "\x00"):
            (self.folder / "campaign.json").write_text(text, encoding="utf-8")
            self._expect_refused("campaign.json")
        (self.folder / "campaign.json").write_text(json.dumps(info), encoding="utf-8")
        for name in ("streams.jsonl", "problems.jsonl", "campaign.json"):
            (self.folder / name).unlink()
            self._expect_refused(name)
        self.assertEqual(run("analyse", self.folder / "nowhere")[0], 2)

    def test_where_nothing_is_verified_or_was_run_the_tables_are_there(self):
        self._write(change=exclude)
        self._expect_headers()
        self._set_lines([])
        self._expect_headers()
        self._write(change=fail)
        self._expect_headers()
        self.assertTrue(pd.read_csv(self.folder / FOLDER / "scaling.csv").empty)

    def test_excluded_cells_are_penalised_by_the_rule_for_the_limit(self):
        self._write(change=exclude)
        cells = cell_table(load_campaign(self.folder)).set_index("rows")["time_limit_s"]
        self.assertEqual(set(cells.loc[10]), {1.0})  # the least
        self.assertEqual(set(cells.loc[200]), {3.0})  # by 300 rows, the most of the class
        self.assertEqual(set(means.mean_table(cell_table(load_campaign(self.folder)))["penalised"]),
                         {len(FAMILIES) * len(SIZES)})

    def _write(self, **arguments) -> None:
        write_campaign(self.folder, {"a": 1.0, "b": 2.0}, tiers=TIERS[:1], copies=1, **arguments)

    def _set_lines(self, lines: list[str]) -> None:
        (self.folder / "streams.jsonl").write_text("".join(line + "\n" for line in lines), encoding="utf-8")

    def _lines(self, name: str) -> list[str]:
        return (self.folder / name).read_text(encoding="utf-8").splitlines()

    def _edit_line(self, name: str, index: int, edit) -> None:
        lines = self._lines(name)
        lines[index] = edit(lines[index])
        (self.folder / name).write_text("\n".join(lines) + "\n", encoding="utf-8")

    def _expect_refused(self, *words: str) -> None:
        self.assert_refused("analyse", self.folder, told=words)

    def _expect_headers(self) -> None:
        self.assertEqual(run("analyse", self.folder), (0, "", ""))
        for name in TABLES:
            self.assertGreater(len(pd.read_csv(self.folder / FOLDER / f"{name}.csv").columns), 5, name)


class Delivered(unittest.TestCase):
    def test_failures_count_with_their_time(self):
        """Of every third cell the answer is wrong: it is paid for, and its residual is among the quantiles."""
        wrong = iter(range(10**9))

        def spoil(record):
            if next(wrong) % 3 == 0:
                record |= {"passes": False, "claim": "iteration_limit", "rho": 0.5}
            return record

        cells = cell_table(campaign_of(write_campaign, {"a": 1.0}, tiers=(1e-3, 1e-6), change=spoil))
        table = means.delivered_table(cells[cells["counts"]])
        self.assertEqual(len(table), 2)
        for row in table.itertuples():
            of_tier = cells[cells["counts"] & (cells["tier"] == row.tier)]
            self.assertEqual(row.problems, len(of_tier))
            self.assertAlmostEqual(row.verified_share, (of_tier["verdict"] == "verified").mean())
            self.assertLess(row.verified_share, 1)
            self.assertEqual(row.rho_max, 0.5)
            self.assertGreater(row.mean_s, 0)
