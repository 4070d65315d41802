"""StepSolver: single steps, batches, output arrays."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse

import lcpbench


def random_step(seed, rows, columns_per_body=3, bodies=None):
    random = np.random.default_rng(seed)
    bodies = bodies or 2 + rows // 2
    first = random.integers(0, bodies, rows)
    body = np.stack([first, (first + random.integers(1, bodies, rows)) % bodies], 1).astype(np.int32)
    body[random.random(rows) < 0.2, 1] = -1
    J = random.normal(size=(rows, 2 * columns_per_body))
    J[body[:, 1] < 0, columns_per_body:] = 0
    return body, J, random.normal(size=rows), random.uniform(0.1, 3, (bodies, columns_per_body))


def as_factors(body, J, b, inverse_mass):
    rows, columns_per_body = len(b), inverse_mass.shape[1]
    side = body.repeat(columns_per_body, 1)
    column = columns_per_body * side + np.tile(np.arange(columns_per_body), 2)
    there = side >= 0
    row = np.arange(rows)[:, None].repeat(2 * columns_per_body, 1)
    matrix = sparse.csr_matrix((J[there], (row[there], column[there])), shape=(rows, inverse_mass.size))
    return lcpbench.Problem(J=matrix, inverse_mass=inverse_mass.ravel(), b=b, columns_per_body=columns_per_body)


@settings(deadline=None, max_examples=60)
@given(seed=st.integers(0, 2**32 - 1), rows=st.integers(1, 60), columns=st.sampled_from([3, 6]))
def test_a_step_is_the_problem_of_its_rows(seed, rows, columns):
    arrays = random_step(seed, rows, columns)
    problem = as_factors(*arrays)
    answer = lcpbench.StepSolver().solve(*arrays)
    judged = lcpbench.verify(problem, answer.f, status=answer.status)
    assert not judged.false_success
    assert answer.status == lcpbench.solve(problem).status


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 2**32 - 1), rows=st.integers(1, 40))
def test_arrays_are_written_in_place(seed, rows):
    arrays = random_step(seed, rows)
    step = lcpbench.StepSolver()
    alone = step.solve(*arrays).f
    f, w = np.full(rows, np.nan), np.full(rows, np.nan)
    answer = step.solve(*arrays, f=f, w=w)
    assert answer.f is f and f.tobytes() == alone.tobytes()
    np.testing.assert_allclose(w, lcpbench.solve(as_factors(*arrays)).w, atol=1e-7 * (1 + np.abs(arrays[2]).max()))
    again = step.solve(*arrays, initial_f=f, f=f)  # a warm start in the output's own array
    assert again.f is f and again.status == answer.status


def test_single_precision_and_layouts_are_taken():
    body, J, b, inverse_mass = random_step(3, 12)
    J = J.astype(np.float32)
    f = lcpbench.StepSolver().solve(body, J, b, inverse_mass).f
    for other in ((body.astype(np.int64), J), (np.asfortranarray(body), J.reshape(-1, 2, 3)), (body.tolist(), J.astype(float))):
        assert lcpbench.StepSolver().solve(*other, b, inverse_mass).f.tobytes() == f.tobytes()


@settings(deadline=None, max_examples=20)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 60))
def test_a_batch_is_its_problems(seed, count):
    random = np.random.default_rng(seed)
    parts = [random_step(int(random.integers(2**32)), int(random.integers(1, 12))) for _ in range(count)]
    first = np.cumsum([0] + [len(part[3]) for part in parts])
    body = np.concatenate([np.where(part[0] < 0, -1, part[0] + offset) for part, offset in zip(parts, first)])
    arrays = [body.astype(np.int32)] + [np.concatenate([part[k] for part in parts]) for k in (1, 2, 3)]
    starts = np.cumsum([0] + [len(part[2]) for part in parts])
    batch = lcpbench.StepSolver(threads=2).solve_batch(*arrays, starts)
    assert lcpbench.solve_batch(*arrays, starts).f.tobytes() == batch.f.tobytes()
    assert len(batch) == count and batch.solved.dtype == bool and batch.rho.shape == batch.iterations.shape == (count,)
    assert batch.solved.tolist() == [status == "solved" for status in batch.status]
    for k, part in enumerate(parts):
        judged = lcpbench.verify(as_factors(*part), batch.f[starts[k] : starts[k + 1]], status=batch.status[k])
        assert not judged.false_success


def test_a_batch_with_friction_is_its_steps():
    random = np.random.default_rng(5)
    parts, laws, at = [], {"row": [], "normal": [], "mu": []}, 0
    for _ in range(20):
        body, J, b, inverse_mass = random_step(int(random.integers(2**32)), 2 * int(random.integers(1, 6)))
        own = {"row": np.arange(1, len(b), 2), "normal": np.arange(0, len(b), 2),
               "mu": random.uniform(0, 1, len(b) // 2)}
        parts.append((body, J, b, inverse_mass, own))
        laws = {"row": np.append(laws["row"], own["row"] + at), "normal": np.append(laws["normal"], own["normal"] + at),
                "mu": np.append(laws["mu"], own["mu"])}
        at += len(b)
    shift = np.cumsum([0] + [len(part[3]) for part in parts])
    body = np.concatenate([np.where(part[0] < 0, -1, part[0] + k) for part, k in zip(parts, shift)]).astype(np.int32)
    arrays = [body] + [np.concatenate([part[k] for part in parts]) for k in (1, 2, 3)]
    starts = np.cumsum([0] + [len(part[2]) for part in parts])
    friction = {"row": laws["row"].astype(int), "normal": laws["normal"].astype(int), "mu": laws["mu"]}
    batch = lcpbench.solve_batch(*arrays, starts, friction=friction, threads=2)
    for k, (*step, own) in enumerate(parts):
        alone = lcpbench.StepSolver().solve(*step, friction=own)
        assert alone.f.tobytes() == batch.f[starts[k] : starts[k + 1]].tobytes() and alone.status == batch.status[k]


def test_friction_holds_in_a_step():
    body, J = [[0, -1], [0, -1]], [[0.0, 1, 0, 0, 0, 0], [1.0, 0, 0, 0, 0, 0]]
    friction = {"row": [1], "normal": [0], "mu": [0.5]}
    answer = lcpbench.StepSolver().solve(body, J, [-10.0, 4.0], np.ones((1, 3)), friction=friction)
    np.testing.assert_allclose(answer.f, [10, -4], rtol=1e-8)


@pytest.mark.parametrize("change, name", [
    ({"body": [[0, 9]] * 4}, "body"),
    ({"body": [[0, 1]] * 3}, "body"),
    ({"J": np.ones((4, 5))}, "J"),
    ({"b": [0, 0, 0, np.nan]}, "b"),
    ({"inverse_mass": np.ones(4)}, "inverse_mass"),
    ({"inverse_mass": -np.ones((4, 3))}, "inverse_mass"),
    ({"initial_f": [1.0]}, "initial_f"),
    ({"f": np.ones(3)}, "f"),
    ({"f": [0.0] * 4}, "f"),
    ({"f": np.ones(8)[::2]}, "f"),
    ({"w": np.ones(4, np.float32)}, "w"),
])
def test_what_is_wrong_is_named(change, name):
    arguments = dict(zip(("body", "J", "b", "inverse_mass"), random_step(1, 4))) | change
    with pytest.raises(ValueError, match=rf"\b{name.replace('_', '.')}\b"):
        lcpbench.StepSolver().solve(**arguments)


def test_starts_are_checked():
    with pytest.raises(ValueError, match="^starts"):
        lcpbench.solve_batch(*random_step(1, 4), [0, 3])


def _apart(n, names):
    """Arrays of one memory, each a number after the one before, so that neighbours overlap."""
    memory = np.zeros(n + len(names))
    return {name: memory[k:k + n] for k, name in enumerate(names)}


@pytest.mark.parametrize("change, name", [
    (lambda a: {"f": (f := np.zeros(4)), "w": f}, "w"),
    (lambda a: _apart(4, ["f", "w"]), "w"),
    (lambda a: {"f": a["b"]}, "f"),
    (lambda a: {"w": a["b"]}, "w"),
    (lambda a: {"f": a["J"].reshape(-1)[2:6]}, "f"),
    (lambda a: {"w": a["J"].reshape(-1)[-4:]}, "w"),
    (lambda a: {"f": a["inverse_mass"].reshape(-1)[:4]}, "f"),
    (lambda a: {"f": a["body"].view(float).reshape(-1)}, "f"),
    (lambda a: {"f": (flags := np.zeros(4)), "bilateral": flags.view(bool)[8:12]}, "f"),
    (lambda a: {"w": (w := np.zeros(4)), "initial_f": w}, "w"),
    (lambda a: _apart(4, ["f", "initial_f"]), "f"),
    (lambda a: _apart(4, ["initial_f", "f"]), "f"),
])
def test_what_is_written_is_nothing_else(change, name):
    arguments = dict(zip(("body", "J", "b", "inverse_mass"), random_step(1, 4)))
    arguments |= change(arguments)
    with pytest.raises(ValueError, match=f"^{name}: shares memory with"):
        lcpbench.StepSolver().solve(**arguments)


def test_a_batch_does_not_write_what_it_reads():
    body, J, b, inverse_mass = random_step(1, 4)
    starts = np.array([0, 4, 0, 0, 0, 0, 0, 0], np.int32)
    for f, other in ((b, "b"), (J.reshape(-1)[:4], "J"), (starts.view(float), "starts")):
        with pytest.raises(ValueError, match=f"^f: shares memory with {other}"):
            lcpbench.solve_batch(body, J, b, inverse_mass, starts[:2], f=f)


def test_neighbours_in_one_memory_are_taken():
    arguments = random_step(1, 4)
    memory = np.zeros(12)
    memory[8:] = arguments[2]
    alone = lcpbench.StepSolver().solve(*arguments)
    f = lcpbench.StepSolver().solve(*arguments[:2], memory[8:], arguments[3], f=memory[:4], w=memory[4:8]).f
    assert f.tobytes() == alone.f.tobytes()
