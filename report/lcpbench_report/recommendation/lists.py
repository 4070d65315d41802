"""The short list of a region: the few solvers of which one is nearly the best on as many problems as possible."""

import numpy as np
import pandas as pd

NEAR = 1.1  # of the best: what counts when a list is made
WITHIN = 1.3  # of the best: what a recommendation must keep
MOST = 5  # solvers of a list
_WORST = 1e3  # a slower or failed answer is no worse than that
_LOG_WEIGHT = 0.1  # of the logarithm of the ratio, where a problem is not near


def family_weights(families: pd.Series, weights: pd.Series) -> np.ndarray:
    """Of every problem, so that all families weigh the same, with what its problems weigh within each."""
    return (weights / weights.groupby(families).transform("sum")).to_numpy()


def ratios(times: pd.DataFrame, best: pd.Series) -> pd.DataFrame:
    """Of every problem (row) and solver (column) the time over the best one; 1e3 where it is more or failed."""
    return times.div(best, axis=0).clip(upper=_WORST).fillna(_WORST)


def choose(of_region: pd.DataFrame, weights: np.ndarray, false_success: set[str], most: int = MOST) -> list[str]:
    """Greedily: the solver that adds most. A problem counts 1 where the best of the list is within NEAR of the best,
    and loses a tenth of the logarithm of the ratio, so that the rest is as little off as possible; what failed is a
    thousand times slower, so a solver that fails is backed up by another. One that ever claimed a success falsely
    is not taken, and none that adds nothing.

    @param of_region  ratios, a row per problem, a column per solver
    """
    columns = [key for key in of_region.columns if key not in false_success]
    if not columns:
        return []
    values = of_region[columns].to_numpy()
    current = np.full(len(values), _WORST)
    chosen: list[str] = []
    score = -np.inf
    while len(chosen) < most:
        merged = np.minimum(current[:, None], values)
        gains = (weights[:, None] * ((merged <= NEAR) - _LOG_WEIGHT * np.log(merged))).sum(axis=0)
        index = int(gains.argmax())
        if chosen and gains[index] <= score + 1e-12:
            break
        score = gains[index]
        chosen.append(columns[index])
        current = merged[:, index]
    return chosen


def record(of_region: pd.DataFrame, verified: pd.DataFrame, weights: np.ndarray) -> list[dict]:
    """How every solver did, best first: shares of the problems, families weighing the same, on which it was verified,
    and within WITHIN of the best."""
    total = weights.sum()
    rows = [{"solver": key, "verified": round(float((weights * verified[key]).sum() / total), 4),
             "within": round(float((weights * (of_region[key] <= WITHIN)).sum() / total), 4)}
            for key in of_region.columns]
    return sorted(rows, key=lambda row: (-row["within"], -row["verified"], row["solver"]))
