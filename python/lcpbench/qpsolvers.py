"""qpsolvers' `solve_problem` and `solve_qp` with the solver "lcpbench", for problems with bounds only:

    minimize 1/2 x.P x + q.x   subject to   lb <= x <= ub

P symmetric and positive semidefinite, but for rounding. Its optimality conditions are the box LCP w = P x + q, which `lcpbench.solve`
solves. Importing this module registers the solver; problems with G, h, A or b, or another P,
are refused. Methods that do not take
bounded rows get rows with one bound as x = lb + f or x = ub - f, f >= 0. Bounds of 1e20 and beyond are infinite.

    import qpsolvers, lcpbench.qpsolvers
    x = qpsolvers.solve_qp(P, q, lb=lb, ub=ub, solver="lcpbench")
"""

from __future__ import annotations

import time

import numpy as np
from qpsolvers import Problem, Solution, available_solvers, dense_solvers, sparse_solvers
from qpsolvers.exceptions import ProblemError
from qpsolvers.solvers import solve_function
from scipy.sparse import identity
from scipy.sparse.linalg import splu

from . import _core
from .formats.quadratic import with_infinities

__all__ = ["solve_problem"]

_NAME = "lcpbench"
_ROUNDINGS = 16  # of an entry of P, in units of n times the precision: Cholesky's, and those of who made P


def solve_problem(problem: Problem, initvals: np.ndarray | None = None, verbose: bool = False, method: str = "auto",
                  symmetrize: float | None = None, **options) -> Solution:
    """Solves a quadratic program with bounds only.

    initvals  (n,) warm start
    verbose   prints the status and rho
    method    a key of lcpbench.available_solvers()
    symmetrize  as of lcpbench.solve, of P
    options   of lcpbench.solve: tolerance (on rho), time_limit, max_iterations, settings of the method

    The solution is `found` where the verifier passes it at the tolerance. `extras` has the method's status, iterations
    and detail, rho and backward_error. Where lb > ub, and where the objective is unbounded, nothing is found.
    Raises qpsolvers' ProblemError for G, h, A or b and a P that is not positive semidefinite, and ValueError naming
    another argument.
    """
    begin = time.perf_counter()
    P, q, G, h, A, b, lb, ub = problem.unpack()
    if any(part is not None for part in (G, h, A, b)):
        raise ProblemError("lcpbench takes problems with bounds only: expected G, h, A and b to be None")
    for name, part in (("P", P), ("q", q), ("lb", lb), ("ub", ub), ("initvals", initvals)):
        if np.ma.is_masked(part):
            raise ValueError(f"{name}: has masked entries, expected numbers for all")
    P = P if hasattr(P, "multiply") else np.asarray(P)
    n = len(q)
    lower = np.full(n, -np.inf) if lb is None else with_infinities(np.asarray(lb, dtype=float))
    upper = np.full(n, np.inf) if ub is None else with_infinities(np.asarray(ub, dtype=float))
    solution = Solution(problem)
    if np.any(lower > upper):
        solution.found = False
        solution.extras = {"status": "infeasible", "detail": "lb > ub"}
        return solution
    free = np.isneginf(lower) & np.isposinf(upper)
    unilateral = (lower == 0) & np.isposinf(upper)
    origin, sign = np.zeros(n), np.ones(n)  # x = origin + sign f
    load = q
    if any(entry.key == method and not entry.takes_bounded for entry in _core.available_solvers()):
        # Not for the others: to count f from a far bound would round x.
        origin, sign, unilateral = _from_one_bound(lower, upper)
        load = sign * (P @ origin + q)
        P = _scaled(P, sign)
        initvals = None if initvals is None else sign * (initvals - origin)
    bounded = np.flatnonzero(~free & ~unilateral)
    lcp = _core.Problem(P, load, bilateral=free, symmetric=True, symmetrize=symmetrize,
                        bounded={"row": bounded, "lower": lower[bounded], "upper": upper[bounded]})
    if not _is_semidefinite(P):
        raise ProblemError("lcpbench takes convex problems only: expected P to be positive semidefinite")
    built = time.perf_counter()
    result = _core.solve(lcp, solver=method, initial_f=initvals, **options)
    solution.solve_time = time.perf_counter() - built
    solution.build_time = built - begin
    verdict = result.verdict
    solution.found = bool(verdict.passes)
    solution.extras = {"status": result.status, "iterations": result.iterations, "detail": result.detail,
                       "rho": verdict.rho, "backward_error": verdict.backward_error}
    if verbose:
        print(f"lcpbench {method}: {result.status}, rho = {verdict.rho:.1e}")
    if solution.found:
        x, w = origin + sign * result.f, sign * result.w
        solution.x = x
        solution.obj = float(0.5 * x @ (w - q) + q @ x)  # w = P x + q
        solution.y = solution.z = np.empty(0)
        # Not by x = lower or x = upper, which methods may miss by rounding.
        solution.z_box = np.where((x - w <= lower) | (x - w >= upper), -w, 0.0)
    return solution


def _scaled(P, scale):
    return P.multiply(scale[:, None]).multiply(scale).tocsc() if hasattr(P, "multiply") else P * scale[:, None] * scale


def _is_semidefinite(P) -> bool:
    """Whether a symmetric P is positive semidefinite, but for rounding: P of unit diagonal, shifted, has a Cholesky factor.
    Scaled first, so that a small negative entry beside large ones is seen."""
    n, diagonal = P.shape[0], P.diagonal()
    if (diagonal < 0).any():
        return False
    scaled = _scaled(P, 1 / np.sqrt(np.where(diagonal > 0, diagonal, 1)))
    if (scaled[diagonal == 0] != 0).sum() > 0:
        return False
    shift = _ROUNDINGS * n * np.finfo(float).eps * np.max(abs(scaled) @ np.ones(n), initial=1)
    try:
        if isinstance(scaled, np.ndarray):
            np.linalg.cholesky(scaled + shift * np.eye(n))
            return True
        # Elimination without exchanges: pivots are those of Cholesky.
        factor = splu(scaled + shift * identity(n, format="csc"), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0,
                      options={"SymmetricMode": True})
    except (np.linalg.LinAlgError, RuntimeError):  # a pivot that is not positive, or 0
        return False
    return bool((factor.perm_r == factor.perm_c).all() and (factor.U.diagonal() > 0).all())


def _from_one_bound(lower, upper):
    """origin, sign and where: x = origin + sign f with f >= 0 in rows with one bound, x = f elsewhere."""
    from_lower, from_upper = np.isfinite(lower) & np.isposinf(upper), np.isneginf(lower) & np.isfinite(upper)
    origin = np.where(from_lower, lower, np.where(from_upper, upper, 0.0))
    return origin, np.where(from_upper, -1.0, 1.0), from_lower | from_upper


if _NAME not in available_solvers:
    solve_function[_NAME] = solve_problem
    for names in (available_solvers, dense_solvers, sparse_solvers):
        names.append(_NAME)
