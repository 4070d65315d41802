"""lcpbench.derivative: the adjoint identity, finite differences, and what it says of points without a derivative."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from problems import FORMS, LAWS, random_problem
from scipy import sparse
from test_arguments import ANYTHING

import lcpbench


def random_change(arguments, random):
    """A direction in all data of a problem, as arguments of jvp and as that of the problem itself."""
    change = {"b": random.normal(size=len(arguments["b"]))}
    if "J" in arguments:
        J = arguments["J"]
        change["J"] = sparse.csr_matrix((random.normal(size=J.nnz), J.indices, J.indptr), shape=J.shape)
        change["inverse_mass"] = random.normal(size=J.shape[1])
    else:
        A = random.normal(size=arguments["A"].shape)
        change["A"] = sparse.csr_matrix(A + A.T) if sparse.issparse(arguments["A"]) else A + A.T
    if "friction" in arguments:
        change["mu"] = random.normal(size=len(arguments["friction"]["mu"]))
    return change


def moved(arguments, change, step):
    """The problem's arguments, `step` along the direction."""
    later = {**arguments, **{name: arguments[name] + step * by for name, by in change.items() if name != "mu"}}
    if "mu" in change:
        later["friction"] = {**arguments["friction"], "mu": arguments["friction"]["mu"] + step * change["mu"]}
    return later


def jvp(derivative, change):
    return derivative.jvp(**{"d" + name: by for name, by in change.items()})


def dense(matrix):
    return matrix.toarray() if sparse.issparse(matrix) else np.asarray(matrix)


@pytest.mark.parametrize("laws", LAWS)
@pytest.mark.parametrize("form", FORMS)
def test_products_are_adjoint_and_equal_finite_differences(form, laws):
    strict = 0
    for seed in range(12):
        arguments = random_problem(seed, 8, form, laws, bodies=6)
        problem = lcpbench.Problem(**arguments)
        derivative = lcpbench.derivative(problem, lcpbench.solve(**arguments, tolerance=1e-12))
        random = np.random.default_rng(seed)
        change = random_change(arguments, random)
        df, dw = found = jvp(derivative, change)
        assert found.status == "solved", found.detail
        assert derivative.strictly_complementary and derivative.f_unique and derivative.forces == "unique"
        f_bar, w_bar = random.normal(size=(2, 8))
        gradient = derivative.vjp(f_bar=f_bar, w_bar=w_bar)
        along = sum((dense(getattr(gradient, name)) * dense(by)).sum() for name, by in change.items())
        assert along == pytest.approx(f_bar @ df + w_bar @ dw, rel=1e-10)
        step = 1e-7
        sides = [lcpbench.solve(**moved(arguments, change, sign * step), tolerance=1e-12) for sign in (-1, 1)]
        difference = (sides[1].f - sides[0].f) / (2 * step)
        if np.abs(difference - df).max() <= 1e-5 * (1 + np.abs(df).max()):  # no row changes its mode in between
            assert (sides[1].w - sides[0].w) / (2 * step) == pytest.approx(dw, abs=1e-5 * (1 + np.abs(dw).max()))
            strict += 1
    assert strict >= 10


def test_a_degenerate_point_has_two_sides():
    # A body of 1 kg that lies on the ground without weight: pushed down it is carried, lifted it leaves.
    problem = lcpbench.Problem([[1.0]], [0.0])
    derivative = lcpbench.derivative(problem, [0.0])
    assert not derivative.strictly_complementary and derivative.degenerate.tolist() == [True]
    for db, expected in ((-1, (1, 0)), (1, (0, 1))):
        df, dw = derivative.jvp(db=[db])
        assert (df[0], dw[0]) == expected
    assert derivative.vjp(f_bar=[1.0]).b == 0  # that of the open contact


def test_forces_that_are_not_unique_are_those_of_least_norm():
    problem = lcpbench.Problem(np.ones((2, 2)), [-2.0, -2.0], symmetric=True, positive_semidefinite=True)
    derivative = lcpbench.derivative(problem, [0.5, 1.5])
    assert derivative.forces == "least-norm" and not derivative.f_unique
    assert derivative.f == pytest.approx([1, 1])
    df, _ = derivative.jvp(db=[-1, -1])
    assert df == pytest.approx([0.5, 0.5])
    jump = derivative.jvp(db=[0, 3])
    assert np.isnan(jump.f).all() and jump.w == pytest.approx([0, 3]) and "jumps" in jump.detail


@pytest.mark.parametrize("arguments, name", [({"db": [1.0]}, "db"), ({"dA": np.ones((2, 3))}, "dA"),
                                             ({"dJ": np.ones((2, 2))}, "J"), ({"dmu": [0.1]}, "dmu")])
def test_refusals_name_the_argument(arguments, name):
    derivative = lcpbench.derivative(lcpbench.Problem(np.eye(2), [-1.0, 1.0]), [1.0, 0.0])
    with pytest.raises(ValueError, match=name):
        derivative.jvp(**arguments)
    with pytest.raises(ValueError, match="w_bar"):
        derivative.vjp(w_bar=[1.0])
    with pytest.raises(ValueError, match="J"):
        derivative.vjp(w_bar=[1.0, 0.0]).J


@settings(deadline=None, max_examples=300)
@given(given=st.dictionaries(st.sampled_from(["dA", "dJ", "dinverse_mass", "db", "dmu"]), ANYTHING, min_size=1))
def test_jvp_answers_or_says_what_is_wrong(given):
    problem = lcpbench.Problem(J=np.eye(2), inverse_mass=np.ones(2), b=[-1.0, 0.0])
    try:
        assert lcpbench.derivative(problem, [1.0, 0.0]).jvp(**given).f.shape == (2,)
    except (ValueError, TypeError) as error:
        assert str(error)


def test_forces_that_do_not_solve_are_refused():
    with pytest.raises(ValueError, match="rho"):
        lcpbench.derivative(lcpbench.Problem(np.eye(2), [-1.0, 1.0]), [0.5, 0.0])
