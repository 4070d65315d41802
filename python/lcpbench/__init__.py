"""Solvers for the linear complementarity problem of rigid bodies in contact, with friction, and one verifier for all.

    import lcpbench
    result = lcpbench.solve(A, b)
    result.f, result.status, result.verdict.rho
"""

from ._command import command
from .campaigns import Campaign, run, tables
from .scenes import Animation, Body, Edge, Row, Scene, generate, scene_families
from ._core import (BatchAnswer, Certificate, Derivative, Gradient, Problem, RayVerdict, Result, SolutionChange, Solver,
                    SolverEntry, StepAnswer, StepSolver, Verdict, __version__, available_solvers, certify, derivative,
                    limit_library_threads, solve, verify)


def solve_batch(body, J, b, inverse_mass, starts, *, bilateral=None, friction=None, bounded=None, f=None,
                tolerance=1e-9, threads=1):
    """StepSolver(tolerance=tolerance, threads=threads).solve_batch of these arrays."""
    solver = StepSolver(tolerance=tolerance, threads=threads)
    return solver.solve_batch(body, J, b, inverse_mass, starts, bilateral=bilateral, friction=friction, bounded=bounded,
                              f=f)


__all__ = ["Animation", "BatchAnswer", "Body", "Campaign", "Certificate", "Derivative", "Edge", "Gradient", "Problem",
           "RayVerdict", "Result", "Row", "Scene", "SolutionChange", "Solver", "SolverEntry", "StepAnswer", "StepSolver",
           "Verdict", "__version__", "available_solvers", "certify", "command", "derivative", "generate",
           "limit_library_threads", "run", "scene_families", "solve", "solve_batch", "tables", "verify"]
