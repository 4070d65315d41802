"""README's blocks of numbers are what the committed results give."""

import json
import re
import sys
import unittest
from pathlib import Path

_REPORT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(_REPORT), str(_REPORT / "tests")]

from lcpbench_report import readme_blocks  # noqa: E402
from lcpbench_report.inputs import load_inputs  # noqa: E402
from lcpbench_report.statistics.load import SCHEMA  # noqa: E402

_README = _REPORT.parent / "README.md"
_CORE = _REPORT / "reference" / "core"
_ABLATION = _REPORT / "reference" / "ablation"
_HELP = "make reference-report writes them"


def _reason() -> str:
    """Why nothing can be compared; empty where it can."""
    info = _CORE / "campaign.json"
    if not info.is_file():
        return f"{_CORE} is not committed yet"
    found = json.loads(info.read_text(encoding="utf-8")).get("schema")
    return "" if found == SCHEMA else f"{info} has schema {found}, this report reads {SCHEMA}"


class Readme(unittest.TestCase):
    def setUp(self):
        self.text = _README.read_text(encoding="utf-8")

    def test_every_block_is_one_that_the_generator_writes(self):
        names = re.findall(r"<!-- numbers:(\S*) -->", self.text)
        self.assertIn("headline", names)
        self.assertLessEqual(set(names), set(readme_blocks.BLOCKS))
        self.assertEqual(self.text.count("<!-- end -->"), len(names))

    @unittest.skipIf(_reason(), _reason())
    def test_the_blocks_are_those_of_the_committed_results(self):
        filled = readme_blocks.fill(self.text, readme_blocks.Source(load_inputs([_CORE], ablation=_ABLATION), _README.parent), _README.name)
        self.assertEqual(self.text.splitlines(), filled.splitlines(), _HELP)


if __name__ == "__main__":
    unittest.main()
