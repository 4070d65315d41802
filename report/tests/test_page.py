"""The page's data and text; what the browser makes of them is in test_browser.py."""

import base64
import json
import re

from lcpbench_report.charts import plotly
from lcpbench_report.errors import ReportError
from lcpbench_report.web import gallery, page
from .cases import FolderCase, SharedFolderCase, inputs_of, page_of
from .synthetic_report import whole_inputs, write_pictures, write_steps


def data_of(text: str) -> dict:
    return json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL).group(1))


class Page(SharedFolderCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.inputs = whole_inputs()
        cls.pictures = gallery.read(write_pictures(cls.path / "pictures"))
        cls.text = page_of(cls.inputs, cls.pictures)
        cls.data = data_of(cls.text)

    def test_the_same_results_give_the_same_page(self):
        self.assertEqual(page_of(self.inputs, self.pictures), self.text)

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

    def test_parts_that_are_absent_have_no_section(self):
        text = page_of(inputs_of(write_steps))
        self.assertNotIn('id="performance"', text)
        self.assertIn('id="sequences"', text)
        self.assertNotIn("figure-motion", text)
        self.assertNotIn('id="scenes"', text)

    def test_the_gallery_has_the_pictures_in_order_with_their_words(self):
        self.assertEqual(re.findall(r'<figure id="scene-([^"]*)"', self.text), ["wedges", "piles", "rockers"])
        picture = re.search(r'id="scene-piles".*?src="data:image/svg\+xml;base64,([^"]*)"', self.text, re.DOTALL)[1]
        self.assertTrue(base64.b64decode(picture).startswith(b"<svg"))
        self.assertIn("Pile. Of &lt;discs&gt;", self.text)

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
        if not plotly.BUNDLE.is_file():
            self.skipTest("python3-plotly is not installed")
        text = page.render(whole_inputs())
        self.assertLess(len(text.encode()), 10e6)
        self.assertIn("Licensed under the MIT license", text)
        self.assertEqual(text.count("</script>"), 3)
