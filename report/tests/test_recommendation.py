"""Rules of `lcpbench recommend`: lists on made-up outcomes whose right answer is known, and an evaluation that does not
see what it holds out."""

import itertools
import json
import math
import unittest
from pathlib import Path

import numpy as np
import pandas as pd

from lcpbench_report.errors import ReportError
from lcpbench_report.recommendation import evaluation, rules
from lcpbench_report.recommendation.outcomes import Outcomes, read_outcomes, read_sequences
from lcpbench_report.statistics.cells import cell_table
from lcpbench_report.statistics.load import load_campaign
from . import synthetic_campaign
from .cases import FolderCase, run
from .synthetic_steps import SEQUENCES, STEPS, one_pass, write_sequences

EDGES = {"rows": [0, 50]}
FAMILIES = ("arches", "boxes", "chains", "discs")


def outcomes_of(latency, families=FAMILIES, sizes=(10, 20, 100, 200), tiers=(1e-3, 1e-6), solvers=("a", "b", "c"),
                seeds=(1,)) -> Outcomes:
    """@param latency  (solver, family, rows, tier) -> seconds, infinite: not verified"""
    table = pd.DataFrame([
        {"problem": f"{family}-n{size}-s{seed}", "family": family, "rows": size, "seed": float(seed), "solver": solver,
         "tier": tier, "verified": (time := latency(solver, family, size, tier)) < math.inf, "false_success": False,
         "weight": 1.0, "source": None, "time_s": time}
        for family, size, seed, tier, solver in itertools.product(families, sizes, seeds, tiers, solvers)])
    features = table.drop_duplicates("problem").set_index("problem")[["rows"]].astype(float)
    return Outcomes(table, features, list(solvers), [], [{"name": "made-up", "commit": "", "cpu": ""}], EDGES)


def candidates_by_region(outcomes: Outcomes, leave_out=frozenset()) -> dict:
    found = rules.make_regions(outcomes, leave_out)
    return {(region["tier"], region["where"]["rows"][0]): region["candidates"] for region in found}


class ChooseTest(unittest.TestCase):
    def test_what_is_chosen(self):
        for why, ratios, most, expected in (
                ("one is enough where it is always the best", {"slow": [2.0, 3.0], "best": [1.0, 1.0]}, 4, ["best"]),
                ("two that complement each other go before the second best on average",
                 {"small": [1.0, 1.0, 9.0], "large": [30.0, 30.0, 1.0], "even": [1.4, 1.4, 1.4]}, 2, ["small", "large"]),
                ("one that fails is backed up", {"fast": [1.0, 1.0, 1e3], "sure": [5.0, 5.0, 1.0]}, 4, ["fast", "sure"]),
                ("who claims success falsely is never chosen", {"liar": [1.0, 1.0], "honest": [1.5, 1.5]}, 4, ["honest"]),
                ("what adds nothing is left out", {"a": [1.0, 1.0], "twin": [1.0, 1.0]}, 4, ["a"])):
            with self.subTest(why):
                table = pd.DataFrame(ratios)
                self.assertEqual(rules.choose(table, np.ones(len(table)), {"liar"}, most), expected)

    def test_families_weigh_the_same_however_many_problems_they_have(self):
        weights = rules.family_weights(pd.Series(["large"] * 9 + ["small"]), pd.Series([0.5] * 2 + [1.0] * 8))
        self.assertAlmostEqual(weights[:9].sum(), weights[9:].sum())
        self.assertAlmostEqual(weights[0] / weights[2], 0.5)  # of one base
        ratios = pd.DataFrame({"of_nine": [1.0] * 9 + [3.0], "of_one": [1.2] * 9 + [1.0]})
        self.assertEqual(rules.choose(ratios, weights, set(), 1), ["of_one"])
        self.assertEqual(rules.choose(ratios, np.ones(10), set(), 1), ["of_nine"])


class RegionsTest(unittest.TestCase):
    def test_a_region_begins_at_its_edge_and_the_last_has_no_end(self):
        features = pd.DataFrame({"rows": [1.0, 16.0, 17.0, 1e6], "spread": [0.0, 5.0, math.nan, 5.0]})
        edges = {"rows": [0, 17], "spread": [0, 5]}
        self.assertEqual(rules.region_of(features, edges).tolist(), [0, 1, 2, 3])
        self.assertEqual(rules.bounds(edges)[3], {"rows": (17, math.inf), "spread": (5, math.inf)})

    def test_every_size_and_tier_has_the_list_of_its_own(self):
        best = {(True, 1e-3): "a", (True, 1e-6): "b", (False, 1e-3): "c", (False, 1e-6): "a"}
        found = candidates_by_region(outcomes_of(
            lambda solver, family, rows, tier: 1e-5 if solver == best[(rows < 50, tier)] else 1e-3))
        self.assertEqual(found, {(1e-3, 0): ["a"], (1e-6, 0): ["b"], (1e-3, 50): ["c"], (1e-6, 50): ["a"]})

    def test_a_region_of_too_few_families_takes_the_list_of_its_size(self):
        made = outcomes_of(lambda solver, family, rows, tier: {"a": 2, "b": 1, "c": 3}[solver] if family == "arches"
                           else {"a": 1, "b": 2, "c": 3}[solver], sizes=(10,))
        made.features["spread"] = [1.0 if name.startswith("arches") else 0.0 for name in made.features.index]
        made.edges = EDGES | {"spread": [0, 1]}
        found = rules.make_regions(made)
        lone = [region for region in found if region["where"]["spread"][0] == 1]
        self.assertEqual([region["problems"] for region in lone], [4, 4])
        self.assertEqual([region["candidates"] for region in lone], [["a", "b"]] * 2)

    def test_solvers_are_ranked_by_how_often_they_are_near_the_best(self):
        made = outcomes_of(lambda solver, family, rows, tier:
                           {"a": math.inf if family == "discs" else 1, "b": 1.2, "c": 9}[solver])
        self.assertEqual(rules.make_regions(made)[0]["solvers"],
                         [{"solver": "b", "verified": 1.0, "within": 1.0},
                          {"solver": "a", "verified": 0.75, "within": 0.75},
                          {"solver": "c", "verified": 1.0, "within": 0.0}])


class EvaluationTest(unittest.TestCase):
    @staticmethod
    def odd_one_out(solver, family, rows, tier):
        """c is good for discs only, and a for all others."""
        good = {"discs": "c"}.get(family, "a")
        return 1e-5 if solver == good else 5e-5 if solver == "b" else 1e-3

    def rows_of(self, made: Outcomes) -> dict:
        table = rules.tier_tables(made)[0]
        return {row["group"]: row for row in evaluation.held_out(made, table, table.families, EDGES)}

    def test_a_family_that_needs_what_no_other_needs_does_not_pass(self):
        found = self.rows_of(outcomes_of(self.odd_one_out))
        self.assertEqual({family: row["passes"] for family, row in found.items()},
                         {"arches": True, "boxes": True, "chains": True, "discs": False})
        self.assertEqual(found["discs"]["right"], 0)
        self.assertAlmostEqual(found["discs"]["median"], 100)
        # Rules that may look at it have the answer.
        self.assertIn("c", candidates_by_region(outcomes_of(self.odd_one_out))[(1e-3, 0)])
        self.assertNotIn("c", candidates_by_region(outcomes_of(self.odd_one_out), frozenset({"discs"}))[(1e-3, 0)])

    def test_what_the_held_out_family_says_changes_nothing(self):
        first = outcomes_of(self.odd_one_out)
        second = outcomes_of(lambda solver, family, rows, tier: 1e-9 if family == "discs" and solver == "b"
                             else self.odd_one_out(solver, family, rows, tier))
        leave_out = frozenset({"discs"})
        self.assertEqual(rules.make_regions(first, leave_out), rules.make_regions(second, leave_out))
        self.assertNotEqual(rules.make_regions(first), rules.make_regions(second))

    def test_what_one_engine_met_is_held_out_at_once(self):
        """Solver b is the best on one engine's two families alone: a rule that knows one of them names it."""
        made = outcomes_of(lambda solver, family, rows, tier: {"a": 1.0 if family < "c" else 9.0,
                                                               "b": 9.0 if family < "c" else 1.0, "c": 20.0}[solver])
        made.table["source"] = made.table["family"].map({"chains": "engine", "discs": "engine"})
        found = evaluation.evaluate(made)
        self.assertEqual({row["source"] for row in found["sources"]}, {"engine"})
        self.assertEqual([(row["problems"], row["right"], row["passes"]) for row in found["sources"]],
                         [(8, 0, False)] * 2)
        by_family = {row["family"]: row["passes"] for row in found["families"]}
        self.assertTrue(by_family["chains"] and by_family["discs"])
        self.assertEqual(found["tiers"][0]["sources"], {"groups": 1, "pass": 0, "problems": 8, "right": 0, "share": 0.0})

    def test_without_other_sources_none_is_held_out(self):
        made = outcomes_of(lambda solver, family, rows, tier: {"a": 1, "b": 2, "c": 3}[solver])
        self.assertEqual(evaluation.evaluate(made)["sources"], [])

    def test_nine_of_ten_problems_are_enough_and_eight_are_not(self):
        for wrong, passes in ((1, True), (2, False)):
            made = outcomes_of(lambda solver, family, rows, tier, wrong=wrong:
                               {"a": 1.0 if family != "discs" or rows > wrong else 9.0, "b": 5.0, "c": 1.0}[solver],
                               sizes=range(1, 11))
            # Only the family that is held out would want c.
            made.table.loc[(made.table.solver == "c") & (made.table.family != "discs"), "time_s"] = 9.0
            row = self.rows_of(made)["discs"]
            self.assertEqual((row["problems"], row["right"], row["passes"]), (10, 10 - wrong, passes))

    def test_a_candidate_that_fails_is_passed_over_for_the_next(self):
        made = outcomes_of(lambda solver, family, rows, tier: math.inf if solver == "a" and rows == 10
                           else {"a": 1.0, "b": 1.2, "c": 9.0}[solver])
        row = self.rows_of(made)["arches"]
        self.assertEqual(row["right"], row["problems"])

    def test_seeds_are_held_out_as_families_are(self):
        made = outcomes_of(lambda solver, family, rows, tier: {"a": 1, "b": 2, "c": 3}[solver], seeds=(1, 2, 3))
        found = evaluation.evaluate(made)
        self.assertEqual([(row["seed"], row["problems"]) for row in found["seeds"]
                          if row["tier"] == 1e-3],
                         [(1, 16), (2, 16), (3, 16)])
        self.assertEqual(found["tiers"][0]["seeds"],
                         {"groups": 3, "pass": 3, "problems": 48, "right": 48, "share": 1.0})

    def test_a_feature_that_tells_two_kinds_apart_shows_as_one_that_helps(self):
        """Twenty-four families fill the list of five with a solver for each size; four others need a sixth."""
        families = [f"a{k:02}" for k in range(24)] + [f"d{k}" for k in range(4)]

        def latency(solver, family, rows, tier):
            return 1e-5 if solver == ("s6" if family.startswith("d") else f"s{rows}") else 1e-3

        made = outcomes_of(latency, families, sizes=(1, 2, 3, 4, 5), tiers=(1e-3,),
                           solvers=[f"s{k}" for k in range(1, 7)])
        made.features["kind"] = [float(name.startswith("d")) for name in made.features.index]
        found = {tuple(of["features"]): of for of in evaluation.compare_divisions(made)}
        self.assertEqual(found[("rows",)]["right"], 120)
        self.assertEqual(found[("rows", "kind")]["right"], 140)
        self.assertEqual((found[("rows",)]["pass"], found[("rows", "kind")]["pass"]), (24, 28))


class CommandTest(FolderCase):
    def setUp(self):
        """A folder of three own solvers, one of them of an ablation, and a peer, and the features of its problems. A
        fill-up has none."""
        super().setUp()
        self.campaign, self.features = folder, path = self.folder / "campaign", self.folder / "features.jsonl"
        synthetic_campaign.write_campaign(
            folder, {"auto": 4.0, "pgs": 1.0, "bare": 0.1, "peer": 2.0}, tiers=(1e-6,), copies=2,
            change_problem=lambda problem: problem | {"family": problem["family"] + problem["problem"][-1],
                                                      "fill": problem["problem"] == "ragdoll"},
            solvers={"peer": {"origin": "peer"}, "bare": {"ablation": "no-self-check", "base": "auto"}},
            info={"environment": {"git_commit": "abc"}})
        problems = [json.loads(line) for line in (folder / "problems.jsonl").read_text().splitlines()]
        path.write_text("".join(json.dumps({"problem": one["problem"], "rows": one["rows"], "redundancy": None}) + "\n"
                                for one in problems if not one["fill"]))

    def test_the_fresh_time_counts_and_peers_are_told_apart(self):
        found = read_outcomes([self.campaign], self.features)
        self.assertEqual((found.own, found.peers), (["auto", "pgs"], ["peer"]))  # nothing of ablations
        self.assertEqual(found.edges["rows"][:4], [0, 2, 4, 7])
        cells = cell_table(load_campaign(self.campaign))
        np.testing.assert_allclose(found.table.groupby("solver").time_s.median(),
                                   cells.groupby("solver").fresh_s.median())
        made = evaluation.make(found)
        self.assertEqual({tuple(region["candidates"]) for region in made["regions"]}, {("pgs",)})
        self.assertEqual({tuple(region["peers"]) for region in made["regions"]}, {("peer",)})
        self.assertEqual(made["sequences"], [])

    def test_sequences_have_lists_by_the_latency_of_warm_steps(self):
        passes = [one_pass(name, solver, mode, [time * (1 if mode == "warm" else cold)] * STEPS,
                           failed=range(5) if solver == "wrong" else ())
                  for name, _ in SEQUENCES for mode in ("cold", "warm")
                  for solver, time, cold in (("quick", 1e-5, 9), ("slow", 2e-5, 1), ("wrong", 1e-6, 1))]
        write_sequences(self.folder / "sequences", passes, [(key, "own") for key in ("quick", "slow", "wrong")])
        found = read_sequences([self.campaign, self.folder / "sequences"])
        self.assertEqual(found.table[found.table.solver == "quick"].time_s.tolist(), [1e-5] * len(SEQUENCES))
        self.assertFalse(found.table[found.table.solver == "wrong"].verified.any())  # on 95 % of the steps
        made = evaluation.make(read_outcomes([self.campaign], self.features), found)
        self.assertEqual({tuple(region["candidates"]) for region in made["sequences"]}, {("quick",)})
        self.assertIsNone(read_sequences([self.campaign]))

    def test_the_file_says_where_it_comes_from_and_is_the_same_each_time(self):
        outputs = [self.folder / "one.json", self.folder / "two.json"]
        for output in outputs:
            status, text, error = run("recommendation", self.campaign, "--features", self.features, "-o", output)
            self.assertEqual((status, error), (0, ""))
            self.assertIn("families held out:", text)
        self.assertEqual(outputs[0].read_bytes(), outputs[1].read_bytes())
        made = json.loads(outputs[0].read_text())
        self.assertEqual((made["schema"], made["campaigns"][0]["commit"]), ("lcpbench-recommendation/1", "abc"))
        self.assertEqual([made["evaluation"]["tiers"][0]["families"][key] for key in ("pass", "groups")], [5, 5])

    def test_families_can_be_left_out(self):
        output = self.folder / "rules.json"
        self.assertEqual(run("recommendation", self.campaign, "--features", self.features, "--leave-out", "piles0", "-o",
                             output)[0], 0)
        made = json.loads(output.read_text())
        self.assertEqual((made["left_out"], made["evaluation"]), (["piles0"], None))
        self.assertLessEqual({region["families"] for region in made["regions"]}, {3, 4})

    def test_mistakes_are_one_line(self):
        for arguments, expected in (
                ((self.campaign, "--features", self.folder / "none", "-o", "x"), "no such file"),
                ((self.folder, "--features", self.features, "-o", "x"), "campaign.json: missing"),
                ((self.campaign, self.campaign, "--features", self.features, "-o", "x"), "is in two"),
                ((self.campaign, "--features", self.features, "--leave-out", "cubes", "-o", "x"),
                 "no problem of family 'cubes'")):
            self.assert_refused("recommendation", *arguments, told=(expected,))
        self.features.write_text(self.features.read_text().split("\n", 1)[1])
        with self.assertRaisesRegex(ReportError, "no line for problem"):
            read_outcomes([self.campaign], self.features)
