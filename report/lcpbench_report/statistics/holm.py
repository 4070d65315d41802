"""Multiple comparisons."""

import numpy as np


def holm(p_values) -> np.ndarray:
    """Adjusted p-values of the step-down procedure (Holm 1979): with p ascending, the largest of min(1, (m - j) p_j)
    over j = 0..i. Comparing them with a level keeps the probability of any false alarm among the m tests below it.

    NaN is no test: it stays, and does not count among the m.
    """
    p = np.asarray(p_values, dtype=float)
    order = np.argsort(p)[:np.count_nonzero(~np.isnan(p))]  # NaN is sorted last
    adjusted = np.full(len(p), np.nan)
    factors = len(order) - np.arange(len(order))
    adjusted[order] = np.minimum(np.maximum.accumulate(factors * p[order]), 1.0)
    return adjusted
