"""A chart as plain data, made once: the page shows it by Plotly (plotly.py), files are drawn by Matplotlib (drawing.py)."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..formats import power, time_unit
from ..style import Look

NAMES = "names"  # the kind of an axis with a row per name, the first on top


def _time(value: float) -> str:
    name, scale = time_unit(value * 1.0001)
    return f"{value / scale:.3g} {name}"


def _plain(value: float) -> str:
    return f"{value:,.0f}".replace(",", "\u2009") if 1 <= value < 1e6 else f"{value:g}" if 1e-3 < value < 1 else power(value)


# Kind of an axis -> words of a tick, and the format of a value in Plotly's hovers.
KINDS: dict[str, tuple[Callable, str]] = {
    "seconds": (_time, ":.3~s}s"), "residual": (power, ":.1e}"), "ratio": (lambda value: f"{value:g}×", ":.3~g}×"),
    "share": (lambda value: f"{100 * value:g} %", ":.2~%}"), "plain": (_plain, ":.4~g}"), NAMES: (str, "}")}


@dataclass(frozen=True)
class Axis:
    """Equal axes of a chart have the same range."""

    title: str = ""
    kind: str = "plain"  # of KINDS
    log: bool = True
    ends: tuple[float, float] | None = None  # default: those of the values


@dataclass(frozen=True)
class Trace:
    name: str  # of the legend; traces of one name have one entry
    x: Sequence
    y: Sequence
    look: Look
    low: Sequence | None = None  # intervals of x
    high: Sequence | None = None
    text: Sequence[str] | None = None  # beside every mark
    marks: Sequence[bool] | None = None  # where there is one; default: everywhere
    steps: bool = False
    bar: bool = False  # from the left, on what other bars of the panel have there


@dataclass(frozen=True)
class Panel:
    x: Axis
    y: Axis
    traces: list[Trace]
    title: str = ""


@dataclass(frozen=True)
class Chart:
    panels: list[Panel]  # by rows
    columns: int = 1

    @property
    def rows(self) -> int:
        return math.ceil(len(self.panels) / self.columns)

    @property
    def names(self) -> int:
        """Rows of the panel with the most names; 0 without such axes."""
        return max((len({name for trace in panel.traces for name in trace.y}) for panel in self.panels if panel.y.kind == NAMES),
                   default=0)

    def ends(self, axis: Axis) -> tuple[float, float]:
        """Both ends, a little beyond the values of all panels that have the axis."""
        if axis.ends is not None:
            return axis.ends
        traces = [(panel, trace) for panel in self.panels for trace in panel.traces]
        found = [values for panel, trace in traces if panel.x == axis
                 for values in (trace.x, trace.low, trace.high) if values is not None]
        found += [trace.y for panel, trace in traces if panel.y == axis]
        values = np.concatenate([np.asarray(one, dtype=float) for one in found]) if found else np.empty(0)
        values = values[np.isfinite(values) & ((values > 0) | (not axis.log))]
        low, high = (float(values.min()), float(values.max())) if len(values) else (1.0, 10.0)
        if not axis.log:
            room = 0.03 * (high - low) or 1.0
            return low - room, high + room
        room = max((high / low) ** 0.04, 1.2)
        return low / room, high * room

    def ticks(self, axis: Axis) -> list[float]:
        """Of a logarithmic axis: powers of ten, or 1, 2 and 5 of each where they are few."""
        low, high = map(math.log10, self.ends(axis))
        powers = range(math.ceil(low), math.floor(high) + 1)
        if len(powers) > 1:
            return [10.0**power for power in powers[::math.ceil(len(powers) / 8)]]
        return [value for power in range(math.floor(low), math.ceil(high)) for value in (k * 10.0**power for k in (1, 2, 5))
                if low <= math.log10(value) <= high]


@dataclass(frozen=True)
class Figure:
    """A place of the page, and a file; `views` are made when they are asked for. The first one is that of the file."""

    name: str
    title: str
    words: str
    views: dict[tuple[str, ...], Callable[[], Chart | None]]  # by what the visitor chooses; None: nothing to be seen
    choices: tuple[str, ...] = field(default=())  # names of what is chosen
