"""Energy error and penetration of one scene over time, for motion.csv."""

import math

import pandas as pd
from matplotlib.lines import Line2D

from . import figures, formats
from .figures import FuncFormatter, LogLocator, NullFormatter, plt
from .style import SolverStyle

_QUANTITIES = (("energy_error", "energy error"), ("penetration", "deepest penetration so far [m]"))
_FLOOR = 1e-17  # smaller values are rounding, and stand on the axis' lower end
_DASHES = ("-", (0, (5, 2)), (0, (1, 1.5)), (0, (6, 1.5, 1, 1.5)))  # loosest tolerance first


def figure(table: pd.DataFrame, styles: dict[str, SolverStyle]) -> str:
    """Energy error and penetration of one scene over time; colour by solver, dash by tolerance."""
    tolerances = sorted(set(table["tolerance"]), reverse=True)
    dashes = {tolerance: _DASHES[min(i, len(_DASHES) - 1)] for i, tolerance in enumerate(tolerances)}
    with plt.rc_context(figures._STYLE):
        picture, axes = plt.subplots(1, 2, figsize=(9.4, 3.4), constrained_layout=True)
        for pane, (column, label) in zip(axes, _QUANTITIES):
            for (solver, tolerance), run in table.groupby(["solver", "tolerance"], sort=False):
                values = run[column].cummax() if column == "penetration" else run[column]
                values = values.clip(lower=_FLOOR).iloc[1:].dropna()
                times = run["time"].loc[values.index]
                pane.plot(times, values, color=styles[solver].colour, linestyle=dashes[tolerance], linewidth=1.1,
                          zorder=3)
                if run["stopped"].iloc[-1] and len(values):
                    pane.plot(times.iloc[-1:], values.iloc[-1:], marker="x",
                              markersize=6, markeredgewidth=1.5, color=styles[solver].colour, zorder=4, clip_on=False)
            _axes(pane, label)
        axes[0].legend(handles=[Line2D([], [], color="#1c2430", linestyle=dashes[t], linewidth=1.1,
                                       label=formats.tier(t)) for t in tolerances],
                       title="tolerance", fontsize=8, title_fontsize=8, loc="best", framealpha=0.85)
        return figures._svg(picture)


def _axes(pane, label: str) -> None:
    pane.set_yscale("log")
    low, high = pane.get_ylim()
    pane.set_ylim(max(low, _FLOOR / 2), high)
    pane.yaxis.set_major_locator(LogLocator(10, numticks=9))
    pane.yaxis.set_major_formatter(FuncFormatter(lambda y, _: f"1e{round(math.log10(y))}"))
    pane.yaxis.set_minor_formatter(NullFormatter())
    pane.set_xlabel("time [s]")
    pane.set_ylabel(f"{label} (log scale)")
