"""Rows of FCLib's and Siconos' contacts, which have one tangent (in the plane) or two (in space)."""

from collections.abc import Callable
from enum import Enum

import numpy as np

from .problem import StoredProblem, mismatch, sparse


class Tangents(Enum):
    """What is read of the tangents of contacts whose coefficient of friction is not 0."""

    ONE = 1  # of contacts with one a friction row; two are refused, whose forces those formats bound by a disc
    BOX = 2  # of two also, a friction row each: a square in the place of the disc
    NONE = 3  # nothing: normal rows alone, as if all coefficients were 0


def contact_rows(dimension: int, mu: np.ndarray, tangents: Tangents,
                 rejected: Callable[[str, object], Exception]) -> tuple[np.ndarray, dict[str, np.ndarray] | None]:
    """The rows of the problem that contacts are: of each its normal and, where its coefficient is not 0, its tangents.

    @param mu        a coefficient a contact
    @param rejected  the error of what was expected and what was found
    @return by row of the file (`dimension` a contact) the row of the problem, -1 where it is not read; friction rows
    """
    has_friction = (mu != 0) & (tangents is not Tangents.NONE)
    is_disc = dimension > 2 and tangents is Tangents.ONE
    wrong = np.flatnonzero(has_friction & ((mu < 0) | is_disc))
    if wrong.size:
        coefficient = float(mu[wrong[0]])
        raise rejected("friction coefficients >= 0" if coefficient < 0 else
                       "friction coefficients 0 of contacts with two tangents, or `lcpbench convert --box-friction`, which "
                       "bounds the force of each tangent, or --without-friction, which passes over them", coefficient)
    is_read = np.zeros((len(mu), dimension), dtype=bool)
    is_read[:, 0] = True
    is_read[has_friction, 1:] = True
    row = np.where(is_read.ravel(), np.cumsum(is_read) - 1, -1).reshape(is_read.shape)
    if not has_friction.any():
        return row.ravel(), None
    repeated = [np.repeat(values, dimension - 1) for values in (row[has_friction, 0], mu[has_friction])]
    return row.ravel(), {"row": row[has_friction, 1:].ravel(), "normal": repeated[0], "mu": repeated[1]}


def inverse_of_diagonal(place: str, size: int, row: np.ndarray, column: np.ndarray, value: np.ndarray) -> np.ndarray:
    """The inverse of M, which is to be diagonal, from its entries."""
    wrong = np.flatnonzero((row != column) & (value != 0))
    if wrong.size:
        raise mismatch(place, "a diagonal matrix, others are not supported",
                       f"an entry in row {row[wrong[0]]} and column {column[wrong[0]]}")
    diagonal = np.zeros(size)
    with np.errstate(all="ignore"):
        np.add.at(diagonal, row[row == column], value[row == column])
        inverse = 1 / diagonal
    for k in np.flatnonzero(~((diagonal > 0) & np.isfinite(diagonal) & np.isfinite(inverse)))[:1]:
        raise mismatch(place, "masses > 0 on the diagonal", f"{float(diagonal[k])} at {k}")
    return inverse


def global_problem(place: str, id: str, rows: int, J: tuple[np.ndarray, np.ndarray, np.ndarray], inverse_mass: np.ndarray,
                   loads: np.ndarray, velocities: np.ndarray, **laws) -> StoredProblem:
    """Of M v = J^T f + loads, w = J v + velocities: b = J M^-1 loads + velocities. @param J  entries"""
    matrix = sparse(place, (rows, len(loads)), *J)
    with np.errstate(all="ignore"):
        b = matrix @ (inverse_mass * loads) + velocities
    if not np.isfinite(b).all():
        raise mismatch(place, "velocities without contact forces that are finite", "an overflow")
    return StoredProblem(id=id, b=b, J=matrix, inverse_mass=inverse_mass, **laws)
