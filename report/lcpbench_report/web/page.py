"""Puts the page together: data, tables and words into page.html.j2, with styles and scripts inline."""

import json
from collections.abc import Sequence
from pathlib import Path

from markupsafe import Markup

from .. import charts, formats, markdown, peers, sentences, shown_tables, summary
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
        caption=found and markdown.caption(inputs, found), figures={name: figures[name] for name in data},
        with_friction=friction_shown, environments=_environments(inputs), limitations=limitations(inputs),
        commit=str(inputs.campaigns[0].info.get("environment", {}).get("git_commit", "unknown"))[:12],
        pictures=[picture for picture in pictures if not (picture.friction and friction_shown)],
        friction_pictures=[picture for picture in pictures if picture.friction],
        pictured={picture.family for picture in pictures})


def _listed(value: object) -> str:
    return (", ".join(map(str, value)) if isinstance(value, list) else str(value or "")) or "not recorded"


def _environments(inputs: Inputs) -> list[dict]:
    """A table per campaign; of equal environments one for all."""
    tables: dict[str, dict] = {}
    for name, campaign in zip(inputs.names, inputs.campaigns):
        machine, facts = _facts(campaign.info)
        same = tables.setdefault(json.dumps(machine), {"machine": machine, "campaigns": []})
        same["campaigns"].append({"name": name, "facts": facts})
    return list(tables.values())


def _facts(info: dict) -> tuple[list, list]:
    """Facts of the machine, and of the campaign."""
    found = info.get("environment", {})
    libraries = ", ".join(f"{name} {version}" for name, version in found.get("libraries", {}).items())
    commit = str(found.get("git_commit", "unknown")) + (" with uncommitted changes" if found.get("git_dirty") else "")
    machine = [("CPU", f"{found.get('cpu', 'unknown')}, {found.get('cores', '?')} cores, "
                       f"{found.get('memory_bytes', 0) / 2**30:.1f}\u202fGiB"),
               ("Instruction sets", _listed(found.get("instruction_sets"))),
               ("System", ", ".join(str(part) for part in (found.get("os", "unknown"), found.get("kernel")) if part)),
               ("Hypervisor", found.get("hypervisor") or "none"), ("Commit", commit),
               ("Compiler", f"{found.get('compiler', 'unknown')}, {found.get('build_type', '')}"),
               ("Flags", f"{found.get('flags', '')}; solvers: {found.get('solver_flags', '') or 'no others'}"),
               ("Libraries", libraries or formats.DASH)]
    manifests = ", ".join(f"{m['name']} {m['version']} ({m['sha256'][:12]}…)" for m in info.get("manifests", []))
    campaign = [("Started", info.get("started", "not recorded")), ("Problems", manifests or formats.DASH),
                ("Tiers", ", ".join(formats.power(t) for t in info["tiers"]) + " on ρ"),
                ("Launches", f"at most {info.get('passes', '?')}, after the one that is judged; seed {info.get('seed', '?')}"),
                ("Filter", info.get("filter") or "none")]
    return machine, campaign
