"""How figures look and are saved: the same bytes for the same data."""

import io
import math
from pathlib import Path

import matplotlib

matplotlib.use("agg")

from matplotlib import pyplot as plt  # noqa: E402
from matplotlib.lines import Line2D  # noqa: E402
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, NullFormatter, NullLocator  # noqa: E402

from ..files import replaced  # noqa: E402
from ..style import ORACLE_COLOUR, SolverStyle  # noqa: E402
from ..formats import time_unit  # noqa: E402

INK, GRID, FAINT = "#1c2430", "#e3e7ec", "#5c6672"
PAGE = 7.16  # width of a page with two columns [in]
ORACLE = {"color": ORACLE_COLOUR, "linestyle": (0, (6, 2)), "linewidth": 1.2, "zorder": 5}
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


def panels(columns: int, width: float, height: float, **options):
    """(figure, axes from left to right)"""
    figure, axes = plt.subplots(1, columns, figsize=(width, height), squeeze=False, layout="constrained", **options)
    return figure, list(axes.flat)


def save(figure, folder: Path, name: str) -> list[Path]:
    """<name>.svg and <name>.pdf of one figure, which is closed."""
    paths = [folder / f"{name}.svg", folder / f"{name}.pdf"]
    folder.mkdir(parents=True, exist_ok=True)
    with replaced(paths[0]) as beside:
        beside.write_bytes(svg(figure, close=False))
    with replaced(paths[1]) as beside:
        figure.savefig(beside, metadata={"CreationDate": None, "Creator": "LCPBench", "Producer": None})
    plt.close(figure)
    return paths


def svg(figure, close: bool = True) -> bytes:
    """On white, so that it can be read on a dark page."""
    # The layout is found once; by default every drawing looks for it again, which takes longer than the drawing.
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    text = io.BytesIO()
    figure.savefig(text, format="svg", metadata={"Date": None, "Creator": "LCPBench"})
    if close:
        plt.close(figure)
    return text.getvalue()


def line(style: SolverStyle) -> dict:
    """Arguments of plot() for a solver's line. Peers are thinner, with hollow markers."""
    return {"color": style.colour, "linestyle": style.dash, "linewidth": 1.2 if style.own else 0.9,
            "zorder": 4 if style.own else 3, "marker": style.marker,
            "markersize": 3.4 if style.marker in "sD" else 4,
            "markerfacecolor": style.colour if style.own else "white", "markeredgecolor": style.colour,
            "markeredgewidth": 0.5 if style.own else 0.9}


def handle(solver: str, style: SolverStyle, **look) -> Line2D:
    """The entry of a legend; `look` differs from line()."""
    return Line2D([], [], label=solver, **line(style) | look)


def legend_below(axes, made: list[Line2D], place: float, **options):
    """Under the panel, outside of its frame. @param place  of its upper end, in heights of the panel"""
    return axes.legend(handles=made, loc="upper center", bbox_to_anchor=(0.5, place), ncol=2, borderaxespad=0, **options)


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


def time_axis(axis, label: str = "", finer: bool = False) -> None:
    """@param finer  labels at 2 and 5 too; times upwards have them where powers of ten alone would be one or two"""
    log_axis(axis, label, time_tick)
    low, high = axis.get_view_interval()
    if finer or (axis.axis_name == "y" and high / low < 100):
        axis.set_minor_formatter(FuncFormatter(lambda value, _: time_tick(value) if f"{value:.0e}"[0] in "25" else ""))
