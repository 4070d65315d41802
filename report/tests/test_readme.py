"""The blocks of numbers of README.md and docs/ are what the committed results give: those that need no times are written
anew, and the tables of the others are those of the summary, which was written with them. long_committed_results.py
writes all of them."""

import re
import unittest

from lcpbench_report import readme_blocks
from .reference import FOLDER, PAGES, ROOT, described

_OF_TIMES = {"headline", "headline-details", "moved", "moved-words", "sealed"}


class Readme(unittest.TestCase):
    def test_every_block_is_one_that_the_generator_writes(self):
        names = {path: re.findall(r"<!-- numbers:(\S*) -->", text) for path, text in PAGES.items()}
        self.assertIn("headline", names[ROOT / "README.md"])
        used = {block for blocks in names.values() for block in blocks}
        self.assertEqual(used, set(readme_blocks.BLOCKS))
        for path, blocks in names.items():
            self.assertEqual(PAGES[path].count("<!-- end -->"), len(blocks), path.relative_to(ROOT))

    def test_blocks_without_times_are_those_of_the_committed_results(self):
        core = described("core")
        for path, text in PAGES.items():
            page = readme_blocks.Page(core, None, ROOT, path)
            for name, block in readme_blocks.BLOCK.findall(text):
                if name not in _OF_TIMES:
                    with self.subTest(path.relative_to(ROOT), block=name):
                        self.assertEqual(block.strip(), readme_blocks.BLOCKS[name](page).strip(), "make reference-report writes them")

    def test_tables_of_times_are_those_of_the_summary(self):
        summary = set((FOLDER / "summary.md").read_text(encoding="utf-8").splitlines())
        blocks = dict(readme_blocks.BLOCK.findall(PAGES[ROOT / "docs" / "results.md"]))
        rows = [line for line in blocks["headline-details"].splitlines() if line.startswith("|")]
        self.assertGreater(len(rows), 10)
        self.assertEqual([line for line in rows if line not in summary], [])
        self.assertIn(dict(readme_blocks.BLOCK.findall(PAGES[ROOT / "README.md"]))["moved-words"], blocks["moved"].splitlines())

    def test_every_solver_and_scene_is_spoken_of_on_its_page(self):
        core = described("core")
        solvers = {origin: [of["key"] for of in core.campaigns[0].info["solvers"] if of["origin"] == origin and of["setting"] != "variant"]
                   for origin in ("own", "peer")}
        scenes = {about["family"] for about in core.problems.values() if about["origin"] in ("placed", "motion")}
        for page, keys in (("solvers", solvers["own"]), ("peers", solvers["peer"]), ("scenes", scenes)):
            self.assertGreater(len(keys), 10)
            text = PAGES[ROOT / "docs" / f"{page}.md"]
            self.assertEqual([key for key in keys if f"`{re.sub('-(default|baseline)$', '', key)}`" not in text], [], page)
