"""The declared space of settings (data/tuning.json) and the configurations that are drawn from it."""

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
    """Of one solver: a grid, the first value of every setting being the default."""

    solver: str
    settings: dict[str, list[str]]

    @property
    def size(self) -> int:
        return math.prod(len(values) for values in self.settings.values())

    def configuration(self, index: int) -> Configuration:
        """By its number, mixed radix: 0 is the default."""
        chosen = {}
        for name, values in self.settings.items():
            index, digit = divmod(index, len(values))
            if digit:
                chosen[name] = values[digit]
        return chosen


def draw(space: Space, budget: int, seed: int) -> list[Configuration]:
    """The default, then others without repetition, as many as fit into the budget; all where the space is no larger.

    Every solver has a generator of its own: what is drawn does not depend on which others are tuned.
    """
    count = min(budget, space.size)
    others = random.Random(f"{seed}/{space.solver}").sample(range(1, space.size), count - 1)
    return [space.configuration(index) for index in (0, *others)]


def load_spaces(path: Path) -> dict[str, Space]:
    """@throws ReportError for the first thing that does not fit; whether solvers and settings exist says `lcpbench`"""
    content = read_object(path, SCHEMA, "the settings that may be tried")
    check_fields(path.name, content, {"solvers": "list"})
    spaces: dict[str, Space] = {}
    for index, record in enumerate(content["solvers"]):
        place = f"{path.name}: solvers[{index}]"
        space = _space(place, record)
        if space.solver in spaces:
            raise ReportError(place, f"solver {space.solver!r} is there twice", "every solver once")
        spaces[space.solver] = space
    return spaces


def _space(place: str, record: object) -> Space:
    record = check_fields(place, record, _SOLVER)
    for key in record:
        if key not in _KEYS:
            raise ReportError(place, f"key {key!r} is unknown", "one of " + ", ".join(_KEYS))
    if not record["settings"]:
        check_fields(place, record, {"note": "name"})  # why there is nothing to tune
    for name, values in record["settings"].items():
        _check_values(f"{place}: settings: {name}", values)
    return Space(record["solver"], record["settings"])


def _check_values(place: str, values: object) -> None:
    if not isinstance(values, list) or len(values) < 2:
        raise ReportError(place, f"found {str(values)[:40]!r}", "a list of two values or more, the default first")
    for value in values:
        # They become words of a command line that are divided by commas.
        if not isinstance(value, str) or not value or "," in value:
            raise ReportError(place, f"value {str(value)[:40]!r}", "texts without commas, as --set takes them")
    if len(set(values)) < len(values):
        raise ReportError(place, "a value is there twice", "every value once")
