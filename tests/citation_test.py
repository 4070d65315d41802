#!/usr/bin/python3
"""CITATION.cff holds what the Citation File Format 1.2.0 requires, and speaks of the version that is built."""

import re
import unittest
from pathlib import Path

import yaml

_ROOT = Path(__file__).resolve().parents[1]


def _is_author(author):
    return bool(author.get("name")) != bool(author.get("family-names"))  # an entity or a person


class Citation(unittest.TestCase):
    def setUp(self):
        self.citation = yaml.safe_load((_ROOT / "CITATION.cff").read_text(encoding="utf-8"))
        project = re.search(r"^project\(lcpbench VERSION (\d+\.\d+\.\d+)", (_ROOT / "CMakeLists.txt").read_text(), re.M)
        self.version = project.group(1)

    def test_required_keys(self):
        self.assertEqual(self.citation["cff-version"], "1.2.0")
        for key in ("message", "title", "abstract"):
            self.assertIsInstance(self.citation[key], str)
            self.assertTrue(self.citation[key].strip())
        self.assertEqual(self.citation["type"], "software")
        self.assertEqual([author for author in self.citation["authors"] if not _is_author(author)], [])

    def test_references_have_what_each_needs(self):
        for reference in self.citation["references"]:
            self.assertLessEqual({"type", "title", "authors"}, set(reference))
            self.assertTrue(all(_is_author(author) for author in reference["authors"]))
        self.assertEqual([r["authors"][0]["family-names"] for r in self.citation["references"]], ["Baraff", "Neumann"])

    def test_version_and_licence_are_the_projects(self):
        self.assertEqual(str(self.citation["version"]), self.version)
        self.assertEqual(self.citation["license"], "Apache-2.0")
        self.assertIn("Apache License", (_ROOT / "LICENSE").read_text(encoding="utf-8"))

    def test_the_change_log_has_this_version(self):
        headings = re.findall(r"^## \[(.*?)\]", (_ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.M)
        self.assertEqual(headings[0], "Unreleased")
        self.assertIn(self.version, headings)


if __name__ == "__main__":
    unittest.main()
