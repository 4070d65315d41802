"""Figures and tables for papers beside the report's page."""

import gzip
import shutil
from pathlib import Path

from . import charts, choice, shown_tables
from .charts import drawing
from .files import replaced, write_text
from .inputs import Inputs
from .statistics.tables import write_csv

_LARGE = 1_000_000  # bytes of a CSV file that is compressed
_ABOVE_LATEX = ("written by LCPBench; needs \\usepackage{booktabs} and \\usepackage{textcomp}, and stands by \\input within "
                "a table* of your own, which has the caption")


def write_static(inputs: Inputs, folder: Path) -> list[Path]:
    """figures/*.svg and *.pdf of what the page shows first; tables/*.csv (large ones *.csv.gz) and
    *.tex; the same bytes for the same inputs. What the inputs do not have is left out.

    @returns the files, in the order in which they were written
    """
    written = []
    for figure in charts.figures(inputs):
        first = next(iter(figure.views.values()), lambda: None)  # none where every problem is to break something
        if chart := first():
            paths = [folder / "figures" / f"{figure.name}{end}" for end in (".svg", ".pdf")]
            drawing.write(chart, *paths)
            written += paths
    return written + write_tables(inputs, folder / "tables")


def write_tables(inputs: Inputs, folder: Path) -> list[Path]:
    folder.mkdir(parents=True, exist_ok=True)
    tables = {**inputs.analysis, "motion": inputs.motion, "friction-motion": inputs.friction_motion}
    written = [_write_csv(table, folder / f"{name}.csv") for name, table in tables.items() if table is not None]
    for name, make in shown_tables.PAPERS.items():
        if (table := make(inputs)) is not None:
            written.append(folder / f"{name}.tex")
            write_text(written[-1], f"% {name}: {_ABOVE_LATEX}\n{table.latex()}")
    return written


def write_figure_of_times(inputs: Inputs, path: Path) -> None:
    """The one that README.md shows, where there are sizes enough."""
    if len(inputs.cells) and (chart := charts.campaign.by_size(inputs, choice.main_tier(inputs))):
        drawing.write(chart, path)


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
