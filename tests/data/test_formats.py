"""Readers and the schemas of docs/formats/ agree on generated changes of documents; files of ours are valid."""

import gzip
import json
import math
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

from schema_case import FORMATS, REMOVED, changed, json_of, validator_of

_ROOT = FORMATS.parents[1]
_READER = os.environ.get("LCPBENCH_FORMAT_READER")
_COMMAND = os.environ.get("LCPBENCH_COMMAND")

_VALUES = [REMOVED, None, True, "", "x", "1/2", -1, 0, 1.5, 3, [], {}, [1], [[1, 2]]]
_STRANGER = "a_member_of_no_format"

_BODY = {"mass": 1, "inertia": 1, "fixed": False, "x": [0, 0], "theta": 0, "v": [0, 0], "omega": 0, "force": [0, 0], "torque": 0}
_VERTEX = {"type": "vertex", "p": [0, 0]}
_FEATURES = [
    _VERTEX,
    {"type": "straight", "a": [0, 0], "b": [1, 0]},
    {"type": "arc", "center": [0, 0], "radius": 1, "side": "convex"},
    {"type": "ellipse", "center": [0, 0], "a": 1, "b": 2, "phi": 0, "side": "concave"},
    {"type": "superellipse", "center": [0, 0], "a": 1, "b": 2, "m": 4, "phi": 0, "side": "convex"},
    {"type": "bezier", "P": [[0, 0], [1, 0], [1, 1], [0, 1]]},
]
_CONTACT = {"type": "rod", "body1": 0, "body2": 1, "feature1": _VERTEX, "feature2": _VERTEX, "length": 1, "s1": None, "nominal_gap": 0}
_RECORDED = {"kind": "curved_curved", "p": 0, "q": 1, "n": [0, 1], "normalFixed": False, "R1": [0, 0], "R2": [0, 0], "U1": [0, 0],
             "U2": [0, 0], "radius1": 1, "radius2": -2, "distance": 0, "vn": 0, "extra": 0}
_MOVING = {"name": "ball", "fixed": False, "m": 1, "I": 1, "x": 0, "y": 0, "angle": 0, "vx": 0, "vy": 0, "omega": 0, "ax": 0, "ay": 0,
           "alpha": 0}
_RECORDING = [
    {"lcpbench_recording": 1, "engine": "e", "engine_version": "1", "licence": "MIT", "scene": "s", "source": "here", "dimension": 3, "gravity": None,
     "time_step": 0.1, "bodies": [{"inverse_mass": 1, "inverse_inertia": [1, 2, 3]}]},
    {"lcpbench_recording": 1, "engine": "e", "engine_version": "1", "licence": "MIT", "scene": "s", "source": "here", "dimension": 2,
     "time_step": 0.1, "bodies": [{"inverse_mass": 1, "inverse_inertia": 2}]},
    {"step": 1, "bodies": {"x": [[0, 0], [1, 1]], "q": [0, 1], "v": [[0, 0], [1, 1]], "omega": [0, 1], "force": [[0, 0], [1, 1]], "torque": [0, 1]},
     "contacts": [{"b": [-1, 0], "p": [0, 0], "n": [0, 1], "gap": 0.1, "mu": 0.5, "id": "c", "shape": ["edge", "circle"], "radius": [None, 0.5]}],
     "joints": [{"b": [0, 1], "kind": "pin", "id": "j", "rows": [{"J": [1, 0, 1, -1, 0, 1], "error": 0, "limit": True}]}]},
    {"step": 1, "bodies": {"x": [[0, 0, 0]] * 2, "q": [[1, 0, 0, 0]] * 2, "v": [[0, 0, 0]] * 2, "omega": [[0, 0, 0]] * 2, "force": [[0, 0, 0]] * 2,
                           "torque": [[0, 0, 0]] * 2},
     "contacts": [{"b": [0, 1], "p": [0, 0, 0], "n": [0, 0, 1], "gap": 0, "mu": 0, "id": "c", "shape": ["box", "box"], "radius": [None, None]}],
     "joints": [{"b": [0, -1], "kind": "ball", "id": "j", "rows": [{"J": [1, 0, 0] * 4, "error": 0}]}]}]
_PROBLEM = {"id": "two", "n": 2, "A": [[2, 1], ["1", "2/1"]], "b": [-1, "1/2"], "bilateral": [1], "symmetrized": 1e-5}


def _line(name):
    """A line of a campaign of every kind, from the types of benchmarks/campaign/result_fields.h."""
    fields = json_of(_ROOT / "report/lcpbench_report/statistics/result_fields.json")
    samples = {"name": "n", "text": "", "boolean": True, "count": 0, "number": -1.5, "nonnegative": 0.5, "positive": 0.5, "object": {}, "list": []}

    def record(*names):
        line = {}
        for one in names:
            for key, field in fields[one].items():
                kind = field["type"].strip("[]?")
                line[key] = [samples[kind], None] if field["type"].startswith("[") else samples[kind]
        return line
    if name == "problem":
        return record("problem")
    if name == "pass":
        return record("pass", "steps") | {"verdicts": [record("step_verdict")], "retried": [record("retry")]}
    line = record("line", name) | {"kind": name, "retried": [record("retry")]}
    if name == "judge":
        return line | {"exceptions": [record("exception")]}
    return line | {"disturbance": record("disturbance")}


def _short(document):
    """With two items of every list."""
    if isinstance(document, list):
        return [_short(item) for item in document[:2]]
    return {key: _short(value) for key, value in document.items()} if isinstance(document, dict) else document


def _small_manifest():
    """One of everything."""
    sets = [json_of(_ROOT / "data" / f"{name}.json") for name in ("smoke", "standard", "sequences")]
    small = sets[0] | {"problems": sets[0]["problems"][:1], "refused": sets[0]["refused"][:1], "sequences": sets[2]["sequences"][:1]}
    small["fill"] = [dict(sets[1]["fill"][0])]
    recipe = dict(small["fill"][0]["recipes"][0])
    recipe["seeds"] = recipe["seeds"][:2]
    small["fill"][0] |= {"recipes": [recipe], "problems": 2, "refused_by_reason": {"why": 1}}
    for problem in sets[1]["problems"]:
        if "file" in problem:
            return small | {"problems": [*small["problems"], problem]}
    raise AssertionError("no problem in a file")


_SIZES = r"expected an array of \d+, found|the length of b|rows of \d+ columns|\[0, \d+\)|the same bilateral rows"
# Format: documents, and what its reader refuses that a schema cannot say.
_DOCUMENTS = {
    "problem": ([
        _PROBLEM, {"b": [1, 2], "A": [1, 0, 0, 1], "joint": [True, False], "status": "solved", "w": [1, 2], "f_minnorm": None,
                   "f_unique": True, "rank_A": 2, "category": "c", "contacts": [{"joint": True}, {}]},
        {"b": [1], "J": {"shape": [1, 3], "row": [0], "col": [2], "val": [1]}, "invM": [1, 1, 1], "columns_per_body": 3, "id": 7},
        {"b": [-1, 1, 1], "A": [1, 0, 0, 0, 1, 0, 0, 0, 1], "friction": {"row": [1], "normal": [0], "mu": ["1/2"], "slip": [-1]},
         "bounded": {"row": [2], "lower": [-1], "upper": [None]}, "w_unique": True, "solvable": True}],
        _SIZES + r"|(friction|bounded): row \d|/shape/\d: expected \d+, found|inverse_mass|row starts|columns\["),
    "sequence": ([{**_PROBLEM, "previous": [-1, -1], "floor": 1e-12}], _SIZES + "|a row of the line before"),
    "reference": ([{"id": "two", "kind": "certified", "status": "solved", "f_unique": True, "w": [0, 1], "f_minnorm": [1, 0], "f": [1, 1]},
                   {"id": "two", "status": "solved", "w": [0, 1], "f": [1, 0], "f_unique": None}, {"id": "two", "status": "infeasible"}],
                  _SIZES + "|id: not found"),
    "contact_record": ([{"id": "s", "bodies": [_BODY], "contacts": [_CONTACT | {"feature2": feature} for feature in _FEATURES]},
                        {"id": "c", "kind": "rope", "body1": _BODY, "body2": _BODY, "feature1": _VERTEX, "feature2": _VERTEX, "length": 2}],
                       "$^"),
    "replay_record": ([{"id": "r", "n": 1, "bodies": [_MOVING, {"name": "floor", "fixed": True, "x": 0, "y": 0, "angle": 0}],
                        "contacts": [contact], "A": [1], "b": [1]} for contact in (
                            _RECORDED, _RECORDED | {"kind": "rod"}, _RECORDED | {"kind": "path_joint", "normal_dt": [0, 0]})],
                      _SIZES + "|the number of contacts|another body than p|a unit vector|a fixed body"),
    "recording": (_RECORDING, _SIZES + r"|expected a number, found|an array of|a unit (vector|quaternion)|an id that stands once in the step|two different bodies"),
    "scene": ([json_of(_ROOT / "tests/fuzz/corpus/every_edge.json"), json_of(_ROOT / "tests/fuzz/corpus/every_shape.json")], ".*"),
    "manifest": ([_small_manifest()], "an id of its own|ids of their own|the number of seeds|within the manifest's folder|name a file|"
                                      "/(base|origin): expected"),
    "tuned": ([_short(json_of(_ROOT / "data/tuned.json"))], "$^"),
    "campaign": ([_short(json_of(_ROOT / "report/reference/core/campaign.json"))], "$^"),
    "campaign_lines": ([_line(name) for name in ("problem", "judge", "fresh", "parts", "again", "pass")], "$^"),
}


def _paths(document, path=()):
    """Of all members, of lists the first two."""
    items = document.items() if isinstance(document, dict) else enumerate(document[:2]) if isinstance(document, list) else ()
    for key, value in items:
        yield (*path, key)
        yield from _paths(value, (*path, key))


def _changes(document, most):
    """(path, document) of changes of single members; of long documents, a fair sample."""
    changes = [(path, value) for path in _paths(document) for value in _VALUES]
    step = max(1, len(changes) // most)
    while math.gcd(step, len(_VALUES)) > 1:  # so that every value has its turn
        step += 1
    for path, value in changes[::step]:
        yield path, changed(document, path, value)
    for path in [(), *_paths(document)]:
        member = document
        for key in path:
            member = member[key]
        if isinstance(member, dict):
            yield (*path, _STRANGER), changed(document, (*path, _STRANGER), 1)


def _text(value, twist, path=()):
    """JSON, but with what `twist` (path, text) has at its path."""
    if twist[0] == path:
        return twist[1]
    if isinstance(value, dict):
        return "{" + ",".join(f"{json.dumps(key)}:{_text(inner, twist, (*path, key))}" for key, inner in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ",".join(_text(inner, twist, (*path, index)) for index, inner in enumerate(value)) + "]"
    return json.dumps(value)


def _read(name, texts):
    run = subprocess.run([_READER, name], input="\n".join(texts) + "\n", capture_output=True, text=True, check=True)
    answers = run.stdout.splitlines()
    assert len(answers) == len(texts), run.stdout[-300:]
    return answers


@unittest.skipUnless(_READER and _COMMAND, "of a build")
class Formats(unittest.TestCase):
    def test_readers_and_schemas_agree(self):
        for name, (documents, beyond) in _DOCUMENTS.items():
            documents = json.loads(json.dumps(documents))  # without members in common
            validator = validator_of(name)
            most = 1000 // len(documents)
            cases = [((), document) for document in documents] + [case for document in documents for case in _changes(document, most)]
            for (path, document), said in zip(cases, _read(name, [json.dumps(document) for _, document in cases]), strict=True):
                with self.subTest(name, path=path):
                    is_valid = validator.is_valid(document)
                    if said == "ok":
                        self.assertTrue(is_valid, f"the schema refuses {json.dumps(document)[:300]}")
                        continue
                    self.assertTrue(path, said)
                    if is_valid:
                        self.assertRegex(said, beyond)
                    else:
                        self.assertTrue(any(key in said for key in path if isinstance(key, str)), said)

    def test_keys_that_stand_twice_and_numbers_that_are_none_are_refused_by_name(self):
        for name, (documents, _) in _DOCUMENTS.items():
            for document in documents:
                paths = [path for path in _paths(document) if isinstance(path[-1], str)][:100]
                twice = _read(name, [_doubled(document, path) for path in paths])
                for path, said in zip(paths, twice, strict=True):
                    self.assertIn("this key is given twice", said, (name, path))
                    self.assertIn(path[-1], said)
                for said in _read(name, [_text(document, (path, word)) for path in paths for word in ("NaN", "-Infinity")]):
                    self.assertIn("not valid JSON", said)
                for said in _read(name, [_text(document, (path, "1e999")) for path in paths]):
                    self.assertIn("beyond the range of double", said)

    def test_what_is_refused_has_exit_status_2_and_one_line(self):
        with tempfile.TemporaryDirectory() as folder:
            problem = Path(folder, "good.jsonl")
            problem.write_text(json.dumps(_PROBLEM) + "\n")
            commands = {"problem": ["solve", "--solver", "dantzig"], "contact_record": ["assemble"], "replay_record": ["replay"], "scene": ["scene"],
                        "manifest": ["run", "--benchmark_list_tests", "--suite"], "tuned": ["run", "--benchmark_list_tests", "--tuned"]}
            for name, words in commands.items():
                path = Path(folder, f"{name}.json")
                document = _DOCUMENTS[name][0][0]
                key = "lcpbench_manifest" if name == "manifest" else "lcpbench_scene" if name == "scene" else "schema" if "schema" in document else "id"
                path.write_text(_doubled(document, (key,)).replace("\n", " ") + "\n")
                run = subprocess.run([_COMMAND, *words, path], capture_output=True, text=True, check=False)
                self.assertEqual((run.returncode, run.stderr.count("\n")), (2, 1), (name, run.stderr))
                self.assertIn("this key is given twice", run.stderr)

    def test_members_that_mean_something_elsewhere_are_refused_by_name(self):
        members = json_of(FORMATS / "problem.schema.json")["properties"]
        foreign = [name for name, schema in members.items() if schema is False] + ["h"]
        self.assertLessEqual({"lo", "hi", "lower", "upper", "l", "u", "mu", "G", "h", "P", "q", "M"}, set(foreign))
        problem = {"id": "p", "A": [[2]], "b": [-1]}
        cases = [(name, value) for name in foreign for value in (None, 0, [0], "x", {})]
        for (name, _), said in zip(cases, _read("problem", [json.dumps(problem | {name: value}) for name, value in cases]), strict=True):
            self.assertIn(f": /{name}: a problem has no such member", said)
        self.assertEqual(_read("problem", [json.dumps(problem | {"h": 0.025, "contacts": [{}]})]), ["ok"])

    def test_members_that_no_schema_has_are_named_once_for_a_file(self):
        members = json_of(FORMATS / "problem.schema.json")["properties"]
        factors = {"J": [[1]], "invM": [1]}
        samples = {"id": "p", "n": 1, "b": [1], "A": [[1]], "bilateral": [0], "joint": [True], "contacts": [{}], "status": "solved", "w": [0],
                   "f_minnorm": [0], "f_unique": True, "columns_per_body": 3, "rank_A": 1, "category": "c", "symmetrized": 0.1,
                   "friction": None, "bounded": {"row": [0], "lower": [0], "upper": [1]}, "w_unique": True, "solvable": True} | factors
        known = [{"id": str(number), "A": [[1]], "b": [1]} | (factors if name in factors else {name: samples.get(name, [0])})
                 for number, (name, schema) in enumerate(members.items()) if schema is not False and name not in ("id", "h")]
        strangers = ["Lo", "x", "a\nb", "members", "quality", "A0", "bb"]
        unknown = [{"id": f"s{number}", "A": [[1]], "b": [1], name: None, "always": {"lo": 1}} for number, name in enumerate(strangers * 3)]
        with tempfile.TemporaryDirectory() as folder:
            for lines, told in ((known, []), (known + unknown, sorted([*strangers, "always"]))):
                Path(folder, "p.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
                for words in (["solve", "--solver", "pgs", f"{folder}/p.jsonl"], ["convert", f"{folder}/p.jsonl"],
                              ["recommend", "--features", f"{folder}/p.jsonl"], ["import", folder, "--provenance", "p", "--licence", "l"]):
                    run = subprocess.run([_COMMAND, *words], capture_output=True, text=True, check=False)
                    self.assertEqual(run.returncode, 0, run.stderr)
                    warnings = [line for line in run.stderr.splitlines() if "warning" in line]
                    self.assertEqual(len(warnings), 1 if told else 0, run.stderr)
                    for warning in warnings:
                        self.assertIn("p.jsonl: warning: ignored members that no problem has: " +
                                      ", ".join(f"'{name}'" for name in told).replace("\n", "\\n"), warning)

    def test_unknown_members_within_members_are_named(self):
        at = {"row": [1], "normal": [0], "mu": [1]}
        line = {"id": "p", "A": {"shape": [2, 2], "row": [0, 1], "col": [0, 1], "val": [1, 1], "vals": []}, "b": [1, 1]}
        for more, told in (({}, "'A/vals'"), ({"friction": at | {"slp": [1]}}, "'A/vals', 'friction/slp'"),
                           ({"J": line["A"] | {"cols": []}, "invM": [1, 1]}, "'A/vals', 'J/cols', 'J/vals'"),
                           ({"bounded": {"row": [1], "lower": [0], "upper": [None], "a/b": 1}}, "'A/vals', 'bounded/a~1b'")):
            with tempfile.TemporaryDirectory() as folder:
                Path(folder, "p.jsonl").write_text(json.dumps(line | more))
                run = subprocess.run([_COMMAND, "solve", "--solver", "pgs", f"{folder}/p.jsonl"], capture_output=True, text=True,
                                     check=False)
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertIn(f"p.jsonl: warning: ignored members that no problem has: {told}\n", run.stderr)

    def test_files_of_ours_are_valid(self):
        lines = {"problem": sorted(str(path.relative_to(_ROOT)) for path in (_ROOT / "data/problems").glob("*.gz")
                                   if not path.name.endswith("-sequence.jsonl.gz")),
                 "reference": sorted(str(path.relative_to(_ROOT)) for path in (_ROOT / "data/references").glob("*.gz"))}
        for name, files in lines.items():
            validator = validator_of(name)
            for file in files:
                with gzip.open(_ROOT / file, "rt") as opened:
                    for number, line in enumerate(opened, start=1):
                        if number % 4 == 1 and len(line) < 20_000:
                            self.assertTrue(validator.is_valid(json.loads(line)), f"{file}:{number}")
        for name, file in {"tuned": "data/tuned.json", "campaign": "report/reference/core/campaign.json"}.items():
            self.assertEqual([error.message for error in validator_of(name).iter_errors(json_of(_ROOT / file))], [], file)

    def test_answers_are_valid(self):
        with tempfile.TemporaryDirectory() as folder:
            problems = Path(folder, "p.jsonl")
            problems.write_text(json.dumps(_PROBLEM) + '\n{"A": [[0]], "b": [-1]}\n')
            for name, words in {"solve_result": ["solve", "--solver", "dantzig"], "certified_answer": ["certify"]}.items():
                run = subprocess.run([_COMMAND, *words, problems], capture_output=True, text=True, check=False)
                lines = run.stdout.splitlines()
                self.assertEqual(len(lines), 2, run.stderr)
                for line in lines:
                    self.assertEqual([error.message for error in validator_of(name).iter_errors(json.loads(line))], [], line)


def _doubled(document, path):
    """JSON in which the member at `path` stands twice."""
    value = document
    for key in path:
        value = value[key]
    text = json.dumps(value)
    return _text(document, (path, f"{text},{json.dumps(path[-1])}:{text}"))


if __name__ == "__main__":
    unittest.main()
