"""Puts the page together: data, tables and words into page.html.j2, with styles and scripts inline."""

import json
from collections.abc import Iterable, Sequence
from pathlib import Path

from markupsafe import Markup

from .. import choice, formats, markdown, peers, plotly_bundle, sentences, shown_tables, solver_facts, summary, table
from ..fairness import limitations
from ..headline_table import headline
from ..inputs import Inputs
from ..static import canvas, curves, friction, front
from . import gallery, payload

_HERE = Path(__file__).resolve().parent
# In the order in which the page runs them.
_SCRIPTS = ("data.js", "numbers.js", "speed.js", "quality.js", "steps.js", "league.js", "app.js")
_PEERS_SHOWN = 3  # besides our well-known ones, when the page opens


def render(inputs: Inputs, pictures: Sequence[gallery.Picture] = ()) -> str:
    """The page as text; the same for the same results."""
    data = payload.build(inputs, shown(inputs))
    data["pictures"] = [picture.family for picture in pictures]
    has = {"cells": len(inputs.cells) > 0, "pathological": len(shown_tables.pathological(inputs)) > 0,
           "sequences": "latency_by_solver" in inputs.analysis, "motion": inputs.motion is not None,
           "scaling": len(inputs.analysis.get("scaling", ())) > 0}
    context = {
        "css": Markup((_HERE / "style.css").read_text(encoding="utf-8")),
        "plotly": Markup(plotly_bundle.minified()),
        "script": Markup("\n".join((_HERE / name).read_text(encoding="utf-8") for name in _SCRIPTS)),
        # JSON that may stand inside a <script>
        "data": Markup(json.dumps(data, ensure_ascii=False, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")),
        "title": ", ".join(inputs.names), "summary": summary.summary_lines(inputs), "has": has,
        "friction": _friction(inputs, pictures), "tables": _tables(inputs), "motions": shown_tables.motions(inputs.motion), "environments": _environments(inputs),
        "commit": str(inputs.campaigns[0].info.get("environment", {}).get("git_commit", "unknown"))[:12],
        "limitations": limitations(inputs), "notes": inputs.notes, **_headline(inputs),
        "peers": peers.table(inputs).html(), "left_out": peers.left_out().html(), "curves": _drawn(curves.figures(inputs)),
        "pictures": [picture for picture in pictures if not (picture.friction and _has_friction(inputs))], "pictured": {picture.family for picture in pictures},
    }
    return sentences.render("web/page.html.j2", **context)


def shown(inputs: Inputs) -> list[str]:
    """Our well-known solvers, and the fastest peer of each of the fastest libraries."""
    chosen = [solver for solver in solver_facts.WELL_KNOWN if solver in inputs.own] or inputs.own[:8]
    means = choice.table(inputs, "means", choice.main_tier(inputs))
    libraries: dict[str, str] = {}
    for solver in means.sort_values("mean")["solver"]:
        if solver in inputs.peers:
            libraries.setdefault(solver_facts.library(inputs.entries[solver]), solver)
    return chosen + list(libraries.values())[:_PEERS_SHOWN]


def _drawn(figures: Iterable[curves.Figure]) -> list[dict]:
    """Drawn as the files are; the page shows them as images."""
    with canvas.look():
        return [{"name": figure.name, "title": figure.title, "words": figure.words,
                 "address": gallery.address(canvas.svg(figure.draw()))} for figure in figures]


def _has_friction(inputs: Inputs) -> bool:
    return inputs.friction_motion is not None or shown_tables.friction(inputs) is not None


def _friction(inputs: Inputs, pictures: Sequence[gallery.Picture]) -> dict | None:
    """What the section has; None where neither a problem nor a motion has friction."""
    if not _has_friction(inputs):
        return None
    of = inputs.friction
    return {"lead": summary.friction(inputs), "not_taking": shown_tables.not_taking_friction(inputs),
            "classes": _html(shown_tables.friction_classes(inputs)), "table": _html(shown_tables.friction(inputs)),
            "sealed": _html(of and shown_tables.sealed(of)), "errors": _html(shown_tables.friction_errors(inputs)),
            "by_solver": _html(of and shown_tables.by_solver(headline(of)), "by-solver"),
            "motions": shown_tables.motions(inputs.friction_motion, friction=True),
            "figures": _drawn(friction.figures(inputs)), "pictures": [of for of in pictures if of.friction]}


def _headline(inputs: Inputs) -> dict:
    found = None if inputs.cells.empty else headline(inputs)
    if not found or not found.classes:  # none where no problem counts
        return {"headline": None}
    with canvas.look():
        figure = front.by_class(inputs, found)
        drawn = figure and gallery.address(canvas.svg(figure))
    return {"headline": shown_tables.classes(found).html(), "headline_words": summary.peers(found),
            "by_solver": shown_tables.by_solver(found).html("by-solver"), "front": _html(shown_tables.front(found)),
            "front_figure": drawn, "flags": _html(shown_tables.equal_flags(inputs)),
            "caption": markdown.caption(inputs, found), "rank_words": summary.origins(inputs)}


def _tables(inputs: Inputs) -> dict[str, Markup | None]:
    found = {"choices": (shown_tables.choices(inputs, detailed=True), "choose by-size"),
             "deadlines": (shown_tables.within_deadlines(inputs), "choose"),
             "warm": (shown_tables.sequences(inputs, detailed=True), ""),
             "ablation": (shown_tables.ablation(inputs), ""), "origins": (shown_tables.origins(inputs), ""),
             "sealed": (shown_tables.sealed(inputs), ""),
             "literature": (shown_tables.literature(inputs), ""),
             "settings": (shown_tables.settings(inputs), "")}
    return {name: _html(made, of_class) for name, (made, of_class) in found.items()}


def _html(made: table.Table | None, of_class: str = "") -> Markup | None:
    return made and made.html(of_class)


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
