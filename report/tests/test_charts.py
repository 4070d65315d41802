"""Charts as data, what Plotly and Matplotlib are given of them, and that they say what the tables say."""

import math
import unittest

import numpy as np
import pandas as pd

from lcpbench_report import charts, choice, formats
from lcpbench_report.charts import campaign, drawing, motion, plotly
from lcpbench_report.charts.chart import NAMES, Axis, Chart, Panel, Trace
from lcpbench_report.errors import ReportError
from lcpbench_report.style import Look
from .cases import FolderCase, SharedFolderCase
from .synthetic_campaign import cells_of
from .synthetic_report import FIGURES, whole_inputs

LINE, HOLLOW, DOT = Look("#123456", "o"), Look("#654321", "s", (0, (5, 2)), False), Look("#000000", "D", None)


class Charts(unittest.TestCase):
    def test_equal_axes_have_the_same_range_a_little_beyond_all_values(self):
        x = Axis("rows n")
        chart = Chart([Panel(x, Axis("t", "seconds"), [Trace("a", [1, 10], [1e-6, math.nan], LINE)]),
                       Panel(x, Axis("share", "share", False, (0, 1)), [Trace("b", [100, 0, math.inf], [1, 2, 3], LINE)])], 2)
        low, high = chart.ends(x)
        self.assertTrue(0.8 < low < 1 and 100 < high < 130)
        self.assertEqual(chart.ends(chart.panels[1].y), (0, 1))
        self.assertEqual(chart.ticks(x), [1, 10, 100])
        self.assertEqual(chart.ends(Axis("of nothing")), (1 / 1.2, 12))

    def test_ticks_are_few_and_there_are_some_within_a_decade(self):
        for ends, ticks in (((1e-12, 1e12), 7), ((1.5, 9), 2), ((1e-6, 1e-3), 4)):
            with self.subTest(ends):
                axis = Axis(ends=ends)
                self.assertEqual(len(Chart([Panel(axis, axis, [])]).ticks(axis)), ticks)

    def test_words_of_ticks(self):
        for kind, value, words in (("seconds", 1e-5, "10 µs"), ("seconds", 2e-7, "200 ns"), ("seconds", 1.0, "1 s"),
                                   ("residual", 1e-9, "1e-9"), ("ratio", 0.5, "0.5×"), ("share", 0.01, "1 %"),
                                   ("plain", 1e4, "10\u2009000"), ("plain", 1e8, "1e8"), ("plain", 0.5, "0.5")):
            with self.subTest(words):
                self.assertEqual(charts.chart.KINDS[kind][0](value), words)

    def test_plotly_is_given_looks_intervals_bars_and_names(self):
        names = Axis(kind=NAMES)
        chart = Chart([Panel(Axis("t", "seconds"), names, [Trace("a", [1.0, math.inf], ["p", "q"], DOT, [0.5, 1], [3.0, 2])], "first"),
                       Panel(Axis("count", log=False), names, [Trace("b", [3, 4], ["p", "q"], LINE, bar=True)]),
                       Panel(Axis("n"), Axis("t"), [Trace("a", [1, 2], [3, 4], HOLLOW, marks=[True, False], text=["x", "y"], steps=True)])], 2)
        made = plotly.figure(chart)
        dots, bars, line = made["data"]
        self.assertEqual((dots["x"], dots["error_x"]["array"], dots["error_x"]["arrayminus"]), ([1.0, None], [2.0, None], [0.5, None]))
        self.assertEqual((dots["mode"], dots["marker"]["symbol"]), ("markers", "diamond"))
        self.assertEqual((bars["type"], bars["x"], bars["yaxis"], made["layout"]["barmode"]), ("bar", [3, 4], "y2", "stack"))
        self.assertEqual((line["mode"], line["marker"]["symbol"], line["marker"]["size"], line["line"]["dash"], line["line"]["shape"]),
                         ("lines+markers+text", "square-open", [7, 0], "7px,2.8px", "hv"))
        self.assertEqual([trace["showlegend"] for trace in made["data"]], [True, True, False])  # `a` has one entry
        self.assertEqual(made["layout"]["yaxis"]["type"], "category")
        self.assertEqual([words["text"] for words in made["layout"]["annotations"]], ["first"])
        for axis in ("xaxis", "xaxis2", "xaxis3", "yaxis3"):
            self.assertTrue(0 <= made["layout"][axis]["domain"][0] < made["layout"][axis]["domain"][1] <= 1 + 1e-9, axis)

    def test_a_missing_bundle_is_told_with_its_package(self):
        with self.assertRaisesRegex(ReportError, "python3-plotly"):
            plotly.script(plotly.BUNDLE / "nowhere")


class Files(FolderCase):
    def test_everything_that_a_trace_can_have_is_drawn_on_white_and_the_same_twice(self):
        names = Axis(kind=NAMES)
        chart = Chart([Panel(Axis("t", "seconds"), names, [Trace("a", [1.0, 2.0], ["p", "q"], DOT, [0.5, 1], [3.0, 2]),
                                                           Trace("b", [3, 4], ["p", "q"], LINE, bar=True)]),
                       Panel(Axis("n"), Axis("t"), [Trace("c", [1, 2], [3, math.nan], HOLLOW, marks=[True, False], text=["x", "y"], steps=True)]),
                       Panel(Axis("n"), Axis("t"), [])], 2)
        first, second = ([self.folder / name / f"chart{end}" for end in (".svg", ".pdf")] for name in ("one", "two"))
        for paths in (first, second):
            drawing.write(chart, *paths)
        for path, again in zip(first, second):
            self.assertEqual(path.read_bytes(), again.read_bytes())
        text = first[0].read_text(encoding="utf-8")
        for colour in ("#ffffff", "#123456", "#654321", "#000000"):
            self.assertIn(f"fill: {colour}", text.replace("stroke: ", "fill: "))
        self.assertTrue(first[1].read_bytes().startswith(b"%PDF"))


class OfInputs(SharedFolderCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.inputs = whole_inputs()
        cls.figures = {figure.name: figure for figure in charts.figures(cls.inputs)}

    def traces(self, chart: Chart) -> dict[str, Trace]:
        return {trace.name: trace for panel in chart.panels for trace in panel.traces}

    def test_there_is_a_figure_for_every_part_with_something_to_be_seen_first(self):
        self.assertEqual([*self.figures], FIGURES)
        for name, figure in self.figures.items():
            chart = next(iter(figure.views.values()))()
            self.assertTrue(any(len(trace.x) for panel in chart.panels for trace in panel.traces), name)
            self.assertEqual({len(chosen) for chosen in figure.views}, {len(figure.choices)}, name)

    def test_times_are_the_medians_of_the_table_and_marked_where_all_are_verified(self):
        times = choice.table(self.inputs, "class_times", 1e-6)
        traces = self.traces(campaign.by_size(self.inputs, 1e-6))
        for solver in self.inputs.keys:
            own = times[(times["solver"] == solver) & (times["size_class"] != "all")]
            finite = own[np.isfinite(own["median_s"])]
            known = ~np.isnan(np.asarray(traces[solver].y))
            np.testing.assert_allclose(np.asarray(traces[solver].y)[known], finite["median_s"], rtol=1e-12)
            self.assertEqual(sum(traces[solver].marks), int((own["verified_share"] == 1).sum()))
        self.assertIn("oracle", traces)

    def test_problems_without_rows_are_drawn_and_one_size_is_no_chart(self):
        cells = self.inputs.counted.assign(rows=0)
        self.assertIsNotNone(campaign.by_size(self.inputs, 1e-6, cells=cells))
        self.assertIsNone(campaign.by_size(self.inputs, 1e-6, cells=cells.assign(size_class="1")))

    def test_families_tiers_and_metrics_choose_the_view(self):
        views = self.figures["time-by-size"].views
        everything, piles = (self.traces(views["1e-6", part]())["pgs"] for part in ("all", "piles"))
        self.assertNotEqual(list(everything.y), list(piles.y))
        self.assertEqual({tier for tier, _ in views}, {"1e-3", "1e-6", "1e-9"})
        self.assertEqual(next(iter(views)), ("1e-6", "all"))
        rho = self.figures["metrics"].views["1e-6", "residual ρ"]()
        self.assertEqual(rho.panels[0].y.kind, "residual")

    def test_a_profile_ends_at_the_share_verified(self):
        chart = next(iter(self.figures["profiles"].views.values()))()
        strictest = {trace.name: trace for trace in chart.panels[-1].traces}
        self.assertAlmostEqual(strictest["auto"].y[-1], 1.0)
        self.assertLess(strictest["auto"].x[-2], 1.5)  # the fastest but where noise says otherwise
        self.assertLess(strictest["pgs"].y[-1], 1.0)

    def test_outcomes_are_those_of_the_cells(self):
        cells = self.inputs.counted[self.inputs.counted["tier"] == 1e-9]
        traces = self.traces(campaign.coverage(self.inputs, cells))
        for words, verdict in (("verified", "verified"), ("false success", "false success"), ("iteration limit", "failed:iteration_limit"),
                               ("excluded", "excluded")):
            counts = (cells["verdict"] == verdict).groupby(cells["solver"]).sum()
            self.assertEqual(dict(zip(traces[words].y, traces[words].x)), counts.to_dict(), words)

    def test_a_proof_counts_more_than_a_claim(self):
        cells = cells_of(pd.DataFrame({"a": [np.inf, np.inf, 2.0, np.inf, np.inf]})).assign(
            false_infeasible=[True, True, False, False, True], proved_infeasible=[False, True, False, False, False],
            infeasible_within_rounding=[False, False, False, True, True])
        self.assertEqual(list(campaign.outcomes(cells)), ["false claim of infeasibility", "proved infeasible", "verified",
                                                          "infeasible within rounding", "false claim of infeasibility"])

    def test_latencies_and_missed_deadlines_are_those_of_the_tables(self):
        table = choice.passes(self.inputs, 1e-6).set_index("solver")
        chart = motion.latency(self.inputs, "all")
        warm = self.traces(chart)["median, warm"]
        self.assertEqual(dict(zip(warm.y, warm.x)), table["p50"].to_dict())
        missed = self.traces(motion.deadline(self.inputs, "all"))
        self.assertGreater(max(missed["pgs"].y), max(missed["auto"].y))

    def test_a_motion_has_a_line_per_driver_and_tolerance_with_few_points(self):
        chart = next(iter(self.figures["motion"].views.values()))()
        self.assertEqual(len(chart.panels), 2)
        self.assertEqual([trace.name for trace in chart.panels[0].traces], ["auto at 1e-6", "pgs at 1e-3", "pgs at 1e-6"])
        deepest = np.asarray(chart.panels[1].traces[0].y)
        self.assertTrue((np.diff(deepest) >= 0).all())
        self.assertEqual({scene for scene, in self.figures["friction-motion"].views},
                         {f"{scene}, velocity level" for scene in ("slabs", "arch")})


class Numbers(unittest.TestCase):
    def test_numbers_of_the_page_have_four_digits(self):
        self.assertEqual(plotly._values(np.array([1.23456e-7, math.nan, math.inf])), [formats.short(1.23456e-7), None, None])
