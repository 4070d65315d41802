"""The page in headless Chromium: every figure drawn, every choice at work, no errors on the console."""

import shutil
import unittest

from lcpbench_report.charts import plotly
from lcpbench_report.web import gallery
from lcpbench_report.web.page import render
from .cases import SharedFolderCase
from .synthetic_report import FIGURES, whole_inputs, write_pictures

_CHROMIUM, _DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
_PATIENCE_S = 300  # of a busy machine

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.by import By
    from selenium.webdriver.support.ui import Select, WebDriverWait
except ImportError:
    webdriver = None


@unittest.skipUnless(webdriver and _CHROMIUM and _DRIVER and plotly.BUNDLE.is_file(),
                     "needs chromium, chromium-driver, python3-selenium and python3-plotly (cmake/packages/packages.txt)")
class Browser(SharedFolderCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        path = cls.path / "index.html"
        pictures = gallery.read(write_pictures(cls.path / "pictures"))
        path.write_text(render(whole_inputs(), pictures), encoding="utf-8")
        options = webdriver.ChromeOptions()
        options.binary_location = _CHROMIUM
        for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                         "--window-size=1280,1000", f"--user-data-dir={cls.path}/profile"):
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        cls.driver = webdriver.Chrome(service=Service(_DRIVER), options=options)
        cls.addClassCleanup(cls.driver.quit)
        cls.driver.set_script_timeout(_PATIENCE_S)
        cls.driver.set_page_load_timeout(_PATIENCE_S)
        cls.address = path.as_uri()

    def setUp(self):
        self.driver.get(self.address)

    def tearDown(self):
        errors = [entry["message"] for entry in self.driver.get_log("browser") if entry["level"] in ("SEVERE", "WARNING")]
        self.assertEqual(errors, [])

    def run_script(self, script: str, *arguments):
        return self.driver.execute_script(script, *arguments)

    def test_every_figure_is_drawn_with_marks(self):
        self.assertEqual(set(self.run_script("return drawAll()")), {f"figure-{name}" for name in FIGURES})
        for figure in FIGURES:
            drawn = self.run_script("""
              const place = document.getElementById('figure-' + arguments[0]);
              const marks = place.querySelectorAll('.scatterlayer path, .barlayer path');
              return [place.data.length, marks.length, place.getBoundingClientRect().width]""", figure)
            self.assertGreater(drawn[0], 0, figure)
            self.assertGreater(drawn[1], 0, figure)
            self.assertGreater(drawn[2], 300, figure)

    def test_what_comes_into_sight_is_drawn_without_being_asked(self):
        place = self.driver.find_element(By.ID, "figure-profiles")
        self.run_script("arguments[0].scrollIntoView()", place)
        WebDriverWait(self.driver, 20).until(lambda _: self.run_script("return Boolean(arguments[0].data)", place))

    def test_a_choice_changes_the_figure_and_what_is_not_there_is_told(self):
        place = self.driver.find_element(By.ID, "figure-time-by-size")
        selects = place.find_elements(By.XPATH, "..//select")
        before = self.run_script("return draw(arguments[0]).then(({data}) => data.map(({y}) => y))", place)
        Select(selects[1]).select_by_visible_text("piles")
        self.assertNotEqual(self.run_script("return arguments[0].data.map(({y}) => y)", place), before)
        Select(selects[0]).select_by_visible_text("1e-9")
        self.assertIn("1e-9", self.run_script("return arguments[0].layout.yaxis.title.text", place))
        self.run_script("CHARTS['time-by-size'] = {}; draw(arguments[0])", place)
        self.assertFalse(place.is_displayed())
        self.assertIn("Nothing", self.driver.find_element(By.ID, "note-time-by-size").text)

    def test_a_link_to_a_picture_shows_it(self):
        self.driver.find_element(By.CSS_SELECTOR, "#families a").click()
        # The browser loads the picture when it comes into view.
        WebDriverWait(self.driver, 20).until(lambda driver: driver.execute_script(
            "return document.querySelector('#scene-piles:target img').naturalWidth > 0"))
        links = self.run_script("return [...document.querySelectorAll('#families a')].map((a) => document.querySelector(a.hash).id)")
        self.assertEqual(links, ["scene-piles", "scene-rockers"])

    def test_nothing_is_wider_than_a_phone(self):
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                    {"width": 400, "height": 800, "deviceScaleFactor": 1, "mobile": True})
        try:
            self.driver.get(self.address)
            self.run_script("return drawAll()")
            self.assertEqual(self.run_script("return document.documentElement.scrollWidth"), 400)
            widths = self.run_script("""return [...document.querySelectorAll('.chart')].filter((place) => !place.hidden)
              .map((place) => place.querySelector('.main-svg').getBoundingClientRect().width)""")
            self.assertTrue(all(200 < width <= 400 for width in widths), widths)
        finally:
            self.driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
