"""lcpbench.solve: answers, the forms of a problem, what is refused, threads."""

import json
import subprocess
import threading

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from problems import FORMS, LAWS, json_line, random_problem
from scipy import sparse

import lcpbench

A = np.array([[2.0, 1.0], [1.0, 2.0]])
B = np.array([-5.0, -6.0])


def test_two_rows_have_the_answer_by_hand():
    result = lcpbench.solve(A, B)
    assert result.status == "solved"
    np.testing.assert_allclose(result.f, [4 / 3, 7 / 3], rtol=1e-12)
    np.testing.assert_allclose(result.w, 0, atol=1e-12)
    assert result.verdict.passes and result.verdict.tier == 1e-9 and result.verdict.parts == {}
    assert result.time > 0 and result.iterations >= 0 and result.ray is None


def test_a_result_outlives_what_it_was_read_from():
    f = lcpbench.solve(A.copy(), B.copy()).f
    np.testing.assert_allclose(f, [4 / 3, 7 / 3], rtol=1e-12)
    assert not f.flags.writeable


@settings(deadline=None, max_examples=60)
@given(seed=st.integers(0, 2**32 - 1), rows=st.integers(1, 60), form=st.sampled_from(FORMS), laws=st.sampled_from(LAWS),
       solver=st.sampled_from(["auto", "lemke", "pgs", "bpp"]))
def test_the_command_has_the_same_bits(seed, rows, form, laws, solver):
    arguments = random_problem(seed, rows, form, laws)
    ours = lcpbench.solve(**arguments, solver=solver, tolerance=1e-6)
    told = subprocess.run([lcpbench.command(), "solve", "--solver", solver, "--tolerance", "1e-6", "-"],
                          input=json_line(arguments), capture_output=True, text=True, check=True)
    theirs = json.loads(told.stdout)
    assert theirs["status"] == ours.status
    assert np.array(theirs["f"]).tobytes() == ours.f.tobytes()
    assert theirs["metrics"]["rho"] == ours.verdict.rho


@settings(deadline=None, max_examples=60)
@given(seed=st.integers(0, 2**32 - 1), rows=st.integers(1, 40), laws=st.sampled_from(LAWS))
def test_every_layout_of_a_matrix_is_the_same_problem(seed, rows, laws):
    arguments = random_problem(seed, rows, "dense", laws)
    dense = arguments.pop("A")
    f = lcpbench.solve(dense, **arguments).f
    wide = np.zeros((2 * rows, 2 * rows))
    wide[::2, ::2] = dense
    for layout in (np.asfortranarray(dense), wide[::2, ::2], dense.astype(">f8"), dense.tolist()):
        assert lcpbench.solve(layout, **arguments).f.tobytes() == f.tobytes()
    f = lcpbench.solve(sparse.csr_array(dense), **arguments).f
    unsorted = sparse.csr_array(dense)
    for i in range(rows):
        part = slice(*unsorted.indptr[i : i + 2])
        unsorted.indices[part], unsorted.data[part] = unsorted.indices[part][::-1].copy(), unsorted.data[part][::-1].copy()
    wide = sparse.csr_array(dense)
    wide.indptr, wide.indices = wide.indptr.astype(np.int64), wide.indices.astype(np.int64)
    for layout in (sparse.csc_matrix(dense), sparse.coo_array(dense), unsorted, wide):
        assert lcpbench.solve(layout, **arguments).f.tobytes() == f.tobytes()


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 2**32 - 1), rows=st.integers(1, 40), laws=st.sampled_from(LAWS))
def test_a_dense_J_is_the_sparse_one(seed, rows, laws):
    arguments = random_problem(seed, rows, "factors", laws)
    f = lcpbench.solve(**arguments).f
    J = arguments.pop("J").toarray()
    for layout in (J, np.asfortranarray(J)):
        assert lcpbench.solve(J=layout, **arguments).f.tobytes() == f.tobytes()


def test_bilateral_rows_are_a_mask_or_indices():
    f = lcpbench.solve(A, -B, bilateral=[1]).f
    assert lcpbench.solve(A, -B, bilateral=np.array([False, True])).f.tobytes() == f.tobytes()
    np.testing.assert_allclose(f, [0, -3], rtol=1e-12)


def test_friction_holds_or_slides():
    friction = {"row": [1], "normal": [0], "mu": [0.5]}
    holds = lcpbench.solve(np.eye(2), [-10.0, 4.0], friction=friction)
    slides = lcpbench.solve(np.eye(2), [-10.0, 8.0], friction=friction)
    np.testing.assert_allclose(holds.f, [10, -4], rtol=1e-9)
    np.testing.assert_allclose(slides.f, [10, -5], rtol=1e-9)
    np.testing.assert_allclose(slides.w, [0, 3], atol=1e-8)
    assert slides.verdict.passes and set(slides.verdict.parts) >= {"penetration", "cone", "dissipation"}


def test_an_infeasible_problem_has_a_ray():
    result = lcpbench.solve(np.zeros((1, 1)), [-1.0])
    assert result.status == "infeasible"
    assert result.verdict.ray.proved and result.ray[0] > 0


@pytest.mark.parametrize("arguments, name", [
    ({"A": np.eye(2)}, "b"),
    ({"b": B}, "A"),
    ({"A": np.eye(3), "b": B}, "A"),
    ({"A": np.ones(4), "b": B}, "A"),
    ({"A": A, "b": [1.0, np.nan]}, "b"),
    ({"A": [[1, np.inf], [0, 1]], "b": B}, "A"),
    ({"A": A, "b": "two"}, "b"),
    ({"A": A, "b": [1j, 2]}, "b"),
    ({"A": A, "b": B, "J": A}, "J"),
    ({"A": A, "b": B, "inverse_mass": B}, "inverse_mass"),
    ({"J": A, "b": B}, "inverse_mass"),
    ({"J": A, "b": B, "inverse_mass": [1, -1]}, "inverse_mass"),
    ({"J": sparse.csr_matrix(([1e308, 1e308], [0, 0], [0, 2, 2]), shape=(2, 2)), "b": B, "inverse_mass": [1, 1]}, "J"),
    ({"A": A, "b": B, "bilateral": [2]}, "bilateral"),
    ({"A": A, "b": B, "bilateral": [0.5]}, "bilateral"),
    ({"A": A, "b": B, "bilateral": [True]}, "bilateral"),
    ({"A": A, "b": B, "friction": {"row": [1], "normal": [0]}}, "friction"),
    ({"A": A, "b": B, "friction": {"row": [1], "normal": [0], "mu": [-1]}}, "friction"),
    ({"A": A, "b": B, "friction": {"row": [1], "normal": [0], "mu": [1, 2]}}, "friction.mu"),
    ({"A": A, "b": B, "friction": {"row": [1], "normal": [0], "mu": [1], "slip": [2]}}, "friction.slip"),
    ({"A": A, "b": B, "bounded": {"row": [1], "lower": [2], "upper": [1]}}, "bounded"),
    ({"A": A, "b": B, "tolerance": 2}, "tolerance"),
    ({"A": A, "b": B, "tolerance": "small"}, "tolerance"),
    ({"A": A, "b": B, "time_limit": -1}, "time_limit"),
    ({"A": A, "b": B, "initial_f": [1.0]}, "initial_f"),
    ({"A": A, "b": B, "solver": 3}, "solver"),
])
def test_what_is_wrong_is_named(arguments, name):
    with pytest.raises(ValueError, match="^" + name.replace("_", ".")):
        lcpbench.solve(**arguments)


def test_unknown_solvers_and_settings_name_what_is_known():
    with pytest.raises(ValueError, match="'newton'.*auto.*lemke"):
        lcpbench.solve(A, B, solver="newton")
    with pytest.raises(ValueError, match="omega.*relaxation"):
        lcpbench.solve(A, B, solver="pgs", omega=1.3)
    assert lcpbench.solve(A, B, solver="pgs", relaxation=1.1).status == "solved"
    assert lcpbench.solve(A, B, solver="apgd", restart=False).status == "solved"
    assert {"auto", "lemke", "pgs"} <= {entry.key for entry in lcpbench.available_solvers()}


def test_a_problem_serves_many_solves():
    problem = lcpbench.Problem(A, B, symmetric=True, positive_semidefinite=True)
    assert (len(problem), problem.form) == (2, "dense")
    result = lcpbench.solve(problem)
    assert result.f_unique is True and lcpbench.solve(A, B).f_unique is None
    with pytest.raises(ValueError, match="^b: "):
        lcpbench.solve(problem, B)
    with pytest.raises(ValueError, match="^symmetric: "):
        lcpbench.Problem([[1, 2], [0, 1]], B, symmetric=True)
    assert lcpbench.verify(problem, result.f).rho == result.verdict.rho
    assert lcpbench.verify(problem, result.f + 1).false_success


def test_two_columns_of_equal_contacts_share_their_force():
    J, inverse_mass = np.array([[1.0, 0, 0], [1.0, 0, 0]]), np.ones(3)
    assert lcpbench.solve(J=J, inverse_mass=inverse_mass, b=[-1.0, -1.0]).f_unique is False


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 2**32 - 1), rows=st.integers(1, 40), form=st.sampled_from(FORMS), laws=st.sampled_from(LAWS))
def test_a_kept_solver_gives_the_bits_of_a_new_one(seed, rows, form, laws):
    arguments = random_problem(seed, rows, form, laws)
    solver = lcpbench.Solver("auto")
    with pytest.raises(ValueError, match="setup"):
        solver.solve()
    solver.setup(lcpbench.Problem(**arguments))
    first = solver.solve()
    assert first.f.tobytes() == lcpbench.solve(**arguments).f.tobytes()
    arguments["b"] = arguments["b"][::-1].copy()
    solver.update(arguments["b"])
    second = solver.solve()
    assert second.f.tobytes() == lcpbench.solve(**arguments).f.tobytes()
    warm = solver.solve(initial_f=second.f)
    assert warm.verdict.passes == second.verdict.passes


def test_eight_threads_at_once_have_the_answers_of_one():
    problems = [random_problem(seed, 80, FORMS[seed % 3], LAWS[seed % 4]) for seed in range(24)]
    shared = lcpbench.Problem(**problems[0])
    alone = [lcpbench.solve(**arguments).f.tobytes() for arguments in problems]
    together = [[] for _ in range(8)]

    def run(answers):
        for arguments in problems:
            answers.append(lcpbench.solve(**arguments).f.tobytes())
            lcpbench.solve(shared).verdict

    threads = [threading.Thread(target=run, args=(answers,)) for answers in together]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(answers == alone for answers in together)


def test_others_run_while_a_solve_does():
    """The GIL is released: a second thread counts on while the first one solves."""
    arguments = random_problem(1, 3000, "factors", "plain")
    done, counted = threading.Event(), []

    def count():
        before = 0
        while not done.is_set():
            before += 1
        counted.append(before)

    thread = threading.Thread(target=count)
    thread.start()
    result = lcpbench.solve(**arguments, solver="pgs", tolerance=1e-15, time_limit=0.3)
    done.set()
    thread.join()
    assert result.status in ("time_limit", "solved", "iteration_limit", "numerical_failure") and counted[0] > 10
