#!/usr/bin/python3
"""The shared library from Python by ctypes, as other languages use it: test_shared_library.py LIBRARY HEADER."""

import ctypes
import re
import subprocess
import sys
import unittest
from ctypes import (POINTER, byref, c_char, c_char_p, c_double, c_int32, c_int64, c_size_t, c_uint8, c_void_p,
                    sizeof)

_LIBRARY, _HEADER = sys.argv[1:3]


class Problem(ctypes.Structure):
    _fields_ = [
        ("size", c_size_t), ("form", c_int32), ("by_rows", c_int32), ("rows", c_int64), ("columns", c_int64),
        ("bodies", c_int64), ("columns_per_body", c_int32), ("symmetric", c_int32), ("positive_semidefinite", c_int32),
        ("values", POINTER(c_double)), ("values_single", c_void_p), ("body", POINTER(c_int32)), ("entries", c_int64),
        ("starts", POINTER(c_int32)), ("indices", POINTER(c_int32)), ("inverse_mass", POINTER(c_double)),
        ("b", POINTER(c_double)), ("kinds", POINTER(c_uint8)), ("friction", c_void_p), ("friction_count", c_int64),
        ("bounded", c_void_p), ("bounded_count", c_int64)
    ]


class Answer(ctypes.Structure):
    _fields_ = [
        ("size", c_size_t), ("status", c_int32), ("relaxed", c_int32), ("n", c_int64), ("f", POINTER(c_double)),
        ("ray", POINTER(c_double)), ("iterations", c_int64), ("nullity", c_int64), ("detail", c_char_p),
        ("rho", c_double), ("force_min", c_double), ("infeasible_proved", c_int64), ("fallbacks", c_int64)
    ]


class Verdict(ctypes.Structure):
    _fields_ = (
        [("size", c_size_t), ("requested", c_double)]
        + [(name, c_int32) for name in ("passes", "false_success", "false_infeasible", "has_ray", "ray_accepted",
                                       "ray_proved")]
        + [(name, c_double) for name in (
            "best_tier", "rho", "backward_error", "natural_residual", "primal_infeasibility", "dual_infeasibility",
            "complementarity", "gap", "energy_bound", "energy_shift", "answer_floor", "ray_b_dot_y",
            "ray_null_residual")]
        + [("reason", c_char * 256), ("ray_reason", c_char * 256)]
        + [(name, c_double) for name in (
            "ray_force_min", "penetration", "adhesion", "separation", "cone", "dissipation", "joints", "beyond_bounds",
            "model_rho")]
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

    def _call(self, function, *arguments):
        error = getattr(self.library, function)(*arguments)
        self.assertEqual(error, 0, self.library.lcpbench_last_error())

    def test_solves_and_judges(self):
        problem, solver, answer, verdict = c_void_p(), c_void_p(), Answer(sizeof(Answer)), Verdict(sizeof(Verdict))
        starts, indices = (c_int32 * 4)(0, 2, 4, 5), (c_int32 * 5)(0, 1, 0, 1, 2)
        values, b, w = (c_double * 5)(2, 1, 1, 2, 1), (c_double * 3)(-5, -6, 3), (c_double * 3)()
        data = Problem(sizeof(Problem), form=2, rows=3, symmetric=1, values=values, entries=5, starts=starts,
                       indices=indices, b=b)
        self._call("lcpbench_problem_create", byref(data), byref(problem))
        self._call("lcpbench_solver_create", b"auto", None, c_size_t(0), byref(solver))
        self._call("lcpbench_solve", solver, problem, None, byref(answer))
        self._call("lcpbench_verify", problem, byref(answer), c_double(1e-9), byref(verdict), w)
        self.assertEqual((answer.n, answer.status, answer.nullity, answer.detail), (3, 1, -1, b"tableau"))
        for found, expected in zip(answer.f[:3] + w[:3], (4 / 3, 7 / 3, 0, 0, 0, 3)):
            self.assertAlmostEqual(found, expected, places=13)
        self.assertEqual((verdict.passes, verdict.best_tier, verdict.reason), (1, 1e-9, b""))
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
