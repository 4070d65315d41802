"""What the command does before it solves: one thread for the libraries below, and the kernels of BLAS that it chooses
itself are left to the environment, so that both have the same bits."""

import os

import lcpbench

os.environ.setdefault("OPENBLAS_CORETYPE", "")
lcpbench.limit_library_threads(1)
