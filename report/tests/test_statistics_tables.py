"""From a campaign's folder to its tables: what they hold, and what is refused."""

import contextlib
import io
import json
import sys
import tempfile
import unittest
from pathlib import Path

_REPORT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(_REPORT), str(_REPORT / "tests")]

import numpy as np  # noqa: E402
import pandas as pd  # noqa: E402

import analyse  # noqa: E402
from lcpbench_report.errors import ReportError  # noqa: E402
from lcpbench_report.statistics import accuracy, means, precision, scaling  # noqa: E402
from lcpbench_report.statistics.cells import cell_table  # noqa: E402
from lcpbench_report.statistics.load import load_campaign  # noqa: E402
from lcpbench_report.statistics.tables import FOLDER, TABLES  # noqa: E402
from synthetic_campaign import (COPIES, EXPONENT, FAMILIES, ORACLE_PER_ROW, SIZES, TIERS, exclude, fail,  # noqa: E402
                                write_campaign)

FACTORS = {"quick": 1.0, "same": 1.0, "slow": 1.1, "liar": 2.0, "limited": 3.0}
COUNTED = len(FAMILIES) * len(SIZES) * COPIES


def _change(record: dict) -> dict:
    if record["solver"] == "liar" and record["tier"] == min(TIERS):
        return fail(record, "solved")
    if record["solver"] == "limited" and "-500-" in record["problem"]:
        return exclude(record)
    if record["solver"] == "limited" and "-200-" in record["problem"]:
        return fail(record, "time_limit")
    return record


def _run(folder: Path) -> tuple[int, str]:
    """Exit status and standard error."""
    error = io.StringIO()
    with contextlib.redirect_stderr(error):
        status = analyse.main([str(folder)])
    return status, error.getvalue()


class Tables(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls._folder = tempfile.TemporaryDirectory()
        cls.folder = write_campaign(Path(cls._folder.name), FACTORS, change=_change)
        cls.status, cls.error = _run(cls.folder)
        cls.tables = {name: pd.read_csv(cls.folder / FOLDER / f"{name}.csv") for name in TABLES}

    @classmethod
    def tearDownClass(cls):
        cls._folder.cleanup()

    def test_all_is_written_without_a_word(self):
        self.assertEqual((self.status, self.error), (0, ""))
        for name, table in self.tables.items():
            self.assertFalse(table.empty, name)

    def test_a_cell_is_a_row(self):
        cells = self.tables["cells"]
        self.assertEqual(len(cells), (COUNTED + 1) * len(FACTORS) * len(TIERS))
        self.assertFalse(cells.duplicated(["problem", "solver", "tier", "mode"]).any())
        run = cells[cells["verdict"] != "excluded"]
        self.assertEqual(set(run["repetitions"]), {10})  # of two rounds
        ordered = run[["solve_min", "solve_p25", "solve_median", "solve_p75", "solve_p90", "solve_p99", "solve_max"]]
        self.assertTrue((ordered.diff(axis=1).iloc[:, 1:] >= 0).all().all())
        self.assertTrue((run["solve_low"] <= run["solve_median"]).all())
        self.assertTrue((run["solve_median"] <= run["solve_high"]).all())
        self.assertEqual(set(run["setup_s"]), {2e-6})

    def test_only_what_is_verified_has_a_time(self):
        cells = self.tables["cells"]
        verified = cells["verdict"] == "verified"
        self.assertTrue((cells.loc[verified, "time_s"] == cells.loc[verified, "solve_median"]).all())
        self.assertTrue(np.isinf(cells.loc[~verified, "time_s"]).all())
        self.assertEqual(set(cells["verdict"]), {"verified", "false success", "failed:time_limit", "excluded"})

    def test_booleans_are_words(self):
        line = (self.folder / FOLDER / "cells.csv").read_text(encoding="utf-8").splitlines()[1]
        self.assertIn("true", line.split(","))
        self.assertNotIn("True", line)

    def test_coverage_knows_the_liar_and_the_limited(self):
        table = self.tables["coverage"].set_index(["solver", "tier"])
        self.assertEqual(set(table["problems"]), {COUNTED})  # the engine's problem does not count
        self.assertEqual(table.loc[("liar", min(TIERS)), "false_share"], 1)
        self.assertEqual(table.loc[("liar", max(TIERS)), "false_share"], 0)
        limited = table.loc[("limited", TIERS[0])]
        per_size = COUNTED // len(SIZES)
        self.assertEqual(list(limited[["verified", "failed", "excluded"]]), [4 * per_size, per_size, per_size])
        self.assertAlmostEqual(limited["verified_of_attempted"], 4 / 5)

    def test_the_slower_one_is_found_and_the_same_one_is_not(self):
        table = self.tables["pairwise"]
        table = table[table["set"] == "counted"].set_index(["tier", "a", "b"])
        for tier in TIERS:
            self.assertEqual(table.loc[(tier, "quick", "slow"), "verdict"], "A faster")
            self.assertEqual(table.loc[(tier, "slow", "same"), "verdict"], "B faster")
            self.assertEqual(table.loc[(tier, "quick", "same"), "verdict"], "no difference")
            self.assertAlmostEqual(table.loc[(tier, "slow", "quick"), "ratio"], 1.1, delta=0.03)

    def test_what_does_not_count_has_tables_of_its_own(self):
        for name in ("profiles", "means", "coverage"):
            self.assertEqual(set(self.tables[name]["set"]), {"counted"}, name)
        for name in ("pairwise", "oracle", "precision"):
            self.assertEqual(set(self.tables[name]["set"]), {"counted", "engine"}, name)

    def test_profiles_end_at_the_coverage(self):
        profiles = self.tables["profiles"]
        last = profiles[profiles["tau"] == profiles["tau"].max()].set_index(["solver", "tier"])["share"]
        covered = self.tables["coverage"].set_index(["solver", "tier"])["verified_share"]
        pd.testing.assert_series_equal(last.sort_index(), covered.sort_index(), check_names=False)

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
        table = self.tables["oracle"].set_index(["set", "solver", "tier"])
        self.assertEqual(table.loc[("counted", "limited", TIERS[0]), "problems"], COUNTED * 4 // 6)
        self.assertNotIn(("counted", "liar", min(TIERS)), table.index)

    def test_work_over_precision_asks_the_same_problems_of_every_tier(self):
        table = self.tables["precision"]
        table = table[table["set"] == "counted"]
        for _, curve in table.groupby(["solver", "strictest"]):
            self.assertEqual(curve["problems"].nunique(), 1)
            self.assertTrue((curve["mean_s"].diff().dropna() > 0).all())  # as the generator has it
            np.testing.assert_allclose(curve["rho_max"], curve["tier"] / 3, rtol=1e-8)
        self.assertEqual(set(table.loc[table["solver"] == "liar", "strictest"]), set(TIERS[:2]))

    def test_accuracy_of_claims_shows_what_verified_ones_hide(self):
        table = self.tables["accuracy"]
        self.assertEqual(set(table["metric"]), {"rho", "backward_error", "w_error"})  # f_error is known nowhere
        liar = table[(table["solver"] == "liar") & (table["tier"] == min(TIERS)) & (table["metric"] == "rho")]
        self.assertEqual(list(liar["answers"]), ["claimed"])
        self.assertEqual(list(liar["median"]), [1.0])
        self.assertEqual(set(table["reference"]), {"certified"})  # the engine's problem has none

    def test_the_same_files_give_the_same_tables(self):
        before = {path.name: path.read_bytes() for path in (self.folder / FOLDER).iterdir()}
        self.assertEqual(_run(self.folder)[0], 0)
        for path in (self.folder / FOLDER).iterdir():
            self.assertEqual(path.read_bytes(), before[path.name], path.name)


class Exponents(unittest.TestCase):
    def test_the_interval_holds_the_true_exponent(self):
        rows, held, robust, seeds = np.repeat(SIZES, 3), 0, 0, 300
        for seed in range(seeds):
            rng = np.random.default_rng([30, seed])
            fit = scaling.fit_exponent(rows, 1e-7 * rows**2.5 * np.exp(rng.normal(0, 0.4, len(rows))))
            held += fit["exponent_low"] <= 2.5 <= fit["exponent_high"]
            robust += fit["theil_sen_low"] <= 2.5 <= fit["theil_sen_high"]
        self.assertTrue(0.92 <= held / seeds <= 0.98, held / seeds)
        self.assertTrue(0.88 <= robust / seeds <= 0.99, robust / seeds)


class Files(unittest.TestCase):
    """A small campaign, and one thing wrong with it."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = write_campaign(Path(folder.name), {"a": 1.0, "b": 2.0}, tiers=TIERS[:1], copies=1)

    def test_a_torn_last_line_is_passed_over_with_a_note(self):
        whole = cell_table(load_campaign(self.folder))
        cells = self.folder / "cells.jsonl"
        text = cells.read_bytes()
        last = text.rstrip(b"\n").rsplit(b"\n", 1)[1]
        for cut in (1, len(last) // 2, len(last) - 1):
            cells.write_bytes(text + last[:cut])
            campaign = load_campaign(self.folder)
            self.assertEqual(len(campaign.notes), 1)
            self.assertIn(f"cells.jsonl:{text.count(10) + 1}:", campaign.notes[0])
            pd.testing.assert_frame_equal(cell_table(campaign), whole)
        status, error = _run(self.folder)
        self.assertEqual((status, error.count("\n")), (0, 1))

    def test_a_last_line_that_only_lacks_its_break_counts(self):
        cells = self.folder / "cells.jsonl"
        whole = cell_table(load_campaign(self.folder))
        cells.write_bytes(cells.read_bytes().rstrip(b"\n"))
        campaign = load_campaign(self.folder)
        self.assertEqual(campaign.notes, [])
        pd.testing.assert_frame_equal(cell_table(campaign), whole)

    def test_anything_else_that_is_not_json_is_refused(self):
        self._edit_line("cells.jsonl", 2, lambda line: line[:-9])
        self._expect_refused("cells.jsonl:3")
        self._edit_line("cells.jsonl", 2, lambda line: '{"tier": NaN}')
        self._expect_refused("cells.jsonl:3", "NaN")
        self._edit_line("cells.jsonl", 2, lambda line: "[1, 2]")
        self._expect_refused("cells.jsonl:3", "an object")

    def test_what_is_not_known_is_refused(self):
        for key, value in (("problem", "elsewhere"), ("solver", "nobody"), ("solver", "absent"), ("tier", 1e-4),
                           ("mode", "lukewarm"), ("round", -1), ("round", 0.5)):
            with self.subTest(key=key, value=value):
                self._with_cell(**{key: value})
                self._expect_refused("cells.jsonl:1", key)

    def test_values_that_do_not_fit_are_refused(self):
        for key, value in (("passes", 1), ("passes", "true"), ("solve_s", []), ("solve_s", [1e-3, 0.0]),
                           ("solve_s", [-1e-3]), ("solve_s", 1e-3), ("metrics", {"rho": "small"}), ("time_limit_s", 0),
                           ("claim", None), ("excluded", None)):
            with self.subTest(key=key, value=value):
                self._with_cell(**{key: value})
                self._expect_refused("cells.jsonl:1")

    def test_every_key_is_missed(self):
        record = json.loads(self._lines("cells.jsonl")[0])
        for key in set(record) - {"detail", "environment"}:
            with self.subTest(key=key):
                self._edit_line("cells.jsonl", 0, lambda line: json.dumps({k: record[k] for k in record if k != key}))
                self._expect_refused("cells.jsonl:1", f"'{key}'")
                self._edit_line("cells.jsonl", 0, lambda line: json.dumps(record))

    def test_lines_that_say_the_same_thing_twice_are_refused(self):
        for name, words in (("cells.jsonl", "round 0"), ("problems.jsonl", "twice")):
            with self.subTest(name=name):
                lines = self._lines(name)
                (self.folder / name).write_text("\n".join([*lines, lines[0]]) + "\n", encoding="utf-8")
                self._expect_refused(f"{name}:{len(lines) + 1}", words)
                (self.folder / name).write_text("\n".join(lines) + "\n", encoding="utf-8")

    def test_a_cell_without_a_first_round_is_refused(self):
        lines = self._lines("cells.jsonl")
        (self.folder / "cells.jsonl").write_text("\n".join(lines[1:]) + "\n", encoding="utf-8")
        self._expect_refused("round 0")

    def test_missing_files_and_other_schemas_are_refused(self):
        info = json.loads((self.folder / "campaign.json").read_text(encoding="utf-8"))
        for text in (json.dumps(info | {"schema": "lcpbench-campaign/2"}), "{", "[]", "\x00"):
            (self.folder / "campaign.json").write_text(text, encoding="utf-8")
            self._expect_refused("campaign.json")
        (self.folder / "campaign.json").write_text(json.dumps(info | {"solvers": info["solvers"] * 2}),
                                                   encoding="utf-8")
        self._expect_refused("'a'")
        (self.folder / "campaign.json").write_text(json.dumps(info), encoding="utf-8")
        for name in ("cells.jsonl", "problems.jsonl", "campaign.json"):
            (self.folder / name).unlink()
            self._expect_refused(name)
        status, error = _run(self.folder / "nowhere")
        self.assertEqual((status, error.count("\n")), (2, 1))

    def test_where_nothing_is_verified_the_tables_are_there(self):
        lines = [json.dumps(fail(json.loads(line))) for line in self._lines("cells.jsonl")]
        (self.folder / "cells.jsonl").write_text("\n".join(lines) + "\n", encoding="utf-8")
        self._expect_headers()
        for name in ("scaling", "precision", "oracle"):
            self.assertTrue(pd.read_csv(self.folder / FOLDER / f"{name}.csv").empty, name)
        profiles = pd.read_csv(self.folder / FOLDER / "profiles.csv")
        self.assertEqual(set(profiles["share"]), {0})

    def test_so_they_are_where_nothing_was_run(self):
        excluded = [json.dumps(exclude(json.loads(line))) for line in self._lines("cells.jsonl")]
        for lines in (excluded, []):
            (self.folder / "cells.jsonl").write_text("".join(line + "\n" for line in lines), encoding="utf-8")
            self._expect_headers()

    def test_excluded_cells_are_penalised_by_the_rule_for_the_limit(self):
        lines = [json.dumps(exclude(json.loads(line))) for line in self._lines("cells.jsonl")]
        (self.folder / "cells.jsonl").write_text("\n".join(lines) + "\n", encoding="utf-8")
        cells = cell_table(load_campaign(self.folder)).set_index("rows")["time_limit_s"]
        self.assertEqual(set(cells.loc[10]), {1.0})  # the least
        self.assertEqual(set(cells.loc[200]), {2.0})
        self.assertEqual(set(means.mean_table(cell_table(load_campaign(self.folder)))["penalised"]),
                         {len(FAMILIES) * len(SIZES)})

    def test_a_round_with_another_verdict_lends_no_times(self):
        record = json.loads(self._lines("cells.jsonl")[1])  # round 1 of the first cell
        self.assertEqual(record["round"], 1)
        self._edit_line("cells.jsonl", 1, lambda line: json.dumps(fail(record) | {"solve_s": [0.0] * 50}))
        row = cell_table(load_campaign(self.folder)).iloc[0]
        self.assertEqual((row["verdict"], row["rounds"], row["rounds_changed"], row["repetitions"]),
                         ("verified", 2, 1, 5))
        self.assertGreater(row["solve_min"], 0)

    def test_warm_and_cold_are_never_mixed(self):
        lines = self._lines("cells.jsonl")
        warm = [json.dumps(json.loads(line) | {"mode": "warm", "solve_s": [1e-9] * 5}) for line in lines]
        (self.folder / "cells.jsonl").write_text("\n".join(lines + warm) + "\n", encoding="utf-8")
        table = means.mean_table(cell_table(load_campaign(self.folder)))
        seconds = table[table["unit"] == "s"].set_index(["mode", "solver"])["mean"]
        self.assertAlmostEqual(seconds["warm", "a"], 1e-9, delta=1e-12)
        self.assertGreater(seconds["cold", "a"], 1e-6)

    def test_answers_against_bounded_references_are_apart(self):
        problem = json.loads(self._lines("problems.jsonl")[0]) | {"reference": "bounded"}
        self._edit_line("problems.jsonl", 0, lambda line: json.dumps(problem))
        table = accuracy.accuracy_table(cell_table(load_campaign(self.folder)))
        self.assertEqual(set(table.loc[table["reference"] == "bounded", "problems"]), {1})

    def test_repetitions_of_a_cell_are_at_hand(self):
        campaign = load_campaign(self.folder)
        key = next(iter(campaign.cells))
        self.assertEqual([len(times) for times in campaign.repetitions(*key)], [5, 5])
        self.assertEqual(campaign.repetitions("elsewhere", "a", 1e-3), [])

    def test_a_solver_that_solves_nothing_strictly_keeps_its_looser_curves(self):
        cells = cell_table(load_campaign(write_campaign(self.folder, {"a": 1.0}, copies=1, change=lambda r: fail(r)
                                                        if r["tier"] == TIERS[1] else r)))
        table = precision.precision_table(cells)
        self.assertEqual(set(table["strictest"]), {TIERS[0]})

    def _lines(self, name: str) -> list[str]:
        return (self.folder / name).read_text(encoding="utf-8").splitlines()

    def _edit_line(self, name: str, index: int, edit) -> None:
        lines = self._lines(name)
        lines[index] = edit(lines[index])
        (self.folder / name).write_text("\n".join(lines) + "\n", encoding="utf-8")

    def _with_cell(self, **values) -> None:
        """Changes the first cell from what it was in the beginning."""
        if not hasattr(self, "_first"):
            self._first = json.loads(self._lines("cells.jsonl")[0])
        self._edit_line("cells.jsonl", 0, lambda line: json.dumps(self._first | values))

    def _expect_refused(self, *words: str) -> None:
        status, error = _run(self.folder)
        self.assertEqual((status, error.count("\n")), (2, 1), error)
        for word in words:
            self.assertIn(word, error)
        with self.assertRaises(ReportError):
            load_campaign(self.folder)

    def _expect_headers(self) -> None:
        self.assertEqual(_run(self.folder), (0, ""))
        for name in TABLES:
            self.assertGreater(len(pd.read_csv(self.folder / FOLDER / f"{name}.csv").columns), 5, name)


if __name__ == "__main__":
    unittest.main()
