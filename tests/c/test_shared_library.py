#!/usr/bin/python3
"""The shared library from Python by ctypes, as other languages use it: test_shared_library.py LIBRARY HEADER."""

import ctypes
import re
import subprocess
import sys
import unittest
from ctypes import POINTER, byref, c_char, c_char_p, c_double, c_int32, c_int64, c_size_t, c_uint8, c_void_p

_LIBRARY = sys.argv[1]
with open(sys.argv[2], encoding="utf-8") as _header:
    _HEADER = re.sub(r"//[^\n]*", "", _header.read())
_TYPES = {"size_t": c_size_t, "int32_t": c_int32, "int64_t": c_int64, "double": c_double, "lcpbench_form": c_int32,
          "lcpbench_status": c_int32, "const double*": POINTER(c_double), "const int32_t*": POINTER(c_int32),
          "const uint8_t*": POINTER(c_uint8), "const char*": c_char_p, "char": c_char}


def _struct(name):
    """A struct as the header declares it, of zeros but for its size."""
    body = re.search(r"typedef struct " + name + r" \{(.*?)\}", _HEADER, re.DOTALL).group(1)
    fields = []
    for kind, member, count in re.findall(r"(\S[^;]*?) (\w+)(?:\[(\d+)\])?;", body):
        c_type = _TYPES.get(kind, c_void_p) if kind.endswith("*") else _TYPES[kind]
        fields.append((member, c_type * int(count) if count else c_type))
    made = type(name, (ctypes.Structure,), {"_fields_": fields})
    return made(ctypes.sizeof(made))


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
        problem, solver, w = c_void_p(), c_void_p(), (c_double * 3)()
        data, answer, verdict = (_struct(f"lcpbench_{name}") for name in ("problem_data", "answer", "verdict"))
        data.form, data.rows, data.symmetric, data.entries = 2, 3, 1, 5
        data.starts, data.indices = (c_int32 * 4)(0, 2, 4, 5), (c_int32 * 5)(0, 1, 0, 1, 2)
        data.values, data.b = (c_double * 5)(2, 1, 1, 2, 1), (c_double * 3)(-5, -6, 3)
        self._call("lcpbench_problem_create", byref(data), byref(problem))
        self._call("lcpbench_solver_create", b"auto", None, byref(solver))
        self._call("lcpbench_solve", solver, problem, None, byref(answer))
        self._call("lcpbench_verify", problem, byref(answer), c_double(1e-9), byref(verdict), w)
        self.assertEqual((answer.n, answer.status, answer.nullity, answer.detail), (3, 1, -1, b"tableau"))
        for found, expected in zip(answer.f[:3] + w[:3], (4 / 3, 7 / 3, 0, 0, 0, 3)):
            self.assertAlmostEqual(found, expected, places=13)
        self.assertEqual((verdict.passes, verdict.best_tier, verdict.reason), (1, 1e-9, b""))
        self.assertEqual((verdict.adhesion, verdict.model_rho), (-1, -1))
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
        declared = re.findall(r"^LCPBENCH_API[^;(]*?(\w+)\(", _HEADER, re.MULTILINE)
        self.assertEqual(exported, set(declared))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
