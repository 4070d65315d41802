"""The figures, drawn by Matplotlib as SVG text with live fonts, the same bytes for the same data."""

import io
import math
from dataclasses import dataclass

import matplotlib
import numpy as np

matplotlib.use("svg")

from matplotlib import pyplot as plt  # noqa: E402
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, NullFormatter  # noqa: E402

from .cells import Cells  # noqa: E402
from .formats import ratio as ratio_text  # noqa: E402
from .formats import decade  # noqa: E402
from .stats import Slope, fit_slope, performance_profile  # noqa: E402
from .style import SolverStyle  # noqa: E402

_INK, _GRID, _FAINT = "#1c2430", "#e3e7ec", "#8a94a1"
_STYLE = {
    "svg.fonttype": "none", "svg.hashsalt": "lcpbench", "font.family": "sans-serif", "font.size": 9,
    "axes.edgecolor": "#9aa4b0", "axes.labelcolor": _INK, "axes.spines.top": False, "axes.spines.right": False,
    "axes.grid": True, "axes.axisbelow": True, "grid.color": _GRID, "grid.linewidth": 0.8, "xtick.color": _INK,
    "ytick.color": _INK, "text.color": _INK, "figure.facecolor": "none", "axes.facecolor": "none",
    "lines.linewidth": 1.4, "lines.markersize": 5.2, "axes.linewidth": 0.8,
}
_WIDE, _NARROW, _HEIGHT = 5.2, 3.7, 4.0  # [in]; the page scales them
_NO_TIMES = (1e-6, 1.0)  # [s] axis of a run without any time
_PROFILE_LIMIT = 1e4  # the profile's axis ends here at the latest


@dataclass
class Curve:
    """One solver in one figure: what the legend says."""

    solver: str
    slope: Slope | None
    marks: int  # sizes with a time


def solve_limits(cells: Cells) -> tuple[float, float] | None:
    """One time axis for all families and tiers, in whole decades, so that figures compare at a glance."""
    return _decades([cell.time_s for cell in cells.all()])


def setup_limits(cells: Cells) -> tuple[float, float] | None:
    """The same for set-up."""
    results = cells.results
    return _decades([cells.setup_time(family, n, solver) for family in results.families for n in cells.sizes(family)
                     for solver in results.solvers])


def _decades(times: list[float]) -> tuple[float, float] | None:
    times = [t for t in times if math.isfinite(t) and t > 0]
    if not times:
        return None
    return 10 ** math.floor(math.log10(min(times))), 10 ** math.ceil(math.log10(max(times)) + 1e-9)


def solve_figure(cells: Cells, family: str, tier: float, styles: dict[str, SolverStyle],
                 limits: tuple[float, float] | None) -> tuple[str, list[Curve]]:
    """Solve time against n at one tier; what was not verified stands in a strip above, one line per solver."""
    solvers = cells.results.solvers
    by_solver = {s: [c for n in cells.sizes(family) if (c := cells.get(family, n, s, tier))] for s in solvers}
    missing = [s for s in solvers if any(not c.passes for c in by_solver[s])]
    with plt.rc_context(_STYLE):
        figure, strip, axes = _with_strip(len(missing))
        curves = []
        for solver in solvers:
            mine = by_solver[solver]
            timed = [c for c in mine if math.isfinite(c.time_s)]
            # NaN breaks the line at sizes where nothing was verified.
            _line(axes, [c.n for c in mine], [c.time_s for c in mine], styles[solver],
                  hollow=[not c.passes for c in mine])
            curves.append(Curve(solver, fit_slope([c.n for c in timed], [c.time_s for c in timed]), len(timed)))
        for row, solver in enumerate(missing):
            _strip_row(strip, row, [c for c in by_solver[solver] if not c.passes], styles[solver])
        _size_axis(axes, cells.sizes(family))
        _time_axis(axes, limits, "solve time")
        if strip is not None:
            _finish_strip(strip, missing, styles, axes)
        return _svg(figure), curves


def setup_figure(cells: Cells, family: str, styles: dict[str, SolverStyle],
                 limits: tuple[float, float] | None) -> str:
    """Set-up time against n: thin and dashed, for it is paid once per structure and at every tier alike."""
    sizes = cells.sizes(family)
    with plt.rc_context(_STYLE):
        figure, axes = plt.subplots(figsize=(_NARROW, _HEIGHT), constrained_layout=True)
        for solver in cells.results.solvers:
            points = [(n, t) for n in sizes if math.isfinite(t := cells.setup_time(family, n, solver)) and t > 0]
            if points:
                _line(axes, *map(list, zip(*points)), styles[solver], hollow=[False] * len(points), thin=True)
        _size_axis(axes, sizes)
        _time_axis(axes, limits, "set-up time")
        return _svg(figure)


def profile_figure(times, styles: dict[str, SolverStyle]) -> str:
    """Dolan-More performance profile of a table problems x solvers, +inf where not verified."""
    profile = performance_profile(times)
    ends = [steps[-1] for steps, _ in profile.values()]
    right = min(_PROFILE_LIMIT, max(2.0, 1.25 * max(ends, default=2.0)))
    with plt.rc_context(_STYLE):
        figure, axes = plt.subplots(figsize=(5.6, 3.3), constrained_layout=True)
        for solver, (steps, share) in profile.items():
            style = styles[solver]
            inside = steps <= right
            x, y = np.append(steps[inside], right), np.append(share[inside], share[inside][-1])
            axes.plot(x, y, drawstyle="steps-post", color=style.colour, linestyle=style.dash, zorder=3)
            marks = _spread_marks(x, y, right)
            axes.plot(*zip(*marks), linestyle="none", marker=style.marker, color=style.colour, markeredgecolor="white",
                      markeredgewidth=0.6, zorder=4, clip_on=False)
        axes.set_xscale("log")
        axes.set_xlim(1, right)
        axes.set_ylim(0, 1.02)
        axes.xaxis.set_major_locator(LogLocator(10, subs=(1.0, 2.0, 5.0) if right <= 100 else (1.0,), numticks=20))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}×"))
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.yaxis.set_major_formatter(FuncFormatter(lambda y, _: f"{100 * y:.0f} %"))
        axes.set_xlabel("at most this many times the fastest verified time (log scale)")
        axes.set_ylabel("share of problems solved")
        return _svg(figure)


def profile_cut(times) -> str:
    """'' or the ratio at which the profile's axis was cut."""
    worst = max((steps[-1] for steps, _ in performance_profile(times).values()), default=1.0)
    return ratio_text(_PROFILE_LIMIT) if worst > _PROFILE_LIMIT else ""


def _with_strip(rows: int):
    if rows == 0:
        figure, axes = plt.subplots(figsize=(_WIDE, _HEIGHT), constrained_layout=True)
        return figure, None, axes
    figure, (strip, axes) = plt.subplots(2, 1, figsize=(_WIDE, _HEIGHT), constrained_layout=True, sharex=True,
                                         gridspec_kw={"height_ratios": [0.21 * rows, 3.2 - 0.15 * rows]})
    return figure, strip, axes


def _line(axes, sizes, times, style: SolverStyle, hollow, thin=False) -> None:
    axes.plot(sizes, times, color=style.colour, linestyle=(0, (4, 2)) if thin else style.dash,
              linewidth=1.0 if thin else None, zorder=3)
    for n, t, empty in zip(sizes, times, hollow):
        face, edge, width = ("white", style.colour, 1.3) if empty else (style.colour, "white", 0.6)
        axes.plot([n], [t], marker=style.marker, markersize=4 if thin else None, color=style.colour,
                  markerfacecolor=face, markeredgecolor=edge, markeredgewidth=width, zorder=4)


def _strip_row(strip, row: int, missing, style: SolverStyle) -> None:
    for cell in missing:
        mark = {"marker": "o", "markerfacecolor": "none", "markersize": 4.5} if cell.excluded else \
               {"marker": "x", "markersize": 5}
        strip.plot([cell.n], [row], color=style.colour, markeredgewidth=1.5, clip_on=False, **mark)


def _finish_strip(strip, missing, styles, axes) -> None:
    strip.set_ylim(len(missing) - 0.4, -0.6)
    strip.set_yticks(range(len(missing)), missing, fontsize=8)
    for label, solver in zip(strip.get_yticklabels(), missing):
        label.set_color(styles[solver].colour)
    strip.tick_params(length=0, labelbottom=False, which="both")
    strip.grid(False)
    strip.spines[["left", "bottom"]].set_visible(False)
    strip.set_xlim(axes.get_xlim())
    strip.set_title("not verified", fontsize=8, loc="left", color=_FAINT, pad=3)


def _size_axis(axes, sizes) -> None:
    axes.set_xscale("log")
    axes.set_xlim(min(sizes) / 1.25, max(sizes) * 1.25)
    axes.xaxis.set_major_locator(FixedLocator(_thin_out(sizes)))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    axes.xaxis.set_minor_locator(FixedLocator(sizes))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_xlabel("n, rows (log scale)")


def _thin_out(sizes) -> list[int]:
    """Ticks at sizes, none so close to the one before that labels would touch."""
    gap = max(0.06 * math.log10(max(sizes) / min(sizes)), 0.05)
    kept: list[int] = []
    for n in sorted(sizes):
        if not kept or math.log10(n / kept[-1]) > gap:
            kept.append(n)
    return kept


def _time_axis(axes, limits, what: str) -> None:
    axes.set_yscale("log")
    axes.set_ylim(*(limits or _NO_TIMES))
    axes.yaxis.set_major_locator(LogLocator(10, numticks=20))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda t, _: decade(t)))
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.set_ylabel(f"{what} (log scale)")


def _spread_marks(x, y, right: float) -> list[tuple[float, float]]:
    """A few points of the step function at even log distance, the end among them."""
    at = np.geomspace(1.0, right, 5)
    return [(float(a), float(y[np.searchsorted(x, a, side="right") - 1])) for a in at]


def _svg(figure) -> str:
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None})
    plt.close(figure)
    return buffer.getvalue()
