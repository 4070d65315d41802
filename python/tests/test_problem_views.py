"""What a problem shows of itself is what it was made of."""

import lcpbench
import numpy as np
import pytest
import scipy.sparse
from hypothesis import given
from hypothesis import strategies as st


@given(st.integers(0, 10**6), st.integers(1, 8), st.sampled_from(["dense", "sparse", "factors"]))
def test_a_problem_made_of_its_views_is_the_same(seed, n, form):
    random = np.random.default_rng(seed)
    contacts = n // 3
    kinds = {"bilateral": random.random(n) < 0.3}
    kinds["bilateral"][:2 * contacts] = False
    kinds["friction"] = {"row": np.arange(1, 2 * contacts, 2), "normal": np.arange(0, 2 * contacts, 2),
                         "mu": random.uniform(0, 1, contacts), "slip": random.integers(-1, 2, contacts)}
    last = np.array([n - 1]) if n > 2 * contacts and not kinds["bilateral"][-1] else np.empty(0, int)
    kinds["bounded"] = {"row": last, "lower": -random.random(len(last)), "upper": np.full(len(last), np.inf)}
    J = scipy.sparse.random_array((n, 6), density=0.5, rng=random, format="csr")
    mass = random.uniform(0, 2, 6)
    A = J.toarray() @ np.diag(mass) @ J.toarray().T
    b = random.normal(size=n)
    given_as = {"dense": {"A": A}, "sparse": {"A": scipy.sparse.csr_array(A)},
                "factors": {"J": J, "inverse_mass": mass}}[form]
    problem = lcpbench.Problem(b=b, **given_as, **kinds)
    np.testing.assert_allclose(problem.A, A, atol=1e-14)
    assert np.array_equal(problem.sparse_A.toarray(), problem.A)
    assert np.array_equal(problem.bilateral, kinds["bilateral"])
    for kind in ("friction", "bounded"):
        shown = getattr(problem, kind)
        assert (shown is None) == (len(kinds[kind]["row"]) == 0)
        assert shown is None or all(np.array_equal(shown[key], kinds[kind][key]) for key in kinds[kind])
    if form == "factors":
        assert np.array_equal(problem.J.toarray(), J.toarray()) and np.array_equal(problem.inverse_mass, mass)
    else:
        assert problem.J is None and problem.inverse_mass is None


def test_views_are_read_only_and_outlive_the_problem():
    problem = lcpbench.Problem(np.eye(3), np.ones(3))
    A, rows = problem.A, problem.sparse_A
    with pytest.raises(ValueError):
        A[0, 0] = 2
    del problem
    assert np.array_equal(A, np.eye(3)) and np.array_equal(rows.toarray(), np.eye(3))
