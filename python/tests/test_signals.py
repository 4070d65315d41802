"""Ctrl-C ends every long call soon, and what was called works afterwards."""

import gc
import os
import signal
import threading
import time

import numpy as np
import pytest
from problems import random_problem

import lcpbench

LATE = 1.0  # s; 0.1 s where the machine has nothing else to do


@pytest.fixture(autouse=True)
def no_collections():
    """Hypothesis has a callback of the collector; Python ignores what a signal's handler raises within one."""
    gc.disable()
    yield
    gc.enable()


def interrupted(call, after=0.3):
    """Calls, sends SIGINT in a while, and returns how long after it KeyboardInterrupt came [s]."""
    sent = []

    def send():
        sent.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(after, send)
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            call()
            pytest.fail("the call ended before the signal")
        return time.perf_counter() - sent[0]
    finally:
        timer.cancel()
        timer.join()


def dense(n, rank, seed=1, with_friction=False):
    X = np.random.default_rng(seed).normal(size=(n, rank))
    tangent = np.arange(1, n, 2)
    friction = {"row": tangent, "normal": tangent - 1, "mu": np.full(len(tangent), 0.5)} if with_friction else None
    return lcpbench.Problem(X @ X.T / rank, np.random.default_rng(seed).normal(size=n), friction=friction)


@pytest.fixture(scope="module")
def stack():
    return lcpbench.generate("tall-stacks", size=4000).problem


@pytest.mark.parametrize("solver, options", [
    ("pgs", {}), ("pgs", {"time_limit": 60}), ("psor", {}), ("nncg", {}), ("apgd", {})])
def test_solve_is_interrupted(stack, solver, options):
    def call():
        lcpbench.solve(stack, solver=solver, tolerance=1e-15, max_iterations=10**9, **options)

    assert interrupted(call) < LATE


@pytest.mark.parametrize("solver", ["auto", "dantzig", "lemke", "bpp", "active-set", "semismooth-newton",
                                    "ipm", "ipopt-qp", "mode-newton", "shift", "hybrid"])
def test_every_method_is_interrupted(solver):
    if solver not in [entry.key for entry in lcpbench.available_solvers()]:
        pytest.skip("not in this build")
    is_for_friction = solver in ("mode-newton", "shift")
    problem, small = (dense(n, n, with_friction=is_for_friction) for n in (2500, 30))
    before = lcpbench.solve(small, solver=solver).f

    def call():  # some are fast
        for _ in range(1000):
            lcpbench.solve(problem, solver=solver)

    assert interrupted(call) < LATE
    assert lcpbench.solve(small, solver=solver).f.tobytes() == before.tobytes()


def test_a_solver_object_works_afterwards(stack):
    solver = lcpbench.Solver("pgs", tolerance=1e-15, max_iterations=10**9)
    solver.setup(stack)
    assert interrupted(solver.solve) < LATE
    small = dense(30, 30)
    solver.setup(small)
    assert solver.solve().f.tobytes() == lcpbench.solve(small, solver="pgs", tolerance=1e-15,
                                                        max_iterations=10**9).f.tobytes()


def steps(count, rows, seed=1):
    """`count` piles of one body each, with as many contacts on it as there are rows."""
    random = np.random.default_rng(seed)
    n = count * rows
    body = np.stack([np.repeat(np.arange(count), rows), np.full(n, -1)], 1).astype(np.int32)
    return body, random.normal(size=(n, 6)), random.normal(size=n) - 1, random.uniform(0.5, 2, (count, 3))


@pytest.mark.parametrize("threads", [1, 2])
def test_batches_are_interrupted(threads):
    arrays = steps(20000, 20)
    starts = np.arange(0, len(arrays[2]) + 1, 20, dtype=np.int32)
    tangent = np.arange(1, len(arrays[2]), 2)
    friction = {"row": tangent, "normal": tangent - 1, "mu": np.full(len(tangent), 0.5)}
    solver = lcpbench.StepSolver(threads=threads, tolerance=1e-12)
    part, few = [array[:160] if len(array) > 20000 else array for array in arrays], starts[:9]
    before = solver.solve_batch(*part, few).f
    for laws in ({}, {"friction": friction}):
        def call():
            for _ in range(1000):
                solver.solve_batch(*arrays, starts, **laws)

        assert interrupted(call) < LATE
    assert solver.solve_batch(*part, few).f.tobytes() == before.tobytes()


def test_a_step_is_interrupted():
    scene = lcpbench.generate("disc-pile", size=8000)
    J = scene.J.tocsr()
    bodies = J.shape[1] // 3
    body = np.full((J.shape[0], 2), -1, np.int32)
    numbers = np.zeros((J.shape[0], 2, 3))
    for i in range(J.shape[0]):
        columns, values = J.indices[J.indptr[i]:J.indptr[i + 1]], J.data[J.indptr[i]:J.indptr[i + 1]]
        for side, k in enumerate(np.unique(columns // 3)):
            body[i, side] = k
            numbers[i, side, columns[columns // 3 == k] % 3] = values[columns // 3 == k]
    arrays = body, numbers, scene.b, scene.problem.inverse_mass.reshape(bodies, 3)
    solver = lcpbench.StepSolver()
    before = solver.solve(*arrays)

    def call():
        for _ in range(10000):
            solver.solve(*arrays)

    assert interrupted(call) < LATE
    after = solver.solve(*arrays)
    assert after.f.tobytes() == before.f.tobytes() and after.status == before.status


def test_certify_is_interrupted():
    problem = lcpbench.Problem(**random_problem(1, 400, "factors", "plain", bodies=150))
    assert interrupted(lambda: lcpbench.certify(problem)) < LATE
    friction = lcpbench.generate("card-house", size=60, friction=0.5).problem

    def call():
        while True:
            lcpbench.certify(friction)

    assert interrupted(call) < LATE


def test_derivatives_are_interrupted():
    problem = dense(2500, 2000)
    result = lcpbench.solve(problem)
    assert interrupted(lambda: [lcpbench.derivative(problem, result) for _ in range(1000)]) < LATE
    derivative = lcpbench.derivative(problem, result)
    assert interrupted(lambda: [derivative.jvp(db=problem.b) for _ in range(10**6)]) < LATE
    assert interrupted(lambda: [derivative.vjp(f_bar=problem.b) for _ in range(10**6)]) < LATE


@pytest.mark.parametrize("family", ["tall-stacks", "disc-pile"])
def test_scenes_are_interrupted(family):
    assert interrupted(lambda: [lcpbench.generate(family, size=100000) for _ in range(1000)]) < LATE
    scene = lcpbench.generate(family, size=20000)
    assert interrupted(lambda: [scene._core.rows() for _ in range(1000)]) < LATE
    assert interrupted(lambda: [scene.svg(False) for _ in range(1000)]) < LATE
    assert interrupted(lambda: [scene.replace(friction=0) for _ in range(1000)]) < LATE
    assert interrupted(lambda: scene.animation(duration=300)) < LATE


def test_a_worker_is_interrupted(stack):
    keys = [entry.key for entry in lcpbench.available_solvers() if entry.is_peer]
    if "ode-quickstep" not in keys:
        pytest.skip("not in this build")
    with pytest.raises(KeyboardInterrupt):
        threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        for _ in range(10**6):
            lcpbench.solve(stack, solver="ode-quickstep", tolerance=1e-15, max_iterations=10**9)


def test_waiting_for_a_solver_is_interrupted(stack):
    solver = lcpbench.Solver("pgs", tolerance=1e-15, max_iterations=10**9, time_limit=4)
    solver.setup(stack)
    other = threading.Thread(target=solver.solve)
    other.start()
    time.sleep(0.1)
    assert interrupted(solver.solve) < LATE
    other.join()


def test_other_handlers_run_within_a_call(stack):
    small, seen = dense(20, 20), []

    def handler(*_):
        seen.append(lcpbench.solve(small).f.tobytes())  # within the call that it interrupts

    before = signal.signal(signal.SIGALRM, handler)
    signal.setitimer(signal.ITIMER_REAL, 0.2, 0.2)
    try:
        result = lcpbench.solve(stack, solver="pgs", tolerance=1e-15, max_iterations=10**9, time_limit=1.5)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert result.status == "time_limit"
    assert len(seen) >= 4 and set(seen) == {lcpbench.solve(small).f.tobytes()}
