"""The published JSON Schema of scene files accepts the examples and refuses what is malformed."""

import unittest
from pathlib import Path

from schema_case import REMOVED, SchemaCase

_SCENES = Path(__file__).resolve().parents[2] / "data" / "scenes"

# As small as a scene can be that has one of each; every malformed scene below is this one with one change.
_SCENE = {
    "lcpbench_scene": 1,
    "gravity": [0, -9.81],
    "motion": {"level": "velocity", "step": 0.01, "restitution": 0.5, "impact_law": "poisson", "resting_speed": 0},
    "shapes": {"disc": {"disc": {"radius": 1}}},
    "bodies": [
        {"name": "floor", "fixed": True, "shape": {"chains": [[[1, 0], [0, 0]]]}, "angular_acceleration": 1},
        {"name": "ball", "shape": "disc", "density": 1, "position": [0, 1]},
        {"name": "drop", "shape": {"path": [[0, 0], {"arc": {"to": [1, 0], "bulge": 1}}, [0, 0]]}, "mass": 2},
    ],
    "joints": [
        {"type": "rod", "body1": "ball", "point1": [0, 0], "body2": "floor", "point2": [0, 0]},
        {"type": "path", "body1": "ball", "point1": [0, 0], "body2": "floor", "edge2": [[0, 1], [1, 1]]},
        {"type": "path", "body1": "floor", "edge1": [0, 0], "body2": "drop", "point2": [0, 0]},
    ],
    "loads": {
        "springs": [{"body1": "ball", "body2": "floor", "point2": [1, 1], "stiffness": 1, "rest_length": 0}],
        "attraction": {"strength": 1},
    },
}

# What is changed, and into what.
_MALFORMED = [
    (("lcpbench_scene",), 2),
    (("lcpbench_scene",), REMOVED),
    (("bodies",), REMOVED),
    (("bodies",), {}),
    (("colour",), "red"),
    (("gravity",), -9.81),
    (("gravity",), [0, -9.81, 0]),
    (("gravity",), [0, 1e31]),
    (("motion", "level"), "position"),
    (("motion", "step"), 0),
    (("motion", "restitution"), 1.5),
    (("motion", "impact_law"), "Newton"),
    (("motion", "resting_speed"), -1),
    (("shapes", "disc", "disc", "radius"), -1),
    (("shapes", "disc", "disc", "radius"), "1"),
    (("shapes", "disc", "disc", "diameter"), 2),
    (("shapes", "disc", "box"), {"width": 1, "height": 1}),
    (("shapes", "disc"), {}),
    (("bodies", 0, "center_of_mass"), [0, 0]),
    (("bodies", 0, "shape", "chains"), [[0, 0], [1, 0]]),
    (("bodies", 1, "name"), ""),
    (("bodies", 1, "name"), REMOVED),
    (("bodies", 1, "name"), "two\nlines"),
    (("bodies", 1, "density"), REMOVED),
    (("bodies", 1, "mass"), 1),
    (("bodies", 1, "fixed"), "no"),
    (("bodies", 1, "acceleration"), [0, 0]),
    (("bodies", 2, "center_of_mass"), [0, 0]),
    (("bodies", 2, "shape", "path", 1, "arc", "bulge"), 0),
    (("bodies", 2, "shape", "path", 1, "arc", "radius"), 1),
    (("bodies", 2, "shape", "path", 1, "arc", "to"), REMOVED),
    (("bodies", 2, "shape", "path", 1), {"spline": {"to": [1, 0]}}),
    (("joints", 0, "type"), "weld"),
    (("joints", 0, "length"), 0),
    (("joints", 0, "point1"), REMOVED),
    (("joints", 1, "edge2"), []),
    (("joints", 1, "edge2"), [[0, 1], 0]),
    (("joints", 2, "edge1"), -1),
    (("loads", "springs", 0, "stiffness"), -1),
    (("loads", "springs", 0, "body1"), 0),
    (("loads", "attraction", "strength"), None),
    (("loads", "magnet"), {}),
]


class SceneSchema(SchemaCase, unittest.TestCase):
    schema = "scene"
    valid = sorted(_SCENES.glob("*.json"))
    base = _SCENE
    malformed = _MALFORMED


if __name__ == "__main__":
    unittest.main()
