"""certify: answers in fractions."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from problems import random_problem

import lcpbench


def test_a_textbook_problem_in_fractions():
    found = lcpbench.certify(lcpbench.Problem([[2, 1], [1, 2]], [-5, -6]))
    assert found.certified and found.f == [Fraction(4, 3), Fraction(7, 3)] and found.w == [0, 0]
    assert found.f_unique and found.w_unique and found.rank == 2 and found.ray is None


@settings(deadline=None, max_examples=25)
@given(seed=st.integers(0, 2**32 - 1), rows=st.integers(1, 10), laws=st.sampled_from(["plain", "bilateral", "friction"]))
def test_fractions_obey_the_laws_exactly(seed, rows, laws):
    arguments = random_problem(seed, rows, "factors", laws)
    found = lcpbench.certify(lcpbench.Problem(**arguments))
    if found.status != "solved":
        assert found.status in ("infeasible", "unknown")
        return
    J = [[Fraction(value) for value in row] for row in arguments["J"].toarray()]
    mass = [Fraction(value) for value in arguments["inverse_mass"]]
    v = [m * sum(J[i][k] * found.f[i] for i in range(rows)) for k, m in enumerate(mass)]
    w = [sum(a * x for a, x in zip(J[i], v)) + Fraction(b) for i, b in enumerate(arguments["b"])]
    assert found.certified and found.w == w
    joints = arguments.get("bilateral", [False] * rows)
    tangents = dict(zip(arguments["friction"]["row"], arguments["friction"]["mu"])) if laws == "friction" else {}
    for i in range(rows):
        if joints[i]:
            assert w[i] == 0
        elif i in tangents:
            bound = Fraction(tangents[i]) * found.f[i - 1]
            assert abs(found.f[i]) <= bound and (w[i] == 0 or found.f[i] == (-bound if w[i] > 0 else bound))
        else:
            assert found.f[i] >= 0 and w[i] >= 0 and found.f[i] * w[i] == 0


def test_an_infeasible_problem_has_an_exact_ray():
    found = lcpbench.certify(lcpbench.Problem(J=[[1.0], [-1.0]], inverse_mass=[1.0], b=[-1.0, -1.0]))
    assert found.status == "infeasible" and found.certified and sum(found.ray) == 1 and found.f is None


def test_what_cannot_be_certified_is_refused():
    with pytest.raises(ValueError, match="symmetric"):
        lcpbench.certify(lcpbench.Problem([[1, 2], [0, 1]], [1, 1]))
    with pytest.raises(ValueError, match="^time_limit"):
        lcpbench.certify(lcpbench.Problem(np.eye(1), [1]), time_limit=0)
