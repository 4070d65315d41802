#!/usr/bin/python3
"""Writes the tables of data/README.md that say what the collection covers, from the manifests.

usage: coverage.py [--check]    (--check: exit status 1 where the README is not what would be written)
"""

import json
import sys
from pathlib import Path

_DATA = Path(__file__).resolve().parent
_README = _DATA / "README.md"
_BEGIN = "<!-- coverage: written by data/coverage.py -->"
_END = "<!-- end of coverage -->"
_TIERS = ["smoke", "engine", "standard", "large", "pathological"]

# (label, upper limit, inclusive)
_SIZES = [("1–3", 3), ("4–30", 30), ("31–300", 300), ("301–3000", 3000), ("3001–20 000", 20_000), ("10⁵–10⁶", 10**6)]
_REDUNDANCY = [("none", 0), ("≤ 0.2", 0.2), ("> 0.2", 1)]
_CONDITION = [("< 10³", 1e3), ("< 10⁶", 1e6), ("≥ 10⁶", float("inf"))]
_UNKNOWN = "?"


def kind_mix(kinds):
    """What the problem is made of, by the least common ingredient."""
    if not kinds:
        return "imported"
    if any(kind in kinds for kind in ("pin", "rod", "rope", "path joint")):
        return "joints"
    text = " ".join(kinds)
    if "ellipse" in text or "bezier" in text:
        return "ovals"
    if "concave" in text:
        return "concave arcs"
    return "arcs" if "arc" in text else "flat"


def _class(value, classes):
    if value is None:
        return _UNKNOWN
    return next(label for label, limit in classes if value <= limit)


def _columns():
    columns = [(r, c) for r, _ in _REDUNDANCY for c, _ in _CONDITION]
    return columns + [(_UNKNOWN, _UNKNOWN)]


def _cell(problem):
    redundancy = _class(problem["redundancy"], _REDUNDANCY)
    condition = _class(problem["condition"], _CONDITION)
    if _UNKNOWN in (redundancy, condition):
        return (_UNKNOWN, _UNKNOWN)
    return (redundancy, condition)


def _table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "| --- |" + " ---: |" * (len(header) - 1)]
    lines += ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]
    return "\n".join(lines)


def coverage(problems):
    """Size × kind mix by redundancy × condition, counted."""
    counts = {}
    for problem in problems:
        row = (_class(problem["rows"], _SIZES), kind_mix(problem["kinds"]))
        counts.setdefault(row, {}).setdefault(_cell(problem), 0)
        counts[row][_cell(problem)] += 1
    order = [label for label, _ in _SIZES]
    rows = []
    for row in sorted(counts, key=lambda r: (order.index(r[0]), r[1])):
        cells = counts[row]
        rows.append([f"{row[0]}, {row[1]}"] + [cells.get(c, "") for c in _columns()] + [sum(cells.values())])
    header = ["rows, kinds"] + [r if r == _UNKNOWN else f"{r}; {c}" for r, c in _columns()] + ["all"]
    return _table(header, rows)


def overview(manifests):
    """One row per tier."""
    rows = []
    for tier, manifest in manifests.items():
        problems = manifest["problems"]
        sizes = [p["rows"] for p in problems]
        kinds = [p["reference"]["kind"] for p in problems]
        rows.append(
            [f"`{tier}`", len(problems), f"{min(sizes)} … {max(sizes)}"]
            + [kinds.count(kind) for kind in ("certified", "bounded", "none")]
            + [len(manifest["refused"])]
        )
    return _table(["tier", "problems", "rows", "certified", "bounded", "no reference", "refused"], rows)


def weights(problems):
    """1 / k for each of the k problems that have a base in common."""
    bases = [problem["base"] for problem in problems]
    counts = {base: bases.count(base) for base in set(bases)}
    return [1 / counts[base] for base in bases]


def motion_share(problems):
    """Of the problems' weight, the part of steps of motions."""
    of_motions = [w for problem, w in zip(problems, weights(problems)) if problem["origin"] == "motion"]
    return sum(of_motions) / sum(weights(problems))


# Size classes of benchmarks/collection/properties.h that the standard tier's motions are meant for.
_MOTION_CLASSES = [("31–100", 31, 100), ("101–300", 101, 300), ("301–1000", 301, 1000), ("1001–10⁴", 1001, 10_000)]


def motions(problems):
    """How much of the standard tier's weight are steps of motions, by size class; fill-ups are not among them."""
    rows = []
    for label, least, most in [*_MOTION_CLASSES, ("all", 1, 10**9)]:
        chosen = [problem for problem in problems if least <= problem["rows"] <= most]
        steps = [problem for problem in chosen if problem["origin"] == "motion"]
        row = [label, len(chosen), len({problem["base"] for problem in chosen}), len(steps)]
        rows.append(row + [len({problem["base"] for problem in steps}), f"{100 * motion_share(chosen):.0f} %"])
    return _table(["rows", "problems", "bases", "steps of motions", "motions", "their weight"], rows)


def fill_ups(manifests):
    """Size classes that are filled up."""
    rows = []
    for tier, manifest in manifests.items():
        for entry in manifest.get("fill", []):
            refused = ", ".join(f"{reason}: {count}" for reason, count in entry["refused_by_reason"].items())
            rows.append([f"`{tier}`: {entry['size_class']} rows", entry["problems"], refused])
    return _table(["fill-ups", "problems", "refused"], rows)


def _answer_kind(problem):
    if problem["fraction_active"] == 1 or problem["bilateral"] == problem["rows"]:
        return "all rows active"
    if problem["fraction_active"] > 0:
        return "some"
    return "no active contact" if problem["bilateral"] else "f = 0"


def small_answers(problems):
    """What the engine tier's answers are: nothing is refused there."""
    kinds = ["f = 0", "no active contact", "all rows active", "some"]
    rows = []
    for size in (1, 2, 3):
        found = [_answer_kind(problem) for problem in problems if problem["rows"] == size]
        rows.append([size] + [found.count(kind) for kind in kinds])
    return _table(["rows"] + [kind + " of the contacts active" if kind == "some" else kind for kind in kinds], rows)


def references(manifests):
    """How references are proved, and how tight bounds are."""
    rows = {}
    for manifest in manifests.values():
        for problem in manifest["problems"]:
            reference = problem["reference"]
            name = reference["kind"]
            if name == "none":
                continue
            name += ": " + reference.get("proof", reference["status"])
            rows.setdefault(name, []).append(reference)
    table = []
    for name in sorted(rows):
        row = [name, len(rows[name])]
        for field in ("w_bound", "energy_shift"):
            values = sorted(r[field] for r in rows[name] if field in r)
            row += [f"{values[len(values) // 2]:.1e}", f"{values[-1]:.1e}"] if values else ["exact", "exact"]
        table.append([str(cell).replace("0.0e+00", "0") for cell in row])
    header = ["reference", "problems", "bound of w: median", "largest", "shift of b: median", "largest"]
    return _table(header, table)


def refusals(manifests):
    """Candidates that were not taken, by tier and reason."""
    rows = []
    for tier, manifest in manifests.items():
        rows += [[f"`{tier}`: {reason}", count] for reason, count in manifest["refused_by_reason"].items()]
    return _table(["refused", "candidates"], rows)


def sequences(entries):
    """One row per sequence."""
    rows = []
    for entry in entries:
        sizes = entry["rows"]
        rows.append(
            [f"`{entry['id']}`", entry["problems"], f"{sizes['least']} / {sizes['median']} / {sizes['most']}"]
            + [entry["changes"][key] for key in ("entered", "left", "activated", "deactivated")]
            + [entry["churn"], f"{100 * entry['still_share']:.0f} %"]
        )
    header = ["sequence", "problems", "rows", "entered", "left", "activated", "deactivated", "churn", "still"]
    return _table(header, rows)


def text():
    manifests = {tier: json.loads((_DATA / f"{tier}.json").read_text(encoding="utf-8")) for tier in _TIERS}
    entries = json.loads((_DATA / "sequences.json").read_text(encoding="utf-8"))["sequences"]
    everything = [problem for manifest in manifests.values() for problem in manifest["problems"]]
    return "\n\n".join(
        [
            _BEGIN,
            overview(manifests),
            "Problems by size and kinds of constraints (rows), redundancy 1 − rank/n and condition of A (columns, "
            "`redundancy; condition`; `?`: not measured):",
            coverage(everything),
            "How the answers are known, how far w / √A_ii may be off, and by how much D^-½ b of the problem that this is "
            "proved for differs from the given one:",
            references(manifests),
            "Candidates that were not taken:",
            refusals(manifests),
            "Steps of motions in `standard`, by weight (each of k problems of one base 1/k; fill-ups are not among these):",
            motions(manifests["standard"]["problems"]),
            "Fill-ups:",
            fill_ups(manifests),
            "What few rows have as answer (`engine`, where nothing is refused):",
            small_answers(manifests["engine"]["problems"]),
            "Sequences (rows: least / median / most; rows that came, went, became active, ceased to be; churn: all of "
            "these by rows, mean; still: problems without any):",
            sequences(entries),
            _END,
        ]
    )


def updated(readme):
    begin = readme.index(_BEGIN)
    end = readme.index(_END) + len(_END)
    return readme[:begin] + text() + readme[end:]


def main():
    readme = _README.read_text(encoding="utf-8")
    new = updated(readme)
    if "--check" in sys.argv[1:]:
        return 0 if new == readme else 1
    _README.write_text(new, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
