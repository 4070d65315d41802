"""All figures and tables of a report's inputs as files."""

import gzip
import shutil
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from .. import choice, motion, shown_tables
from ..files import replaced, write_text
from ..inputs import Inputs
from ..statistics.tables import write_csv
from ..formats import power
from . import canvas, curves, quality, speed, steps

_OF_CELLS = {"time-by-size": speed.by_size, "time-by-family": speed.by_family, "accuracy": quality.distributions,
             "coverage": quality.bars, "work-precision": quality.work_precision, "scaling": speed.exponents, "profile-by-origin": speed.profile_by_origin,
             "robustness": quality.pathological, "robustness-grids": quality.grids}
_OF_SEQUENCES = {"sequence-latency": steps.latency, "sequence-deadlines": steps.deadlines}
_LARGE = 1_000_000  # bytes of a CSV file that is compressed


def write_static(inputs: Inputs, folder: Path) -> list[Path]:
    """figures/*.svg and *.pdf, tables/*.csv (large ones *.csv.gz) and *.tex; the same bytes for the same inputs. What
    the inputs do not have is left out.

    @returns the files, in the order in which they were written
    """
    written = []
    with canvas.look():
        for name, draw in figures(inputs):
            if (figure := draw()) is not None:
                written += canvas.save(figure, folder / "figures", name)
    return written + write_tables(inputs, folder / "tables")


def figures(inputs: Inputs) -> Iterator[tuple[str, Callable]]:
    """(name, function that draws it or returns None)"""
    for tier in choice.shown_tiers(inputs):
        yield f"profile-{power(tier)}", partial(speed.profile, inputs, tier)
    for name, draw in ((_OF_CELLS if len(inputs.cells) else {}) | _OF_SEQUENCES).items():
        yield name, partial(draw, inputs)
    for scene, level in motion.scenes(inputs.motion):
        yield f"motion-{Path(scene).stem}-{level}", partial(steps.errors, inputs, scene, level)
    for figure in curves.figures(inputs):
        yield figure.name, figure.draw


def write_tables(inputs: Inputs, folder: Path) -> list[Path]:
    folder.mkdir(parents=True, exist_ok=True)
    studied = {} if inputs.motion is None else {"motion": inputs.motion}
    studied |= {f"curve-{name}": table for name, table in inputs.curves.items()}
    written = [_write_csv(table, folder / f"{name}.csv") for name, table in (dict(inputs.analysis) | studied).items()]
    papers = {name: table for name, make in shown_tables.PAPERS.items() if (table := make(inputs)) is not None}
    texts = {f"{name}.tex": f"% {name}: written by LCPBench, see README.md beside it\n{table.latex()}"
             for name, table in papers.items()}
    texts["README.md"] = _readme(list(texts))
    for name, text in texts.items():
        written.append(folder / name)
        write_text(written[-1], text)
    return written


def write_figure_of_times(inputs: Inputs, path: Path) -> None:
    """The one that README.md shows, where there are sizes enough."""
    with canvas.look():
        if (figure := speed.by_size(inputs)) is not None:
            canvas.save_svg(figure, path)
            canvas.plt.close(figure)


def _readme(tex: list[str]) -> str:
    """What the folder holds and how a paper uses it."""
    lines = ["# Tables", "",
             "`*.csv`: all tables of the analysis, as `lcpbench analyse` writes them, and the studies of motion and curves (columns: "
             "benchmarks/RESULTS.md); large ones are compressed (`.csv.gz`).", ""]
    if tex:
        names = ", ".join(f"`{name}`" for name in tex)
        lines += [f"`*.tex`: the same in short for papers: {names}. They need", "",
                  r"    \usepackage{booktabs}", r"    \usepackage{textcomp}", "",
                  "and stand in a table of your own, which has the caption:", "",
                  *("    " + line for line in (r"\begin{table*}", r"  \centering", rf"  \input{{tables/{tex[0]}}}",
                                               r"  \caption{...}", r"\end{table*}")), "",
                  "The files are UTF-8 with LaTeX's own commands only. Wide ones fit the width of two columns; "
                  "`\\resizebox{\\linewidth}{!}{\\input{...}}` (graphicx) fits them to another."]
    return "\n".join(lines) + "\n"


def _write_csv(table, path: Path) -> Path:
    """Compressed where large, without a time stamp."""
    packed = path.with_name(path.name + ".gz")
    packed.unlink(missing_ok=True)
    write_csv(table, path)
    if path.stat().st_size <= _LARGE:
        return path
    with path.open("rb") as source, replaced(packed) as beside, beside.open("wb") as file:
        with gzip.GzipFile("", "wb", compresslevel=6, fileobj=file, mtime=0) as target:
            shutil.copyfileobj(source, target)
    path.unlink()
    return packed
