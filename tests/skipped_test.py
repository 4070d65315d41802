#!/usr/bin/python3
"""Skipped tests are counted by reason, in one line."""

import unittest

import skipped


def _file(*cases):
    tests = [f'<testcase name="t{k}"><{tag}/><system-out>{out}</system-out></testcase>' for k, (tag, out) in enumerate(cases)]
    return f'<?xml version="1.0" encoding="UTF-8"?>\n<testsuite name="x">{"".join(tests)}</testsuite>'


def _gtest(reason):
    return f"[ RUN      ] A.B\n/a/b.cc:47: Skipped\n{reason}\n\n[  SKIPPED ] A.B (0 ms)\n[  SKIPPED ] 1 test.\n"


class Skipped(unittest.TestCase):
    def test_reasons_are_counted_most_frequent_first(self):
        line = skipped.summary(
            _file(
                ("properties", "[  PASSED  ] 1 test.\n"),
                ("skipped", "try_slurm.sh: not installed: slurmctld\n"),
                ("skipped", _gtest("osqp-dual is not in this build")),
                ("failure", "/a/b.cc:50: Failure\n"),
                ("skipped", _gtest("scs-dual is not in this build")),
                ("skipped", ""),
            )
        )
        self.assertEqual(
            line,
            "4 of 6 tests skipped: a solver or peer is not in this build (2), "
            "try_slurm.sh: not installed: slurmctld (1), no reason given (1)",
        )

    def test_nothing_skipped(self):
        self.assertEqual(skipped.summary(_file(("properties", ""))), "0 of 1 tests skipped")


if __name__ == "__main__":
    unittest.main()
