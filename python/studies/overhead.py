"""What a call from Python costs above the call in C++, from arrays to arrays, by the number of rows, and how much memory
a solve takes at most: the tables of docs/python.md.

    build/python-venv/bin/python python/studies/overhead.py
"""

import ctypes
import statistics
import time

import numpy as np
from scipy import sparse

import lcpbench

ROWS = (1, 3, 10, 30, 100, 300)
LARGE = (10_000, 100_000, 1_000_000)
STACK = 100  # rows of an island that StepSolver solves in place
DENSE = 5000  # rows of a dense A
TRIM = ctypes.CDLL(None).malloc_trim
ROUNDS = 101
ROUND_S = 5e-4


def chain(rows):
    """Rows of a stack of bodies in the plane, as a step and as factors."""
    random = np.random.default_rng(rows)
    body = np.stack([np.arange(rows), np.arange(rows) - 1], 1).astype(np.int32)
    J = random.normal(size=(rows, 2, 3))
    J[0, 1] = 0
    column = (3 * np.maximum(body[:, ::-1], 0)[:, :, None] + np.arange(3)).astype(np.int32)
    starts = np.arange(0, 6 * rows + 1, 6, dtype=np.int32)
    starts[1:] -= 3  # the first body stands on the ground
    factor = sparse.csr_matrix((J[:, ::-1].ravel()[3:], column.ravel()[3:], starts), shape=(rows, 3 * rows))
    return body, J, random.normal(size=rows), random.uniform(0.5, 2, (rows, 3)), factor


def above_solve(call):
    """(C++, above it) of a call [us]: medians of what the result says, and of the rest of the call."""
    inside, above = [], []
    for _ in range(10 * ROUNDS):
        begin = time.perf_counter()
        result = call()
        result.f
        elapsed = time.perf_counter() - begin
        inside.append(result.time)
        above.append(elapsed - result.time)
    return 1e6 * statistics.median(inside), 1e6 * statistics.median(above)


def above_step(body, J, b, inverse_mass):
    """(C++, above it) of StepSolver.solve with a kept output array [us]: medians over rounds of both in turn."""
    step, f = lcpbench.StepSolver(), np.empty(len(b))
    solve = step.solve
    calls = 1 + int(ROUND_S / step._time(body, J, b, inverse_mass, f, 1))
    inside, above = [], []
    for _ in range(ROUNDS):
        of_cxx = step._time(body, J, b, inverse_mass, f, calls) / calls
        begin = time.perf_counter()
        for _ in range(calls):
            solve(body, J, b, inverse_mass, f=f)
        inside.append(of_cxx)
        above.append((time.perf_counter() - begin) / calls - of_cxx)
    return 1e6 * statistics.median(inside), 1e6 * statistics.median(above)


def memory(name):
    """VmRSS or VmHWM of this process [MB]."""
    with open("/proc/self/status", encoding="ascii") as status:
        return next(int(line.split()[1]) / 1024 for line in status if line.startswith(name))


def peak_above(call):
    """What memory a call takes at most beyond what there was [MB]."""
    TRIM(0)  # else what calls before it freed would not count
    with open("/proc/self/clear_refs", "w", encoding="ascii") as reset:
        reset.write("5")
    before = memory("VmRSS")
    kept = call()
    return memory("VmHWM") - before, kept


def times():
    print("| rows | `solve(A, b)` in C++ [µs] | above it | `solve(J=…)` in C++ | above it | `StepSolver.solve` in C++ | "
          "above it |\n|" + " ---: |" * 7)
    for rows in ROWS:
        body, J, b, inverse_mass, factor = chain(rows)
        A = (factor @ sparse.diags(inverse_mass.ravel()) @ factor.T).toarray()
        cells = [above_solve(lambda: lcpbench.solve(A, b)),
                 above_solve(lambda: lcpbench.solve(b=b, J=factor, inverse_mass=inverse_mass)),
                 above_step(body, J, b, inverse_mass)]
        print(f"| {rows} | " + " | ".join(f"{inside:.2f} | {above:.2f}" for inside, above in cells) + " |")


def peaks():
    print("\n| rows | J, M⁻¹ and b [MB] | `Problem(J=…)` | `solve(problem)` | `solve(J=…)` | `StepSolver.solve` | "
          f"of stacks of {STACK} | A and b [MB] | `Problem(A)` | `solve(A, b)` |\n|" + " ---: |" * 10)
    for rows in LARGE:
        body, J, b, inverse_mass, factor = chain(rows)
        factors = {"b": b, "J": factor, "inverse_mass": inverse_mass}
        of_problem, problem = peak_above(lambda: lcpbench.Problem(**factors))
        of_solve, _ = peak_above(lambda: lcpbench.solve(problem))
        del problem
        of_both, _ = peak_above(lambda: lcpbench.solve(**factors))
        f = np.empty(rows)
        of_step, _ = peak_above(lambda: lcpbench.StepSolver().solve(body, J, b, inverse_mass, f=f))
        body[::STACK, 1], J[::STACK, 1] = -1, 0
        of_stacks, _ = peak_above(lambda: lcpbench.StepSolver().solve(body, J, b, inverse_mass, f=f))
        A = (factor @ sparse.diags(inverse_mass.ravel()) @ factor.T).tocsr()
        A.sort_indices()
        print(f"| {rows} | {megabytes(factor, inverse_mass, b):.1f} | {of_problem:.1f} | {of_solve:.1f} | "
              f"{of_both:.1f} | {of_step:.1f} | {of_stacks:.1f} | " + peaks_of_matrix(A, b) + " |")
    body, J, b, inverse_mass, factor = chain(DENSE)
    A = (factor @ sparse.diags(inverse_mass.ravel()) @ factor.T).toarray()
    print(f"| {DENSE}, A dense | | | | | | | " + peaks_of_matrix(A, b) + " |")


def peaks_of_matrix(A, b):
    of_problem, problem = peak_above(lambda: lcpbench.Problem(A, b))
    del problem
    of_solve, _ = peak_above(lambda: lcpbench.solve(A, b))
    return f"{megabytes(A, b):.1f} | {of_problem:.1f} | {of_solve:.1f}"


def megabytes(matrix, *vectors):
    arrays = [matrix.data, matrix.indices, matrix.indptr] if sparse.issparse(matrix) else [matrix]
    return sum(array.nbytes for array in (*arrays, *vectors)) / 2**20


if __name__ == "__main__":
    times()
    peaks()
