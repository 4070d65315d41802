#!/usr/bin/python3
"""Draws which folders include which as docs/includes.svg, lower layers below. Run it when tests/house_test.py says that
the drawing is out of date; a new folder needs a place in _BOXES first, and a new long arrow one in _LANES."""

import html
import re
import subprocess
from collections import Counter
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]
DRAWING = ROOT / "docs" / "includes.svg"
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
    if top == "benchmarks":
        return top
    if re.match(r"solvers/peers/(?!protocol$)", folder):
        return "solvers/peers/<library>"
    return folder if top in ("support", "solvers", "model") else None


def drawn(found):
    """(boxes, {(from, to): number of includes}), an arrow only where no way over other boxes leads from one to the
    other: the transitive reduction, without which most boxes would point to support and solvers/lcp."""
    arrows = Counter()
    boxes = set()
    for include in found:
        source, target = box_of(include.source), box_of(include.target)
        boxes.update({source, target} - {None})
        if source and target and source != target:
            arrows[source, target] += 1
    below = {box: {target for source, target in arrows if source == box} for box in boxes}

    def reachable(box, seen):
        for other in below[box] - seen:
            seen.add(other)
            reachable(other, seen)
        return seen

    implied = {(box, far) for box in boxes for near in below[box] for far in reachable(near, set())}
    return boxes, {arrow: number for arrow, number in arrows.items() if arrow not in implied}


_LEFT = [30, 162, 294, 426, 558, 728, 856]  # of columns
_WIDTH = 114
_PITCH, _HEIGHT, _HEADING, _ROWS = 88, 50, 66, 10


class Box(NamedTuple):
    row: int  # from below; arrows point to lower rows
    left: int
    right: int
    text: tuple  # what the folder holds, a line each

    @property
    def middle(self):
        return (self.left + self.right) / 2

    @property
    def is_wide(self):
        return self.right - self.left > 3 * _WIDTH


def _top(row):
    return _HEADING + (_ROWS - 1 - row) * _PITCH


def _at(row, column, *text, span=0):
    left = _LEFT[int(column)] + (column % 1) * 132
    return Box(row, round(left), round(left + _WIDTH + span), text)


_BOXES = {
    "benchmarks": Box(9, 14, 986, ("the command lcpbench, problem collection, campaigns, studies, advice, pictures",)),
    "solvers/c": _at(8, 0, "the interface", "for C programs"),
    "solvers": _at(7, 1, "the registry: makes", "solvers by key"),
    "solvers/batch": _at(6, 2.5, "small problems,", "many at once"),
    "solvers/step": _at(7, 2.5, "an engine's arrays", "to forces"),
    "solvers/rows": _at(4, 1, "islands of a step,", "profile factors"),
    "solvers/auto": _at(5, 2, "chooses a method,", "then asks another"),
    "solvers/ipopt": _at(5, 0, "ipopt-qp, ipopt-ncp"),
    "solvers/interior_point": _at(4, 3, "ipm, hybrid"),
    "solvers/peers/<library>": _at(4, 0, "Bullet, ODE, DART…"),
    "solvers/peers": _at(3, 0, "other projects'", "solvers"),
    "solvers/pivoting": _at(3, 1, "dantzig, lemke"),
    "solvers/active_set": _at(3, 2, "bpp, active-set,", "semismooth-newton"),
    "solvers/first_order": _at(3, 3, "pgs, psor, apgd,", "nncg"),
    "solvers/exact": _at(3, 4, "answers in rational", "numbers, proofs"),
    "solvers/peers/protocol": _at(2, 0, "worker processes"),
    "solvers/linear_algebra": _at(2, 1, "factors of", "active rows"),
    "solvers/answers": _at(2, 2, "judges candidates,", "keeps the best"),
    "solvers/first_order/sweeps": _at(2, 3, "passes over rows"),
    "solvers/io": _at(2, 4, "files of problems", "and answers"),
    "solvers/lcp": Box(1, 30, 672, ("the problem, the interface of solvers, the verifier that judges every answer",)),
    "model/scenes": _at(6, 5, "families of scenes,", "by size and seed"),
    "model/scene_file": _at(6, 6, "scenes as JSON"),
    "model/motion": _at(5, 5, "time steps, impacts"),
    "model/detection": _at(4, 5, "which bodies touch,", "and where"),
    "model/shape": _at(3, 5, "outlines and", "their masses"),
    "model/records": _at(3, 6, "contacts from", "other programs"),
    "model/contact": _at(2, 5.5, "bodies, rows of J,", "the LCP's A and b"),
    "model/geometry": _at(1, 5, "vectors, edges, curves, bounding boxes", span=128),
    "support": Box(0, 14, 986, ("clock, files, JSON fields, child processes, errors: nothing of LCPs",)),
}
# x at which a long arrow passes the rows between its boxes; the others go straight.
_LANES = {
    ("benchmarks", "model/records"): 850,
    ("solvers", "solvers/peers"): 153,
    ("solvers/ipopt", "solvers/lcp"): 22,
    ("solvers/interior_point", "solvers/answers"): 417,
    ("solvers/interior_point", "solvers/linear_algebra"): 285,
    ("solvers/peers/<library>", "solvers/linear_algebra"): 153,
}
_NAMES = {"solvers": "solvers/*.h"}  # what the box holds, where that is not the whole folder
_PANELS = {"solvers": (14, 688, 568), "model": (712, 986, 751)}  # behind a top folder's boxes: left, right, its name
_PANEL_TOP_ROW = 8
_COLOURS = {  # panel, box, lines
    "support": ("#ffffff", "#eceff1", "#455a64"),
    "solvers": ("#eff5fc", "#ffffff", "#1f5f9f"),
    "model": ("#eef7ee", "#ffffff", "#2e7d32"),
    "benchmarks": ("#ffffff", "#fdf0dc", "#a65b00"),
}
_SUBTITLE = ("A folder includes only what is below it. solvers/ knows no bodies and model/ no methods; what they share is "
             "solvers/lcp.")
_CAPTION = (
    "An arrow: files of the upper folder include headers of the lower one; thin: 1 or 2 includes, thicker: 3 to 8, "
    "9 and more.",
    "Arrows that others imply are left out: solvers/pivoting also includes solvers/lcp directly, and most folders "
    "include support.",
    "benchmarks/ and solvers/peers/<library> stand for the folders in them. Drawn by docs/draw_includes.py; "
    "a test compares it with the tree.",
)
_WIDEST = [(9, 3.4), (3, 2.2), (1, 1.2)]  # from so many includes on, the width of an arrow
_HEAD = 7  # length of an arrow's head


def _end(box, other, lane):
    """Where an arrow from or to `box` begins or ends: towards `other`; above, below or on its lane at a wide box."""
    if box.is_wide:
        wanted = lane or min(box, other, key=lambda b: b.right - b.left).middle
        return min(max(wanted, box.left + 16), box.right - 16)
    return box.middle + (0 if other.is_wide else min(max((other.middle - box.middle) / 7, -42), 42))


def _route(arrow):
    """[(x, y), ...]: from the bottom of a box, by the arrow's lane where it has one, to the top of another."""
    source, target = (_BOXES[box] for box in arrow)
    if source.row <= target.row:
        raise ValueError(f"{arrow[0]} includes {arrow[1]} and must be drawn above it: change its row in _BOXES")
    lane = _LANES.get(arrow)
    begin, end = _end(source, target, lane), _end(target, source, lane)
    between = [(lane, _top(source.row - 1) - 4), (lane, _top(target.row + 1) + _HEIGHT + 4)] if lane else []
    return [(begin, _top(source.row) + _HEIGHT), *between, (end, _top(target.row) - _HEAD)]


def _curve(route):
    """Between rows curves that begin and end upright, along a row straight down."""
    parts = [f"M{route[0][0]:.1f},{route[0][1]}"]
    for (x0, y0), (x1, y1) in zip(route, route[1:]):
        middle = (y0 + y1) / 2
        parts.append(f"L{x1:.1f},{y1}" if x0 == x1 else f"C{x0:.1f},{middle:.1f} {x1:.1f},{middle:.1f} {x1:.1f},{y1}")
    return " ".join(parts)


def _text(x, y, size, words, extra="", anchor="middle"):
    return f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" text-anchor="{anchor}"{extra}>{html.escape(words)}</text>'


def _box(folder, box):
    top, _, inner = folder.partition("/")
    above, _, name = inner.rpartition("/")
    _, fill, line = _COLOURS[top]
    y, width = _top(box.row), box.right - box.left
    lines = [(9.5, above + "/", f' fill="{line}"')] if above else []
    lines.append((12.5, name or _NAMES.get(top, f"{top}/"), f' font-weight="bold" fill="{line}"'))
    lines += [(10, text, "") for text in box.text]
    parts = [
        f'<g data-folder="{html.escape(folder)}">',
        f'<rect x="{box.left}" y="{y}" width="{width}" height="{_HEIGHT}" rx="6" fill="{fill}" stroke="{line}"/>',
    ]
    baseline = y + (_HEIGHT - sum(size + 2.5 for size, _, _ in lines)) / 2 - 2.5
    for size, text, extra in lines:
        if len(text) * size * 0.6 > width + 6:
            raise ValueError(f"too long for its box: {text}")
        baseline += size + 2.5
        parts.append(_text(box.middle, baseline, size, text, extra))
    return [*parts, "</g>"]


def drawing(boxes, arrows):
    if boxes != set(_BOXES):
        lacks, needless = sorted(boxes - set(_BOXES)), sorted(set(_BOXES) - boxes)
        raise ValueError(f"_BOXES lacks {lacks} and has without need {needless}")
    bottom = _top(0) + _HEIGHT
    height = bottom + 84
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1000 {height}" width="1000" height="{height}" '
        'font-family="Helvetica, Arial, sans-serif" fill="#263238">',
        "<title>Who includes whom</title>",
        f'<rect width="1000" height="{height}" fill="#ffffff"/>',
        _text(14, 30, 19, "Who includes whom", ' font-weight="bold"', "start"),
        _text(14, 49, 11.5, _SUBTITLE, "", "start"),
    ]
    for top, (left, right, name) in _PANELS.items():
        fill, _, line = _COLOURS[top]
        y = _top(_PANEL_TOP_ROW) - 12
        parts.append(
            f'<rect x="{left}" y="{y}" width="{right - left}" height="{_top(1) + _HEIGHT + 14 - y}" rx="10" '
            f'fill="{fill}" stroke="{line}" stroke-opacity="0.25"/>'
        )
        parts.append(_text(name, y + 26, 15, f"{top}/", f' font-weight="bold" fill="{line}"'))
    for arrow in sorted(arrows):
        colour = _COLOURS[arrow[0].partition("/")[0]][2]
        width = next(width for least, width in _WIDEST if arrows[arrow] >= least)
        route = _route(arrow)
        x, y = route[-1]
        half = 3 + width / 2
        parts.append(
            f'<g data-from="{html.escape(arrow[0])}" data-to="{html.escape(arrow[1])}">'
            f'<path d="{_curve(route)}" fill="none" stroke="{colour}" stroke-width="{width}" stroke-opacity="0.75"/>'
            f'<path d="M{x - half:.1f},{y - 1} L{x + half:.1f},{y - 1} L{x:.1f},{y + _HEAD} Z" fill="{colour}"/></g>'
        )
    for folder in sorted(_BOXES):
        parts += _box(folder, _BOXES[folder])
    parts += [_text(14, bottom + 28 + 17 * i, 11.5, line, "", "start") for i, line in enumerate(_CAPTION)]
    return "\n".join([*parts, "</svg>", ""])


def read_drawing(text):
    """(boxes, arrows) that a drawing shows."""
    boxes = {html.unescape(folder) for folder in re.findall(r'data-folder="(.*?)"', text)}
    arrows = {tuple(map(html.unescape, pair)) for pair in re.findall(r'data-from="(.*?)" data-to="(.*?)"', text)}
    return boxes, arrows


if __name__ == "__main__":
    files = tracked_files()
    own = set(files)
    DRAWING.write_text(drawing(*drawn(i for i in includes(files) if i.target in own)), encoding="utf-8")
