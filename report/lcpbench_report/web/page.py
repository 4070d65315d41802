"""Puts the page together: data, tables and words into page.html.j2, with styles and scripts inline."""

import json
from collections.abc import Sequence
from pathlib import Path

from markupsafe import Markup

from .. import charts, peers, sentences, shown_tables, summary
from ..charts import plotly
from ..fairness import limitations
from ..headline_table import headline
from ..inputs import Inputs
from . import gallery

_HERE = Path(__file__).resolve().parent


def render(inputs: Inputs, pictures: Sequence[gallery.Picture] = ()) -> str:
    """The page as text; the same for the same results."""
    figures = {figure.name: figure for figure in charts.figures(inputs)}
    data = {name: views for name, figure in figures.items() if (views := {
        "\n".join(chosen): plotly.figure(chart) for chosen, make in figure.views.items() if (chart := make())})}
    friction_shown = inputs.friction_motion is not None or shown_tables.friction(inputs) is not None
    found = None if inputs.cells.empty else headline(inputs)
    found = found if found and found.classes else None  # none where no problem counts
    return sentences.render(
        "web/page.html.j2", inputs=inputs, found=found, shown=shown_tables, summary=summary, peers=peers,
        css=Markup((_HERE / "style.css").read_text(encoding="utf-8")), plotly=Markup(plotly.script()),
        script=Markup((_HERE / "page.js").read_text(encoding="utf-8")),
        # JSON that may stand inside a <script>
        data=Markup(json.dumps(data, ensure_ascii=False, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")),
        figures={name: figures[name] for name in data},
        with_friction=friction_shown, limitations=limitations(inputs),
        pictures=[picture for picture in pictures if not (picture.friction and friction_shown)],
        friction_pictures=[picture for picture in pictures if picture.friction],
        pictured={picture.family for picture in pictures})
