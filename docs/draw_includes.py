#!/usr/bin/python3
"""Writes which folders include which into docs/architecture.md. Run it when tests/house_test.py says that the chart is
out of date."""

import html
import re
import subprocess
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]
DOCUMENT = ROOT / "docs" / "architecture.md"
_BEGIN, _END = "<!-- includes: written by docs/draw_includes.py -->", "<!-- end of includes -->"
_INCLUDE = re.compile(r'\s*#\s*include\s*(["<])([^">]+)[">]')


class Include(NamedTuple):
    source: str  # the file that includes, from the root
    line: int
    target: str  # as it is written
    is_quoted: bool

    def __str__(self):
        return f"{self.source}:{self.line} includes {self.target}"


def tracked_files(root=ROOT):
    """Paths from the root; without a git repository, every file outside build folders."""
    listed = subprocess.run(["git", "-C", str(root), "ls-files", "-z"], capture_output=True, check=False)
    if listed.returncode == 0 and listed.stdout:
        return sorted(path for path in listed.stdout.decode().split("\0") if path and (root / path).is_file())
    found = [path.relative_to(root) for path in root.rglob("*") if path.is_file()]
    return sorted(path.as_posix() for path in found if not {".git", "build", "__pycache__"}.intersection(path.parts))


def includes(files, root=ROOT):
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


def box_of(path):
    """The box that a file is drawn in, or None."""
    folder = folder_of(path)
    top = folder.partition("/")[0]
    if top in ("benchmarks", "python"):
        return top
    if re.match(r"solvers/peers/(?!protocol$)", folder):
        return "solvers/peers/<library>"
    return folder if top in ("support", "solvers", "model") else None


def drawn(found):
    """(boxes, arrows), an arrow only where no way over other boxes leads from one to the other: the transitive
    reduction, without which most boxes would point to support and solvers/lcp."""
    arrows = set()
    boxes = set()
    for include in found:
        source, target = box_of(include.source), box_of(include.target)
        boxes.update({source, target} - {None})
        if source and target and source != target:
            arrows.add((source, target))
    below = {box: {target for source, target in arrows if source == box} for box in boxes}

    def reachable(box, seen):
        for other in below[box] - seen:
            seen.add(other)
            reachable(other, seen)
        return seen

    implied = {(box, far) for box in boxes for near in below[box] for far in reachable(near, set())}
    return boxes, arrows - implied


def chart(boxes, arrows):
    """A flowchart for Mermaid, which lays it out; as text a line for each folder that includes others."""
    names = {box: re.sub(r"\W+", "_", box).strip("_") for box in boxes}
    lines = ["```mermaid", "flowchart TD"]
    for top in sorted({box.partition("/")[0] for box in boxes}):
        inside = [f'{names[box]}["{html.escape(box)}"]' for box in sorted(boxes) if box.partition("/")[0] == top]
        lines += [f"  subgraph of_{top}[{top}]", *(f"    {node}" for node in inside), "  end"] if len(inside) > 1 else []
    for box in sorted(boxes):
        below = [names[target] for source, target in sorted(arrows) if source == box]
        lines += [f"  {names[box]} --> {' & '.join(below)}"] if below else []
    return "\n".join([*lines, "```"])


def with_chart(text, found):
    """The text of docs/architecture.md with the chart of these includes."""
    before, _, rest = text.partition(_BEGIN)
    _, end, after = rest.partition(_END)
    if not end:
        raise ValueError(f"{DOCUMENT.name} lacks the lines '{_BEGIN}' and '{_END}'")
    return f"{before}{_BEGIN}\n{chart(*drawn(found))}\n{_END}{after}"


if __name__ == "__main__":
    files = tracked_files()
    own = set(files)
    text = DOCUMENT.read_text(encoding="utf-8")
    DOCUMENT.write_text(with_chart(text, [i for i in includes(files) if i.target in own]), encoding="utf-8")
