"""The published JSON Schema of scene files accepts the examples and refuses most of what the reader refuses."""

import json
import unittest
from pathlib import Path

from schema_case import json_of, validator_of

_DATA = Path(__file__).resolve().parent


class SceneSchema(unittest.TestCase):
    def test_every_example_is_valid(self):
        scenes = sorted((_DATA.parents[1] / "data/scenes").glob("*.json"))
        self.assertGreaterEqual(len(scenes), 6)
        for path in scenes:
            with self.subTest(path.name):
                self.assertEqual([error.message for error in validator_of("scene").iter_errors(json_of(path))], [])

    def test_mistakes_of_form_are_refused(self):
        """What takes arithmetic, names or the keys' order is left to the reader (scene_file_test.cc)."""
        validator = validator_of("scene")
        lines = [line for line in (_DATA / "refusals/scene.txt").read_text(encoding="utf-8").splitlines() if line.startswith(("{", "["))]
        accepted = [line for line in lines if validator.is_valid(json.loads(line.split(" => ")[0]))]
        self.assertLessEqual(len(accepted), 43, "\n".join(accepted))
        self.assertGreaterEqual(len(lines), 100)


if __name__ == "__main__":
    unittest.main()
