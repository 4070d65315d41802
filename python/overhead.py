"""What a call from Python costs above the call in C++, from arrays to arrays, by the number of rows: the table of
docs/python.md.

    build/python-venv/bin/python python/overhead.py
"""

import statistics
import time

import numpy as np
from scipy import sparse

import lcpbench

ROWS = (1, 3, 10, 30, 100, 300)
CALLS = 300  # of a round
ROUNDS = 15


def chain(rows):
    """Rows of a stack of bodies in the plane, as a step and as A."""
    random = np.random.default_rng(rows)
    body = np.stack([np.arange(rows), np.arange(rows) - 1], 1).astype(np.int32)
    J = random.normal(size=(rows, 2, 3))
    J[0, 1] = 0
    inverse_mass = random.uniform(0.5, 2, (rows, 3))
    column = 3 * np.maximum(body, 0)[:, :, None] + np.arange(3)
    factor = sparse.csr_matrix((J.ravel(), (np.arange(rows).repeat(6), column.ravel())), shape=(rows, 3 * rows))
    return body, J, random.normal(size=rows), inverse_mass, factor


def above_solve(call):
    """(C++, above it) of a call [us]: medians of what the result says, and of the rest of the call."""
    inside, above = [], []
    for _ in range(CALLS * ROUNDS // 3):
        begin = time.perf_counter()
        result = call()
        result.f
        elapsed = time.perf_counter() - begin
        inside.append(result.time)
        above.append(elapsed - result.time)
    return 1e6 * statistics.median(inside), 1e6 * statistics.median(above)


def above_step(body, J, b, inverse_mass):
    """(C++, above it) of StepSolver.solve with a kept output array [us]: rounds in turn, medians."""
    step, f = lcpbench.StepSolver(), np.empty(len(b))
    solve, calls = step.solve, range(CALLS)
    inside, above = [], []
    for _ in range(ROUNDS):
        of_cxx = step._time(body, J, b, inverse_mass, f, CALLS) / CALLS
        begin = time.perf_counter()
        for _ in calls:
            solve(body, J, b, inverse_mass, f=f)
        inside.append(of_cxx)
        above.append((time.perf_counter() - begin) / CALLS - of_cxx)
    return 1e6 * statistics.median(inside), 1e6 * statistics.median(above)


def main():
    print("| rows | `solve(A, b)` in C++ [µs] | above it | `solve(J=…)` in C++ | above it | `StepSolver.solve` in C++ | "
          "above it |\n|" + " --- |" * 7)
    for rows in ROWS:
        body, J, b, inverse_mass, factor = chain(rows)
        A = (factor @ sparse.diags(inverse_mass.ravel()) @ factor.T).toarray()
        cells = [above_solve(lambda: lcpbench.solve(A, b)),
                 above_solve(lambda: lcpbench.solve(b=b, J=factor, inverse_mass=inverse_mass.ravel())),
                 above_step(body, J, b, inverse_mass)]
        print(f"| {rows} | " + " | ".join(f"{inside:.2f} | {above:.2f}" for inside, above in cells) + " |")


if __name__ == "__main__":
    main()
