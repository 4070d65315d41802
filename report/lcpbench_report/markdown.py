"""The headline table as Markdown, for README.md."""

from . import formats, tables
from .cells import Cells
from .errors import ReportError

BEGIN = "<!-- headline: written by report/headline.py -->"
END = "<!-- end of headline -->"
# The tier that every solver here is meant for.
_TIER = 1e-6


def headline(cells: Cells) -> str:
    """A row per solver, a column per size; the machine, commit and date above it."""
    run, results = cells.results.run, cells.results
    tier = min(results.tiers, key=lambda t: abs(t - _TIER))
    sizes = tables.all_sizes(cells)
    families = [sum(n in cells.sizes(family) for family in results.families) for n in sizes]
    lines = [
        f"Median over scene families of the solve time at tier {formats.tier(tier)}, set-up and conversion excluded, "
        f"and how many families are verified ({run['cpu']}, {run['compiler']}, one thread, "
        f"commit {run['git_commit'][:12]}{' with changes' if run['git_dirty'] else ''}, {run['started'][:10]}, "
        f"at most {run['time_limit_s']:g} s a solve; **bold**: fastest of those that verify most):",
        "",
        "| solver | " + " | ".join(f"n = {n}" for n in sizes) + " |",
        "| --- |" + " ---: |" * len(sizes),
    ]
    for row in tables.headline(cells, tier):
        lines.append(f"| `{row['solver']}` | " + " | ".join(_cell(cell) for cell in row["cells"]) + " |")
    lines.append("| families | " + " | ".join(map(str, families)) + " |")
    if results.missing:
        lines += ["", "Not in this build: " + ", ".join(f"`{solver}`" for solver in results.missing) + "."]
    return "\n".join(lines) + "\n"


def _cell(cell: dict) -> str:
    if not cell["verified"]:
        return formats.DASH if cell["excluded"] else "✗ " + cell["word"]
    time = f"**{cell['time']}**" if cell["best"] else cell["time"]
    return f"{time} · {cell['verified']}"


def replace_between_markers(text: str, table: str, name: str) -> str:
    begin, end = text.find(BEGIN), text.find(END)
    if begin < 0 or end < begin:
        raise ReportError(name, "the markers of the table are missing", f"'{BEGIN}' and, after it, '{END}'")
    return text[:begin] + BEGIN + "\n\n" + table + "\n" + text[end:]
