#!/usr/bin/python3
"""The shared library from Python by ctypes, as other languages use it: test_shared_library.py LIBRARY HEADER."""

import ctypes
import re
import subprocess
import sys
import unittest
from ctypes import POINTER, byref, c_char, c_char_p, c_double, c_int32, c_int64, c_size_t, c_void_p

_LIBRARY, _HEADER = sys.argv[1:3]


class Verdict(ctypes.Structure):
    _fields_ = (
        [("requested", c_double)]
        + [(name, c_int32) for name in ("passes", "false_success", "false_infeasible", "has_ray", "ray_accepted",
                                       "ray_proved")]
        + [(name, c_double) for name in (
            "best_tier", "rho", "backward_error", "natural_residual", "primal_infeasibility", "dual_infeasibility",
            "complementarity", "gap", "energy_bound", "energy_shift", "answer_floor", "ray_b_dot_y",
            "ray_null_residual")]
        + [("reason", c_char * 256), ("ray_reason", c_char * 256), ("ray_force_min", c_double)]
    )


def _declared_functions():
    with open(_HEADER, encoding="utf-8") as header:
        text = re.sub(r"//[^\n]*", "", header.read())
    return set(re.findall(r"^LCPBENCH_API[^;(]*?(\w+)\(", text, re.MULTILINE))


class SharedLibrary(unittest.TestCase):
    def setUp(self):
        self.library = ctypes.CDLL(_LIBRARY)
        self.library.lcpbench_last_error.restype = c_char_p
        self.library.lcpbench_version.restype = c_char_p
        self.library.lcpbench_problem_free.argtypes = [c_void_p]
        self.library.lcpbench_solver_free.argtypes = [c_void_p]
        self.library.lcpbench_result_free.argtypes = [c_void_p]

    def _call(self, function, *arguments):
        error = getattr(self.library, function)(*arguments)
        self.assertEqual(error, 0, self.library.lcpbench_last_error())

    def test_solves_and_judges(self):
        problem, solver, result = c_void_p(), c_void_p(), c_void_p()
        starts, indices = (c_int32 * 4)(0, 2, 4, 5), (c_int32 * 5)(0, 1, 0, 1, 2)
        values, b = (c_double * 5)(2, 1, 1, 2, 1), (c_double * 3)(-5, -6, 3)
        self._call("lcpbench_problem_from_sparse", c_int64(3), c_int32(0), starts, indices, values, c_int64(5), b, None,
                   ctypes.c_uint32(1), byref(problem))
        self._call("lcpbench_solver_create", b"auto", None, c_size_t(0), byref(solver))
        self._call("lcpbench_result_create", byref(result))
        self._call("lcpbench_solve", solver, problem, None, result)
        f, n, w, verdict = POINTER(c_double)(), c_int64(), (c_double * 3)(), Verdict()
        self._call("lcpbench_result_f", result, byref(f), byref(n))
        self._call("lcpbench_verify_result", problem, result, c_double(1e-9), byref(verdict),
                   c_size_t(ctypes.sizeof(verdict)), w)
        self.assertEqual(n.value, 3)
        for found, expected in zip(f[:3] + w[:3], (4 / 3, 7 / 3, 0, 0, 0, 3)):
            self.assertAlmostEqual(found, expected, places=13)
        self.assertEqual((verdict.passes, verdict.best_tier, verdict.reason), (1, 1e-9, b""))
        self.library.lcpbench_result_free(result)
        self.library.lcpbench_solver_free(solver)
        self.library.lcpbench_problem_free(problem)

    def test_blas_is_found_where_only_this_library_has_loaded_it(self):
        threads = c_int32(-1)
        self._call("lcpbench_limit_library_threads", c_int32(1), byref(threads))
        self.assertIn(threads.value, (0, 1))  # 0: a BLAS that does not tell

    def test_exports_what_the_header_declares_and_nothing_else(self):
        listed = subprocess.run(["nm", "-D", "--defined-only", _LIBRARY], check=True, capture_output=True, text=True)
        kinds_and_names = [line.split()[1:] for line in listed.stdout.splitlines()]
        exported = {name.split("@")[0] for kind, name in kinds_and_names if kind != "A"}
        self.assertEqual(exported, _declared_functions())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
