"""Parts of the space of features."""

import itertools
import math

import numpy as np
import pandas as pd

# By feature the ends of its parts: each begins at one and ends before the next; the last one has no end.
Edges = dict[str, list[float]]


def bounds(edges: Edges) -> list[dict[str, tuple[float, float]]]:
    """Of every region, in the order of region_of."""
    parts = [[(low, high) for low, high in zip(ends, [*ends[1:], math.inf])] for ends in edges.values()]
    return [dict(zip(edges, chosen)) for chosen in itertools.product(*parts)]


def region_of(features: pd.DataFrame, edges: Edges) -> pd.Series:
    """The number of every problem's region. A feature that is not known counts as the smallest, as the first region
    that excludes nothing does for `lcpbench recommend`."""
    number = np.zeros(len(features), dtype=int)
    for name, ends in edges.items():
        values = features[name].fillna(ends[0]).clip(lower=ends[0])
        number = number * len(ends) + np.searchsorted(ends, values, side="right") - 1
    return pd.Series(number, index=features.index)
