"""How figures look and are saved: the same bytes for the same data."""

import base64
import io
import math
from pathlib import Path

import matplotlib

matplotlib.use("agg")

from matplotlib import pyplot as plt  # noqa: E402
from matplotlib.lines import Line2D  # noqa: E402
from matplotlib.ticker import (FixedLocator, FuncFormatter, LogLocator, MaxNLocator, NullFormatter,  # noqa: E402
                               NullLocator)

from ..files import replaced  # noqa: E402
from ..style import ORACLE_COLOUR, SolverStyle  # noqa: E402
from ..formats import time_unit  # noqa: E402

INK, GRID, FAINT, CONTEXT = "#1c2430", "#e3e7ec", "#5c6672", "#d3d9e0"
COLUMN, PAGE = 3.5, 7.16  # widths of a column and of a page with two [in]
ORACLE = {"color": ORACLE_COLOUR, "linestyle": (0, (6, 2)), "linewidth": 1.2, "zorder": 5}
# Verdicts; told apart by lightness as well.
VERDICTS = {"verified": "#0072B2", "false success": "#D55E00", "below the tier": "#E8A27C",
            "proved infeasible": "#8CC5E8", "infeasible within rounding": "#C5DFF0", "failed": "#F0C98A",
            "not asked": "#cfe0dc", "excluded": "#e1e5ea"}
_STYLE = {
    "svg.fonttype": "path", "svg.hashsalt": "lcpbench", "pdf.fonttype": 42, "font.family": "DejaVu Sans",
    "font.size": 7.5, "axes.titlesize": 8, "axes.labelsize": 8, "legend.fontsize": 7, "xtick.labelsize": 7,
    "ytick.labelsize": 7, "axes.edgecolor": "#9aa4b0", "axes.labelcolor": INK, "axes.titlecolor": INK,
    "axes.titlelocation": "left", "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True,
    "axes.axisbelow": True, "grid.color": GRID, "grid.linewidth": 0.6, "xtick.color": INK, "ytick.color": INK,
    "text.color": INK, "figure.facecolor": "white", "axes.facecolor": "white", "savefig.facecolor": "white",
    "lines.linewidth": 1.1, "lines.markersize": 4, "axes.linewidth": 0.7, "hatch.linewidth": 0.5,
    "xtick.major.width": 0.6, "ytick.major.width": 0.6, "xtick.minor.width": 0.4, "ytick.minor.width": 0.4,
    "legend.frameon": False, "legend.handlelength": 2.4, "legend.columnspacing": 1.1, "legend.labelspacing": 0.35,
    "savefig.bbox": "tight", "savefig.pad_inches": 0.03,
}


def look():
    return plt.rc_context(_STYLE)


def panels(columns: int, width: float, height: float, rows: int = 1, **options):
    """(figure, axes row by row)"""
    figure, axes = plt.subplots(rows, columns, figsize=(width, height), squeeze=False, layout="constrained", **options)
    return figure, list(axes.flat)


def save(figure, folder: Path, name: str) -> list[Path]:
    """<name>.svg and <name>.pdf of one figure, which is closed."""
    paths = [folder / f"{name}.svg", folder / f"{name}.pdf"]
    save_svg(figure, paths[0])
    with replaced(paths[1]) as beside:
        figure.savefig(beside, metadata={"CreationDate": None, "Creator": "LCPBench", "Producer": None})
    plt.close(figure)
    return paths


def save_svg(figure, path: Path) -> None:
    """On white, so that it can be read on a dark page."""
    path.parent.mkdir(parents=True, exist_ok=True)
    # The layout is found once; by default every drawing looks for it again, which takes longer than the drawing.
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    with replaced(path) as beside:
        figure.savefig(beside, metadata={"Date": None, "Creator": "LCPBench"})


def address(figure) -> str:
    """The figure as a data URI, for the page; it is closed."""
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    text = io.BytesIO()
    figure.savefig(text, format="svg", metadata={"Date": None, "Creator": "LCPBench"})
    plt.close(figure)
    return "data:image/svg+xml;base64," + base64.b64encode(text.getvalue()).decode("ascii")


def line(style: SolverStyle, marks: bool = True) -> dict:
    """Arguments of plot() for a solver's line. Peers are thinner, with hollow markers."""
    return {"color": style.colour, "linestyle": style.dash, "linewidth": 1.2 if style.own else 0.9,
            "zorder": 4 if style.own else 3} | (marker(style) if marks else {})


def marker(style: SolverStyle, size: float = 4) -> dict:
    return {"marker": style.marker, "markersize": size * (0.85 if style.marker in "sD" else 1),
            "markerfacecolor": style.colour if style.own else "white", "markeredgecolor": style.colour,
            "markeredgewidth": 0.5 if style.own else 0.9, "color": style.colour}


def handles(solvers: list[str], styles: dict[str, SolverStyle], oracle: bool = False) -> list[Line2D]:
    return [Line2D([], [], label=solver, **line(styles[solver])) for solver in solvers] + \
        [Line2D([], [], label="oracle", **ORACLE)] * oracle


def legend_below(axes, made: list[Line2D]):
    """Under the panel, outside of its frame."""
    return axes.legend(handles=made, loc="upper center", bbox_to_anchor=(0.5, -0.2), ncol=2, borderaxespad=0)


def legend_outside(figure, made: list, columns: int):
    """Under the whole figure; save() makes room for it."""
    return figure.legend(handles=made, loc="upper center", bbox_to_anchor=(0.5, 0), ncol=columns, borderaxespad=0.2)


def log_axis(axis, label: str, form=None, decades: int = 9) -> None:
    """Logarithmic with whole powers of ten as ticks. `form` makes text of a tick; default 10^k."""
    axes = axis.axes
    (axes.set_xscale if axis.axis_name == "x" else axes.set_yscale)("log")
    axis.set_major_locator(LogLocator(10, numticks=decades))
    axis.set_minor_locator(LogLocator(10, subs=range(2, 10), numticks=decades + 6))
    axis.set_minor_formatter(NullFormatter())
    if form is not None:
        axis.set_major_formatter(FuncFormatter(lambda value, _: form(value)))
    axis.set_label_text(label)


def time_tick(seconds: float) -> str:
    """10 µs"""
    if seconds <= 0:
        return "0"
    name, scale = time_unit(seconds * 1.0001)
    value = seconds / scale
    return f"{value:.0f} {name}" if value >= 0.999 else f"{value:g} {name}"


def power_tick(value: float) -> str:
    return f"$10^{{{round(math.log10(value))}}}$"


def size_axis(axes, sizes) -> None:
    """Rows, logarithmic, with labelled ticks at powers of ten only."""
    sizes = sorted(set(sizes))
    log_axis(axes.xaxis, "rows $n$", lambda value: f"{value:,.0f}".replace(",", "\u2009"))
    if sizes:
        axes.set_xlim(sizes[0] / 1.2, sizes[-1] * 1.2)
        inside = [10**k for k in range(0, 8) if sizes[0] / 1.2 <= 10**k <= sizes[-1] * 1.2]
        ticks = inside if len(inside) > 1 else sizes if len(sizes) < 5 else [sizes[0], sizes[-1]]
        axes.xaxis.set_major_locator(FixedLocator(ticks))
        if len(inside) < 2:
            axes.xaxis.set_minor_locator(NullLocator())


def time_axis(axes, label: str = "", axis: str = "y") -> None:
    log_axis(axes.yaxis if axis == "y" else axes.xaxis, label, time_tick)
    low, high = axes.get_ylim()
    if axis == "y" and high / low < 100:  # powers of ten alone would be one label or two
        axes.yaxis.set_minor_formatter(FuncFormatter(lambda value, _: time_tick(value) if f"{value:.0e}"[0] in "25" else ""))


def name_axis(axes, names: list[str]) -> None:
    """One row of a figure per name, the first on top."""
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.tick_params(axis="y", length=0)
    axes.grid(False, axis="y")
