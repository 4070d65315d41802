"""The declared space of settings (data/tuning.json) and the configurations that are drawn from it."""

import hashlib
import json
import math
import random
from dataclasses import dataclass
from pathlib import Path

from ..errors import ReportError
from ..statistics.fields import check_fields
from ..statistics.jsonl import read_object

SCHEMA = "lcpbench-tuning/1"
_SOLVER = {"solver": "name", "settings": "object"}
_KEYS = ("solver", "settings", "note")

# What differs from the defaults, as `lcpbench solve --set` takes it; empty: the default.
Configuration = dict[str, str]


@dataclass
class Space:
    """The settings of one solver: a grid, the first value of every setting being the default."""

    solver: str
    settings: dict[str, list[str]]

    @property
    def size(self) -> int:
        return math.prod(map(len, self.settings.values()))

    def configuration(self, index: int) -> Configuration:
        """By its number, mixed radix: 0 is the default."""
        chosen = {}
        for name, values in self.settings.items():
            index, digit = divmod(index, len(values))
            if digit:
                chosen[name] = values[digit]
        return chosen


def hash_of(spaces: list[Space]) -> str:
    """Of what is declared of these solvers, whatever else the file has."""
    declared = {space.solver: space.settings for space in spaces}
    return hashlib.sha256(json.dumps(declared, sort_keys=True).encode()).hexdigest()


def draw(space: Space, budget: int, seed: int) -> list[Configuration]:
    """The default, then others without repetition, as many as fit into the budget; all where the space is no larger.

    Every solver has a generator of its own: what is drawn does not depend on which others are tuned.
    """
    count = min(budget, space.size)
    others = random.Random(f"{seed}/{space.solver}").sample(range(1, space.size), count - 1)
    return [space.configuration(index) for index in (0, *others)]


def load_spaces(path: Path) -> dict[str, Space]:
    """@throws ReportError for the first thing that does not fit; whether solvers and settings exist says `lcpbench`"""
    content = check_fields(path.name, read_object(path, SCHEMA, "the settings that may be tried"), {"solvers": "list"})
    spaces: dict[str, Space] = {}
    for index, record in enumerate(content["solvers"]):
        place = f"{path.name}: solvers[{index}]"
        check_fields(place, record, _SOLVER)
        for key in record:
            if key not in _KEYS:
                raise ReportError(place, f"key {key!r} is unknown", "one of " + ", ".join(_KEYS))
        if not record["settings"]:
            check_fields(place, record, {"note": "name"})  # why there is nothing to tune
        for name, values in record["settings"].items():
            # They become words of a command line that are divided by commas.
            if (not isinstance(values, list) or len(values) < 2 or len(set(map(str, values))) < len(values)
                    or not all(isinstance(value, str) and value and "," not in value for value in values)):
                raise ReportError(f"{place}: settings: {name}", f"found {str(values)[:40]!r}", "a list of two texts or "
                                  "more without commas, as --set takes them, none twice, the default first")
        if record["solver"] in spaces:
            raise ReportError(place, f"solver {record['solver']!r} is there twice", "every solver once")
        spaces[record["solver"]] = Space(record["solver"], record["settings"])
    return spaces
