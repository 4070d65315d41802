"""pickle, copy and multiprocessing: equal bits after the round trip."""

import copy
import multiprocessing
import pickle

import numpy as np
import pytest
from problems import FORMS, LAWS, random_problem

import lcpbench

WAYS = [copy.copy, copy.deepcopy] + [lambda of, protocol=protocol: pickle.loads(pickle.dumps(of, protocol))
                                     for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1)]


def bits(value):
    """Whatever can be compared."""
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, dict):
        return {name: bits(of) for name, of in value.items()}
    if isinstance(value, float):
        return value.hex()
    if hasattr(value, "indptr"):
        return value.shape, bits(value.indptr), bits(value.indices), bits(value.data)
    if type(value).__module__ == "lcpbench._core":
        return members(value)
    return value


def members(of):
    names = [name for name in dir(of) if not name.startswith("_") and not callable(getattr(of, name))]
    assert names
    return {name: bits(getattr(of, name)) for name in names}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("laws", LAWS)
def test_problems_and_results_come_back(way, form, laws):
    problem = lcpbench.Problem(**random_problem(3, 12, form, laws), symmetric=True, positive_semidefinite=True)
    assert members(way(problem)) == members(problem)
    for read_before in (False, True):
        result = lcpbench.solve(problem)
        if read_before:
            result.w, result.verdict
        again = way(result)
        assert members(again) == members(result) and again.verdict.passes == result.verdict.passes


@pytest.mark.parametrize("way", WAYS)
def test_rays_and_certificates_come_back(way):
    problem = lcpbench.Problem(J=[[1.0], [-1.0]], inverse_mass=[1.0], b=[-1.0, -1.0])
    for of in (lcpbench.solve(problem), lcpbench.solve(problem).verdict, lcpbench.solve(problem).verdict.ray,
               lcpbench.certify(problem), lcpbench.certify(lcpbench.Problem([[2, 1], [1, 2]], [-5, -6])),
               lcpbench.certify(lcpbench.Problem(**random_problem(1, 4, "factors", "friction"))),
               lcpbench.Problem(np.zeros((0, 0)), []),
               lcpbench.generate("boxes-and-discs", size=12).problem):
        assert members(way(of)) == members(of)


@pytest.mark.parametrize("way", WAYS)
def test_solvers_come_back_with_their_options_and_problem(way):
    solver = lcpbench.Solver("pgs", tolerance=1e-3, max_iterations=40, time_limit=9, relaxation=1.3)
    assert way(solver).key == "pgs"
    solver.setup(lcpbench.Problem(**random_problem(5, 30, "sparse", "plain")))
    expected = solver.solve()
    again = way(solver).solve()
    for name in ("f", "status", "iterations", "tolerance"):
        assert bits(getattr(again, name)) == bits(getattr(expected, name))

    body, J = np.array([[0, -1], [1, -1]], np.int32), np.eye(2, 6)
    step = lcpbench.StepSolver(tolerance=1e-4, threads=2)
    assert bits(way(step).solve(body, J, [-1.0, 2], np.ones((2, 3))).f) == \
        bits(step.solve(body, J, [-1.0, 2], np.ones((2, 3))).f)


def test_what_is_no_state_is_refused():
    problem = lcpbench.Problem(np.eye(2), [-1.0, -2])
    maker, arguments, state = problem.__reduce_ex__(2)[:3]
    for cut in (state[:0], state[:5], state[:-1]):
        with pytest.raises((ValueError, RuntimeError)):
            maker(*arguments).__setstate__(cut)


def _solved(problem):
    return lcpbench.solve(problem, solver="bpp")


def test_other_processes_take_problems_and_return_results():
    problems = [lcpbench.Problem(**random_problem(seed, 8, "factors", "plain")) for seed in range(4)]
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        for problem, result in zip(problems, pool.map(_solved, problems)):
            assert bits(result.f) == bits(_solved(problem).f)


def test_joblib_takes_them():
    joblib = pytest.importorskip("joblib")
    problem = lcpbench.Problem(**random_problem(2, 8, "sparse", "bounded"))
    results = joblib.Parallel(n_jobs=2)(joblib.delayed(lcpbench.solve)(problem) for _ in range(2))
    assert {result.f.tobytes() for result in results} == {lcpbench.solve(problem).f.tobytes()}
