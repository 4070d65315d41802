#!/usr/bin/python3
"""Prints what the collection covers, as Markdown tables, from the manifests. It has no options."""

import json
from collections import Counter
from pathlib import Path

_DATA = Path(__file__).resolve().parent
_TIERS = ["smoke", "engine", "standard", "large", "pathological", "recorded", "literature", "nonsymmetric",
          "friction-engine", "friction", "friction-recorded", "friction-literature", "friction-pathological", "painleve"]

# (label, upper limit, inclusive)
_SIZES = [("1–3", 3), ("4–30", 30), ("31–300", 300), ("301–3000", 3000), ("3001–20 000", 20_000), ("10⁵–10⁶", 10**6)]
_REDUNDANCY = [("none", 0), ("≤ 0.2", 0.2), ("> 0.2", 1)]
_CONDITION = [("< 10³", 1e3), ("< 10⁶", 1e6), ("≥ 10⁶", float("inf"))]
_UNKNOWN = "?"


def kind_mix(kinds):
    """What the problem is made of, by the least common ingredient."""
    if not kinds:
        return "no geometry"
    if any(kind in kinds for kind in ("pin", "rod", "rope", "path joint")):
        return "joints"
    text = " ".join(kinds)
    if "ellipse" in text or "bezier" in text:
        return "ovals"
    if "concave" in text:
        return "concave arcs"
    return "arcs" if "arc" in text else "flat"


def _class(value, classes):
    return _UNKNOWN if value is None else next(label for label, limit in classes if value <= limit)


def _table(header, rows):
    lines = [header, ["---"] + ["---:"] * (len(header) - 1), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines)


def coverage(problems):
    """Size × kind mix by redundancy × condition, counted."""
    def cell(problem):
        known = _class(problem["redundancy"], _REDUNDANCY), _class(problem["condition"], _CONDITION)
        return (_UNKNOWN, _UNKNOWN) if _UNKNOWN in known else known

    counts = Counter((_class(p["rows"], _SIZES), kind_mix(p["kinds"]), cell(p)) for p in problems)
    columns = [(r, c) for r, _ in _REDUNDANCY for c, _ in _CONDITION] + [(_UNKNOWN, _UNKNOWN)]
    order = [label for label, _ in _SIZES]
    rows = []
    for size, kinds in sorted({key[:2] for key in counts}, key=lambda row: (order.index(row[0]), row[1])):
        cells = [counts[size, kinds, column] for column in columns]
        rows.append([f"{size}, {kinds}", *(count or "" for count in cells), sum(cells)])
    return _table(["rows, kinds", *(r if r == _UNKNOWN else f"{r}; {c}" for r, c in columns), "all"], rows)


def overview(manifests):
    """One row per tier."""
    rows = []
    for tier, manifest in manifests.items():
        sizes = [p["rows"] for p in manifest["problems"]]
        kinds = Counter(p["reference"]["kind"] for p in manifest["problems"])
        rows.append([f"`{tier}`", len(sizes), f"{min(sizes)} … {max(sizes)}",
                     *(kinds[kind] for kind in ("certified", "bounded", "none")), len(manifest["refused"])])
    return _table(["tier", "problems", "rows", "certified", "bounded", "no reference", "refused"], rows)


def weights(problems):
    """1 / k for each of the k problems that have a base in common."""
    counts = Counter(problem["base"] for problem in problems)
    return [1 / counts[problem["base"]] for problem in problems]


def motion_share(problems):
    """The share of the problems' weight that steps of motions have."""
    of_motions = [w for problem, w in zip(problems, weights(problems)) if problem["origin"] == "motion"]
    return sum(of_motions) / sum(weights(problems))


# Size classes of benchmarks/collection/properties.h.
_CLASSES = [("1", 1), ("2–3", 3), ("4–6", 6), ("7–12", 12), ("13–30", 30), ("31–100", 100), ("101–300", 300),
            ("301–1000", 1000), ("1001–10⁴", 10_000)]


def of_class(problems, label):
    return [problem for problem in problems if _class(problem["rows"], _CLASSES) == label]


def motions(problems):
    """How much of the standard tier's weight are steps of motions, by size class; fill-ups are not among them."""
    rows = []
    for label in ("31–100", "101–300", "301–1000", "1001–10⁴", "all"):
        chosen = problems if label == "all" else of_class(problems, label)
        steps = [problem for problem in chosen if problem["origin"] == "motion"]
        bases, of_steps = (len({problem["base"] for problem in some}) for some in (chosen, steps))
        rows.append([label, len(chosen), bases, len(steps), of_steps, f"{100 * motion_share(chosen):.0f} %"])
    return _table(["rows", "problems", "bases", "steps of motions", "motions", "their weight"], rows)


def engines(problems):
    """What engines contribute to each size class."""
    rows = []
    for label, _ in _CLASSES:
        chosen = of_class(problems, label)
        scenes = {problem["family"] for problem in chosen}
        rows.append([label, len(chosen), len({problem["base"] for problem in chosen}), len(scenes),
                     len({scene.split()[0] for scene in scenes})])
    return _table(["rows", "problems", "bases", "scenes", "engines"], rows)


def fill_ups(manifests):
    """Size classes that are filled up."""
    rows = [[f"`{tier}`: {entry['size_class']} rows", entry["problems"],
             ", ".join(f"{reason}: {count}" for reason, count in entry["refused_by_reason"].items())]
            for tier, manifest in manifests.items() for entry in manifest.get("fill", [])]
    return _table(["fill-ups", "problems", "refused"], rows)


def small_answers(problems):
    """What the engine tier's answers are: nothing is refused there."""
    kinds = ["f = 0", "no active contact", "all rows active", "some of the contacts active"]

    def kind(problem):
        if problem["fraction_active"] == 1 or problem["bilateral"] == problem["rows"]:
            return kinds[2]
        return kinds[3] if problem["fraction_active"] > 0 else kinds[bool(problem["bilateral"])]

    found = Counter((problem["rows"], kind(problem)) for problem in problems)
    return _table(["rows", *kinds], [[size, *(found[size, kind] for kind in kinds)] for size in (1, 2, 3)])


def references(manifests):
    """How references are proved, and how tight bounds are."""
    by_name = {}
    for reference in (problem["reference"] for manifest in manifests.values() for problem in manifest["problems"]):
        if reference["kind"] != "none":
            name = f"{reference['kind']}: {reference.get('proof', reference['status'])}"
            by_name.setdefault(name, []).append(reference)
    rows = []
    for name, found in sorted(by_name.items()):
        row = [name, len(found)]
        for field in ("w_bound", "energy_shift"):
            values = sorted(r[field] for r in found if field in r)
            unknown = ["exact" if name.startswith("certified") else "–"] * 2
            row += [f"{values[len(values) // 2]:.1e}", f"{values[-1]:.1e}"] if values else unknown
        rows.append([str(cell).replace("0.0e+00", "0") for cell in row])
    return _table(["reference", "problems", "bound of w: median", "largest", "shift of b: median", "largest"], rows)


def refusals(manifests):
    """Candidates that were not taken, by tier and reason."""
    return _table(["refused", "candidates"], [[f"`{tier}`: {reason}", count] for tier, manifest in manifests.items()
                                              for reason, count in manifest["refused_by_reason"].items()])


def friction(manifests):
    """What the contacts of problems with friction do, and how many of these have which answers."""
    rows = []
    for tier, manifest in manifests.items():
        chosen = [problem for problem in manifest["problems"] if "friction" in problem]
        if not chosen:
            continue
        solved = [problem for problem in chosen if "open" in problem]
        shares = [f"{100 * sum(p[key] for p in solved) / len(solved):.0f} %" for key in ("open", "stick", "slip")]
        answers = [sum(p["reference"].get("status") == "infeasible" for p in chosen),
                   *(sum(p["reference"].get("f_unique") is unique for p in solved) for unique in (True, False))]
        rows.append([f"`{tier}`", len(chosen), *shares, *answers, len(chosen) - sum(answers)])
    return _table(["tier", "problems", "open", "stick", "slip", "no solution", "one f", "several", "not known"], rows)


def sequences(entries):
    """One row per sequence."""
    changes = ["entered", "left", "activated", "deactivated"]
    rows = [[f"`{entry['id']}`", entry["problems"], "{least} / {median} / {most}".format(**entry["rows"]),
             *(entry["changes"][key] for key in changes), entry["churn"], f"{100 * entry['still_share']:.0f} %"]
            for entry in entries]
    return _table(["sequence", "problems", "rows", *changes, "churn", "still"], rows)


def text():
    manifests = {tier: json.loads((_DATA / f"{tier}.json").read_text(encoding="utf-8")) for tier in _TIERS}
    entries = [entry for tier in ("sequences", "recorded", "friction-sequences")
               for entry in json.loads((_DATA / f"{tier}.json").read_text(encoding="utf-8"))["sequences"]]
    everything = [problem for manifest in manifests.values() for problem in manifest["problems"]]
    return "\n\n".join([
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
        "Problems of engines (`recorded`), by size class:",
        engines(manifests["recorded"]["problems"]),
        "Problems of engines with friction (`friction-recorded`), by size class:",
        engines(manifests["friction-recorded"]["problems"]),
        "Fill-ups:",
        fill_ups(manifests),
        "What few rows have as answer (`engine`, where nothing is refused):",
        small_answers(manifests["engine"]["problems"]),
        "Problems with friction: means over the problems of the shares of their friction rows that are open, stick and "
        "slip, and how many problems have no solution, one f or several:",
        friction(manifests),
        "Sequences (rows: least / median / most; rows that came, went, became active, ceased to be; churn: all of "
        "these by rows, mean; still: problems without any):",
        sequences(entries),
    ])


if __name__ == "__main__":
    print(text())
