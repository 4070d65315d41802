"""Solvers for the linear complementarity problem of rigid bodies in contact, with friction, and one verifier for all.

    import lcpbench
    result = lcpbench.solve(A, b)
    result.f, result.status, result.verdict.rho
"""

from ._command import command
from ._core import (BatchAnswer, Certificate, Problem, RayVerdict, Result, Solver, SolverEntry, StepAnswer, StepSolver,
                    Verdict, __version__, available_solvers, certify, limit_library_threads, solve, verify)


def solve_batch(body, J, b, inverse_mass, starts, *, bilateral=None, f=None, tolerance=1e-9, threads=1):
    """StepSolver(tolerance=tolerance, threads=threads).solve_batch of these arrays."""
    solver = StepSolver(tolerance=tolerance, threads=threads)
    return solver.solve_batch(body, J, b, inverse_mass, starts, bilateral=bilateral, f=f)


__all__ = ["BatchAnswer", "Certificate", "Problem", "RayVerdict", "Result", "Solver", "SolverEntry", "StepAnswer",
           "StepSolver", "Verdict", "__version__", "available_solvers", "certify", "command", "limit_library_threads",
           "solve", "solve_batch", "verify"]
