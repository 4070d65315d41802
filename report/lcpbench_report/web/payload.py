"""The data of the page as one JSON object, columns aligned to the list of problems. data.js reads it.

Numbers over many decades have two bytes each: times and residuals need 0.07 %, not sixteen digits. A value x > 0 is
stored as round(1600 log10 x), which reaches from 1e-20 to 1e20; what is smaller or larger is moved to the nearest of
these.
"""

import base64
import math

import numpy as np
import pandas as pd

from ..formats import power, short, size_class
from ..inputs import Inputs
from ..statistics.cells import BELOW_TIER, CHANGED, EXCLUDED, FAILED, FALSE_SUCCESS, NOT_ASKED, VERIFIED
from ..statistics.model import ORIGINS
from ..statistics.means import shift_of
from ..studies import DRIVER
from ..style import MARKER_PATHS

STEPS_PER_DECADE = 1600
LARGEST = 32000
ZERO, INFINITE, UNKNOWN = -32767, 32767, -32768
# Verdict -> letter in the strings of verdicts; other failures are "e". app.js has the words.
LETTERS = {VERIFIED: "v", FALSE_SUCCESS: "f", BELOW_TIER: "b", CHANGED: "h", EXCLUDED: "x", FAILED + "iteration_limit": "i",
           FAILED + "time_limit": "t", FAILED + "numerical_failure": "n", NOT_ASKED: "u",
           FAILED + "crashed": "c", FAILED + "killed": "k", FAILED + "out_of_memory": "m",
           FAILED + "infeasible": "p", FAILED + "solved": "w"}
PROVED_INFEASIBLE, WITHIN_ROUNDING, FALSE_INFEASIBLE, OTHER, ABSENT = "r", "o", "q", "e", "."
# Key in the page -> column of statistics.cells; all packed as logarithms. `time` is the fresh time.
NUMBERS = {"again": "again_s", "problem": "problem_s", "prepare": "prepare_s", "convert": "convert_s", "solve": "solve_s",
           "iterations": "iterations", "rho": "rho", "backward": "backward_error", "werror": "w_error", "time": "time"}
_MOTION_POINTS = 120  # of a curve: more are not seen


def build(inputs: Inputs, shown: list[str]) -> dict:
    """@param shown  solvers that are visible when the page opens"""
    # Thousands of problems fill up the streams: they are in the tables, and would only stall the browser.
    names = [name for name, about in inputs.problems.items() if not about["fill"]]
    cells = inputs.cells[~inputs.cells["fill"].astype(bool)]
    return {
        "solvers": [_solver(inputs, key) | {"shown": key in shown} for key in inputs.keys],
        "tiers": inputs.tiers, "shift": short(shift_of(cells)) or 0,
        "classes": [{"label": size_class(of["key"]), "low": of["least"], "high": of["most"]} for of in inputs.size_classes],
        "problems": _problems(inputs, names),
        "cells": {solver: _cells(table, names) for solver, table in cells.groupby("solver", sort=False)},
        "latency": _records(inputs.analysis.get("latency_by_solver")),
        "deadlines": _records(inputs.analysis.get("deadline")),
        "scaling": _records(inputs.analysis.get("scaling"), drop=("set",)),
        "precision": _records(inputs.analysis.get("delivered") if inputs.precision is None else inputs.precision),
        "motion": _motion(inputs.motion),
    }


def _solver(inputs: Inputs, key: str) -> dict:
    entry, style = inputs.entries[key], inputs.styles[key]
    return {"key": key, "method": entry.get("method", ""), "origin": entry["origin"],
            "colour": style.colour, "symbol": style.plotly_symbol, "dash": style.plotly_dash,
            "path": MARKER_PATHS[style.marker]}


def _problems(inputs: Inputs, names: list[str]) -> dict:
    about = [inputs.problems[name] for name in names]
    (family, families), (of_set, sets) = (pd.factorize(np.array([record[key] for record in about], dtype=object))
                                          for key in ("family", "set"))
    origins = [origin for origin in ORIGINS if any(record["origin"] == origin for record in about)]
    found = {"name": names, "origins": [ORIGINS[origin] for origin in origins],
             "origin": [origins.index(record["origin"]) for record in about], "families": families.tolist(), "family": family.tolist(), "sets": sets.tolist(),
             "set": of_set.tolist(), "counts": [int(record["counts"]) for record in about],
             "rows": [record["rows"] for record in about], "oracle": pack(_column(about, "oracle_s")), "weight": [record["weight"] for record in about]}
    for key in ("redundancy", "mass_ratio", "condition", "fraction_active"):
        found[key] = pack(_column(about, key))
    return found


def _column(records: list[dict], key: str) -> list[float]:
    return [math.nan if record.get(key) is None else float(record[key]) for record in records]


def _cells(table: pd.DataFrame, names: list[str]) -> dict:
    """Verdicts by tier; numbers, which a direct method has but once, by tier as places in a list."""
    verdicts, numbers, places = {}, [], {}
    for tier, of_tier in table.groupby("tier", sort=False):
        letters = of_tier["verdict"].map(LETTERS).fillna(OTHER)
        for flag, letter in (("infeasible_within_rounding", WITHIN_ROUNDING), ("false_infeasible", FALSE_INFEASIBLE),
                             ("proved_infeasible", PROVED_INFEASIBLE)):
            letters = letters.mask(of_tier[flag].astype(bool), letter)
        # What failed has the time of the solve that was judged.
        time = of_tier["time_s"].where(of_tier["passes"].astype(bool), of_tier["first_s"])
        rows = of_tier.assign(letter=letters, time=time).set_index("problem").reindex(names)
        packed = {name: pack(rows[column]) for name, column in NUMBERS.items()}
        if packed not in numbers:
            numbers.append(packed)
        key = power(tier)  # by which the page looks tiers up
        verdicts[key], places[key] = "".join(rows["letter"].fillna(ABSENT)), numbers.index(packed)
    return {"verdicts": verdicts, "numbers": numbers, "places": places}


def _records(table: pd.DataFrame | None, drop: tuple[str, ...] = ()) -> list[dict]:
    """Rows as objects, with four digits; what is not known is left out."""
    if table is None:
        return []
    return [{key: found for key, value in row.items() if (found := short(value)) is not None}
            for row in table.drop(columns=list(drop)).to_dict("records")]


def _motion(table: pd.DataFrame | None) -> list[dict]:
    """A curve per scene, level, driver and tolerance, thinned; the deepest penetration so far."""
    if table is None:
        return []
    found = []
    keys = ["scene", "level", "solver", DRIVER, "tolerance"]
    for values, run in table.groupby(keys, sort=False):
        picked = np.unique(np.linspace(0, len(run) - 1, min(len(run), _MOTION_POINTS)).astype(int))
        found.append(dict(zip(keys, values)) | {"stopped": run["stopped"].iloc[-1]}
                     | {key: [short(float(v)) for v in column.iloc[picked]]
                        for key, column in (("time", run["time"]), ("energy", run["energy_error"]),
                                            ("penetration", run["penetration"].cummax()))})
    return found


def pack(values) -> str:
    """Base64 of little-endian 16-bit integers. NaN is unknown; negative values are not expected."""
    given = np.asarray(values, dtype=float)
    with np.errstate(divide="ignore", invalid="ignore"):
        logs = np.rint(np.log10(given) * STEPS_PER_DECADE)
    codes = np.clip(np.nan_to_num(logs, nan=0, posinf=LARGEST, neginf=-LARGEST), -LARGEST, LARGEST)
    codes = np.where(np.isnan(given), UNKNOWN, np.where(given == 0, ZERO, np.where(np.isinf(given), INFINITE, codes)))
    return base64.b64encode(codes.astype("<i2").tobytes()).decode("ascii")
