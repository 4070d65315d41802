"""The headline table as Markdown, for README.md."""

from . import tables
from .cells import Cells
from .errors import ReportError

BEGIN = "<!-- headline: written by report/headline.py -->"
END = "<!-- end of headline -->"


def headline(cells: Cells) -> str:
    """Solve time and rho per solver; the machine, commit and date above it."""
    run, solvers = cells.results.run, cells.results.solvers
    lines = [
        f"Solve time and ρ at the strictest tier passed, set-up excluded ({run['cpu']}, {run['compiler']}, one thread, "
        f"commit {run['git_commit'][:12]}{' with changes' if run['git_dirty'] else ''}, {run['started'][:10]}, "
        f"time limit {run['time_limit_s']:g} s; **bold**: fastest; a tier in brackets is looser than 1e-9):",
        "",
        "| scene | n | " + " | ".join(f"`{solver}`" for solver in solvers) + " |",
        "| --- | ---: |" + " ---: |" * len(solvers),
    ]
    for row in tables.headline(cells):
        name = f"`{row['family']}`" if row["first"] else ""
        lines.append(f"| {name} | {row['n']} | " + " | ".join(_cell(cell) for cell in row["cells"]) + " |")
    return "\n".join(lines) + "\n"


def _cell(cell: dict) -> str:
    if cell["kind"] == "absent":
        return "not run"
    if cell["kind"] != "passed":
        return cell["word"]
    time = f"**{cell['time']}**" if cell["best"] else cell["time"]
    return f"{time} · {cell['rho']}" + (f" ({cell['tier']})" if cell["looser"] else "")


def replace_between_markers(text: str, table: str, name: str) -> str:
    begin, end = text.find(BEGIN), text.find(END)
    if begin < 0 or end < begin:
        raise ReportError(name, "the markers of the table are missing", f"'{BEGIN}' and, after it, '{END}'")
    return text[:begin] + BEGIN + "\n\n" + table + "\n" + text[end:]
