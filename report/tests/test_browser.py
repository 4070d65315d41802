"""The page in headless Chromium: every figure drawn, every control at work, no errors on the console."""

import shutil
import unittest

from lcpbench_report import plotly_bundle
from lcpbench_report.web import gallery
from lcpbench_report.web.page import render
from .cases import SharedFolderCase
from .synthetic_report import whole_inputs, write_pictures

FIGURES = {"times", "winners", "profile", "rho", "werror", "precision", "coverage", "pathological", "latency", "deadline",
           "energy", "penetration", "scaling"}
_CHROMIUM, _DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
_PATIENCE_S = 300  # of a busy machine

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.by import By
    from selenium.webdriver.support.ui import Select, WebDriverWait
except ImportError:
    webdriver = None


@unittest.skipUnless(webdriver and _CHROMIUM and _DRIVER and plotly_bundle.BUNDLE.is_file(),
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

    def drawn(self, figure: str, mode: str = "") -> dict[str, dict]:
        """The traces that a figure has now, by name: of the mode if one is asked for."""
        self.run_script("return draw(arguments[0]).then(() => 0)", figure)
        traces = self.run_script("""return document.getElementById('figure-' + arguments[0]).data
          .map(({name, mode, x, y, text}) => ({name, mode, x, y, text}))""", figure)
        return {trace["name"]: trace for trace in traces if not mode or trace["mode"] == mode}

    def names(self, figure: str) -> set[str]:
        return set(self.drawn(figure))

    def choose(self, name: str, value: str) -> None:
        Select(self.driver.find_element(By.CSS_SELECTOR, f"select[data-choice={name}]")).select_by_value(value)

    def test_every_figure_is_drawn_with_marks(self):
        self.assertEqual(set(self.run_script("return window.lcpbench.drawAll()")), FIGURES)
        for figure in FIGURES:
            drawn = self.run_script("""
              const place = document.getElementById('figure-' + arguments[0]);
              const marks = place.querySelectorAll('.scatterlayer path, .barlayer path, .boxlayer path, .heatmaplayer image');
              return [place.data.length, marks.length, place.getBoundingClientRect().width]""", figure)
            self.assertGreater(drawn[0], 0, figure)
            self.assertGreater(drawn[1], 0, figure)
            self.assertGreater(drawn[2], 300, figure)

    def test_what_comes_into_sight_is_drawn_without_being_asked(self):
        place = self.driver.find_element(By.ID, "figure-profile")
        self.run_script("arguments[0].scrollIntoView()", place)
        WebDriverWait(self.driver, 20).until(lambda _: self.run_script("return Boolean(arguments[0].data)", place))

    def test_chips_and_presets_take_solvers_out_and_put_them_back(self):
        self.assertIn("pgs", self.names("profile"))
        self.driver.find_element(By.CSS_SELECTOR, "#more summary").click()
        chip = self.driver.find_element(By.CSS_SELECTOR, "#chips .chip[data-solver=pgs]")
        chip.click()
        self.assertEqual(self.names("profile"), {"auto", "ode-dantzig"})
        self.assertEqual(chip.get_attribute("aria-pressed"), "false")
        self.assertEqual(len(self.driver.find_elements(By.CSS_SELECTOR, "#legend .chip")), 2)
        chip.click()
        self.assertIn("pgs", self.names("profile"))
        for preset, expected in (("own", {"auto", "pgs"}), ("peer", {"ode-dantzig"}), ("none", set()),
                                 ("all", {"auto", "pgs", "ode-dantzig"})):
            self.driver.find_element(By.CSS_SELECTOR, f"[data-preset={preset}]").click()
            self.assertEqual(self.names("profile"), expected, preset)

    def test_family_size_and_tier_choose_the_problems(self):
        count = "return selected(window.lcpbench.view).map((i) => PROBLEMS.name[i])"
        everything = self.run_script(count)
        self.assertNotIn("ragdoll", everything)
        self.choose("family", "piles")
        piles = self.run_script(count)
        self.assertTrue(piles and all(name.startswith("piles-") for name in piles))
        self.choose("low", self.driver.find_elements(By.CSS_SELECTOR, "select[data-choice=low] option")[-1]
                    .get_attribute("value"))
        self.assertEqual(sorted(self.run_script(count)), ["piles-500-0", "piles-500-1"])
        good = "return cellsOf('pgs', window.lcpbench.view.tier).verdicts[PROBLEMS.name.indexOf('piles-500-0')]"
        self.assertEqual(self.run_script(good), "v")
        self.choose("tier", "1e-9")
        self.assertEqual(self.run_script(good), "i")

    def test_times_are_divided_by_what_was_chosen(self):
        self.choose("family", "piles")
        self.choose("norm", "solver:auto")
        for solver, ratio, delta in (("pgs", 3.0, 0.5), ("auto", 1.0, 1e-6)):
            for value in self.drawn("times", "lines+markers")[solver]["y"]:
                self.assertAlmostEqual(value, ratio, delta=delta)

    def test_metric_changes_the_axis(self):
        title = "return draw('times').then(() => document.getElementById('figure-times').layout.yaxis.title.text)"
        self.assertIn("fresh time", self.run_script(title))
        self.choose("metric", "rho")
        self.assertIn("residual", self.run_script(title))

    def test_marks_say_which_problem_they_are(self):
        self.choose("family", "piles")
        words = self.drawn("times", "markers")["pgs"]["text"]
        self.assertTrue(any("pgs</b> on piles-20-1<br>verified at 1e-6" in text for text in words))

    def test_the_profile_is_that_of_the_statistics(self):
        curve = self.drawn("profile")["auto"]
        # auto is the fastest but where noise says otherwise, and solves all.
        self.assertAlmostEqual(curve["y"][-1], 1.0)
        self.assertLess(curve["x"][-2], 1.5)

    def test_the_table_sorts_by_what_is_clicked(self):
        order = "return [...document.querySelectorAll('#league tbody th')].map((th) => th.textContent.trim())"
        self.assertEqual(self.run_script(order)[0], "auto")
        for place in (0, -1):
            self.driver.find_elements(By.CSS_SELECTOR, "#league thead button")[4].click()  # the mean time
            self.assertEqual(self.run_script(order)[place], "auto")

    def test_a_family_that_has_a_picture_links_to_it(self):
        link = self.driver.find_element(By.ID, "picture")
        self.choose("family", "chains")
        self.assertFalse(link.is_displayed())
        self.choose("family", "piles")
        link.click()
        # The browser loads the picture when it comes into view.
        WebDriverWait(self.driver, 20).until(lambda driver: driver.execute_script(
            "return document.querySelector('#scene-piles:target img').naturalWidth > 0"))
        links = self.run_script("return [...document.querySelectorAll('#families a')].map((a) => document.querySelector(a.hash).id)")
        self.assertEqual(links, ["scene-piles", "scene-rockers"])

    def test_nothing_shows_through_the_bar_of_filters(self):
        bar = self.driver.find_element(By.ID, "controls")
        self.run_script("document.getElementById('figure-profile').scrollIntoView(); window.scrollBy(0, 60)")
        self.names("profile")
        hidden = self.run_script("""const box = arguments[0].getBoundingClientRect(), found = [];
          for (let x = box.left + 2; x < box.right - 2; x += 20)
            for (let y = box.top + 2; y < box.bottom - 2; y += 10) found.push(arguments[0].contains(document.elementFromPoint(x, y)));
          return [box.top, getComputedStyle(arguments[0]).backgroundColor, found.length, found.every(Boolean)]""", bar)
        self.assertEqual(hidden[:2], [0, "rgb(255, 255, 255)"])
        self.assertGreater(hidden[2], 100)
        self.assertTrue(hidden[3])

    def test_nothing_is_wider_than_a_phone(self):
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                    {"width": 400, "height": 800, "deviceScaleFactor": 1, "mobile": True})
        try:
            self.driver.get(self.address)
            self.run_script("return window.lcpbench.drawAll()")
            self.assertEqual(self.run_script("return document.documentElement.scrollWidth"), 400)
            widths = self.run_script("""return [...document.querySelectorAll('.chart')]
              .map((place) => place.querySelector('.main-svg').getBoundingClientRect().width)""")
            self.assertTrue(all(200 < width <= 400 for width in widths), widths)
        finally:
            self.driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
