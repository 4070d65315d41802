#!/usr/bin/python3
"""What is compiled for one instruction set must not be linked in place of another's: files *_sse2.cc, *_avx2.cc and
*_avx512.cc define no function that other files may define as well. Arguments: object files."""

import re
import subprocess
import sys
import unittest

_OBJECTS = [path for path in sys.argv[1:] if re.search(r"_(sse2|avx2|avx512)[.]cc[.]o$", path)]


class Kernels(unittest.TestCase):
    def test_they_define_nothing_that_the_linker_may_choose_among(self):
        self.assertGreater(len(_OBJECTS), 6)
        for path in _OBJECTS:
            listed = subprocess.run(["nm", "-C", path], check=True, capture_output=True, text=True).stdout
            self.assertEqual(re.findall(r"(?m)^[0-9a-f]+ [WVu] .*", listed), [], path)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
