"""Charts as files: the same bytes for the same data."""

import io
from pathlib import Path

import matplotlib

matplotlib.use("agg")

from matplotlib import pyplot as plt  # noqa: E402
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, NullFormatter  # noqa: E402

from ..files import replaced  # noqa: E402
from .chart import KINDS, NAMES, Axis, Chart, Panel, Trace  # noqa: E402

_INK = "#1c2430"
_PAGE = 7.16  # width of a page with two columns [in]
_STYLE = {
    "svg.fonttype": "path", "svg.hashsalt": "lcpbench", "pdf.fonttype": 42, "font.family": "DejaVu Sans",
    "font.size": 7, "axes.titlesize": 8, "axes.labelsize": 8, "axes.edgecolor": "#9aa4b0", "axes.labelcolor": _INK,
    "axes.titlecolor": _INK, "axes.titlelocation": "left", "axes.spines.top": False, "axes.spines.right": False,
    "axes.grid": True, "axes.axisbelow": True, "axes.linewidth": 0.7, "grid.color": "#e3e7ec", "grid.linewidth": 0.6,
    "xtick.color": _INK, "ytick.color": _INK, "text.color": _INK, "figure.facecolor": "white", "axes.facecolor": "white",
    "savefig.facecolor": "white", "legend.frameon": False, "legend.handlelength": 2.4, "legend.columnspacing": 1.1,
    "legend.labelspacing": 0.35, "savefig.bbox": "tight", "savefig.pad_inches": 0.03,
}


def write(chart: Chart, *paths: Path) -> None:
    """In the formats that the paths end in, .svg or .pdf, in one folder, which is made."""
    paths[0].parent.mkdir(parents=True, exist_ok=True)
    metadata = {".svg": {"Date": None, "Creator": "LCPBench"},
                ".pdf": {"CreationDate": None, "Creator": "LCPBench", "Producer": None}}
    with plt.rc_context(_STYLE):
        figure = _draw(chart)
        # The layout is found once; by default every drawing looks for it again, which takes longer than the drawing.
        figure.draw_without_rendering()
        figure.set_layout_engine("none")
        for path in paths:
            text = io.BytesIO()
            figure.savefig(text, format=path.suffix[1:], metadata=metadata[path.suffix])
            with replaced(path) as beside:
                beside.write_bytes(text.getvalue())
        plt.close(figure)


def _draw(chart: Chart):
    height = 1 + 0.14 * chart.names if chart.names else 3.2 if chart.rows == 1 else 2
    figure, axes = plt.subplots(chart.rows, chart.columns, figsize=(_PAGE, height * chart.rows), squeeze=False,
                                layout="constrained")
    handles = {}
    for index, pane in enumerate(axes.flat):
        if index >= len(chart.panels):
            pane.remove()
            continue
        panel = chart.panels[index]
        _panel(pane, panel)
        for axis, of in ((pane.xaxis, panel.x), (pane.yaxis, panel.y)):
            _axis(chart, axis, of)
        pane.set_title(panel.title)
        if index % chart.columns and panel.y == chart.panels[index - 1].y and panel.y.kind != NAMES:
            pane.set_ylabel("")
        handles |= {name: handle for handle, name in zip(*pane.get_legend_handles_labels())}
    if len(handles) > 1:
        figure.legend(handles=[*handles.values()], labels=[*handles], loc="upper center", bbox_to_anchor=(0.5, 0), ncol=5)
    return figure


def _axis(chart: Chart, axis, of: Axis) -> None:
    axis.set_label_text(of.title)
    if of.kind == NAMES:
        axis.axes.set_ylim(chart.names - 0.5, -0.5)
        return
    words = KINDS[of.kind][0]
    (axis.axes.set_xlim if axis.axis_name == "x" else axis.axes.set_ylim)(chart.ends(of))
    if of.log:
        axis._set_axes_scale("log")
        axis.set_major_locator(FixedLocator(chart.ticks(of)))
        axis.set_minor_locator(LogLocator(10, subs=range(2, 10), numticks=15))
        axis.set_minor_formatter(NullFormatter())
    if of.log or of.kind != "plain":
        axis.set_major_formatter(FuncFormatter(lambda value, _: words(value)))


def _panel(pane, panel: Panel) -> None:
    before: dict[str, float] = {}
    for trace in panel.traces:
        if trace.bar:
            left = [before.get(name, 0) for name in trace.y]
            pane.barh(list(trace.y), list(trace.x), left=left, color=trace.look.colour, label=trace.name)
            before |= {name: before.get(name, 0) + value for name, value in zip(trace.y, trace.x)}
            continue
        pane.plot(list(trace.x), list(trace.y), label=trace.name, **_line(trace))
        if trace.low is not None:
            reach = [[x - low for x, low in zip(trace.x, trace.low)], [high - x for x, high in zip(trace.x, trace.high)]]
            pane.errorbar(list(trace.x), list(trace.y), xerr=reach, fmt="none", ecolor=trace.look.colour, elinewidth=0.8)
        for x, y, words in zip(trace.x, trace.y, trace.text or ()):
            pane.annotate(words, (x, y), (3, -3), textcoords="offset points", rotation=-35, rotation_mode="anchor", va="top",
                          fontsize=5.5, color=trace.look.colour)


def _line(trace: Trace) -> dict:
    """Arguments of plot(). What is not strong is thinner, with hollow markers."""
    look = trace.look
    return {"color": look.colour, "linestyle": "none" if look.dash is None else look.dash, "linewidth": 1.2 if look.strong else 0.9,
            "zorder": 4 if look.strong else 3, "marker": look.marker or "none", "markersize": 0.55 * look.size, "alpha": look.opacity,
            "markerfacecolor": look.colour if look.strong else "white", "markeredgecolor": look.colour,
            "markeredgewidth": 0.5 if look.strong else 0.9, "drawstyle": "steps-post" if trace.steps else "default",
            "markevery": None if trace.marks is None else [k for k, there in enumerate(trace.marks) if there]}
