"""The page's data and text; what the browser makes of them is in test_browser.py."""

import base64
import json
import re
import unittest
from pathlib import Path
from unittest import mock

import numpy as np
import pandas as pd

from lcpbench_report import formats, plotly_bundle
from lcpbench_report.errors import ReportError
from lcpbench_report.inputs import load_inputs
from lcpbench_report.web import gallery, page, payload
from .cases import FolderCase, SharedFolderCase, run
from .synthetic_campaign import cells_of, write_campaign
from .synthetic_report import FACTORS, whole_inputs, write_pictures, write_steps

# Plotly's script takes a second and says nothing here.
NO_BUNDLE = mock.patch.object(plotly_bundle, "minified", return_value="")


def decoded(text: str) -> np.ndarray:
    codes = np.frombuffer(base64.b64decode(text), dtype="<i2").astype(float)
    values = 10 ** (codes / payload.STEPS_PER_DECADE)
    values[codes == payload.ZERO] = 0
    values[codes == payload.INFINITE] = np.inf
    values[codes == payload.UNKNOWN] = np.nan
    return values


def data_of(text: str) -> dict:
    return json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL).group(1))


class Encoding(unittest.TestCase):
    def test_numbers_keep_their_digits_over_forty_decades(self):
        """What is too small or large is moved to the nearest, and what is no positive number stays what it is."""
        given = 10.0 ** np.random.default_rng(1).uniform(-20, 20, 10000)
        self.assertLess(np.abs(decoded(payload.pack(given)) / given - 1).max(), 7.3e-4)
        np.testing.assert_allclose(decoded(payload.pack([1e-300, 1e300, 0, np.inf, np.nan, 1.0])),
                                   [1e-20, 1e20, 0, np.inf, np.nan, 1.0], rtol=1e-9)


class Page(SharedFolderCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.inputs = whole_inputs()
        with NO_BUNDLE:
            cls.pictures = gallery.read(write_pictures(cls.path / "pictures"))
            cls.text = page.render(cls.inputs, cls.pictures)
        cls.data = data_of(cls.text)

    def test_the_same_results_give_the_same_page(self):
        with NO_BUNDLE:
            self.assertEqual(page.render(self.inputs, self.pictures), self.text)

    def test_verdicts_and_times_are_those_of_the_cells(self):
        names = self.data["problems"]["name"]
        letters = {"verified": "v", "false success": "f", "excluded": "x", "below the tier": "b", "failed:iteration_limit": "i"}
        for row in self.inputs.cells.itertuples():
            of_solver = self.data["cells"][row.solver]
            tier = formats.power(row.tier)
            at = names.index(row.problem)
            self.assertEqual(of_solver["verdicts"][tier][at], letters[row.verdict])
        of_solver = self.data["cells"]["pgs"]
        times = decoded(of_solver["numbers"][of_solver["places"]["1e-6"]]["time"])
        mine = self.inputs.cells[(self.inputs.cells["solver"] == "pgs") & (self.inputs.cells["tier"] == 1e-6)]
        expected = mine.set_index("problem")["time_s"].reindex(names)
        np.testing.assert_allclose(times, expected, rtol=1e-3)

    def test_a_proof_counts_more_than_a_claim(self):
        cells = cells_of(pd.DataFrame({"a": [np.inf, np.inf, 2.0, np.inf, np.inf]})).assign(
            false_infeasible=[True, True, False, False, True],
            proved_infeasible=[False, True, False, False, False],
            infeasible_within_rounding=[False, False, False, True, True], iterations=1, backward_error=0.0, w_error=0.0)
        found = payload._cells(cells, [0, 1, 2, 3, 4, 5])
        self.assertEqual(found["verdicts"], {"1e-6": "qrvoq."})

    def test_text_of_the_data_is_escaped(self):
        self.assertIn("the method of pgs &lt;&amp;&gt;", self.text)
        self.assertNotIn("the method of pgs <&>", self.text)
        self.assertNotIn("</script", json.dumps(self.data))

    def test_every_section_is_there(self):
        for section in ("summary", "headline", "choose", "performance", "accuracy", "robustness", "sequences", "scaling", "scenes",
                        "settings", "environment", "limitations"):
            self.assertEqual(self.text.count(f'<section id="{section}">'), 1, section)
            self.assertIn(f'href="#{section}"', self.text)
        for word in ("a made-up CPU", "2026-01-02T03:04:05Z", "0123456789ab"):
            self.assertIn(word, self.text)

    def test_own_and_the_best_of_a_library_are_shown_first(self):
        self.assertEqual([s["key"] for s in self.data["solvers"] if s["shown"]], ["auto", "pgs", "ode-dantzig"])

    def test_parts_that_are_absent_have_no_section(self):
        with NO_BUNDLE:
            text = page.render(load_inputs([write_steps(self.path / "steps")]))
        self.assertNotIn('id="performance"', text)
        self.assertIn('id="sequences"', text)
        self.assertNotIn("figure-energy", text)
        self.assertNotIn('id="scenes"', text)

    def test_the_gallery_has_the_pictures_in_order_with_their_words(self):
        self.assertEqual(re.findall(r'<figure id="scene-([^"]*)"', self.text), ["wedges", "piles", "rockers"])
        picture = re.search(r'id="scene-piles".*?src="data:image/svg\+xml;base64,([^"]*)"', self.text, re.DOTALL)[1]
        self.assertTrue(base64.b64decode(picture).startswith(b"<svg"))
        self.assertIn("Pile. Of &lt;discs&gt;", self.text)
        self.assertEqual(self.data["pictures"], ["piles", "rockers", "wedges"])

    def test_pictures_that_are_missing_too_large_or_none_are_refused(self):
        folder = self.path / "wrong"
        folder.mkdir()
        with self.assertRaisesRegex(ReportError, "scenes.txt"):
            gallery.read(folder)
        write_pictures(folder)
        for content in ("<html>", "<svg" + " " * 400_000):
            (folder / "piles.svg").write_text(content, encoding="utf-8")
            with self.assertRaisesRegex(ReportError, "piles.svg"):
                gallery.read(folder)
        (folder / "piles.svg").unlink()
        with self.assertRaisesRegex(ReportError, "missing"):
            gallery.read(folder)

    def test_nothing_is_fetched(self):
        self.assertEqual(re.findall(r'(?:src|href)="(?!#|data:)[^"]*"', self.text), [])


class Script(FolderCase):
    def test_one_page_below_ten_megabytes_with_the_licence_of_what_it_embeds(self):
        if not plotly_bundle.BUNDLE.is_file():
            self.skipTest("python3-plotly is not installed")
        text = page.render(whole_inputs())
        self.assertLess(len(text.encode()), 10e6)
        self.assertIn("Licensed under the MIT license", text)
        self.assertEqual(text.count("</script>"), 3)

    def test_the_summary_tells_what_changed_since_an_earlier_run(self):
        slower = FACTORS | {"pgs": 2 * FACTORS["pgs"]}
        old, new = (write_campaign(self.folder / str(run), factors, tiers=(1e-6,), run=run)
                    for run, factors in enumerate((FACTORS, slower)))
        with NO_BUNDLE:
            self.assertEqual(run("report", new, "--previous", old, "-o", self.folder / "out" / "index.html")[0], 0)
        text = (self.folder / "out" / "summary.md").read_text(encoding="utf-8")
        part = text[text.index("## Compared with an earlier run"):]
        self.assertRegex(part, r"(?m)^\| .*pgs.*\b(2\.0|1\.9)")
        self.assertNotRegex(part, r"(?m)^# ")

    def test_a_missing_bundle_is_told_with_its_package(self):
        with self.assertRaisesRegex(ReportError, "python3-plotly"):
            plotly_bundle.minified(Path("/nowhere/plotly.js"))
