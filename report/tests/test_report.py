"""Run: /usr/bin/python3 -m unittest discover -s report/tests

The mathematics on hand-made cases; the files on a synthetic results folder (synthetic.py), whole and damaged.
"""

import contextlib
import csv
import html.parser
import io
import json
import math
import re
import statistics
import sys
import tempfile
import unittest
from pathlib import Path

import pandas as pd

_REPORT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(_REPORT), str(_REPORT / "tests")]

import generate  # noqa: E402
from lcpbench_report import formats, stats, style, svg, tables, times  # noqa: E402
from lcpbench_report.cells import BENCHMARK, SINGLE_RUN, Cells  # noqa: E402
from lcpbench_report.errors import ReportError  # noqa: E402
from lcpbench_report.limitations import limitations  # noqa: E402
from lcpbench_report.load import load_results  # noqa: E402
from lcpbench_report.summary import ranking, size_classes, summary_lines  # noqa: E402
from lcpbench_report.timing import read_timing  # noqa: E402
from synthetic import EXTERNAL, FAMILIES, MISSING, OWN, PEERS, SIZES, SOLVERS, TIERS, write_results  # noqa: E402

INF, NAN = math.inf, math.nan


def _exclude(table, rows, rule):
    """Makes rows of accuracy.csv excluded by `rule`: all they said of an answer is gone."""
    kept = ("problem", "family", "n", "seed", "solver", "tier")
    table.loc[rows, [c for c in table.columns if c not in kept]] = ""
    table.loc[rows, "excluded"] = rule


class PerformanceProfile(unittest.TestCase):
    # a is best on p1 and p3 (there with b), b on p2; c fails on p1, nobody solves p4.
    TIMES = pd.DataFrame({"a": [1.0, 4.0, 3.0, INF], "b": [2.0, 2.0, 3.0, INF], "c": [INF, 8.0, 30.0, NAN]},
                         index=["p1", "p2", "p3", "p4"])

    def test_agrees_with_the_example_worked_by_hand(self):
        profile = stats.performance_profile(self.TIMES)
        self.assertEqual([list(part) for part in profile["a"]], [[1.0, 2.0], [0.5, 0.75]])
        self.assertEqual([list(part) for part in profile["b"]], [[1.0, 2.0], [0.5, 0.75]])
        self.assertEqual([list(part) for part in profile["c"]], [[1.0, 4.0, 10.0], [0.0, 0.25, 0.5]])

    def test_a_tie_counts_for_both(self):
        ratios = stats.time_ratios(self.TIMES)
        self.assertEqual(list(ratios.loc["p3"]), [1.0, 1.0, 10.0])

    def test_failures_lie_at_infinity_whether_written_inf_or_nan(self):
        ratios = stats.time_ratios(self.TIMES)
        self.assertEqual(ratios.at["p1", "c"], INF)
        self.assertTrue((ratios.loc["p4"] == INF).all())

    def test_curves_rise_and_end_at_the_share_solved(self):
        for solver, (steps, share) in stats.performance_profile(self.TIMES).items():
            self.assertTrue((share[1:] >= share[:-1]).all() and (steps[1:] > steps[:-1]).all())
            self.assertEqual(share[-1], (self.TIMES[solver] < INF).mean())

    def test_scaling_the_times_of_a_problem_changes_nothing(self):
        scaled = self.TIMES.mul([8.0, 0.5, 4.0, 2.0], axis=0)
        for solver, (steps, share) in stats.performance_profile(scaled).items():
            expected = stats.performance_profile(self.TIMES)[solver]
            self.assertEqual((list(steps), list(share)), tuple(map(list, expected)))

    def test_solvers_that_never_succeed_have_a_flat_line_at_zero(self):
        profile = stats.performance_profile(pd.DataFrame({"a": [1.0], "b": [INF]}))
        self.assertEqual([list(part) for part in profile["b"]], [[1.0], [0.0]])


class Slope(unittest.TestCase):
    def test_exact_power_law_is_recovered(self):
        for exponent in (0.5, 1.0, 2.75):
            sizes = [10, 30, 100, 300, 1000, 3000]
            slope = stats.fit_slope(sizes, [2e-7 * n**exponent for n in sizes])
            self.assertAlmostEqual(slope.exponent, exponent, places=12)
            self.assertAlmostEqual(slope.coefficient / 2e-7, 1.0, places=9)

    def test_small_sizes_do_not_count(self):
        sizes = [1, 2, 4, 8, 16, 32]
        slope = stats.fit_slope(sizes, [1.0, 1.0, 1.0, 8.0, 16.0, 32.0])
        self.assertAlmostEqual(slope.exponent, 1.0)
        self.assertEqual((slope.n_min, slope.n_max, slope.points), (8, 32, 3))

    def test_of_an_odd_number_of_sizes_the_middle_one_counts(self):
        self.assertEqual(stats.fit_slope([1, 2, 4, 8, 16], [1.0] * 5).points, 3)

    def test_missing_times_are_left_out(self):
        slope = stats.fit_slope([10, 20, 40, 80], [1.0, 2.0, NAN, 8.0])
        self.assertAlmostEqual(slope.exponent, 1.0)
        self.assertEqual(slope.points, 2)

    def test_one_size_has_no_slope(self):
        self.assertIsNone(stats.fit_slope([10], [1.0]))
        self.assertIsNone(stats.fit_slope([10, 10], [1.0, 2.0]))
        self.assertIsNone(stats.fit_slope([10, 100], [NAN, INF]))
        self.assertIsNone(stats.fit_slope([], []))


class SmallStatistics(unittest.TestCase):
    def test_geometric_mean(self):
        self.assertAlmostEqual(stats.geometric_mean([1.0, 10.0, 100.0]), 10.0)
        self.assertAlmostEqual(stats.geometric_mean([2.0, INF, NAN, 8.0]), 4.0)
        self.assertTrue(math.isnan(stats.geometric_mean([INF])))

    def test_nearest_sizes_are_nearest_by_ratio_and_appear_once(self):
        self.assertEqual(stats.nearest_sizes([10, 30, 100, 300, 1000, 3000], [10, 100, 1000]), [10, 100, 1000])
        self.assertEqual(stats.nearest_sizes([8, 64, 512], [10, 100, 1000]), [8, 64, 512])
        self.assertEqual(stats.nearest_sizes([50], [10, 100, 1000]), [50])
        self.assertEqual(stats.nearest_sizes([], [10]), [])

    def test_size_classes_are_labelled_by_what_is_present(self):
        self.assertEqual([c.label for c in size_classes([10, 30, 100, 3000])], ["n = 10–30", "n = 100", "n = 3000"])
        self.assertEqual([c.label for c in size_classes([1000])], ["n = 1000"])


class Formats(unittest.TestCase):
    def test_times_have_three_digits_in_the_unit_that_fits(self):
        cases = {4.1234e-6: "4.12 µs", 35e-3: "35.0 ms", 1.2: "1.20 s", 123.4e-9: "123 ns", 999.7e-6: "1.00 ms",
                 125.0: "125 s", NAN: "–", INF: "–", 0.0: "0 ns"}
        for value, text in cases.items():
            self.assertEqual(formats.seconds(value).replace("\u202f", " "), text)

    def test_residuals_name_what_is_not_a_number(self):
        self.assertEqual([formats.residual(v) for v in (1.23e-11, 0.0, INF, NAN)], ["1.2e-11", "0", "∞", "–"])

    def test_formulas_get_exponents_and_indices_but_names_stay(self):
        self.assertEqual(formats.formula("|D^-1/2 b|_2 < w_i"), "|D<sup>−1/2</sup> b|<sub>2</sub> &lt; w<sub>i</sub>")
        self.assertEqual(formats.formula("backward_error"), "backward_error")


class Timing(unittest.TestCase):
    @staticmethod
    def read(*entries):
        return read_timing({"benchmarks": list(entries)}, ["pile"], ["pgs"], [1e-3, 1e-6])

    def test_repetitions_of_a_cell_are_gathered_and_units_honoured(self):
        name = "solve/pile/10/pgs/1e-06/min_time:0.050/repeats:3/real_time"
        times = [(3.0, "us"), (1000.0, "ns"), (0.002, "ms")]
        cell, = self.read(*({"name": name, "run_name": name, "real_time": t, "time_unit": u} for t, u in times))
        self.assertEqual((cell.kind, cell.family, cell.n, cell.solver, cell.tier), ("solve", "pile", 10, "pgs", 1e-6))
        self.assertAlmostEqual(cell.median, 2e-6)
        self.assertAlmostEqual(cell.spread, 1.0)

    def test_aggregates_count_only_where_repetitions_were_not_kept(self):
        name = "setup/pile/10/pgs"
        median = {"name": name + "_median", "run_name": name, "run_type": "aggregate", "aggregate_name": "median",
                  "real_time": 7.0, "time_unit": "s"}
        mean = median | {"name": name + "_mean", "aggregate_name": "mean", "real_time": 9.0}
        run = {"name": name, "run_name": name, "run_type": "iteration", "real_time": 5.0, "time_unit": "s"}
        self.assertEqual([c.median for c in self.read(median, mean)], [7.0])
        self.assertEqual([c.median for c in self.read(median, mean, run)], [5.0])

    def test_a_refused_cell_has_a_reason_and_no_time(self):
        cell, = self.read({"name": "solve/pile/10/pgs/1e-03", "error_occurred": True, "error_message": "rho too large"})
        self.assertTrue(math.isnan(cell.median))
        self.assertEqual(cell.error, "rho too large")

    def test_unknown_names_are_errors(self):
        for name in ("solve/pile/10/pgs/1e-09", "solve/tower/10/pgs/1e-03", "solve/pile/10/lemke/1e-03",
                     "solve/pile/ten/pgs/1e-03", "solve/pile/10/pgs", "BM_Noise"):
            with self.assertRaisesRegex(ReportError, "timing.json: benchmark"):
                self.read({"name": name, "real_time": 1.0})

    def test_a_time_that_is_no_time_is_an_error(self):
        for entry in ({"real_time": NAN}, {"real_time": -1.0}, {}, {"real_time": 1.0, "time_unit": "h"}):
            with self.assertRaises(ReportError):
                self.read({"name": "solve/pile/10/pgs/1e-03", **entry})


class OnSyntheticResults(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.directory = tempfile.TemporaryDirectory()
        cls.folder = write_results(Path(cls.directory.name) / "results")
        cls.cells = Cells(load_results(cls.folder))

    @classmethod
    def tearDownClass(cls):
        cls.directory.cleanup()

    def test_false_successes_are_the_claims_that_do_not_hold(self):
        # synthetic.py: ipopt-qp at 1e-9 on the last family, n = 300 and 1000, three seeds each; nowhere else.
        rows = {(row["solver"], row["tier"]): row for row in tables.accuracy(self.cells)}
        for key, row in rows.items():
            self.assertFalse(row["absent"])
            self.assertEqual(row["false_success"], 6 if key == ("ipopt-qp", "1e-9") else 0)
            self.assertEqual(row["claimed"] - row["false_success"], row["verified"] - row["unclaimed"])
        line = next(line for line in summary_lines(self.cells) if line["label"] == "False successes")
        self.assertTrue(line["alert"])
        self.assertIn("ipopt-qp 6", line["text"])

    def test_every_problem_is_counted_once_per_solver_and_tier(self):
        for row in tables.accuracy(self.cells):
            self.assertEqual(row["problems"], len(self.cells.results.problems))
            self.assertEqual(row["claimed"] + sum(row["claims"]) + row["excluded"], row["problems"])

    def test_excluded_cells_count_as_problems_and_are_not_verified(self):
        row = tables.accuracy(self.cells)[0]
        self.assertEqual((row["solver"], row["excluded"]), ("dantzig", 15))
        times, _ = self.cells.problem_times(1e-9)
        self.assertEqual((times["dantzig"] == INF).sum(), 15)

    def test_the_residual_map_counts_what_passes_the_strictest_tier(self):
        runs = self.cells.runs[self.cells.runs["tier"] == min(TIERS)]
        for family in tables.residual_map(self.cells):
            mine = runs[runs["family"] == family["family"]]
            self.assertEqual((family["verified"], family["of"]), (int(mine["verified"].sum()), len(mine)))

    def test_residuals_are_taken_over_verified_answers_only(self):
        runs = self.cells.runs[(self.cells.runs["solver"] == "pgs") & (self.cells.runs["tier"] == 1e-9)]
        row = tables.accuracy_row(runs, [])
        self.assertLessEqual(float(row["rho_max"]), 1e-9)
        nothing = tables.accuracy_row(runs[~runs["verified"]], [])
        self.assertEqual((nothing["verified"], nothing["rho_median"], nothing["rho_max"]), (0, "–", "–"))

    def test_times_within_a_problem_come_from_one_source(self):
        runs, (times, repeated) = self.cells.runs, self.cells.problem_times(1e-3)
        self.assertEqual(repeated, len(self.cells.results.problems) // 3)  # the first of three seeds is timed
        for column, seeds in (("bench_s", {1}), ("solve_s", {2, 3})):
            good = runs[(runs["tier"] == 1e-3) & runs["verified"] & runs["seed"].isin(seeds)]
            for row in good.itertuples(index=False):
                self.assertEqual(times.at[row.problem, row.solver], getattr(row, column))

    def test_a_direct_method_has_one_time_for_every_tier(self):
        cells = [self.cells.get("rockers", 100, "dantzig", tier) for tier in TIERS]
        self.assertEqual({c.time_source for c in cells}, {BENCHMARK})
        self.assertEqual(len({c.time_s for c in cells}), 1)

    def test_failures_have_no_time_and_a_reason(self):
        for cell in self.cells.all():
            self.assertEqual(math.isnan(cell.time_s), cell.verified == 0)
            self.assertEqual(cell.passes, cell.reason == "")

    def test_rho_of_a_cell_with_failures_is_that_of_a_failure(self):
        for cell in self.cells.all():
            if 0 < cell.verified < cell.runs:
                self.assertGreater(cell.rho, cell.tier)

    def test_strictest_is_the_strictest_tier_that_all_seeds_pass(self):
        self.assertEqual(self.cells.strictest("rockers", 300, "ipopt-qp").tier, 1e-6)
        self.assertEqual(self.cells.strictest("discs-in-v", 10, "pgs").tier, 1e-9)
        self.assertFalse(self.cells.strictest("discs-in-v", 3000, "dantzig").passes)

    def test_ranks_count_each_problem_for_its_fastest_solver(self):
        for tier in TIERS:
            for size_class in size_classes([10, 30, 100, 300, 1000, 3000]):
                ranks = ranking(self.cells, tier, size_class)
                self.assertEqual(sum(r.fastest for r in ranks), ranks[0].problems)
                self.assertTrue(all(r.mean_ratio >= 1 for r in ranks if r.verified))

    def test_pgs_is_called_out_as_built_for_loose_tiers_and_others_are_not(self):
        subjects = [subject for subject, _ in limitations(self.cells)]
        self.assertEqual([s for s in subjects if s.endswith("strict tiers")], ["pgs and strict tiers"])

    def test_the_page_is_self_contained_unique_in_its_ids_and_repeats_byte_for_byte(self):
        pages, tables_ = [], []
        folder = write_results(Path(self.directory.name) / "small", families=FAMILIES[:2])
        for name in ("a.html", "b.html"):
            output = Path(self.directory.name) / name
            self.assertEqual(generate.main([str(folder), "-o", str(output)]), 0)
            pages.append(output.read_bytes())
            tables_.append(output.with_suffix(".csv").read_bytes())
        self.assertEqual(pages[0], pages[1])
        self.assertEqual(tables_[0], tables_[1])
        self.assertLess(len(pages[0]), 5_000_000)
        page = _Page(pages[0].decode("utf-8"))
        self.assertEqual(len(page.ids), len(set(page.ids)))
        self.assertEqual([r for r in page.references if r not in page.ids], [])
        self.assertEqual(page.outside, [])
        self.assertNotIn("@import", page.text)


    def test_solvers_stand_in_the_order_own_peers_external(self):
        self.assertEqual(self.cells.results.solvers, list(SOLVERS))

    def test_headline_counts_families_and_takes_the_median_over_the_verified_ones(self):
        for tier in TIERS:
            for row in tables.headline(self.cells, tier):
                for n, cell in zip(SIZES, row["cells"]):
                    found = [self.cells.get(family, n, row["solver"], tier) for family in FAMILIES]
                    times = [c.time_s for c in found if c.passes]
                    self.assertEqual((cell["verified"], cell["of"]), (len(times), len(FAMILIES)))
                    if times:
                        self.assertEqual(cell["seconds"], statistics.median(times))

    def test_headline_is_bold_only_where_most_families_are_verified(self):
        for column in zip(*(row["cells"] for row in tables.headline(self.cells, 1e-9))):
            best = [cell for cell in column if cell["best"]]
            self.assertEqual(len(best), 1)
            self.assertEqual(best[0]["verified"], max(cell["verified"] for cell in column))

    def test_the_oracle_is_the_faster_of_contact_and_body_space(self):
        times = dict(self.cells.oracle_times("rockers"))
        self.assertAlmostEqual(times[10], 2e-7 * 10)
        self.assertAlmostEqual(times[3000], min(2e-7 * 3000, 1e-6 * 3000**0.9), places=12)
        self.assertAlmostEqual(dict(self.cells.oracle_times(FAMILIES[0]))[3000], 2e-7 * 3000)  # no body space there

    def test_conversion_stands_beside_the_time_of_those_that_tell_it(self):
        rows = {row["solver"]: row for row in tables.family_table(self.cells, "rockers", 1e-6)}
        self.assertEqual(rows["ipm"]["cells"][0]["convert"], "")
        self.assertIn("ns", rows["bullet-dantzig"]["cells"][0]["convert"])

    def test_times_csv_has_a_row_per_cell_with_time_and_verdict(self):
        rows = list(csv.DictReader(io.StringIO(times.as_csv(self.cells))))
        self.assertEqual(len(rows), len(self.cells.all()))
        for row in rows:
            cell = self.cells.get(row["family"], int(row["n"]), row["solver"], float(row["tier"]))
            self.assertEqual(row["verdict"] == "verified", cell.passes)
            self.assertEqual(row["time_s"] == "", math.isnan(cell.time_s))
            if cell.passes:
                self.assertAlmostEqual(float(row["time_s"]) / cell.time_s, 1, places=3)

    def test_times_as_markdown_names_the_oracle_and_every_solver(self):
        text = times.as_markdown(self.cells, 1e-6, ["rockers"])
        rows = [line for line in text.splitlines() if line.startswith("|")]
        self.assertEqual(len(rows), 2 + len(SOLVERS) + 1)
        self.assertTrue(rows[-1].startswith("| oracle-chol |"))


class Styles(unittest.TestCase):
    def test_every_solver_looks_different_and_its_look_does_not_depend_on_the_build(self):
        keys = [*OWN, *PEERS, *MISSING, *EXTERNAL]
        described = [{"key": key, "source": key.split("-")[0], "available": True, "origin":
                      "own" if key in OWN else "external" if key in EXTERNAL else "peer"} for key in keys]
        styles = style.solver_styles(described)
        looks = {(s.colour, s.marker, str(s.dash)) for s in styles.values()}
        self.assertEqual(len(looks), len(keys))
        for entry in described:
            entry["available"] = entry["origin"] == "own"
        self.assertEqual(style.solver_styles(described), styles)

    def test_variants_share_colour_and_marker_with_their_method(self):
        styles = style.solver_styles([{"key": key, "source": "X", "origin": "peer"} for key in
                                      ("x-pgs", "x-pgs-default", "x-dantzig", "x-dantzig-cfm")])
        for method, variant in (("x-pgs", "x-pgs-default"), ("x-dantzig", "x-dantzig-cfm")):
            self.assertEqual((styles[method].colour, styles[method].marker),
                             (styles[variant].colour, styles[variant].marker))
            self.assertNotEqual(styles[method].dash, styles[variant].dash)
        self.assertNotEqual(styles["x-pgs"].marker, styles["x-dantzig"].marker)


class _Page(html.parser.HTMLParser):
    """Collects ids, references to ids and anything that would be fetched."""

    def __init__(self, text: str):
        super().__init__()
        self.text, self.ids, self.references, self.outside = text, [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        for key, value in attributes:
            value = value or ""
            if key == "id":
                self.ids.append(value)
            if key in ("href", "xlink:href", "src", "srcset"):
                if value.startswith("#"):
                    self.references.append(value[1:])
                elif not value.startswith("data:"):
                    self.outside.append(value)
            self.references += re.findall(r"url\(#([^)]+)\)", value)


class IncompleteResults(unittest.TestCase):
    def setUp(self):
        self.directory = tempfile.TemporaryDirectory()
        self.addCleanup(self.directory.cleanup)
        self.folder = write_results(Path(self.directory.name) / "results", families=("rockers",), sizes=(10, 30, 100),
                                    seeds=(1,))
        self.output = Path(self.directory.name) / "page.html"

    def run_main(self) -> tuple[int, str]:
        errors = io.StringIO()
        with contextlib.redirect_stderr(errors):
            status = generate.main([str(self.folder), "-o", str(self.output)])
        return status, errors.getvalue()

    def edit(self, name: str, change) -> None:
        path = self.folder / name
        path.write_text(change(path.read_text(encoding="utf-8")), encoding="utf-8")

    def edit_run(self, **changes) -> None:
        self.edit("run.json", lambda text: json.dumps(json.loads(text) | changes))

    def edit_cell(self, name: str, line: int, column: str, value: str) -> None:
        table = pd.read_csv(self.folder / name, dtype=str, keep_default_na=False)
        table.loc[line - 2, column] = value
        table.to_csv(self.folder / name, index=False)

    def assert_fails(self, *parts: str) -> None:
        status, message = self.run_main()
        self.assertEqual(status, 2)
        self.assertEqual(message.count("\n"), 1, message)
        for part in (*parts, "expected"):
            self.assertIn(part, message)
        self.assertFalse(self.output.exists())

    def test_missing_folder(self):
        self.folder = self.folder / "nowhere"
        self.assert_fails("no such folder")

    def test_each_missing_file(self):
        for name in ("run.json", "problems.csv", "accuracy.csv", "timing.json", "rockers.svg"):
            text = (self.folder / name).read_text(encoding="utf-8")
            (self.folder / name).unlink()
            self.assert_fails(name, "missing")
            (self.folder / name).write_text(text, encoding="utf-8")

    def test_another_schema_version(self):
        self.edit_run(schema="lcpbench-run/2")
        self.assert_fails("run.json", "lcpbench-run/2", "lcpbench-run/1")

    def test_run_json_that_is_not_json_or_lacks_a_key(self):
        self.edit_run(cores="two")
        self.assert_fails("run.json", "'cores'", "'two'", "int")
        self.edit_run(cores=2, solvers=[{"key": "pgs"}])
        self.assert_fails("run.json", "solvers[0].method")
        self.edit("run.json", lambda text: text[:-5])
        self.assert_fails("run.json", "line 1", "JSON")

    def test_a_missing_column_is_named(self):
        self.edit("accuracy.csv", lambda text: text.replace("backward_error", "backwards", 1))
        self.assert_fails("accuracy.csv", "'backward_error'")

    def test_a_wrong_value_is_named_with_line_and_column(self):
        for column, value in (("n", "0"), ("seed", "1.5"), ("passes", "yes"), ("rho", "small"), ("tier", "nan"),
                              ("claim", ""), ("passes", "")):
            before = (self.folder / "accuracy.csv").read_text(encoding="utf-8")
            self.edit_cell("accuracy.csv", 5, column, value)
            self.assert_fails("accuracy.csv", "line 5", f"'{column}'", repr(value))
            (self.folder / "accuracy.csv").write_text(before, encoding="utf-8")

    def test_rows_that_refer_to_nothing_known(self):
        for column, value in (("problem", "ghost"), ("solver", "ghost"), ("tier", "0.5"), ("n", "77")):
            before = (self.folder / "accuracy.csv").read_text(encoding="utf-8")
            self.edit_cell("accuracy.csv", 4, column, value)
            self.assert_fails("accuracy.csv", "line 4", f"'{column}'")
            (self.folder / "accuracy.csv").write_text(before, encoding="utf-8")

    def test_a_repeated_row(self):
        self.edit("accuracy.csv", lambda text: text + text.splitlines()[1] + "\n")
        self.assert_fails("accuracy.csv", "repeats")

    def test_empty_tables(self):
        self.edit("problems.csv", lambda text: text.splitlines()[0] + "\n")
        self.assert_fails("problems.csv", "no rows")
        self.edit("problems.csv", lambda text: "")
        self.assert_fails("problems.csv")

    def test_a_picture_that_is_not_svg(self):
        self.edit("rockers.svg", lambda text: "<svg")
        self.assert_fails("rockers.svg", "SVG")

    def test_unknown_values_are_shown_as_unknown(self):
        table = pd.read_csv(self.folder / "accuracy.csv", dtype=str, keep_default_na=False)
        table.loc[:, ["rho", "backward_error", "setup_s", "solve_s", "w_error"]] = ""
        table.to_csv(self.folder / "accuracy.csv", index=False)
        problems = pd.read_csv(self.folder / "problems.csv", dtype=str, keep_default_na=False)
        problems.loc[:, ["rank_a", "separating", "nnz_a", "movable", "oracle_contact_s", "oracle_body_s"]] = ""
        problems.to_csv(self.folder / "problems.csv", index=False)
        self.assertEqual(self.run_main(), (0, ""))
        page = self.output.read_text(encoding="utf-8")
        self.assertIsNone(re.search(r">\s*nan", page))

    def test_without_timing_the_single_runs_count_and_the_page_says_so(self):
        (self.folder / "timing.json").write_text('{"benchmarks": []}', encoding="utf-8")
        cells = Cells(load_results(self.folder))
        self.assertEqual({c.time_source for c in cells.all() if c.verified}, {SINGLE_RUN})
        self.assertEqual(cells.problem_times(1e-3)[1], 0)
        self.assertEqual(self.run_main(), (0, ""))
        self.assertIn("No repeated timing", self.output.read_text(encoding="utf-8"))

    def test_a_run_in_which_nothing_was_verified_still_makes_a_page(self):
        table = pd.read_csv(self.folder / "accuracy.csv", dtype=str, keep_default_na=False)
        table["passes"], table["best_tier"], table["claim"], table["rho"] = "false", "", "numerical_failure", "inf"
        table["false_success"] = "false"
        table.to_csv(self.folder / "accuracy.csv", index=False)
        (self.folder / "timing.json").write_text('{"benchmarks": []}', encoding="utf-8")
        self.assertEqual(self.run_main(), (0, ""))
        self.assertIn("no solver verified", self.output.read_text(encoding="utf-8"))

    def test_a_solver_that_was_excluded_everywhere_keeps_its_row(self):
        table = pd.read_csv(self.folder / "accuracy.csv", dtype=str, keep_default_na=False)
        mine = table["solver"] == "ipopt-ncp"
        _exclude(table, mine, "dense")
        table.to_csv(self.folder / "accuracy.csv", index=False)
        (self.folder / "timing.json").write_text('{"benchmarks": []}', encoding="utf-8")
        cells = Cells(load_results(self.folder))
        self.assertNotIn("ipopt-ncp", cells.problem_times(1e-3)[0].columns)
        line = next(line for line in summary_lines(cells) if line["label"] == "ipopt-ncp")
        self.assertEqual(line["text"], "not run: dense.")
        self.assertEqual(self.run_main(), (0, ""))

    def test_nobody_is_the_fastest_where_a_tier_was_not_asked_of_all(self):
        table = pd.read_csv(self.folder / "accuracy.csv", dtype=str, keep_default_na=False)
        left = (table["n"] == "100") & (table["solver"] == "pgs") & (table["tier"] == "1e-09")
        _exclude(table, left, "tier not run above n = 30")
        table.to_csv(self.folder / "accuracy.csv", index=False)
        (self.folder / "timing.json").write_text('{"benchmarks": []}', encoding="utf-8")
        cells = Cells(load_results(self.folder))
        large = size_classes([100])[0]
        self.assertEqual(ranking(cells, 1e-9, large), [])
        self.assertNotEqual(ranking(cells, 1e-6, large), [])
        text = {line["label"]: line["text"] for line in summary_lines(cells)}
        self.assertIn(f"{large.label}: not run", text["Fastest at 1e-9"])
        self.assertNotIn("not run", text["Fastest at 1e-6"])
        self.assertEqual(self.run_main(), (0, ""))

    def test_who_ran_out_of_time_at_a_looser_tier_is_not_called_excluded(self):
        table = pd.read_csv(self.folder / "accuracy.csv", dtype=str, keep_default_na=False)
        mine = (table["solver"] == "clp") & (table["tier"] == "1e-09")
        _exclude(table, mine, "out of time at the looser tier 1e-06")
        table.to_csv(self.folder / "accuracy.csv", index=False)
        cells = Cells(load_results(self.folder))
        self.assertEqual({c.verdict for c in cells.all() if c.solver == "clp" and c.tier == 1e-9}, {"time limit"})
        rows = {row["solver"]: row for row in tables.family_table(cells, "rockers", 1e-9)}
        self.assertEqual({cell["word"] for cell in rows["clp"]["cells"]}, {"time limit"})

    def test_solvers_that_are_not_in_the_build_are_one_line_of_names(self):
        self.assertEqual(self.run_main(), (0, ""))
        results = load_results(self.folder)
        self.assertEqual(tuple(results.missing), MISSING)
        page = self.output.read_text(encoding="utf-8")
        for solver in MISSING:
            self.assertNotIn(f'data-solver="{solver}"', page)
        self.assertIn("Not in this build: " + ", ".join(MISSING), page)
        lines = [line for line in summary_lines(Cells(results)) if line["label"] == "Not in this build"]
        self.assertEqual([line["text"] for line in lines], ["petsc-rsls and tao-tron."])

    def test_an_unknown_origin_or_a_cell_of_a_missing_solver_is_an_error(self):
        run = json.loads((self.folder / "run.json").read_text(encoding="utf-8"))
        run["solvers"][0]["origin"] = "elsewhere"
        self.edit_run(solvers=run["solvers"])
        self.assert_fails("run.json", "solvers[0].origin", "elsewhere")
        run["solvers"][0]["origin"] = "own"
        self.edit_run(solvers=run["solvers"])
        self.edit_cell("accuracy.csv", 3, "solver", MISSING[0])
        self.assert_fails("accuracy.csv", "line 3", MISSING[0])

    def test_words_from_the_files_cannot_become_markup(self):
        self.edit_run(cpu="<script>alert(1)</script>", flags="-O3 <b>")
        self.assertEqual(self.run_main(), (0, ""))
        page = self.output.read_text(encoding="utf-8")
        self.assertNotIn("<script>alert", page)
        self.assertIn("-O3 &lt;b&gt;", page)


class EmbeddedPicture(unittest.TestCase):
    PICTURE = """<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"
      width="80px" height="60px">
      <style>/* x */ * {fill: red} .a, #b {stroke: url(#g)} svg {color: blue}</style><script>alert(1)</script>
      <linearGradient id="g"/><circle id="b" class="a" fill="url(#g)" onclick="alert(1)"/>
      <use xlink:href="#b"/><image href="https://example.org/x.png"/></svg>"""

    def setUp(self):
        self.text = svg.embed(self.PICTURE, "one", "A <picture>")

    def test_ids_and_references_get_the_prefix(self):
        for part in ('id="one-g"', 'id="one-b"', 'fill="url(#one-g)"', 'href="#one-b"', "stroke: url(#one-g)"):
            self.assertIn(part, self.text)

    def test_styles_stay_inside_the_picture(self):
        css = re.search(r"<style>(.*?)</style>", self.text, re.DOTALL).group(1)
        for rule in css.splitlines():
            for selector in rule.split("{")[0].split(","):
                self.assertTrue(selector.startswith("#one"), selector)

    def test_nothing_runs_and_nothing_is_fetched(self):
        for part in ("script", "onclick", "example.org"):
            self.assertNotIn(part, self.text)

    def test_size_becomes_a_view_box(self):
        self.assertIn('viewBox="0 0 80 60"', self.text)
        self.assertNotIn("width=", self.text)

    def test_other_documents_are_errors(self):
        for text in ("", "<html/>", "<svg"):
            with self.assertRaises(ReportError):
                svg.embed(text, "one", "")


class Synthetic(unittest.TestCase):
    def test_same_seed_same_files(self):
        with tempfile.TemporaryDirectory() as directory:
            folders = [write_results(Path(directory) / name, families=("rockers",), sizes=(10,)) for name in "ab"]
            for file in folders[0].iterdir():
                self.assertEqual(file.read_bytes(), (folders[1] / file.name).read_bytes())


if __name__ == "__main__":
    unittest.main()
