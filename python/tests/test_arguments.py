"""Whatever a caller passes ends in a result, or in an error that says what is wrong."""

import collections
import types

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


ANYTHING = st.one_of(st.none(), _NUMBERS, st.text(max_size=3), st.lists(_NUMBERS, max_size=4), _arrays(), _sparse(),
                      st.dictionaries(st.sampled_from(["row", "normal", "mu", "slip", "lower", "upper"]),
                                      st.lists(_NUMBERS, max_size=3)))
_ARGUMENTS = ("A", "b", "J", "inverse_mass", "bilateral", "friction", "bounded", "initial_f", "tolerance", "time_limit",
              "solver", "max_iterations")


@settings(deadline=None, max_examples=600)
@given(given=st.dictionaries(st.sampled_from(_ARGUMENTS), ANYTHING), rows=st.integers(0, 4))
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
                                              "initial_f", "f", "w"]), ANYTHING), rows=st.integers(0, 4))
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


def _step(change):
    body, J = np.array([[0, -1], [1, -1]], np.int32), np.eye(2, 6)
    arguments = {"body": body, "J": J, "b": np.array([-1.0, -2]), "inverse_mass": np.ones((2, 3))} | change
    return lcpbench.StepSolver().solve(**arguments)


# Calls that take friction=, bounded= and the like.
CALLS = {
    "solve": lambda **laws: lcpbench.solve(np.eye(2), [-1.0, -5], **laws),
    "Problem": lambda **laws: lcpbench.Problem(np.eye(2), [-1.0, -5], **laws),
    "StepSolver": lambda **laws: _step(laws),
    "solve_batch": lambda **laws: lcpbench.solve_batch([[0, -1], [1, -1]], np.eye(2, 6), [-1.0, -2], np.ones((2, 3)),
                                                       [0, 2], **laws),
}


@pytest.mark.parametrize("call", CALLS.values(), ids=CALLS)
@pytest.mark.parametrize("law, members", [
    ("friction", {"row": [1], "normal": [0], "mu": [0.5], "slp": [1]}),
    ("friction", types.MappingProxyType({"row": [1], "normal": [0], "mu": [0.5], "Slip": None})),
    ("friction", {"row": [1], "normal": [0], "mu": [0.5], 3: [1]}),
    ("bounded", {"row": [1], "lower": [0], "upper": [1], "uper": [2]}),
    ("bounded", collections.UserDict({"row": [1], "lower": [0], "upper": [1], "mu": [2]})),
])
def test_unknown_members_are_named_with_the_known(call, law, members):
    stranger = list(members)[-1]
    known = {"friction": "row, normal, mu, slip", "bounded": "row, lower, upper"}[law]
    with pytest.raises(ValueError, match=f"^{law}: has an unknown member '{stranger}', known are {known}$"):
        call(**{law: members})
    call(**{law: {name: of for name, of in members.items() if name != stranger}})


@pytest.mark.parametrize("call", CALLS.values(), ids=CALLS)
def test_bilateral_has_one_meaning(call):
    def result(bilateral):
        of = call(bilateral=bilateral)
        return lcpbench.solve(of).f.tolist() if isinstance(of, lcpbench.Problem) else of.f.tolist()

    for rows, mask in (([0, 1], [True, True]), ([1], [False, True]), ([0], [True, False]), ([], [False, False])):
        for kind in (np.int64, np.int32, np.uint8):
            assert result(np.array(rows, kind)) == result(mask) == result(np.array(mask))
        assert result(rows) == result(mask)
    for wrong in ([2], [-1], [0, 0], [True], [0.5]):
        with pytest.raises(ValueError, match="^bilateral"):
            call(bilateral=wrong)


def _masked(values, dtype=float):
    values = np.asarray(values, dtype)
    return np.ma.masked_array(values, np.arange(values.size).reshape(values.shape) == values.size - 1)


_FRICTION, _BOUNDED = {"row": [1], "normal": [0], "mu": [0.5]}, {"row": [1], "lower": [0.0], "upper": [1.0]}
_B, _EYE = [-1.0, -2], np.eye(2)


@pytest.mark.parametrize("call, name", [
    (lambda of: lcpbench.solve(of(_EYE), _B), "A"),
    (lambda of: lcpbench.solve([of(row) for row in _EYE], _B), "A"),
    (lambda of: lcpbench.solve(of(np.eye(2, dtype=np.int64), int), _B), "A"),
    (lambda of: lcpbench.solve(_EYE, of(_B)), "b"),
    (lambda of: lcpbench.Problem(_EYE, of(_B)), "b"),
    (lambda of: lcpbench.solve(J=of(_EYE), b=_B, inverse_mass=[1, 1]), "J"),
    (lambda of: lcpbench.solve(J=_EYE, b=_B, inverse_mass=of([1, 1])), "inverse_mass"),
    (lambda of: lcpbench.solve(_EYE, _B, bilateral=of([0, 1], int)), "bilateral"),
    (lambda of: lcpbench.solve(_EYE, _B, bilateral=of([False, True], bool)), "bilateral"),
    (lambda of: lcpbench.solve(_EYE, _B, initial_f=of(_B)), "initial_f"),
    (lambda of: lcpbench.verify(lcpbench.Problem(_EYE, _B), of([1.0, 2])), "f"),
    (lambda of: lcpbench.verify(lcpbench.Problem(_EYE, _B), [1.0, 2], ray=of([1.0, 2])), "ray"),
    (lambda of: _derivative().jvp(db=of(_B)), "db"),
    (lambda of: _derivative().jvp(dA=of(_EYE)), "dA"),
    (lambda of: _derivative().vjp(f_bar=of(_B)), "f_bar"),
    (lambda of: lcpbench.derivative(lcpbench.Problem(_EYE, _B), of([1.0, 2])), "result"),
    (lambda of: _step({"body": of([[0, -1], [1, -1]], np.int32)}), "body"),
    (lambda of: _step({"J": of(np.eye(2, 6), np.float32)}), "J"),
    (lambda of: _step({"b": of(_B)}), "b"),
    (lambda of: _step({"f": of(_B)}), "f"),
    (lambda of: _step({"w": of(_B)}), "w"),
    (lambda of: _step({"initial_f": of(_B)}), "initial_f"),
    (lambda of: _step({"bilateral": of([False, True], bool)}), "bilateral"),
    (lambda of: lcpbench.generate("boxes-and-discs", size=4).replace(forces=of(
        lcpbench.generate("boxes-and-discs", size=4).forces)), "forces"),
    *[(lambda of, law=law, name=name, base=base: lcpbench.solve(
        _EYE, _B, **{law: base | {name: of(base[name], np.asarray(base[name]).dtype)}}), f"{law}.{name}")
      for law, base in (("friction", _FRICTION | {"slip": [1]}), ("bounded", _BOUNDED)) for name in base],
])
def test_masked_entries_are_missing(call, name):
    with pytest.raises(ValueError, match=f"^{name}: has masked entries"):
        call(_masked)
    call(lambda values, dtype=float: np.ma.masked_array(np.asarray(values, dtype)))  # none is masked


def _derivative():
    problem = lcpbench.Problem(_EYE, _B)
    return lcpbench.derivative(problem, lcpbench.solve(problem))


def _parts(matrix, kind, seed=1):
    """The matrix in CSR or CSC with every entry in three parts, in any order."""
    random = np.random.default_rng(seed)
    whole = kind(matrix)
    starts, indices, data = [0], [], []
    for k in range(len(whole.indptr) - 1):
        piece = slice(whole.indptr[k], whole.indptr[k + 1])
        places = np.tile(whole.indices[piece], 3)
        values = np.concatenate([whole.data[piece] / 4, whole.data[piece] / 4, whole.data[piece] / 2])
        order = random.permutation(len(places))
        indices += places[order].tolist()
        data += values[order].tolist()
        starts.append(len(indices))
    return kind((data, indices, starts), shape=whole.shape)


@pytest.mark.parametrize("kind", [sparse.csr_matrix, sparse.csc_matrix, sparse.csr_array, sparse.csc_array])
def test_entries_in_parts_are_their_sum(kind):
    matrix = np.array([[4.0, 1, 0], [1, 3, 0.5], [0, 0.5, 2]])
    b, mass = [-1.0, -2, 1], [1.0, 2, 3]
    given = _parts(matrix, kind)
    before = given.data.copy(), given.indices.copy()
    assert lcpbench.Problem(given, b).sparse_A.toarray().tolist() == matrix.tolist()
    assert lcpbench.solve(given, b).f.tolist() == lcpbench.solve(kind(matrix), b).f.tolist()
    assert lcpbench.solve(J=given, b=b, inverse_mass=mass).f.tolist() == \
        lcpbench.solve(J=kind(matrix), b=b, inverse_mass=mass).f.tolist()
    assert (given.data == before[0]).all() and (given.indices == before[1]).all()
    problem = lcpbench.Problem(J=matrix, b=b, inverse_mass=mass)
    derivative = lcpbench.derivative(problem, lcpbench.solve(problem))
    assert derivative.jvp(dJ=given).f.tolist() == derivative.jvp(dJ=matrix).f.tolist()
    problem = lcpbench.Problem(matrix, b)
    derivative = lcpbench.derivative(problem, lcpbench.solve(problem))
    assert derivative.jvp(dA=given).f.tolist() == derivative.jvp(dA=matrix).f.tolist()


def test_parts_that_cancel_leave_zero():
    A = sparse.csr_array(([2.0, 5, -5, 3], [0, 1, 1, 1], [0, 3, 4]), shape=(2, 2))
    assert lcpbench.solve(A, [-2.0, -3]).f.tolist() == [1, 1]


@pytest.mark.parametrize("call, name", [
    (lambda of: lcpbench.solve(of, _B), "A"),
    (lambda of: lcpbench.Problem(of, _B), "A"),
    (lambda of: lcpbench.solve(J=of, b=_B, inverse_mass=[1, 1]), "J"),
    (lambda of: _derivative().jvp(dA=of), "dA"),
    (lambda of: _derivative().jvp(dJ=of), "dJ"),
])
def test_sparse_arrays_of_one_dimension_are_refused(call, name):
    for of in (sparse.coo_array([1.0, 2]), sparse.coo_array([1.0, 2]).tocsr()):
        with pytest.raises(ValueError, match=f"^{name}: expected two dimensions, found 1"):
            call(of)


_NEARLY = np.array([[4, 1 + 2**-52], [1, 3]])


def test_a_small_asymmetry_is_made_0_where_asked():
    mean = np.full((2, 2), 0.5 * (1 + 2**-52) + 0.5)
    mean[0, 0], mean[1, 1] = 4, 3
    for form in (np.asarray, np.asfortranarray, sparse.csr_array, sparse.csc_array):
        given = form(_NEARLY)
        assert lcpbench.Problem(given, _B, symmetrize=1e-15).A.tolist() == mean.tolist()
        assert lcpbench.solve(given, _B, symmetrize=1e-15).problem.A.tolist() == mean.tolist()
        problem = lcpbench.Problem(given, _B)
        assert lcpbench.solve(problem, symmetrize=1e-15).problem.A.tolist() == mean.tolist()
        solver = lcpbench.Solver()
        solver.setup(problem, symmetrize=1e-15)
        assert solver.solve().problem.A.tolist() == mean.tolist()
        exact = lcpbench.certify(lcpbench.Problem(mean, _B))
        assert lcpbench.certify(problem, symmetrize=1e-15).f == exact.f
        assert lcpbench.certify(lcpbench.Problem(given, _B, symmetrize=1e-15)).f == exact.f
        of_mean = lcpbench.derivative(lcpbench.Problem(mean, _B), lcpbench.solve(mean, _B))
        assert lcpbench.derivative(problem, lcpbench.solve(mean, _B), symmetrize=1e-15).w.tolist() == of_mean.w.tolist()
        with pytest.raises(ValueError, match=r"^problem: A has an asymmetry of 6\.41e-17, .*symmetrize="):
            lcpbench.certify(problem)
    assert lcpbench.Problem(_NEARLY, _B, symmetric=True, positive_semidefinite=True, symmetrize=0.1).A[0, 1] == mean[0, 1]
    assert lcpbench.solve(lcpbench.Problem(_NEARLY, _B, symmetric=True, positive_semidefinite=True,
                                           symmetrize=0.1)).f_unique
    factors = lcpbench.Problem(J=_NEARLY, b=_B, inverse_mass=[1, 1], symmetrize=0)
    assert factors.form == "factors"


@pytest.mark.parametrize("call", [
    lambda **options: lcpbench.Problem([[2, 1], [0, 2]], _B, **options),
    lambda **options: lcpbench.solve([[2, 1], [0, 2]], _B, **options),
    lambda **options: lcpbench.Solver().setup(lcpbench.Problem([[2, 1], [0, 2]], _B), **options),
    lambda **options: lcpbench.certify(lcpbench.Problem([[2, 1], [0, 2]], _B), **options),
    lambda **options: lcpbench.derivative(lcpbench.Problem([[2, 1], [0, 2]], _B), [0, 1.0], **options),
])
def test_a_large_asymmetry_is_refused_with_its_size(call):
    with pytest.raises(ValueError, match="^symmetrize: A has an asymmetry of 0.5, expected at most 0.1"):
        call(symmetrize=0.1)
    for wrong in (-1, float("nan"), "a"):
        with pytest.raises(ValueError, match="^symmetrize"):
            call(symmetrize=wrong)


def test_a_statement_of_symmetry_that_does_not_hold_says_by_how_much():
    with pytest.raises(ValueError, match="^symmetric: A has an asymmetry of 0.5, .*symmetrize="):
        lcpbench.Problem([[2, 1], [0, 2]], _B, symmetric=True)


def test_no_message_begins_with_an_empty_name():
    with pytest.raises(ValueError, match="^expected at most 4000 rows"):
        lcpbench.certify(lcpbench.Problem(sparse.eye(4001, format="csr"), np.zeros(4001)))
