#!/usr/bin/python3
"""Skipped tests are counted by reason, in one line."""

import unittest

import skipped


def _ctest(*cases):
    tests = [f'<testcase name="{name}"><{tag}/><system-out>{out}</system-out></testcase>' for name, tag, out in cases]
    return f'<?xml version="1.0" encoding="UTF-8"?>\n<testsuite name="x">{"".join(tests)}</testsuite>'


def _gtest(*cases):
    """As GoogleTest writes them: a test that is disabled is none."""
    tests = [f'<testcase name="t" status="run">{case}</testcase>' for case in cases]
    return f'<testsuites><testsuite name="s">{"".join(tests)}<testcase name="u" status="notrun"/></testsuite></testsuites>'


def _skip(reason):
    return f'<skipped message="/a/b.cc:47&#x0A;{reason}"><![CDATA[/a/b.cc:47\n{reason}]]></skipped>'


class Skipped(unittest.TestCase):
    def test_reasons_are_counted_most_frequent_first(self):
        line = skipped.summary(
            _ctest(
                ("x_tests.1", "properties", "[  PASSED  ] 1 test.\n"),
                ("x_tests.2", "failure", "/a/b.cc:50: Failure\n"),
                ("tool", "skipped", "first\ntry.sh: not installed: tool\n"),
                ("other", "skipped", ""),
            ),
            {
                "x_tests.1": _gtest("", _skip("no AVX-512 here"), _skip("not in this build: OSQP, SCS")),
                "x_tests.2": _gtest("<failure/>", _skip("no AVX-512 here")),
            },
        )
        self.assertEqual(
            line,
            "5 of 7 tests skipped: no AVX-512 here (2), try.sh: not installed: tool (1), "
            "no reason given (1), not in this build: OSQP, SCS (1)",
        )

    def test_nothing_skipped(self):
        self.assertEqual(skipped.summary(_ctest(("a", "properties", "")), {}), "0 of 1 tests skipped")


if __name__ == "__main__":
    unittest.main()
