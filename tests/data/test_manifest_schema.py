"""The published JSON Schema of manifests accepts the collection's, and they keep what data/README.md promises."""

import functools
import gzip
import json
import sys
import unittest
from fractions import Fraction
from pathlib import Path

from schema_case import json_of, validator_of

_DATA = Path(__file__).resolve().parents[2] / "data"
sys.path.insert(0, str(_DATA))
import coverage  # noqa: E402
_TIERS = ["smoke", "engine", "standard", "large", "sequences", "pathological", "literature", "nonsymmetric",
          "friction-engine", "friction", "friction-recorded", "friction-literature", "friction-pathological", "painleve",
          "friction-sequences"]


@functools.cache
def _manifest(tier):
    return json_of(_DATA / f"{tier}.json")


class ManifestSchema(unittest.TestCase):
    def test_the_committed_ones_are_valid(self):
        validator = validator_of("manifest")
        for tier in _TIERS:
            self.assertEqual([error.message for error in validator.iter_errors(_manifest(tier))], [], tier)


class Collection(unittest.TestCase):
    """What data/README.md promises of the tiers."""

    def test_ids_and_contents_are_unique(self):
        # The engine's and the standard tier's problems differ in size; nothing is counted twice.
        items = [item for tier in _TIERS for item in _manifest(tier)["problems"] + _manifest(tier)["sequences"]]
        for key in ("id", "sha256"):
            self.assertEqual(len({item[key] for item in items}), len(items))

    def test_no_trivial_problems(self):
        for tier in ("smoke", "standard"):
            for problem in _manifest(tier)["problems"]:
                self.assertLess(problem["fraction_active"], 1, problem["id"])
                self.assertGreater(problem["fraction_active"], 0, problem["id"])
                self.assertEqual(problem["reference"].get("status", "solved"), "solved", problem["id"])

    def test_literature_is_not_ours_and_has_answers(self):
        for tier in ("literature", "nonsymmetric", "friction-literature"):
            problems = _manifest(tier)["problems"]
            self.assertEqual({p["origin"] for p in problems}, {"literature"})
            for problem in problems:
                self.assertTrue(problem["provenance"] and problem["licence"], problem["id"])
                if tier == "literature" and problem["rows"] <= 20_000:
                    self.assertIn(problem["reference"]["kind"], ("certified", "bounded"), problem["id"])
                    self.assertEqual(problem["reference"]["status"], "solved", problem["id"])
        sizes = {problem["rows"] for problem in _manifest("literature")["problems"] if "recipe" in problem}
        self.assertLessEqual({100, 1024, 10_000, 99_856, 1_000_000}, sizes)

    def test_pathological_problems_say_what_they_break(self):
        for tier in ("pathological", "friction-pathological", "painleve"):
            for problem in _manifest(tier)["problems"]:
                self.assertTrue(problem.get("purpose", "").endswith("."), problem["id"])

    def test_problems_with_friction_have_some_and_shares_of_what_it_does(self):
        for tier, least, most in (("friction-engine", 2, 18), ("friction", 4, 10_000)):
            problems = _manifest(tier)["problems"]
            for problem in problems:
                self.assertGreater(problem["friction"], 0, problem["id"])
                self.assertTrue(least <= problem["rows"] <= most, problem["id"])
                if problem["reference"]["kind"] == "none":
                    continue
                self.assertAlmostEqual(problem["open"] + problem["stick"] + problem["slip"], 1, 3, problem["id"])
                self.assertLess(problem["open"], 1, problem["id"])
                self.assertEqual(problem["reference"]["status"], "solved", problem["id"])
            self.assertLessEqual(sum(p["reference"]["kind"] == "none" for p in problems), len(problems) / 100)
            self.assertEqual(len({problem["family"] for problem in problems if "grid" not in problem}),
                             {"friction-engine": 12, "friction": 15}[tier])
        self.assertLessEqual(max(p["friction"] for p in _manifest("friction-engine")["problems"]), 3)

    def test_accelerations_have_none_one_or_several_answers(self):
        references = [problem["reference"] for problem in _manifest("painleve")["problems"]]
        self.assertEqual({reference["kind"] for reference in references}, {"certified"})
        self.assertGreaterEqual(sum(r["status"] == "infeasible" for r in references), 10)
        self.assertGreaterEqual(sum(r.get("f_unique") is False for r in references), 10)
        self.assertGreaterEqual(sum(r.get("f_unique") is True for r in references), 10)

    def test_sliding_tips_have_the_answers_of_painleve(self):
        # The law of one sliding contact, w = (A_nn - s mu A_nt) f + b_n, in the rationals that the doubles are.
        references = {problem["id"]: problem["reference"] for problem in _manifest("painleve")["problems"]}
        seen = set()
        with gzip.open(_DATA / "problems/painleve.jsonl.gz", "rt", encoding="utf-8") as lines:
            for record in map(json.loads, lines):
                if record["family"] != "sliding-rod":
                    continue
                friction = record["friction"]
                factor = Fraction(friction["slip"][0]) * Fraction(friction["mu"][0])
                slope = sum(Fraction(n) * Fraction(m) * (Fraction(n) - factor * Fraction(t))
                            for n, t, m in zip(*record["J"], record["invM"]))
                sign, load = (slope > 0) - (slope < 0), (record["b"][0] > 0) - (record["b"][0] < 0)
                has_two = sign < 0 < load or sign == load == 0
                has_none = sign <= 0 and load < 0
                reference = references[record["id"]]
                self.assertEqual(reference["status"], "infeasible" if has_none else "solved", record["id"])
                if not has_none:
                    self.assertEqual(reference["f_unique"], not has_two, record["id"])
                seen.add((sign, load))
        self.assertEqual(seen, {(1, -1), (1, 1), (0, -1), (0, 0), (0, 1), (-1, -1), (-1, 0), (-1, 1)})

    def test_sequences_with_friction_are_thirty_of_a_hundred_steps(self):
        sequences = _manifest("friction-sequences")["sequences"]
        self.assertEqual([sequence["steps"] for sequence in sequences], [100] * 30)

    def test_what_friction_stores_is_small(self):
        files = [path for path in _DATA.rglob("*") if path.name.startswith(("friction", "painleve"))]
        self.assertLessEqual(sum(path.stat().st_size for path in files), 15_000_000)

    def test_steps_of_motions_are_thirty_percent_of_the_weight(self):
        problems = _manifest("standard")["problems"]
        self.assertGreaterEqual(coverage.motion_share(problems), 0.3)
        steps = [problem for problem in problems if problem["origin"] == "motion"]
        self.assertGreaterEqual(min(problem["rows"] for problem in steps), 40)
        self.assertLessEqual(max(problem["rows"] for problem in steps), 2000)
        self.assertGreaterEqual(len({problem["family"] for problem in steps}), 12)

    def test_problems_of_one_base_share_its_weight(self):
        problems = [{"base": base} for base in ("a", "a", "b", "a", "c")]
        self.assertEqual(coverage.weights(problems), [1 / 3, 1 / 3, 1, 1 / 3, 1])

    def test_rank_and_condition_are_there_up_to_2000_rows(self):
        for tier in ("smoke", "engine", "standard", "pathological"):
            for problem in _manifest(tier)["problems"]:
                self.assertIn("exact", problem["rank_method"], problem["id"])
                if problem["rows"] <= 2000:
                    self.assertTrue(problem["condition"] is not None or "zero" in problem["condition_method"])

    def test_the_tables_count_every_problem(self):
        tables = coverage.text()
        for tier in coverage._TIERS:
            self.assertIn(f"| `{tier}` | {len(_manifest(tier)['problems'])} |", tables)

    def test_grids_vary_one_thing(self):
        grids = {}
        for problem in _manifest("standard")["problems"]:
            if "grid" not in problem:
                continue
            (change,) = problem["recipe"]["changes"]
            rows = problem["recipe"]["rows"]
            grids.setdefault((problem["grid"], problem["family"], rows), []).append((change["name"], change["amount"]))
        self.assertEqual(
            {key[0] for key in grids},
            {"mass ratio", "redundancy", "condition", "active fraction", "curvature contrast"},
        )
        for key, points in grids.items():
            self.assertGreaterEqual(len(points), 3, key)
            self.assertEqual(len({name for name, _ in points}), 1, key)


if __name__ == "__main__":
    unittest.main()
