"""Whatever a caller passes ends in a result, or in an error that says what is wrong."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse

import lcpbench

_NUMBERS = st.one_of(st.integers(-3, 3), st.floats(width=64), st.just(2**70))
_SHAPES = st.lists(st.integers(0, 4), max_size=3).map(tuple)


@st.composite
def _arrays(draw):
    kind = draw(st.sampled_from(["f8", "f4", ">f8", "i8", "i4", "u1", "?", "c16", "O", "U3"]))
    return np.full(draw(_SHAPES), draw(st.sampled_from([0, 1, 2])), kind)


@st.composite
def _sparse(draw):
    rows, columns = draw(st.integers(0, 4)), draw(st.integers(0, 4))
    matrix = sparse.random(rows, columns, 0.5, draw(st.sampled_from(["csr", "csc", "coo", "lil"])), random_state=1)
    if matrix.format == "csr" and draw(st.booleans()):
        matrix.indices = draw(st.sampled_from([matrix.indices - 1, matrix.indices + 3, matrix.indices[:1]]))
    if matrix.format == "csc" and draw(st.booleans()):
        matrix.indptr = draw(st.sampled_from([matrix.indptr[::-1].copy(), matrix.indptr * 7 - 1, matrix.indptr[:-1]]))
    return matrix


_ANYTHING = st.one_of(st.none(), _NUMBERS, st.text(max_size=3), st.lists(_NUMBERS, max_size=4), _arrays(), _sparse(),
                      st.dictionaries(st.sampled_from(["row", "normal", "mu", "slip", "lower", "upper"]),
                                      st.lists(_NUMBERS, max_size=3)))
_ARGUMENTS = ("A", "b", "J", "inverse_mass", "bilateral", "friction", "bounded", "initial_f", "tolerance", "time_limit",
              "solver", "max_iterations")


@settings(deadline=None, max_examples=600)
@given(given=st.dictionaries(st.sampled_from(_ARGUMENTS), _ANYTHING), rows=st.integers(0, 4))
def test_solve_answers_or_says_what_is_wrong(given, rows):
    arguments = {"b": -np.ones(rows)} | ({} if "J" in given else {"A": np.eye(rows)}) | given
    try:
        result = lcpbench.solve(**arguments)
    except (ValueError, TypeError) as error:
        assert str(error)
    else:
        assert result.f.shape == result.w.shape and result.verdict.rho is not None


@settings(deadline=None, max_examples=400)
@given(given=st.dictionaries(st.sampled_from(["body", "J", "b", "inverse_mass", "bilateral", "friction", "bounded",
                                              "initial_f", "f", "w"]), _ANYTHING), rows=st.integers(0, 4))
def test_a_step_answers_or_says_what_is_wrong(given, rows):
    arguments = {"body": np.zeros((rows, 2), np.int32), "J": np.ones((rows, 6)), "b": -np.ones(rows),
                 "inverse_mass": np.ones((1, 3))} | given
    try:
        assert lcpbench.StepSolver().solve(**arguments).f.shape[0] >= 0
    except (ValueError, TypeError) as error:
        assert str(error)


def test_members_of_objects_are_taken_as_those_of_dicts():
    class Friction:
        row, normal, mu = [1], [0], [0.5]

    f = lcpbench.solve(np.eye(2), [-10.0, 8.0], friction=Friction()).f
    np.testing.assert_allclose(f, [10, -5], rtol=1e-9)
    with pytest.raises(ValueError, match="friction: lacks 'row'"):
        lcpbench.solve(np.eye(2), [-10.0, 8.0], friction=3)
