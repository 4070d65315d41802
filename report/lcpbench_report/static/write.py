"""All figures and tables of a report's inputs as files."""

import gzip
import shutil
from pathlib import Path

from .. import shown_tables
from ..files import replaced, write_text
from ..headline_table import headline
from ..inputs import Inputs
from ..statistics.tables import write_csv
from . import canvas, classes, curves, friction

_LARGE = 1_000_000  # bytes of a CSV file that is compressed
_ABOVE_LATEX = ("written by LCPBench; needs \\usepackage{booktabs} and \\usepackage{textcomp}, and stands by \\input within "
                "a table* of your own, which has the caption")


def write_static(inputs: Inputs, folder: Path) -> list[Path]:
    """figures/*.svg and *.pdf of what the page has as pictures, or not at all; tables/*.csv (large ones *.csv.gz) and
    *.tex; the same bytes for the same inputs. What the inputs do not have is left out.

    @returns the files, in the order in which they were written
    """
    written = []
    with canvas.look():
        drawn = {"time-by-size": classes.by_size(inputs), "front": classes.front(inputs, headline(inputs))} if len(inputs.cells) else {}
        drawn |= {figure.name: figure.draw() for figures in (friction, curves) for figure in figures.figures(inputs)}
        for name, figure in drawn.items():
            if figure is not None:
                written += canvas.save(figure, folder / "figures", name)
    return written + write_tables(inputs, folder / "tables")


def write_tables(inputs: Inputs, folder: Path) -> list[Path]:
    folder.mkdir(parents=True, exist_ok=True)
    studied = {name: table for name, table in (("motion", inputs.motion), ("friction-motion", inputs.friction_motion)) if table is not None}
    studied |= {f"curve-{name}": table for name, table in inputs.curves.items()}
    written = [_write_csv(table, folder / f"{name}.csv") for name, table in (dict(inputs.analysis) | studied).items()]
    for name, make in shown_tables.PAPERS.items():
        if (table := make(inputs)) is not None:
            written.append(folder / f"{name}.tex")
            write_text(written[-1], f"% {name}: {_ABOVE_LATEX}\n{table.latex()}")
    return written


def write_figure_of_times(inputs: Inputs, path: Path) -> None:
    """The one that README.md shows, where there are sizes enough."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with canvas.look():
        if (figure := classes.by_size(inputs)) is not None:
            with replaced(path) as beside:
                beside.write_bytes(canvas.svg(figure))


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
