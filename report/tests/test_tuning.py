"""Tuning: what is drawn, what is chosen, and what is told of a space that does not fit."""

import contextlib
import json
import math
import unittest
from collections import Counter
from pathlib import Path

import numpy as np
import pandas as pd

from lcpbench_report.errors import ReportError
from lcpbench_report.statistics.jsonl import write_object
from lcpbench_report.tuning import campaign, choice
from lcpbench_report.tuning.space import Space, draw, hash_of, load_spaces
from .cases import FolderCase, campaign_of, json_of, run
from .synthetic_campaign import Noise, cells_of, fail, median_times, only, write_campaign

SPACE = Space("pgs", {"sweep": ["coloured", "forward", "symmetric"], "relaxation": ["1", "1.2", "1.4", "1.6"]})
SMALL = Space("lemke", {"block_start": ["no", "yes"]})
NOISE_SEEDS = 100
DATA = Path(__file__).resolve().parents[2] / "data"


def judged(cells, keys=("default", "fast", "same")) -> list[choice.Outcome]:
    return choice.judge(cells, list(keys))[1]


def chosen(times, false_successes=()) -> str:
    """@param times  problems x configurations, the default first
    @param false_successes  (configuration, problem): failures that are false successes
    """
    cells = cells_of(times)
    for solver, problem in false_successes:
        cells.loc[(cells["solver"] == solver) & (cells["problem"] == problem), "verdict"] = "false success"
    keys = list(times.columns)
    return keys[choice.choose(judged(cells, keys))]


class Problems(FolderCase):
    def test_sealed_families_are_left_out(self):
        class Written(campaign.Command):
            def run(self, *arguments, output=None):
                if arguments[0] == "collection":
                    ids = ("gear-train-n12-s1", "disc-pile-n12-s1", "spinning-drum-n12-s1")
                    Path(arguments[-1]).write_text("".join(json.dumps({"id": name}) + "\n" for name in ids), encoding="utf-8")
                elif arguments[0] == "generate":
                    output.write(f'{{"id": "{arguments[1]}"}}\n'.encode())

            def available(self, what):
                return ["gear-train", "disc-pile", "spinning-drum", "gear-trains"]

        campaign.make_problems(Written(Path("lcpbench")), DATA, Path(self.folder), [8], 1)
        made = [json.loads(line)["id"] for name in ("smoke", "scenes")
                for line in (Path(self.folder) / campaign.PROBLEMS / f"{name}.jsonl").read_text(encoding="utf-8").splitlines()]
        self.assertEqual(made, ["disc-pile-n12-s1", "disc-pile", "gear-trains"])


class Choice(unittest.TestCase):
    def setUp(self):
        self.times = median_times(np.random.default_rng(3), {"default": 1.0, "fast": 0.8, "same": 1.0}, 64)

    def test_of_clearly_better_ones_the_best_is_chosen(self):
        self.assertEqual(chosen(self.times), "fast")
        self.times["faster"] = 0.5 * self.times["default"]
        self.assertEqual(chosen(self.times), "faster")

    def test_one_per_cent_is_not_enough_however_sure(self):
        self.times["fast"] = 0.99 * self.times["default"]
        outcome = judged(cells_of(self.times))[1]
        self.assertLess(outcome.wilcoxon_p_holm, 1e-6)
        self.assertEqual(chosen(self.times), "default")

    def test_noise_is_not_chosen(self):
        wrong = 0
        for seed in range(NOISE_SEEDS):
            rng = np.random.default_rng(seed)
            # Eight times the same, 30 % of noise.
            times = np.exp(rng.normal(0, 1, (40, 1)) + rng.normal(0, 0.3, (40, 8)))
            wrong += chosen(pd.DataFrame(times, columns=[f"c{k}" for k in range(8)])) != "c0"
        self.assertLessEqual(wrong, 0.1 * NOISE_SEEDS)  # expected: 5 % at most of false alarms

    def test_one_that_fails_more_is_not_chosen_however_fast(self):
        self.times["fast"] *= 0.01
        self.assertEqual(chosen(self.times), "fast")
        self.times.loc[self.times.index[5], "fast"] = math.inf
        self.assertEqual(chosen(self.times), "default")

    def test_nor_one_with_more_false_successes(self):
        first, second = self.times.index[:2]
        self.times.loc[first, "default"] = math.inf
        self.times.loc[first, "fast"] = math.inf
        self.assertEqual(chosen(self.times), "fast")
        self.assertEqual(chosen(self.times, [("default", first), ("fast", first)]), "fast")
        self.assertEqual(chosen(self.times, [("fast", first)]), "default")
        self.times.loc[second, "default"] = math.inf
        self.assertEqual(chosen(self.times, [("fast", first)]), "default")

    def test_one_that_solves_more_is_better_though_no_faster(self):
        self.times["fast"] = self.times["same"]
        self.times.iloc[:20, self.times.columns.get_loc("default")] = math.inf
        self.times.iloc[:20, self.times.columns.get_loc("same")] = math.inf
        self.assertEqual(chosen(self.times), "fast")

    def test_excluded_problems_do_not_count(self):
        cells = cells_of(self.times.rename(index=str))
        expected = judged(cells)
        excluded = cells_of(median_times(np.random.default_rng(4), {key: 1.0 for key in self.times}, 9).rename(
            index=lambda k: f"large-{k}")).assign(verdict="excluded", time_s=math.inf)
        found = judged(pd.concat([cells, excluded]))
        self.assertEqual([o.mean_s for o in found], [o.mean_s for o in expected])
        self.assertEqual(found[0].problems, 64)

    def test_every_size_class_weighs_the_same(self):
        """Fifty small problems say one thing, ten large ones, by as much, the opposite: that is no gain."""
        rng = np.random.default_rng(5)
        small, large = (median_times(rng, {"default": 1.0, "other": factor}, problems)
                        for factor, problems in ((0.5, 50), (2.0, 10)))
        cells = pd.concat([cells_of(small.rename(index=str)),
                           cells_of(large.rename(index=lambda k: f"large-{k}"), size_class="301-1000")])
        ratio = judged(cells, ["default", "other"])[1].ratio
        self.assertAlmostEqual(ratio, 1.0, delta=0.15)
        self.assertLess(judged(cells.assign(size_class="1"), ["default", "other"])[1].ratio, 0.75)

    def test_an_answer_below_the_tier_is_as_bad_as_a_false_success(self):
        cells = cells_of(self.times)
        cells.loc[(cells["solver"] == "fast") & (cells["problem"] == 3), ["verdict", "time_s"]] = ["below the tier", math.inf]
        outcome = judged(cells)[1]
        self.assertEqual((outcome.false_successes, outcome.allowed), (1, False))

    def test_the_interval_of_the_gain_holds_the_gain(self):
        outcome = judged(cells_of(1e4 * self.times).assign(time_limit_s=math.inf))[1]
        self.assertLess(outcome.ratio_low, outcome.ratio)
        self.assertLess(outcome.ratio, outcome.ratio_high)
        self.assertAlmostEqual(outcome.ratio, 0.8, delta=0.03)


class Drawing(unittest.TestCase):
    def test_the_default_comes_first_and_none_twice(self):
        for seed in range(20):
            for budget in (1, 2, 5, 11, 12):
                drawn = draw(SPACE, budget, seed)
                self.assertEqual(len(drawn), budget)
                self.assertEqual(drawn[0], {})
                self.assertEqual(len({tuple(sorted(c.items())) for c in drawn}), budget)
                for configuration in drawn:
                    for name, value in configuration.items():
                        self.assertIn(value, SPACE.settings[name][1:])

    def test_the_same_seed_draws_the_same_and_another_one_others(self):
        self.assertEqual(draw(SPACE, 5, 1), draw(SPACE, 5, 1))
        self.assertGreater(len({json.dumps(draw(SPACE, 5, seed)) for seed in range(10)}), 5)

    def test_a_smaller_space_is_tried_as_a_whole(self):
        self.assertEqual(draw(SMALL, 8, 1), [{}, {"block_start": "yes"}])
        self.assertEqual(draw(Space("cgal-qp", {}), 8, 1), [{}])
        self.assertEqual(len(draw(SPACE, 100, 1)), 12)

    def test_every_configuration_is_as_likely(self):
        counts = Counter(json.dumps(drawn) for seed in range(2200) for drawn in draw(SPACE, 2, seed)[1:])
        self.assertEqual(len(counts), 11)
        self.assertLess(sum((n - 200) ** 2 / 200 for n in counts.values()), 29.6)  # chi-squared of 10, 0.1 %


class Mistakes(FolderCase):
    def spaces(self, text: str):
        path = self.folder / "tuning.json"
        path.write_text(text, encoding="utf-8")
        return load_spaces(path)

    def test_are_told_with_their_place(self):
        def of(solvers: str) -> str:
            return f'{{"schema": "lcpbench-tuning/1", "solvers": [{solvers}]}}'
        good = '{"solver": "pgs", "settings": {"sweep": ["a", "b"]}}'
        self.assertEqual(self.spaces(of(good))["pgs"].size, 2)
        for text, *words in (
                ("{", "JSON"), ("[]", "lcpbench-tuning/1"), ('{"schema": "x"}', "lcpbench-tuning/1"),
                ('{"schema": "lcpbench-tuning/1"}', "solvers"), (of("3"), "solvers[0]", "object"),
                (of(good + "," + good), "solvers[1]", "'pgs'", "twice"),
                (of('{"settings": {}}'), "'solver'"), (of('{"solver": "pgs", "settings": []}'), "'settings'"),
                (of('{"solver": "pgs", "settings": {}}'), "'note'"),
                (of('{"solver": "pgs", "settings": {}, "notes": ""}'), "'notes'"),
                (of('{"solver": "pgs", "settings": {"sweep": "a"}}'), "sweep", "list"),
                (of('{"solver": "pgs", "settings": {"sweep": ["a"]}}'), "sweep", "two texts"),
                (of('{"solver": "pgs", "settings": {"sweep": ["a", 3]}}'), "sweep", "3"),
                (of('{"solver": "pgs", "settings": {"sweep": ["a", "b,c=d"]}}'), "sweep", "commas"),
                (of('{"solver": "pgs", "settings": {"sweep": ["a", "a"]}}'), "sweep", "twice")):
            with self.subTest(text), self.assertRaises(ReportError) as caught:
                self.spaces(text)
            for word in words:
                self.assertIn(word, str(caught.exception))
            self.assertNotIn("\n", str(caught.exception))

    def test_of_the_command_line_are_one_line(self):
        for words in (["--budget", "0"], ["--budget", "x"], ["--seed", "-1"], ["--problem-seed", "1.5"], ["--launches", "0"],
                      ["--cpu", "-1"], ["--sizes", "10,x"], ["--sizes", "\u00b2"], ["--sizes", "9" * 5000], ["--\x1b[31m", "1"], ["--space", str(self.folder / "none.json")]):
            self.assert_refused("tune", "--lcpbench", "/bin/true", "--folder", self.folder, *words)

    def test_a_tuning_problem_of_another_set_is_refused(self):
        for name, problem in (("smoke", {"id": "a", "sha256": "1"}), ("standard", {"id": "b", "sha256": "2"})):
            (self.folder / f"{name}.json").write_text(json.dumps({"lcpbench_manifest": 1, "problems": [problem]}))
        (self.folder / "other.json").write_text("{}")
        own = self.folder / "own"
        own.mkdir()
        for problems, refused in (([{"id": "a", "sha256": "1"}], False), ([{"id": "b", "sha256": "3"}], True),
                                  ([{"id": "c", "sha256": "2"}], True)):
            (own / "manifest.json").write_text(json.dumps({"problems": problems}))
            with self.assertRaisesRegex(ReportError, "standard.json") if refused else contextlib.nullcontext():
                self.assertEqual(campaign.require_disjoint(own / "manifest.json", self.folder), ["standard"])


class Portfolio(FolderCase):
    def test_peers_and_their_order_are_chosen_by_size_class(self):
        write_campaign(self.folder / "problems", {"auto": 0.1, "quick": 1.0, "sure": 4.0}, tiers=(1e-3, 1e-6), copies=1,
                       peers=("quick", "sure"), change=only("quick", "-50-", fail))
        status, told, error = run("portfolio", self.folder / "problems", "-o", self.folder / "portfolio.json")
        self.assertEqual((status, error), (0, ""))
        found = json_of(self.folder / "portfolio.json")
        self.assertEqual((found["schema"], found["tier"]), ("lcpbench-portfolio/1", 1e-6))
        self.assertEqual(found["classes"], dict.fromkeys(found["classes"], ["quick", "sure"]))
        self.assertIn("7-12: quick, sure\n", told)
        write_campaign(self.folder / "own", {"auto": 1.0}, tiers=(1e-6,), copies=1)
        self.assert_refused("portfolio", self.folder / "own", "-o", self.folder / "other.json", told=("peers",))


class Record(FolderCase):
    """What is written of a campaign, from its files to the file."""

    def describe(self, sizes: list[int], *say) -> dict:
        self.campaign = campaign_of(write_campaign, {"lemke": 1.0, "lemke-try1": 0.5}, tiers=(1e-6,), noise=Noise(problem=0.02))
        return choice.describe(self.campaign, {"lemke": SMALL}, {"lemke": draw(SMALL, 8, 1)},
                               choice.Asked(8, 1, DATA / "tuning.json", sizes, 21), ["standard"], "2026-01-01", *say)

    def test_says_what_was_tried_and_what_is_chosen(self):
        said: list[str] = []
        made = self.describe([10], said.append)
        write_object(self.folder / "tuned.json", made)
        read = json_of(self.folder / "tuned.json")
        self.assertEqual(read, json.loads(json.dumps(made)))
        self.assertEqual(read["schema"], "lcpbench-tuned/2")
        self.assertEqual(read["budget"], 8)
        self.assertEqual(read["space"]["sha256"], hash_of([load_spaces(DATA / "tuning.json")["lemke"]]))
        solver = read["solvers"][0]
        self.assertEqual(solver["chosen"], {"block_start": "yes"})
        self.assertEqual((solver["space"], solver["configurations"], len(solver["tried"])), (2, 2, 2))
        gain = solver["gain"]
        self.assertEqual(gain["ratio"], solver["tried"][1]["ratio"])
        self.assertTrue(0.48 < gain["low"] <= gain["ratio"] <= gain["high"] < 0.7, gain)
        self.assertGreater(read["measured_s"]["lemke"], 0)
        self.assertIn("block_start=yes", said[0])

    def test_every_size_has_a_choice_of_its_own_on_the_problems_nearest_to_it(self):
        sizes = [4, 40, 400]
        made = self.describe(sizes)["solvers"]
        self.assertEqual([one["rows"] for one in made], sizes)
        rows = [problem["rows"] for problem in self.campaign.problems.values()]
        self.assertEqual(sum(one["tried"][0]["problems"] for one in made), len(rows))
        for one in made:
            near = sum(abs(math.log(n / one["rows"])) == min(abs(math.log(n / size)) for size in sizes) for n in rows)
            self.assertEqual(one["tried"][0]["problems"], near)

    def test_the_nearest_size_is_by_ratio(self):
        for rows, size in ((1, 10), (31, 10), (32, 100), (316, 100), (317, 1000), (10**6, 1000)):
            self.assertEqual(choice.nearest(rows, [1000, 10, 100]), size)

    def test_the_committed_file_is_of_the_committed_space(self):
        tuned = json_of(DATA / "tuned.json")
        spaces = load_spaces(DATA / "tuning.json")
        of_tuned = dict.fromkeys(solver["solver"] for solver in tuned["solvers"])
        self.assertEqual(tuned["space"]["sha256"], hash_of([spaces[key] for key in of_tuned]))
        for solver in tuned["solvers"]:
            space = spaces[solver["solver"]]
            drawn = draw(space, tuned["budget"], tuned["seed"])
            self.assertEqual([outcome["settings"] for outcome in solver["tried"]], drawn, solver["solver"])
            self.assertIn(solver["chosen"], drawn)
            self.assertEqual(solver["configurations"], min(tuned["budget"], space.size))
