#!/usr/bin/python3
"""An external solver in Python: least squares with bounds, from SciPy (docs/protocol.md has the protocol).

    lcpbench solve --external mine=examples/external_solver.py --solver mine problems.jsonl
"""
import os, struct, sys, time
import numpy as np
from scipy.optimize import lsq_linear

source, sink = sys.stdin.buffer, os.fdopen(os.dup(1), "wb")
os.dup2(2, 1)  # whatever prints must not end up in the protocol
HELLO, PROBLEM, PREPARED, SOLVE, RESULT, QUIT = range(1, 7)


def text(s):
    return struct.pack("<I", len(s.encode())) + s.encode()


def send(kind, payload):
    sink.write(struct.pack("<IQ", kind, len(payload)) + payload)
    sink.flush()


def receive():
    header = source.read(12)
    kind, size = struct.unpack("<IQ", header) if len(header) == 12 else (QUIT, 0)
    return kind, source.read(size)


send(HELLO, struct.pack("<IB", 1, 0) + text("lsq_linear") + text("SciPy") + text("BSD-3-Clause"))
while True:
    kind, data = receive()
    if kind == PROBLEM:  # dense, as the greeting asked for
        n = struct.unpack_from("<Q", data)[0]
        b = np.frombuffer(data, "<f8", n, 11)
        bilateral = np.frombuffer(data, "u1", n, 11 + 8 * n) != 0
        eigenvalues, V = np.linalg.eigh(np.frombuffer(data, "<f8", n * n, 11 + 9 * n).reshape(n, n))
        keep = eigenvalues > 1e-12 * eigenvalues.max(initial=0)  # A = C^T C and C^T d = -b: min |C f - d|, f >= 0
        root = np.sqrt(eigenvalues[keep])
        C, d = root[:, None] * V[:, keep].T, -(V[:, keep].T @ b) / root
        send(PREPARED, struct.pack("<d", 0.0) + text("" if keep.any() else "A = 0"))
    elif kind == SOLVE:
        tolerance, limit, most, repetitions, start = struct.unpack_from("<ddqQB", data)
        begin = time.perf_counter()
        answer = lsq_linear(C, d, (np.where(bilateral, -np.inf, 0.0), np.full(n, np.inf)), "bvls", tol=1e-14)
        elapsed = time.perf_counter() - begin
        status = "solved" if answer.status > 0 else "iteration_limit"
        send(RESULT, text(status) + struct.pack("<qdd", answer.nit, elapsed, 0.0) + text(answer.message)
             + answer.x.astype("<f8").tobytes() + b"\0")
    else:
        break
