"""All figures and tables of a report's inputs as files."""

import gzip
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

from .. import choice
from ..inputs import Inputs
from ..statistics.tables import write_csv
from ..formats import power
from . import (accuracy, canvas, coverage, latex_tables, motion, precision, profiles, robustness, scaling, sequences,
               times)

_LARGE = 1_000_000  # bytes of a CSV file that is compressed


def write_static(inputs: Inputs, folder: Path) -> list[Path]:
    """figures/*.svg and *.pdf, tables/*.csv (large ones *.csv.gz) and *.tex; the same bytes for the same inputs. What
    the inputs do not have is left out.

    @returns the files, in the order in which they were written
    """
    return write_figures(inputs, folder / "figures") + write_tables(inputs, folder / "tables")


def write_figures(inputs: Inputs, folder: Path) -> list[Path]:
    written = []
    with canvas.look():
        for name, draw in figures(inputs):
            figure = draw()
            if figure is not None:
                written += canvas.save(figure, folder, name)
    return written


def figures(inputs: Inputs) -> Iterator[tuple[str, Callable]]:
    """(name, function that draws it or returns None)"""
    for tier in choice.shown_tiers(inputs):
        yield f"profile-{power(tier)}", lambda: profiles.profile(inputs, tier)
    if len(inputs.cells):
        yield "time-by-size", lambda: times.by_size(inputs)
        yield "time-by-family", lambda: times.by_family(inputs)
        yield "accuracy", lambda: accuracy.distributions(inputs)
        yield "coverage", lambda: coverage.bars(inputs)
        yield "work-precision", lambda: precision.work_precision(inputs)
        yield "scaling", lambda: scaling.exponents(inputs)
        yield "robustness", lambda: robustness.pathological(inputs)
        yield "robustness-grids", lambda: robustness.grids(inputs)
    yield "sequence-latency", lambda: sequences.latency(inputs)
    yield "sequence-deadlines", lambda: sequences.deadlines(inputs)
    for scene, level in motion.scenes(inputs):
        yield f"motion-{Path(scene).stem}-{level}", lambda: motion.errors(inputs, scene, level)


def write_tables(inputs: Inputs, folder: Path) -> list[Path]:
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    studied = {} if inputs.motion is None else {"motion": inputs.motion}
    for name, table in (dict(inputs.analysis) | studied).items():
        written.append(_write_csv(table, folder / f"{name}.csv"))
    for name, text in latex_tables.tables(inputs):
        written.append(folder / f"{name}.tex")
        written[-1].write_text(text, encoding="utf-8")
    written.append(folder / "README.md")
    written[-1].write_text(latex_tables.readme([path.name for path in written[:-1]]), encoding="utf-8")
    return written


def _write_csv(table, path: Path) -> Path:
    """Compressed where large, without a time stamp."""
    packed = path.with_name(path.name + ".gz")
    packed.unlink(missing_ok=True)
    write_csv(table, path)
    if path.stat().st_size <= _LARGE:
        return path
    with path.open("rb") as source, packed.open("wb") as file:
        with gzip.GzipFile("", "wb", compresslevel=6, fileobj=file, mtime=0) as target:
            shutil.copyfileobj(source, target)
    path.unlink()
    return packed
