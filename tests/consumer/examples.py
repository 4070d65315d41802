#!/usr/bin/python3
"""Writes the programs of a document to files: examples.py DOCUMENT FOLDER. A line `<!-- program in C: NAME -->`, or in
C++, stands before each, which is an indented block."""

import re
import sys
from pathlib import Path

_SUFFIXES = {"C": ".c", "C++": ".cc"}

document, folder = map(Path, sys.argv[1:3])
text = document.read_text(encoding="utf-8")
folder.mkdir(parents=True, exist_ok=True)
for language, name, block in re.findall(r"^<!-- program in (\S+): (\S+) -->\n\n((?:    .*\n|\n)+)", text, re.MULTILINE):
    program = re.sub(r"^    ", "", block, flags=re.MULTILINE)
    (folder / (name + _SUFFIXES[language])).write_text(program, encoding="utf-8")
