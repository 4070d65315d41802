"""qpsolvers: the KKT conditions of programs with bounds only; a refusal otherwise."""

import lcpbench.qpsolvers as qpsolvers_of_lcpbench
import numpy as np
import pytest
import qpsolvers
import scipy.sparse
from hypothesis import given, settings
from hypothesis import strategies as st
from qpsolvers.exceptions import ProblemError


def program(seed, n, rank, kind):
    random = np.random.default_rng(seed)
    C = random.normal(size=(rank, n))
    lower, upper = {
        "both": (-random.uniform(0, 1, n), random.uniform(0, 1, n)),
        "lower": (random.normal(size=n), None),
        "upper": (None, random.normal(size=n)),
        "zero": (np.zeros(n), None),
        "fixed": (np.full(n, 0.5), np.full(n, 0.5)),
        "mixed": (np.where(random.random(n) < 0.5, -np.inf, -1.0), np.where(random.random(n) < 0.5, np.inf, 1.0)),
    }[kind]
    return qpsolvers.Problem(C.T @ C, -C.T @ random.normal(size=rank), lb=lower, ub=upper)  # never unbounded


@settings(max_examples=150, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 12), st.integers(1, 15),
       st.sampled_from(["both", "lower", "upper", "zero", "fixed", "mixed"]), st.booleans())
def test_solutions_satisfy_the_kkt_conditions(seed, n, rank, kind, sparse):
    problem = program(seed, n, rank, kind)
    if sparse:
        problem.P = scipy.sparse.csc_matrix(problem.P)
    solution = qpsolvers.solve_problem(problem, "lcpbench")
    assert solution.found, solution.extras
    assert solution.is_optimal(1e-6), solution.extras
    P = problem.P.toarray() if sparse else problem.P
    assert solution.obj == pytest.approx(0.5 * solution.x @ P @ solution.x + problem.q @ solution.x, abs=1e-9)


@settings(max_examples=150, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 12), st.booleans(), st.booleans(),
       st.sampled_from(["dantzig", "principal-pivoting", "lemke"]))  # lemke takes bounded rows as they are
def test_methods_for_plain_problems_take_rows_with_one_bound(seed, n, sparse, warm, method):
    random = np.random.default_rng(seed)
    side = random.integers(0, 3, n)  # a lower bound, an upper one, none
    problem = program(seed, n, n + 2, "zero")
    problem.lb = np.where(side == 0, random.normal(size=n), -np.inf)
    problem.ub = np.where(side == 1, random.normal(size=n), np.inf)
    if sparse:
        problem.P = scipy.sparse.csc_matrix(problem.P)
    expected = qpsolvers.solve_problem(problem, "lcpbench")
    start = expected.x if warm else None
    solution = qpsolvers.solve_problem(problem, "lcpbench", initvals=start, method=method)
    assert solution.found and solution.is_optimal(1e-6), solution.extras
    assert solution.x == pytest.approx(expected.x, rel=1e-5, abs=1e-6)
    assert solution.obj == pytest.approx(expected.obj, rel=1e-6, abs=1e-8)
    if method != "lemke":
        assert np.all((solution.x >= problem.lb) & (solution.x <= problem.ub))  # without rounding


def test_methods_for_plain_problems_do_not_take_two_bounds():
    solution = qpsolvers.solve_problem(program(1, 4, 6, "both"), "lcpbench", method="dantzig")
    assert not solution.found and solution.extras["status"] == "unsupported"


def test_solve_qp_and_warm_starts():
    P, q = np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([-1.0, 1.0])
    x = qpsolvers.solve_qp(P, q, lb=np.zeros(2), solver="lcpbench")
    assert x == pytest.approx([0.5, 0])
    assert qpsolvers.solve_qp(P, q, lb=np.zeros(2), solver="lcpbench", initvals=x) == pytest.approx(x)
    assert "lcpbench" in qpsolvers.available_solvers


@pytest.mark.parametrize("sparse", [False, True])
@pytest.mark.parametrize("method", ["auto", "dantzig", "lemke"])
@pytest.mark.parametrize("P", [[[1, 5], [5, 1]], [[1, 0], [0, -1]], [[-1]], [[0, 1], [1, 0]], [[0, 1], [1, 5]], [[-1, 0], [0, -2]],
                               [[1e20, 0], [0, -1]], [[1e-20, 1e-3], [1e-3, 1]], [[1, 1 + 1e-9], [1 + 1e-9, 1]], [[-1e-300]],
                               [[2, 2, 2], [2, 2, 2], [2, 2, 1]], [[1, -.6, -.6], [-.6, 1, -.6], [-.6, -.6, 1]]])
def test_saddles_maxima_and_unbounded_programs_are_refused(P, method, sparse):
    P = scipy.sparse.csc_matrix(P, dtype=float) if sparse else np.array(P, dtype=float)
    n = P.shape[0]
    for bounds in ({}, {"lb": np.zeros(n)}, {"lb": -np.ones(n), "ub": np.ones(n)}):
        with pytest.raises(ProblemError, match="expected P to be positive semidefinite"):
            qpsolvers.solve_problem(qpsolvers.Problem(P, np.zeros(n), **bounds), "lcpbench", method=method)


@settings(max_examples=150, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 40), st.integers(1, 40), st.booleans())
def test_semidefiniteness_is_told_but_for_rounding(seed, n, rank, sparse):
    random = np.random.default_rng(seed)
    C = random.normal(size=(rank, n)) * (random.random((rank, n)) < 0.3) * 10.0 ** random.integers(-9, 9, n)
    C[:, random.random(n) < 0.2] = C[:, :1] * 3  # columns that depend on another
    made = scipy.sparse.csc_matrix if sparse else np.asarray
    P = np.tril(C.T @ C) + np.tril(C.T @ C, -1).T
    assert qpsolvers_of_lcpbench._is_semidefinite(made(P))
    scale = np.sqrt(np.where(P.diagonal() > 0, P.diagonal(), 1))
    least = np.linalg.eigvalsh(P / scale[:, None] / scale)[0]
    assert not qpsolvers_of_lcpbench._is_semidefinite(made(P - np.diag((least + 1e-9) * scale**2)))


def test_large_sparse_matrices_are_told_apart():
    n = 20000
    chain = scipy.sparse.diags([-np.ones(n - 1), np.r_[1, np.full(n - 2, 2.0), 1], -np.ones(n - 1)], offsets=[-1, 0, 1], format="csc")
    assert qpsolvers_of_lcpbench._is_semidefinite(chain)  # singular
    assert not qpsolvers_of_lcpbench._is_semidefinite(chain - 1e-6 * scipy.sparse.identity(n, format="csc"))


@pytest.mark.parametrize("far", [1e20, 1e30, 1e300, np.inf])
@pytest.mark.parametrize("method", ["auto", "dantzig"])  # which takes rows with one bound
def test_bounds_of_1e20_and_beyond_are_infinite(far, method):
    unbounded = qpsolvers.Problem(np.diag([0.0, 3.0]), np.array([1.0, -2.0]), lb=np.array([-far, 0.0]), ub=np.full(2, far))
    assert not qpsolvers.solve_problem(unbounded, "lcpbench", method=method).found
    problem = qpsolvers.Problem(np.eye(3), np.array([1.0, -2.0, 3.0]), lb=np.array([-far, 3.0, -far]), ub=np.array([far, far, -4.0]))
    solution = qpsolvers.solve_problem(problem, "lcpbench", method=method)
    assert solution.found and solution.x == pytest.approx([-1, 3, -4])
    assert solution.z_box == pytest.approx([0, -1, 1])


def test_what_has_no_solution_is_not_found():
    assert qpsolvers.solve_qp(np.zeros((1, 1)), np.array([1.0]), ub=np.ones(1), solver="lcpbench") is None  # unbounded
    crossed = qpsolvers.Problem(np.eye(1), np.zeros(1), lb=np.ones(1), ub=-np.ones(1))
    assert qpsolvers.solve_problem(crossed, "lcpbench").found is False


@pytest.mark.parametrize("more", [{"G": np.eye(2), "h": np.ones(2)}, {"A": np.ones((1, 2)), "b": np.ones(1)}])
def test_other_constraints_are_refused(more):
    problem = qpsolvers.Problem(np.eye(2), np.zeros(2), **more)
    with pytest.raises(ProblemError, match="bounds only"):
        qpsolvers.solve_problem(problem, "lcpbench")
    with pytest.raises(ValueError, match="symmetric"):
        qpsolvers.solve_problem(qpsolvers.Problem(np.array([[1.0, 2.0], [0.0, 1.0]]), np.zeros(2)), "lcpbench")


def test_a_P_that_is_nearly_symmetric_is_taken_where_asked():
    P = np.array([[4, 1 + 1e-6], [1, 3]])
    problem = qpsolvers.Problem(P, np.array([-1.0, -2]), lb=np.zeros(2))
    with pytest.raises(ValueError, match="asymmetry of 2.89e-07, .*symmetrize="):
        qpsolvers.solve_problem(problem, "lcpbench")
    solution = qpsolvers.solve_problem(problem, "lcpbench", symmetrize=1e-5)
    np.testing.assert_allclose(solution.x, [1 / 11, 7 / 11], atol=1e-6)


@pytest.mark.parametrize("name", ["P", "q", "lb", "ub", "initvals"])
def test_masked_entries_are_missing(name):
    parts = {"P": np.eye(2), "q": -np.ones(2), "lb": np.zeros(2), "ub": np.ones(2), "initvals": np.zeros(2)}
    parts[name] = np.ma.masked_array(parts[name], parts[name] > -2)
    initvals = parts.pop("initvals")
    with pytest.raises(ValueError, match=f"^{name}: has masked entries"):
        qpsolvers_of_lcpbench.solve_problem(qpsolvers.Problem(**parts), initvals)
