"""Charts as Plotly's JSON, and its script, minified, from Debian's python3-plotly: the page must open from disk, without
a network."""

import re
import shutil
import subprocess
from pathlib import Path

import numpy as np

from ..errors import ReportError
from ..formats import short
from .chart import KINDS, NAMES, Axis, Chart, Panel, Trace

BUNDLE = Path("/usr/share/python3-plotly/plotly.js")
_SYMBOLS = {"o": "circle", "s": "square", "^": "triangle-up", "D": "diamond", "v": "triangle-down",
            "P": "cross", "X": "x", "*": "star", "|": "line-ns-open"}
_LINE, _SOFT = "#dfe4ea", "#5a6573"


def figure(chart: Chart) -> dict:
    """`data` and `layout`."""
    height = (22 * chart.names or 340) if chart.rows == 1 else 230 * chart.rows
    data, layout, told = [], {"height": 100 + height, "annotations": []}, set()
    for index, panel in enumerate(chart.panels):
        number = str(index + 1) if index else ""
        layout |= _place(chart, index, number)
        if panel.title:
            layout["annotations"].append({
                "text": panel.title, "xref": f"x{number} domain", "yref": f"y{number} domain", "x": 0, "y": 1, "xanchor": "left",
                "yanchor": "bottom", "showarrow": False})
        for trace in panel.traces:
            data.append(_trace(panel, trace) | {"xaxis": f"x{number}", "yaxis": f"y{number}", "showlegend": trace.name not in told})
            told.add(trace.name)
    bars = any(trace.bar for panel in chart.panels for trace in panel.traces)
    return {"data": data, "layout": layout | {"showlegend": len(told) > 1} | ({"barmode": "stack"} if bars else {})}


def _place(chart: Chart, index: int, number: str) -> dict:
    """The axes of a panel."""
    panel, (row, column) = chart.panels[index], divmod(index, chart.columns)
    first = column == 0 or panel.y != chart.panels[index - 1].y or panel.y.kind == NAMES
    below_it = chart.panels[index + chart.columns:index + chart.columns + 1]
    last = not below_it or panel.x != below_it[0].x
    beside, below = 0.21 if panel.y.kind == NAMES else 0.07, 0.16 / chart.rows**0.5
    width, height = (1 - beside * (chart.columns - 1)) / chart.columns, (1 - below * (chart.rows - 1)) / chart.rows
    left, top = column * (width + beside), 1 - row * (height + below)
    return {f"xaxis{number}": _axis(chart, panel.x, panel.x.title if last else "") | {"domain": [left, left + width], "anchor": f"y{number}"},
            f"yaxis{number}": _axis(chart, panel.y, panel.y.title if first else "")
            | {"domain": [max(0, top - height), top], "anchor": f"x{number}"}}


def _axis(chart: Chart, axis: Axis, title: str) -> dict:
    common = {"title": {"text": title}, "gridcolor": _LINE, "linecolor": _SOFT, "zeroline": False, "automargin": True}
    if axis.kind == NAMES:
        return common | {"type": "category", "autorange": "reversed", "dtick": 1}
    if not axis.log:
        return common | {"range": chart.ends(axis)} | ({"tickformat": ".0%"} if axis.kind == "share" else {})
    ticks = chart.ticks(axis)
    return common | {"type": "log", "range": np.log10(chart.ends(axis)).tolist(), "tickvals": ticks,
                     "ticktext": [KINDS[axis.kind][0](tick) for tick in ticks]}


def _trace(panel: Panel, trace: Trace) -> dict:
    look = trace.look
    told = "".join(f"<br>{axis.title or letter}: %{{{letter}{KINDS[axis.kind][1]}" for letter, axis in (("x", panel.x), ("y", panel.y)))
    found = {"name": trace.name, "x": _values(trace.x), "y": _values(trace.y), "legendgroup": trace.name,
             "hovertemplate": f"<b>{trace.name}</b>{told}<extra></extra>"}
    if trace.bar:
        return found | {"type": "bar", "orientation": "h", "marker": {"color": look.colour}}
    size = look.size if trace.marks is None else [look.size * bool(there) for there in trace.marks]
    modes = ["lines"] * (look.dash is not None) + ["markers"] * bool(look.marker) + ["text"] * bool(trace.text)
    found |= {"type": "scatter", "mode": "+".join(modes), "opacity": look.opacity,
              "line": {"color": look.colour, "width": 2 if look.strong else 1.5, "dash": _dash(look.dash),
                       "shape": "hv" if trace.steps else "linear"},
              "marker": {"symbol": _SYMBOLS.get(look.marker, "circle") + ("" if look.strong else "-open"), "color": look.colour,
                         "size": size}}
    if trace.text:
        found |= {"text": list(trace.text), "textposition": "bottom right", "textfont": {"color": look.colour, "size": 10}}
    if trace.low is not None:
        middle = np.asarray(trace.x, dtype=float)
        found["error_x"] = {"type": "data", "symmetric": False, "color": look.colour, "thickness": 1.2, "width": 3,
                            "array": _values(np.asarray(trace.high, dtype=float) - middle),
                            "arrayminus": _values(middle - np.asarray(trace.low, dtype=float))}
    return found


def _dash(dash) -> str:
    """In pixels of a line 1.4 px wide."""
    return "solid" if dash in ("-", None) else ",".join(f"{1.4 * length:g}px" for length in dash[1])


def _values(values) -> list:
    """With four digits; null where there is none."""
    return [short(value) for value in np.asarray(values).tolist()]


def script(bundle: Path = BUNDLE) -> str:
    """With the licence's notice at its beginning, and safe inside a <script>.

    @throws ReportError where the bundle or esbuild is missing
    """
    if not bundle.is_file():
        raise ReportError(str(bundle), "missing", "Debian's package python3-plotly (cmake/packages/packages.txt)")
    if shutil.which("esbuild") is None:
        raise ReportError("esbuild", "not found", "Debian's package esbuild (cmake/packages/packages.txt)")
    source = bundle.read_text(encoding="utf-8")
    notice = re.match(r"/\*.*?\*/", source, re.DOTALL)
    made = subprocess.run(["esbuild", "--minify", "--log-level=error"], input=source, capture_output=True, text=True,
                          check=False)
    if made.returncode:
        raise ReportError(str(bundle), f"esbuild says {made.stderr.strip()[:200]!r}", "a script that it can minify")
    text = made.stdout.replace("</script", r"<\/script").replace("<!--", r"<\!--")
    return (notice.group(0) + "\n" if notice else "") + text
