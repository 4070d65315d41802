"""Every committed summary has the tables that the code makes of its folder today. That of the campaign `core`, which
takes a minute, is in long_committed_results.py."""

import json
import re
import unittest

from .reference import FOLDER, PAGES, ROOT, SUMMARIES, check_tables

_COMMIT = re.compile(r"\bcommit ([0-9a-f]{12})\b")


def _commits(*folders: str) -> set[str]:
    """Of the records of campaigns and motions."""
    files = [next(path for file in ("campaign.json", "motion.json") if (path := FOLDER / name / file).is_file()) for name in folders]
    environments = [json.loads(path.read_text(encoding="utf-8"))["environment"] for path in files]
    assert not any(of["git_dirty"] for of in environments), folders
    return {of["git_commit"][:12] for of in environments}


class CommittedSummaries(unittest.TestCase):
    def test_one_command_at_one_commit_makes_all_folders(self):
        names = re.findall(r"^(?:PARTS|MOTIONS) := (.*)$", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
        folders = {path.name for path in FOLDER.iterdir() if path.is_dir()}
        self.assertEqual(folders, set(" ".join(names).split()))
        self.assertEqual(len(_commits(*folders)), 1)
        self.assertLessEqual(sum(path.stat().st_size for path in FOLDER.rglob("*") if path.is_file()), 10e6)

    def test_every_summary_is_one_that_is_made(self):
        self.assertEqual({path.name for path in FOLDER.glob("*summary.md")}, set(SUMMARIES))

    def test_every_table_is_that_of_the_folder(self):
        for name in SUMMARIES:
            if name != "summary.md":
                check_tables(self, name)

    def test_what_is_published_names_the_commit_of_its_records(self):
        for name, folders in SUMMARIES.items():
            named = set(_COMMIT.findall((FOLDER / name).read_text(encoding="utf-8")))
            self.assertEqual(named, _commits(*folders), name)
        for path, text in PAGES.items():
            named = set(_COMMIT.findall(text))
            self.assertLessEqual(named, _commits("core"), path.relative_to(ROOT))
        self.assertIn(*_commits("core"), PAGES[ROOT / "README.md"])
