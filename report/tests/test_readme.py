"""The blocks of numbers of README.md and docs/ are what the committed results give."""

import re
import unittest
from pathlib import Path

from lcpbench_report import readme_blocks
from lcpbench_report.headline_table import headline
from .reference import inputs_of

_ROOT = Path(__file__).resolve().parents[2]
_PAGES = {path: path.read_text(encoding="utf-8") for path in [*sorted(_ROOT.glob("*.md")), *sorted(_ROOT.glob("docs/*.md"))]}
_RESULTS = ("core", "sequences")  # sequences change nothing in the blocks, and are those of summary.md
_HELP = "make reference-report writes them"


def _name(path: Path) -> str:
    return path.relative_to(_ROOT).as_posix()


class Readme(unittest.TestCase):
    def test_every_block_is_one_that_the_generator_writes(self):
        names = {path: re.findall(r"<!-- numbers:(\S*) -->", text) for path, text in _PAGES.items()}
        self.assertIn("headline", names[_ROOT / "README.md"])
        used = {block for blocks in names.values() for block in blocks}
        self.assertEqual(used, set(readme_blocks.BLOCKS))
        for path, blocks in names.items():
            self.assertEqual(_PAGES[path].count("<!-- end -->"), len(blocks), _name(path))

    def test_the_blocks_are_those_of_the_committed_results(self):
        inputs = inputs_of(*_RESULTS)
        found = headline(inputs)
        for path, text in _PAGES.items():
            with self.subTest(_name(path)):
                filled = readme_blocks.fill(text, readme_blocks.Page(inputs, found, _ROOT, path))
                self.assertEqual(text.splitlines(), filled.splitlines(), _HELP)

    def test_every_solver_and_scene_is_spoken_of_on_its_page(self):
        inputs = inputs_of(*_RESULTS)
        solvers = {origin: [of["key"] for of in inputs.solvers if of["origin"] == origin and of["setting"] != "variant"]
                   for origin in ("own", "peer")}
        scenes = re.findall("`([^`]*)`", readme_blocks.BLOCKS["scene-keys"](readme_blocks.Page(inputs, None, _ROOT, _ROOT)))
        for page, keys in (("solvers", solvers["own"]), ("peers", solvers["peer"]), ("scenes", scenes)):
            self.assertGreater(len(keys), 10)
            text = _PAGES[_ROOT / "docs" / f"{page}.md"]
            self.assertEqual([key for key in keys if f"`{re.sub('-(default|baseline)$', '', key)}`" not in text], [], page)
