"""The figures, drawn by Matplotlib as SVG text with live fonts, the same bytes for the same data."""

import io
import math
import re

import matplotlib
import numpy as np

matplotlib.use("svg")

from matplotlib import pyplot as plt  # noqa: E402
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, NullFormatter, NullLocator  # noqa: E402

from .cells import Cells  # noqa: E402
from .formats import ratio as ratio_text  # noqa: E402
from .formats import decade  # noqa: E402
from .stats import Slope, fit_slope, performance_profile  # noqa: E402
from .style import ORACLE_COLOUR, SolverStyle  # noqa: E402

_INK, _GRID, _FAINT = "#1c2430", "#e3e7ec", "#8a94a1"
_STYLE = {
    "svg.fonttype": "none", "svg.hashsalt": "lcpbench", "font.family": "sans-serif", "font.size": 9,
    "axes.edgecolor": "#9aa4b0", "axes.labelcolor": _INK, "axes.spines.top": False, "axes.spines.right": False,
    "axes.grid": True, "axes.axisbelow": True, "grid.color": _GRID, "grid.linewidth": 0.8, "xtick.color": _INK,
    "ytick.color": _INK, "text.color": _INK, "figure.facecolor": "none", "axes.facecolor": "none",
    "lines.linewidth": 1.4, "lines.markersize": 5.2, "axes.linewidth": 0.8,
}
_PAIR, _SINGLE = (10.0, 4.2), (5.4, 3.4)  # [in]; the page scales them
_NO_TIMES = (1e-6, 1.0)  # [s] axis of a run without any time
_PROFILE_LIMIT = 1e4  # the profile's axis ends here at the latest
_LONG_NUMBER = re.compile(r"\d+\.\d{3,}")
# Curves that are context only: those of the other panel.
_CONTEXT = {"color": "#d3d9e0", "linewidth": 0.8, "zorder": 2}


def solve_limits(cells: Cells) -> tuple[float, float] | None:
    """One time axis for all families and tiers, in whole decades, so that figures compare at a glance."""
    oracle = [t for family in cells.results.families for _, t in cells.oracle_times(family)]
    return _decades([cell.time_s for cell in cells.all()] + oracle)


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


def growth(cells: Cells, family: str, tier: float, solver: str) -> Slope | None:
    """Exponent of the solve time over the larger half of the verified sizes."""
    mine = [c for n in cells.sizes(family) if (c := cells.get(family, n, solver, tier)) and math.isfinite(c.time_s)]
    return fit_slope([c.n for c in mine], [c.time_s for c in mine])


def solve_figure(cells: Cells, family: str, tier: float, styles: dict[str, SolverStyle],
                 limits: tuple[float, float] | None) -> str:
    """Solve time against n at one tier, own solvers on the left, all others on the right, oracle-chol in both."""
    series = {}
    for solver in cells.results.solvers:
        mine = [c for n in cells.sizes(family) if (c := cells.get(family, n, solver, tier))]
        # NaN breaks the line at sizes where nothing was verified.
        series[solver] = ([c.n for c in mine], [c.time_s for c in mine], [not c.passes for c in mine])
    return _panels(cells, family, series, styles, limits, "solve time", oracle=cells.oracle_times(family))


def setup_figure(cells: Cells, family: str, styles: dict[str, SolverStyle],
                 limits: tuple[float, float] | None) -> str:
    """Set-up time against n: paid once per structure and at every tier alike."""
    series = {}
    for solver in cells.results.solvers:
        points = [(n, t) for n in cells.sizes(family)
                  if math.isfinite(t := cells.setup_time(family, n, solver)) and t > 0]
        if points:
            series[solver] = (*map(list, zip(*points)), [False] * len(points))
    return _panels(cells, family, series, styles, limits, "set-up time", oracle=[])


def panel_groups(solvers: list[str], styles: dict[str, SolverStyle]) -> list[tuple[str, list[str]]]:
    """(title, solvers) of each panel: own solvers, then all others; empty ones are left out."""
    groups = [("own solvers", [s for s in solvers if styles[s].own]),
              ("peers and external solvers", [s for s in solvers if not styles[s].own])]
    return [group for group in groups if group[1]]


def _panels(cells, family, series, styles, limits, what, oracle) -> str:
    groups = panel_groups(list(series), styles) or [("", [])]
    with plt.rc_context(_STYLE):
        figure, panels = plt.subplots(1, len(groups), figsize=_PAIR if len(groups) > 1 else _SINGLE, squeeze=False,
                                      sharey=True)
        _margins(figure, len(groups))
        for index, (axes, (title, group)) in enumerate(zip(panels[0], groups)):
            for solver in [s for s in series if s not in group]:
                axes.plot(*series[solver][:2], **_CONTEXT)
            if oracle:
                axes.plot(*zip(*oracle), color=ORACLE_COLOUR, linestyle=(0, (6, 2)), linewidth=1.6, zorder=5,
                          gid=f"{index}-line--oracle-chol")
                axes.annotate("oracle-chol", oracle[-1], xytext=(0, -27), textcoords="offset points", ha="right",
                              fontsize=8, color=ORACLE_COLOUR)
            for solver in group:
                _line(axes, *series[solver], solver, styles[solver])
            axes.set_title(title, fontsize=9, loc="left", color=_FAINT)
            _size_axis(axes, cells.sizes(family))
            _time_axis(axes, limits, what if axes is panels[0][0] else "")
        return _svg(figure)


def _margins(figure, count: int) -> None:
    # By hand: the automatic layout takes longer than the drawing.
    if count > 1:
        figure.subplots_adjust(left=0.075, right=0.99, top=0.935, bottom=0.115, wspace=0.09)
    else:
        figure.subplots_adjust(left=0.14, right=0.98, top=0.92, bottom=0.14)


def profile_figure(times, styles: dict[str, SolverStyle]) -> str:
    """Dolan-More performance profile of a table problems x solvers, +inf where not verified; panels as above."""
    profile = performance_profile(times)
    ends = [steps[-1] for steps, _ in profile.values()]
    right = min(_PROFILE_LIMIT, max(2.0, 1.25 * max(ends, default=2.0)))
    curves = {}
    for solver, (steps, share) in profile.items():
        inside = steps <= right
        curves[solver] = (np.append(steps[inside], right), np.append(share[inside], share[inside][-1]))
    groups = panel_groups(list(curves), styles) or [("", [])]
    with plt.rc_context(_STYLE):
        figure, panels = plt.subplots(1, len(groups), figsize=_PAIR if len(groups) > 1 else _SINGLE, squeeze=False,
                                      sharey=True)
        _margins(figure, len(groups))
        for axes, (title, group) in zip(panels[0], groups):
            for solver in [s for s in curves if s not in group]:
                axes.plot(*curves[solver], drawstyle="steps-post", **_CONTEXT)
            for solver in group:
                x, y = curves[solver]
                style = styles[solver]
                axes.plot(x, y, drawstyle="steps-post", color=style.colour, linestyle=style.dash,
                          linewidth=_width(style), zorder=4 if style.own else 3, gid=f"line--{solver}")
                axes.plot(*zip(*_spread_marks(x, y, right)), linestyle="none", clip_on=False, **_marker(style))
            axes.set_title(title, fontsize=9, loc="left", color=_FAINT)
            _profile_axes(axes, right, "share of problems solved" if axes is panels[0][0] else "")
        return _svg(figure)


def _profile_axes(axes, right: float, label: str) -> None:
    axes.set_xscale("log")
    axes.set_xlim(1, right)
    axes.set_ylim(0, 1.02)
    axes.xaxis.set_major_locator(LogLocator(10, subs=(1.0, 2.0, 5.0) if right <= 100 else (1.0,), numticks=20))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}×"))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda y, _: f"{100 * y:.0f} %"))
    axes.set_xlabel("at most this many times the fastest verified time (log scale)")
    axes.set_ylabel(label)


def profile_cut(times) -> str:
    """'' or the ratio at which the profile's axis was cut."""
    worst = max((steps[-1] for steps, _ in performance_profile(times).values()), default=1.0)
    return ratio_text(_PROFILE_LIMIT) if worst > _PROFILE_LIMIT else ""


def _width(style: SolverStyle) -> float:
    return 1.7 if style.own else 1.1


def _marker(style: SolverStyle, hollow: bool | None = None) -> dict:
    """Own solvers have filled markers, the others hollow ones; partly verified cells have small ones of either kind."""
    if style.own and not hollow:
        return {"marker": style.marker, "color": style.colour, "markeredgecolor": "white", "markeredgewidth": 0.6,
                "markersize": 5.6, "zorder": 6}
    return {"marker": style.marker, "color": style.colour, "markerfacecolor": "white", "markeredgewidth": 1.1,
            "markersize": 4.6, "zorder": 6}


def _line(axes, sizes, times, hollow, solver: str, style: SolverStyle) -> None:
    axes.plot(sizes, times, color=style.colour, linestyle=style.dash, linewidth=_width(style),
              zorder=4 if style.own else 3, gid=f"line--{solver}")
    for empty in (False, True):
        points = [(n, t) for n, t, h in zip(sizes, times, hollow) if h == empty and math.isfinite(t)]
        if points:
            marker = _marker(style, empty)
            if empty:
                marker["alpha"] = 0.55
            axes.plot(*zip(*points), linestyle="none", **marker)


def _size_axis(axes, sizes) -> None:
    axes.set_xscale("log")
    axes.set_xlim(min(sizes) / 1.25, max(sizes) * 1.25)
    axes.xaxis.set_major_locator(FixedLocator(_thin_out(sizes)))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    axes.xaxis.set_minor_locator(NullLocator())
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
    axes.yaxis.set_minor_locator(NullLocator())  # nine in a decade would take longer than all the rest
    axes.set_ylabel(f"{what} (log scale)" if what else "")


def _spread_marks(x, y, right: float) -> list[tuple[float, float]]:
    """A few points of the step function at even log distance, the end among them."""
    at = np.geomspace(1.0, right, 5)
    return [(float(a), float(y[np.searchsorted(x, a, side="right") - 1])) for a in at]


def _svg(figure) -> str:
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None})
    plt.close(figure)
    return _compact(buffer.getvalue())


def _compact(text: str) -> str:
    """Matplotlib's SVG without what nobody sees: half the size, and there are many figures on a page."""
    text = _LONG_NUMBER.sub(lambda match: f"{float(match.group()):.2f}", text)  # hundredths of a point are enough
    text = re.sub(r"(font: [\d.]+px )[^;\"]*sans-serif", r"\1sans-serif", text)  # the page has a font of its own
    text = re.sub(r' transform="rotate\(-0 [^)]*\)"', "", text)
    used = set(re.findall(r'#([\w-]+)[)"]', text))
    text = re.sub(r' id="([^"]*)"', lambda m: m.group() if m.group(1) in used or "line--" in m.group(1) else "", text)
    return re.sub(r">\s+<", "><", text)
