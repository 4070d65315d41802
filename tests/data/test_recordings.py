"""What data/recordings holds to: the laws that every recording obeys, whatever the engine."""

import functools
import math
import re
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "data" / "recordings"))
import table  # noqa: E402

_ROUNDING = 2e-5  # single-precision engines, nine digits


@functools.cache
def _recordings():
    return table.recordings()


def _cross(a, b):
    if len(a) == 2:
        return [a[0] * b[1] - a[1] * b[0]]
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def _normal_velocity(step, contact, loads):
    """n . (velocity of the point on j - that on i), after the loads of a time step where `loads` has inverse masses."""
    bodies = step["bodies"]
    w = 0
    for body, sign in zip(contact["b"], (-1, 1)):
        if body < 0:
            continue
        lever = [p - x for p, x in zip(contact["p"], bodies["x"][body])]
        turn = _cross(lever, contact["n"])
        omega = bodies["omega"][body]
        w += sign * sum(n * v for n, v in zip(contact["n"], bodies["v"][body]))
        w += sign * sum(t * o for t, o in zip(turn, omega if isinstance(omega, list) else [omega]))
        w += sign * loads[body] * sum(n * f for n, f in zip(contact["n"], bodies["force"][body]))
    return w


def _each(check):
    """A test of every recording."""

    def test(self):
        for path, header, steps in _recordings():
            with self.subTest(path.name):
                check(self, path, header, steps)

    return test


class Recordings(unittest.TestCase):
    def test_the_table_has_a_line_of_each(self):
        lines = table.text(_recordings()).splitlines()
        self.assertEqual(sum(line.startswith("| `") for line in lines), len(_recordings()))

    def test_the_readme_counts_them_by_engine(self):
        readme = (table.FOLDER / "README.md").read_text(encoding="utf-8")
        counted = {name.lower(): (version, licence, int(count)) for name, version, licence, count in
                   re.findall(r"(?m)^\| (\w+) ([\d.]+) \| (.*?) \| (\d+) \|", readme)}
        headers = [header for _, header, _ in _recordings()]
        found = {header["engine"]: (header["engine_version"], header["licence"],
                                    sum(other["engine"] == header["engine"] for other in headers)) for header in headers}
        self.assertEqual(counted, found)

    @_each
    def test_names_tell_engine_and_scene(self, path, header, _steps):
        stem = f"{header['engine']}-{header['scene']}"
        self.assertIn(path.name, (f"{stem}.jsonl.gz", f"{stem}-sequence.jsonl.gz"))

    @_each
    def test_lists_have_one_entry_a_body(self, _path, header, steps):
        count = len(header["bodies"])
        for step in steps:
            self.assertEqual({len(values) for values in step["bodies"].values()}, {count})
            for item in step["contacts"] + step["joints"]:
                i, j = item["b"]
                self.assertTrue(-1 <= min(i, j) and i != j and max(i, j) < count, item)

    @_each
    def test_normals_are_unit_and_identities_unique(self, _path, header, steps):
        for step in steps:
            ids = [item["id"] for item in step["contacts"]]
            self.assertEqual(len(set(ids)), len(ids))
            ids = [item["id"] for item in step["joints"]]
            self.assertEqual(len(set(ids)), len(ids))
            for contact in step["contacts"]:
                self.assertEqual(len(contact["n"]), header["dimension"])
                self.assertAlmostEqual(math.hypot(*contact["n"]), 1, delta=_ROUNDING)

    @_each
    def test_joint_rows_are_zero_for_the_world(self, _path, header, steps):
        width = 3 if header["dimension"] == 2 else 6
        for step in steps:
            for joint in step["joints"]:
                for row in joint["rows"]:
                    self.assertEqual(len(row["J"]), 2 * width)
                    for body, half in zip(joint["b"], (row["J"][:width], row["J"][width:])):
                        self.assertTrue(body >= 0 or not any(half), joint)

    @_each
    def test_loads_close_contacts_more_often_than_they_open_them(self, _path, header, steps):
        # The sign of normals and of loads: gravity presses bodies on what does not move, unless they hang from it.
        if not any(header["gravity"]):
            return
        share = [body["inverse_mass"] * header["time_step"] for body in header["bodies"]]
        none = [0] * len(share)
        changes = [
            _normal_velocity(step, contact, share) - _normal_velocity(step, contact, none)
            for step in steps
            for contact in step["contacts"]
            if -1 in contact["b"] and not any(set(contact["b"]) == set(joint["b"]) for joint in step["joints"])
        ]
        self.assertLessEqual(sum(changes), 0)

    @_each
    def test_contacts_of_sequences_stay(self, path, _header, steps):
        if "-sequence" not in path.name:
            return
        self.assertEqual([step["step"] for step in steps], list(range(steps[0]["step"], steps[0]["step"] + 100)))
        self.assertLessEqual(max(map(table.rows_of, steps)), 300)
        ids = [{contact["id"] for contact in step["contacts"]} for step in steps]
        stayed = sum(len(a & b) for a, b in zip(ids, ids[1:]))
        self.assertGreaterEqual(stayed, 0.7 * sum(map(len, ids[:-1])))


if __name__ == "__main__":
    unittest.main()
