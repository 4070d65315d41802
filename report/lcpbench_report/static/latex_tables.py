"""The report's tables for papers. Units stand in the headers; -- is what was not measured."""

import math
from collections.abc import Iterator

import numpy as np
import pandas as pd

from .. import choice
from ..headline_table import headline
from ..inputs import Inputs
from ..formats import time_unit
from . import latex
from .latex import count, escape, key, number, percent, power, scientific, spanning, tabular
from .sequences import ALL

_PACKAGES = r"\usepackage{booktabs}" + "\n" + r"\usepackage{textcomp}"
_MICROSECONDS = r"\textmu{}s"


def tables(inputs: Inputs) -> Iterator[tuple[str, str]]:
    """(name, LaTeX) of what the inputs have."""
    makers = {"headline": _headline, "coverage": _coverage, "means": _means, "accuracy": _accuracy,
              "scaling": _scaling, "sequences": _sequences, "deadlines": _deadlines}
    for name, make in makers.items():
        text = make(inputs)
        if text is not None:
            yield name, f"% {name}: written by LCPBench, see README.md beside it\n{text}"


def readme(files: list[str]) -> str:
    """What the folder holds and how a paper uses it."""
    tex = [name for name in files if name.endswith(".tex")]
    lines = ["# Tables", "",
             "`*.csv`: all tables of the analysis, as `lcpbench analyse` writes them, and the study of motion (columns: "
             "benchmarks/RESULTS.md); large ones are compressed (`.csv.gz`).", ""]
    if tex:
        names = ", ".join(f"`{name}`" for name in tex)
        lines += [f"`*.tex`: the same in short for papers: {names}. They need", "",
                  *("    " + line for line in _PACKAGES.splitlines()), "",
                  "and stand in a table of your own, which has the caption:", "",
                  *("    " + line for line in (r"\begin{table*}", r"  \centering", rf"  \input{{tables/{tex[0]}}}",
                                               r"  \caption{...}", r"\end{table*}")), "",
                  "The files are UTF-8 with LaTeX's own commands only. Wide ones fit the width of two columns; "
                  "`\\resizebox{\\linewidth}{!}{\\input{...}}` (graphicx) fits them to another."]
    return "\n".join(lines) + "\n"


def _headline(inputs: Inputs) -> str | None:
    """Median fresh time (what is not verified took infinitely long) and share verified, per size class."""
    found = headline(inputs) if len(inputs.cells) else None
    if not found or not found.solvers:
        return None
    entries = {solver: [row.entries.get(solver) for row in found.classes] for solver in found.solvers}
    units = [_unit(mine[index].time_s for mine in entries.values() if mine[index]) for index in range(len(found.classes))]
    rows = []
    for solver, mine in entries.items():
        row = [key(solver)]
        for (_, scale), entry in zip(units, mine):
            if entry is None or not entry.attempted:
                row += [latex.DASH, latex.DASH]
                continue
            text = number(entry.time_s / scale) if math.isfinite(entry.time_s) else latex.DASH
            row += [rf"\textbf{{{text}}}" if entry.best else text, latex.share(entry.share)]
        rows.append(row)
    header = spanning([_size(row.size_class) + " rows" for row in found.classes], 2)
    header.append(" & ".join(["solver", *(cell for name, _ in units for cell in (escape(name), r"\%"))]) + r" \\")
    return tabular("l" + "rr" * len(units), header, rows, "scriptsize")


def _size(size_class: str) -> str:
    """1001-1e4 -> 1001--$10^{4}$"""
    return "--".join(f"$10^{{{end[2:]}}}$" if end.startswith("1e") else end for end in size_class.split("-"))


def _unit(times) -> tuple[str, float]:
    finite = [time for time in times if math.isfinite(time)]
    return time_unit(float(np.median(finite)) if finite else 1.0)


def _per_tier(inputs: Inputs, name: str):
    """(rows of a table that count, tiers, solvers) or None"""
    table = inputs.analysis.get(name)
    table = None if table is None else choice.counted(table)
    tiers = [] if table is None else [tier for tier in choice.shown_tiers(inputs) if (table["tier"] == tier).any()]
    if not tiers:
        return None
    return table, tiers, _in_order(inputs, table)


def _rows(table: pd.DataFrame, tiers: list[float], solvers: list[str], cells) -> list[list[str]]:
    """@param cells  three words from a row of the table"""
    by = table.set_index(["solver", "tier"])
    return [[key(solver), *(word for tier in tiers for word in (
        cells(by.loc[(solver, tier)]) if (solver, tier) in by.index else [latex.DASH] * 3))] for solver in solvers]


def _coverage(inputs: Inputs) -> str | None:
    """Of all problems that count: per cent verified, numbers of false successes and of answers below the tier."""
    found = _per_tier(inputs, "coverage")
    if found is None:
        return None
    table, tiers, solvers = found
    rows = _rows(table, tiers, solvers, lambda of: [
        latex.share(of["verified_share"]), count(of["false_successes"]), count(of["below_tier"])])
    header = spanning([f"tier ${power(tier)}$" for tier in tiers], 3)
    header.append(" & ".join(["solver", *[r"verified [\%]", "false", "below"] * len(tiers)]) + r" \\")
    return tabular("l" + "rrr" * len(tiers), header, rows, "footnotesize")


def _means(inputs: Inputs) -> str | None:
    """Shifted geometric means in which what is not verified has the time limit, and over the best."""
    found = _per_tier(inputs, "means")
    if found is None:
        return None
    table, tiers, solvers = found
    table = table[table["unit"] == "s"]
    rows = _rows(table, tiers, solvers, lambda of: [
        number(1e6 * of["mean"]), f"[{number(1e6 * of['mean_low'])}, {number(1e6 * of['mean_high'])}]",
        number(of["over_best"])])
    shifts = table.drop_duplicates("tier").set_index("tier")["shift"]
    header = spanning([f"tier ${power(tier)}$, shift {number(1e6 * shifts[tier])} {_MICROSECONDS}" for tier in tiers], 3)
    header.append(" & ".join(["solver", *[f"mean [{_MICROSECONDS}]", r"95\,\%", "ratio"] * len(tiers)]) + r" \\")
    return tabular("l" + "rrr" * len(tiers), header, rows, "footnotesize")


def _accuracy(inputs: Inputs) -> str | None:
    """Verified answers at the main tier: residual, and error against answers that are known exactly."""
    table = inputs.analysis.get("accuracy")
    if table is None:
        return None
    tier = choice.main_tier(inputs)
    table = choice.counted(table, tier)
    table = table[(table["answers"] == "verified") & (table["reference"] == "certified")]
    by = table[table["problems"] > 0].set_index(["solver", "metric"])
    solvers = [solver for solver in inputs.keys if (solver, "rho") in by.index]
    if not solvers:
        return None
    rows = []
    for solver in solvers:
        row = [key(solver), count(by.loc[(solver, "rho"), "problems"])]
        for metric in ("rho", "w_error"):
            of = by.loc[(solver, metric)] if (solver, metric) in by.index else None
            row += [latex.DASH if of is None else scientific(of[level]) for level in ("median", "p99", "max")]
        rows.append(row)
    header = spanning([r"residual $\rho$", r"$\max_i |w_i - w_i^*| / (1 + \|b\|_\infty)$"], 3, first=3)
    header[0] = " & " + header[0]
    header.append(" & ".join([f"solver, tier ${power(tier)}$", "answers",
                              *["median", r"99\,\%", "largest"] * 2]) + r" \\")
    return tabular("lr" + "rrr" * 2, header, rows, "footnotesize")


def _scaling(inputs: Inputs) -> str | None:
    """Exponents of time ~ rows^exponent over the families."""
    table = inputs.analysis.get("scaling")
    tier = choice.main_tier(inputs)
    table = None if table is None else choice.counted(table, tier)
    if table is None or not len(table):
        return None
    rows = []
    for solver in inputs.keys:
        mine = table[table["solver"] == solver]
        if len(mine):
            values = mine["exponent"]
            rows.append([key(solver), count(len(mine)), number(values.median()), number(values.min()),
                         number(values.max()), number((mine["exponent_high"] - mine["exponent_low"]).median() / 2),
                         f"{count(mine['rows_min'].min())}--{count(mine['rows_max'].max())}"])
    header = [" & ".join([f"solver, tier ${power(tier)}$", "families", "median exponent", "least", "largest",
                          r"median half width (95\,\%)", "rows"]) + r" \\"]
    return tabular("lrrrrrr", header, rows)


def _sequences(inputs: Inputs) -> str | None:
    """Latency of a step over all sequences, cold and warm."""
    table = inputs.analysis.get("latency_by_solver")
    if table is None or not len(table):
        return None
    table = table[table["size"].astype(str) == ALL]
    table = table[table["tier"] == _nearest(table)]
    by = table.set_index(["solver", "mode"])
    columns = ("verified", "p50", "p99", "max")
    rows = []
    for solver in _in_order(inputs, table):
        row = [key(solver)]
        for mode in ("cold", "warm"):
            of = by.loc[(solver, mode)] if (solver, mode) in by.index else None
            row += [latex.DASH] * len(columns) if of is None else [
                percent(of["verified"], of["steps"]), *(number(1e6 * of[column]) for column in columns[1:])]
        row.append(number(by.loc[(solver, "warm"), "warm_gain"]) if (solver, "warm") in by.index else latex.DASH)
        rows.append(row)
    if not rows:
        return None
    unit = f"[{_MICROSECONDS}]"
    header = spanning(["cold start", "warm start"], len(columns))
    header[0] = header[0].replace(r" \\", r" & \\")
    header.append(" & ".join(["solver", *[r"verified [\%]", f"median {unit}", rf"99\,\% {unit}",
                                          f"largest {unit}"] * 2, "gain"]) + r" \\")
    return tabular("l" + 2 * len(columns) * "r" + "r", header, rows, "footnotesize")


def _deadlines(inputs: Inputs) -> str | None:
    """Per cent of steps in time and verified, per deadline."""
    table = inputs.analysis.get("deadline")
    if table is None or not len(table):
        return None
    table = table[(table["size"].astype(str) == ALL)]
    table = table[table["tier"] == _nearest(table)]
    limits = sorted(set(table["deadline_s"]))
    if not limits:
        return None
    by = table.set_index(["solver", "deadline_s"])
    rows = [[key(solver), *(percent(by.loc[(solver, limit), "verified"], by.loc[(solver, limit), "steps"])
                            if (solver, limit) in by.index else latex.DASH for limit in limits)]
            for solver in _in_order(inputs, table)]
    names = [f"{number(1e3 * limit)} ms" for limit in limits]
    header = spanning([r"in time and verified [\%], deadline"], len(limits))
    header.append(" & ".join(["solver", *names]) + r" \\")
    return tabular("l" + "r" * len(limits), header, rows)


def _in_order(inputs: Inputs, table: pd.DataFrame) -> list[str]:
    """The table's solvers in the order of the registry."""
    return [solver for solver in inputs.keys if solver in set(table["solver"])]


def _nearest(table: pd.DataFrame) -> float:
    return min(set(table["tier"]), key=lambda tier: abs(math.log10(tier / choice.TIER)), default=choice.TIER)
