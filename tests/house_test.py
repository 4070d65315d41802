#!/usr/bin/python3
"""The rules of the source tree: which folders may include which, how many entries a folder has, that cited files exist,
and that every peer's package is installed."""

import graphlib
import os
import re
import subprocess
import sys
import unittest
from collections import defaultdict
from pathlib import Path
from typing import NamedTuple

_ROOT = Path(__file__).resolve().parents[1]
sys.dont_write_bytecode = True

_OURS = ("support", "solvers", "model", "benchmarks", "tests", "examples", "python")

# What a folder may include of ours; the first entry that fits the including file decides.
_MAY_INCLUDE = (
    ("support/", r"support/"),
    ("solvers/lcp/", r"(support|solvers/lcp)/"),
    ("solvers/", r"(support|solvers)/"),
    ("model/", r"(support|solvers/lcp|model)/"),
    ("benchmarks/", r"(support|solvers|model|benchmarks)/"),
    ("python/", r"(support|solvers|model|benchmarks|python)/"),
    ("tests/", r"(support|solvers|model|benchmarks|tests|examples)/"),
    ("", r"(support|solvers|model|benchmarks)/"),
)

# The registry depends on every solver, so nothing that a solver is made of may include it.
_MAY_INCLUDE_REGISTRY = re.compile(r"(benchmarks|tests|examples|solvers/c|python)/|solvers/registry\.cc$")

# Generated headers without a template of the same name (*.in).
_GENERATED = {"git_revision.h"}

_MOST_ENTRIES = 32  # of a folder: what a listing shows at a glance
_UNCOUNTED = ("tests", "data", "report/reference")

# Texts about past states of the tree.
_HISTORY = ("CHANGELOG.md", "report/reference/")
# Headers of libraries that comments name.
_FOREIGN_HEADERS = {"fclib.h"}

_TOP = "support|solvers|model|benchmarks|tests|report|data|docs|cmake|examples|python"
_SUFFIX = "h|cc|py|md|json|cmake|sh"
_CITED_PATH = re.compile(rf"(?<![\w/.$}}<>*-])((?:{_TOP})(?:/[\w.+-]+)*/[\w.+-]+\.(?:{_SUFFIX}))(?![\w/*])")
_CITED_FOLDER = re.compile(rf"(?<![\w/.$}}<>*-])((?:{_TOP})(?:/[\w-]+)+)/(?![\w.*<{{$(%-])")
# A path without its first folders, such as lcp/verify.h.
_CITED_TAIL = re.compile(r"(?<![\w/.$}<>*-])((?:[\w-]+/)+[\w-]+\.(?:h|cc|py))(?![\w/*])")
# Sections of the page on the model, such as docs/model.md sections 3, 4 and 8; and links to files and a page's headings.
_CITED_SECTIONS = re.compile(r"model\.md\)? sections? (\d+(?:(?:, (?:and )?| and )\d+)*)(?!\d|\.\d)")
_LINKED = re.compile(r"\]\(([\w./-]*)(?:#([^)\s]+))?\)")
_CITED_NAME = re.compile(r"(?<![\w/.$}<>*-])([a-z][\w-]+\.(?:h|cc))(?![\w/*(])")

_CXX_TOKEN = re.compile(
    r'(?P<comment>//[^\n]*|/\*.*?\*/)|(?P<string>R"(?P<mark>[^(\s]*)\(.*?\)(?P=mark)"|"(?:\\.|[^"\\\n])*")'
    r"|(?<!\w)'(?:\\.|[^'\\\n])+'",
    re.S,
)


_INCLUDE = re.compile(r'\s*#\s*include\s*(["<])([^">]+)[">]')


class Include(NamedTuple):
    source: str  # the file that includes, from the root
    line: int
    target: str  # as it is written
    is_quoted: bool

    def __str__(self):
        return f"{self.source}:{self.line} includes {self.target}"


def tracked_files(root=_ROOT):
    """Paths from the root; without a git repository, every file outside build folders."""
    listed = subprocess.run(["git", "-C", str(root), "ls-files", "-z"], capture_output=True, check=False)
    if listed.returncode == 0 and listed.stdout:
        return sorted(path for path in listed.stdout.decode().split("\0") if path and (root / path).is_file())
    found = [path.relative_to(root) for path in root.rglob("*") if path.is_file()]
    return sorted(path.as_posix() for path in found if not {".git", "build", "__pycache__"}.intersection(path.parts))


def includes(files, root=_ROOT):
    """Every include of every C and C++ file, templates (*.in) too."""
    found = []
    for path in files:
        if re.search(r"\.(h|cc|c)(\.in)?$", path):
            lines = (root / path).read_text(encoding="utf-8").splitlines()
            matches = ((number, _INCLUDE.match(line)) for number, line in enumerate(lines, 1))
            found += [Include(path, number, match[2], match[1] == '"') for number, match in matches if match]
    return found


def folder_of(path):
    return path.rpartition("/")[0]


def _only(text, spans):
    """The text with all but the spans blanked, so that lines keep their numbers."""
    blank = [character if character == "\n" else " " for character in text]
    for begin, end in spans:
        blank[begin:end] = text[begin:end]
    return "".join(blank)


def _prose(path, text):
    """The text with nothing but what may cite files: (comments and documents, these and strings of code)."""
    if re.search(r"\.(h|cc|c)(\.in)?$", path):
        tokens = list(_CXX_TOKEN.finditer(re.sub(r"(?m)^[ \t]*#[ \t]*include.*$", lambda m: " " * len(m[0]), text)))
        comments = [match.span() for match in tokens if match["comment"]]
        return _only(text, comments), _only(text, comments + [m.span() for m in tokens if m["string"]])
    if path.endswith((".md", ".json", ".cff", ".html", ".svg")):
        return text, text
    comments = [match.span(1) for match in re.finditer(r"(?m)(?:^|\s)((?:#|//|/\*|\*).*)$", text)]
    if path.endswith((".py", ".js")):
        documentation = [match.span() for match in re.finditer(r'""".*?"""', text, re.S)]
        return _only(text, comments + documentation), text
    if path.endswith(("CMakeLists.txt", ".cmake", ".cmake.in")):  # what is not quoted counts from the file's folder
        quoted = [match.span() for match in re.finditer(r'"[^"\n]*"', text)]
        return _only(text, comments), _only(text, comments + quoted)
    return _only(text, comments), text


def _anchor(heading):
    """What a link to a heading says, as GitHub makes it."""
    return re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-")


class _Tree(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.files = tracked_files(_ROOT)
        cls.known = set(cls.files)
        cls.includes = includes(cls.files, _ROOT)
        # Other includes are of the language and of libraries.
        cls.own_includes = [include for include in cls.includes if include.target in cls.known]

    def assertNone(self, found, why):
        if found:
            self.fail("\n".join([why, *map(str, found)]))


def _cycle(includes, name):
    """Includes, one of each edge of a cycle in the graph of who includes whom; none where there is none.

    @param name  what a file is called there: by its folder, for instance
    """
    edges = defaultdict(dict)  # from -> to -> the first include
    for include in includes:
        source, target = name(include.source), name(include.target)
        if source != target:
            edges[source].setdefault(target, include)
    try:
        graphlib.TopologicalSorter(edges).prepare()
    except graphlib.CycleError as error:
        cycle = error.args[1]  # every node is included by the next one
        return [edges[source][target] for target, source in zip(cycle, cycle[1:])]
    return []


class Includes(_Tree):
    def test_includes_of_ours_exist(self):
        self.assertGreater(len(self.own_includes), 1000)  # there is something to check
        made = {path.rpartition("/")[2][:-3] for path in self.files if path.endswith(".in")} | _GENERATED
        lost = [
            include
            for include in self.includes
            if include.target not in self.known | made
            and (include.target.startswith(tuple(f"{top}/" for top in _OURS)) or include.is_quoted)
        ]
        self.assertNone(lost, "no such file is tracked or generated:")

    def test_directions_between_top_folders(self):
        may = {i: next(may for begin, may in _MAY_INCLUDE if i.source.startswith(begin)) for i in self.own_includes}
        wrong = [f"{i}, may include of ours: {targets}" for i, targets in may.items() if not re.match(targets, i.target)]
        self.assertNone(wrong, "includes against the direction of the layers:")

    def test_the_registry_is_included_from_above_only(self):
        includes = [include for include in self.own_includes if include.target == "solvers/registry.h"]
        self.assertTrue(includes)
        wrong = [include for include in includes if not _MAY_INCLUDE_REGISTRY.match(include.source)]
        self.assertNone(wrong, "solvers/registry.h depends on every solver and is for benchmarks/, tests/, examples/, python/, solvers/c/:")

    def test_there_are_no_cycles(self):
        for what, is_checked, name in (
            ("folders", lambda path: not path.startswith("tests/"), folder_of),
            # X.h and X.cc as one
            ("files", lambda path: path.startswith(("solvers/", "model/")), lambda path: re.sub(r"\.(h|cc|c)$", "", path)),
            ("headers", lambda path: path.endswith(".h"), lambda path: path),
        ):
            with self.subTest(what):
                includes = (include for include in self.own_includes if is_checked(include.source))
                self.assertNone(_cycle(includes, name), f"{what} include each other in a cycle:")

    def test_a_cycle_is_found(self):
        pairs = [("a", "b"), ("b", "c"), ("c", "d"), ("d", "b"), ("a", "d")]
        includes = [Include(source, 1, target, True) for source, target in pairs]
        self.assertEqual({include.source for include in _cycle(includes, str)}, {"b", "c", "d"})
        self.assertEqual(_cycle(includes[:3], str), [])


class Folders(_Tree):
    def test_folders_are_small_enough_to_look_over(self):
        entries = defaultdict(set)
        for path in self.files:
            while path:
                folder, _, entry = path.rpartition("/")
                entries[folder].add(entry)
                path = folder
        uncounted = re.compile("({})(/|$)".format("|".join(_UNCOUNTED)))
        large = [
            f"{folder or '.'}: {len(found)} files and folders"
            for folder, found in sorted(entries.items())
            if len(found) > _MOST_ENTRIES and not uncounted.match(folder)
        ]
        self.assertNone(large, f"more than {_MOST_ENTRIES} entries:")


class Citations(_Tree):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.folders = {path[: at.start()] for path in cls.files for at in re.finditer("/", path)}
        cls.texts = {}  # of a path: lines of comments and documents alone, lines of these and of strings
        for path in cls.files:
            if not path.startswith(_HISTORY):
                try:
                    text = (_ROOT / path).read_text(encoding="utf-8")
                except UnicodeDecodeError:
                    continue  # compressed
                cls.texts[path] = [part.split("\n") for part in _prose(path, text)]

    def _cited(self, pattern, strings):
        """(place, what is cited there) in comments and documents, and in strings of code where these are wanted."""
        for path, parts in self.texts.items():
            for number, line in enumerate(parts[strings], 1):
                for match in pattern.finditer(line):
                    yield f"{path}:{number}", match[1]

    def test_what_is_cited_exists(self):
        tops = tuple(f"{top}/" for top in _TOP.split("|"))
        ends = {path[at.end() :] for path in self.files for at in re.finditer("/", path)}
        names = {path.rpartition("/")[2] for path in self.files}
        names |= {name[:-3] for name in names if name.endswith(".in")} | _GENERATED | _FOREIGN_HEADERS

        def is_file(place, cited):  # from the root, or a link of a page
            return not self.known.isdisjoint((cited, f"{place.rpartition('/')[0]}/{cited}"))

        for pattern, strings, exists, why in (
            (_CITED_PATH, True, is_file, "no such file is tracked:"),
            (_CITED_FOLDER, True, lambda _, cited: cited in self.folders, "no such folder is tracked:"),
            (_CITED_TAIL, False, lambda _, cited: cited.startswith(tops) or cited in ends, "no tracked path ends so:"),
            (_CITED_NAME, False, lambda _, cited: cited in names, "no such source is tracked:"),
        ):
            with self.subTest(why):
                found = list(self._cited(pattern, strings))
                self.assertTrue(found)
                self.assertNone([f"{place} cites {cited}" for place, cited in found if not exists(place, cited)], why)

    def _headings(self, page):
        return re.findall(r"(?m)^#+ (.*)$", (_ROOT / page).read_text(encoding="utf-8"))

    def test_sections_of_the_model_that_are_cited_exist(self):
        sections = {m[1] for heading in self._headings("docs/model.md") if (m := re.match(r"(\d+)\. ", heading))}
        self.assertEqual(sorted(map(int, sections)), list(range(1, len(sections) + 1)))
        cited = []
        for path, (lines, _) in self.texts.items():
            # A comment goes on over the ends of its lines.
            text = " ".join(re.sub(r"^\s*(///?|#)?\s*|\s+$", "", line) for line in lines)
            cited += [(path, number) for match in _CITED_SECTIONS.finditer(text) for number in re.findall(r"\d+", match[1])]
        self.assertGreater(len(cited), 25)  # there is something to check
        wrong = [f"{path} cites section {number}" for path, number in cited if number not in sections]
        self.assertNone(wrong, "docs/model.md has no such section:")

    def test_excerpts_stand_in_their_files(self):
        found = [(page, source, block)
                 for page in self.texts if page.endswith(".md")
                 for source, block in re.findall(r"<!-- from (\S+) -->\n\n((?:    .*\n|\n)+)",
                                                 (_ROOT / page).read_text(encoding="utf-8"))]
        self.assertTrue(found)
        wrong = [f"{page} quotes {source}" for page, source, block in found
                 if " ".join(block.split()) not in " ".join((_ROOT / source).read_text(encoding="utf-8").split())]
        self.assertNone(wrong, "an excerpt differs from its file:")

    def test_files_and_headings_that_are_linked_exist(self):
        pages = [path for path in self.texts if path.endswith(".md")]
        anchors = {page: set(map(_anchor, self._headings(page))) for page in pages}
        links = [
            (page, os.path.normpath(Path(page).parent / to) if to else page, anchor)
            for page in pages
            for to, anchor in _LINKED.findall(re.sub(r"`[^`]*`|(?m:^    .*$)", "", "\n".join(self.texts[page][0])))
        ]
        self.assertTrue(links)
        wrong = [f"{page} links {to}#{anchor}" for page, to, anchor in links
                 if (anchor not in anchors.get(to, ()) if anchor else to not in self.known | self.folders)]
        self.assertNone(wrong, "no such file or heading:")

    def test_tests_that_documents_name_exist(self):
        tests = set()
        for path in self.files:
            if path.startswith("tests/") and path.endswith(".cc"):
                text = (_ROOT / path).read_text(encoding="utf-8")
                tests |= {f"{m[1]}.{m[2]}" for m in re.finditer(r"(?m)^TEST(?:_F|_P)?\((\w+),\s*(\w+)\)", text)}
        cited = [
            (path, name)
            for path, (text, _) in self.texts.items()
            if path.endswith(".md")
            for names in re.findall(r"\[((?:`[A-Z]\w+\.[A-Z]\w+`(?:, )?)+)\]", "\n".join(text))
            for name in re.findall(r"[\w.]+", names)
        ]
        self.assertTrue(cited)
        self.assertNone([f"{path} names {name}" for path, name in cited if name not in tests], "no such test:")


class Packages(unittest.TestCase):
    def test_every_peer_of_debian_is_installed_by_one_list_and_those_of_engines_for_everyone(self):
        listed = [re.findall(r"(?m)^[a-z][\w.+-]*", (_ROOT / name).read_text(encoding="utf-8"))
                  for name in ("cmake/packages/packages.txt", "cmake/packages/packages-peers.txt")]
        self.assertEqual(set(listed[0]) & set(listed[1]) - {"python3-venv"}, set())
        options = "".join(path.read_text(encoding="utf-8") for path in (_ROOT / "solvers/peers").glob("*/*.cmake"))
        wanted = re.findall(r"(?m)^lcpbench_peer_option\(\w+ \S+ ([\w.+-]+)\)", options)
        self.assertGreater(len(wanted), 5)
        self.assertEqual(set(wanted) - {*listed[0], *listed[1]}, set())
        self.assertLessEqual({"libode-dev", "libbullet-dev"}, set(listed[0]))


if __name__ == "__main__":
    unittest.main()
