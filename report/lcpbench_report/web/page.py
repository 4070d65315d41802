"""Puts the page together: data, tables and words into page.html.j2, with styles and scripts inline."""

import json
from collections.abc import Sequence
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

from .. import ablation_table, choice, decision, formats, markdown_headline, motion, plotly_bundle, summary
from ..fairness import limitations
from ..headline_table import headline
from ..inputs import Inputs
from ..style import solver_styles
from ..summary import pathological, peers
from . import payload
from .gallery import Picture

_HERE = Path(__file__).resolve().parent
# In the order in which the page runs them.
_SCRIPTS = ("data.js", "numbers.js", "times.js", "profile.js", "accuracy.js", "robustness.js", "sequences.js",
            "scaling.js", "league.js", "app.js")
_ORIGINS = {"own": "ours", "peer": "another project's", "external": "named by the user"}
_TOLERANCES = {"direct": "none (direct)", "follows": "the tier", "default": "its library's own"}
# What is visible when the page opens: the usual names of engines, and the best of others.
_WELL_KNOWN = ("auto", "dantzig", "lemke", "bpp", "pgs", "ipm", "nncg")
_PEERS_SHOWN = 3


def render(inputs: Inputs, pictures: Sequence[Picture] = ()) -> str:
    """The page as text; the same for the same results."""
    environment = Environment(loader=FileSystemLoader(_HERE), autoescape=True, undefined=StrictUndefined,
                              trim_blocks=True, lstrip_blocks=True)
    environment.filters["keys"] = keys
    environment.filters["seconds"] = formats.seconds
    environment.filters["tier"] = formats.power
    environment.filters["ratio"] = formats.ratio
    environment.filters["percent"] = formats.percent
    environment.filters["plain"] = lambda text: text.replace("*", "")
    environment.filters["share"] = formats.share_of
    environment.filters["size_class"] = formats.size_class
    environment.filters["interval"] = markdown_headline.ratio
    environment.filters["residual"] = formats.residual
    data = payload.build(inputs, solver_styles(inputs.solvers), shown(inputs))
    data["pictures"] = [picture.family for picture in pictures]
    context = {
        "css": Markup((_HERE / "style.css").read_text(encoding="utf-8")),
        "plotly": Markup(plotly_bundle.minified()),
        "script": Markup("\n".join((_HERE / name).read_text(encoding="utf-8") for name in _SCRIPTS)),
        "data": Markup(as_script(data)),
        "title": ", ".join(inputs.names), "summary": summary.summary_lines(inputs),
        "tiers": inputs.tiers, "has": _has(inputs), "classes": _classes(inputs),
        "deadlines": decision.by_deadline(inputs), "warm": decision.by_warm_start(inputs, choice.main_tier(inputs)),
        "decision_tiers": choice.shown_tiers(inputs),
        "motions": _motions(inputs), "settings": _settings(inputs), "environments": _environments(inputs), "commit": _commit(inputs),
        "limitations": limitations(inputs), "notes": inputs.notes, **_headline(inputs),
        "pictures": pictures, "pictured": {picture.family for picture in pictures},
    }
    return environment.get_template("page.html.j2").render(context)


def as_script(data: dict) -> str:
    """JSON that may stand inside a <script>."""
    text = json.dumps(data, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c")


def keys(text: str) -> Markup:
    """`key` as <code>key</code>."""
    parts = str(text).split("`")
    return Markup("".join(f"<code>{escape(part)}</code>" if i % 2 else str(escape(part))
                          for i, part in enumerate(parts)))


def shown(inputs: Inputs) -> list[str]:
    """Of peers the fastest of every library, a few of them."""
    chosen = [solver for solver in _WELL_KNOWN if solver in inputs.own] or inputs.own[:8]
    means = inputs.analysis.get("means")
    if means is None or means.empty:
        return chosen
    tier = choice.main_tier(inputs)
    ranked = means[(means["unit"] == "s") & (means["tier"] == tier)].sort_values("mean")["solver"]
    libraries: dict[str, str] = {}
    for solver in ranked:
        if solver not in inputs.own:
            libraries.setdefault(solver.split("-")[0], solver)
    return chosen + list(libraries.values())[:_PEERS_SHOWN]


def _headline(inputs: Inputs) -> dict:
    if inputs.cells.empty:
        return {"headline": None, "ablation": None}
    found = headline(inputs)
    return {"headline": found, "headline_words": peers(found), "caption": markdown_headline.caption(inputs, found),
            "ablation": ablation_table.rows(inputs), "ablation_words": ablation_table.WORDS}


def _has(inputs: Inputs) -> dict[str, bool]:
    analysis = inputs.analysis
    return {"cells": len(inputs.cells) > 0, "pathological": len(pathological(inputs)) > 0,
            "sequences": "latency" in analysis, "motion": inputs.motion is not None,
            "scaling": len(analysis.get("scaling", ())) > 0,
            "precision": len(inputs.tiers) > 3}


def _classes(inputs: Inputs) -> list[dict]:
    """Rows of the decision table: size class and redundancy, a cell per tier of the three that are judged by default."""
    rows: dict[tuple, dict] = {}
    tiers = choice.shown_tiers(inputs)
    for found in decision.by_class(inputs):
        if found.tier not in tiers:
            continue
        row = rows.setdefault((found.size_class, found.redundant), {
            "size": formats.size_class(found.size_class), "redundant": found.redundant,
            "problems": found.problems, "cells": {}})
        row["cells"][found.tier] = _cell(found)
    return list(rows.values())


def _cell(found: decision.Choice) -> dict:
    ranked = found.own or found.everyone
    best = ranked[0]
    peer = next((c for c in found.everyone if not c.own), None)
    return {"best": best, "next": ranked[1] if len(ranked) > 1 else None,
            "peer": peer if peer is not None and peer.mean < best.mean else None}


def _motions(inputs: Inputs) -> list[dict]:
    """A table per scene: what is worst, and where a motion was stopped."""
    if inputs.motion is None:
        return []
    return [{"scene": scene, "level": level,
             "rows": motion.summary(table := motion.of_scene(inputs.motion, scene, level),
                                    list(dict.fromkeys(table["solver"])))}
            for scene, level in motion.scenes(inputs.motion)]


def _settings(inputs: Inputs) -> list[dict]:
    limits = {entry["solver"]: entry for campaign in inputs.campaigns for entry in campaign.info.get("size_limits", [])}
    rows = []
    for entry in inputs.solvers:
        if entry["key"] not in inputs.keys:
            continue
        key = entry["key"]
        limit = next((limits[name] for name in limits if key == name or key.startswith(name + "-")), None)
        settings = ", ".join(f"{name} = {value}" for name, value in entry.get("settings", {}).items())
        rows.append({"key": key, "method": entry.get("method", ""), "origin": _ORIGINS.get(entry["origin"], ""),
                     "version": entry.get("library_version", ""), "licence": entry.get("licence", ""),
                     "setting": _setting_words(entry), "settings": settings,
                     "limit": f"{limit['largest']} rows: {limit['reason']}" if limit else "",
                     "tolerance": _TOLERANCES[entry["tolerance"]]})
    return rows


def _setting_words(entry: dict) -> str:
    if entry["setting"] == "variant":
        return f"{entry.get('base', '')} with"
    if entry["setting"] == "tuned" and entry["origin"] == "peer":
        return "stopping options chosen per tier by one rule"
    return "as committed" if entry["origin"] == "own" else "the library's own defaults"


def _commit(inputs: Inputs) -> str:
    return str(inputs.campaigns[0].info.get("environment", {}).get("git_commit", "unknown"))[:12]


def _listed(value: object) -> str:
    return (", ".join(map(str, value)) if isinstance(value, list) else str(value or "")) or "not recorded"


def _environments(inputs: Inputs) -> list[dict]:
    """A table per campaign; of equal environments one for all."""
    tables: dict[str, dict] = {}
    for name, campaign in zip(inputs.names, inputs.campaigns):
        facts = _facts(campaign.info)
        same = tables.setdefault(json.dumps(facts["machine"]), {"machine": facts["machine"], "campaigns": []})
        same["campaigns"].append({"name": name, "facts": facts["campaign"]})
    return list(tables.values())


def _facts(info: dict) -> dict:
    found = info.get("environment", {})
    libraries = ", ".join(f"{name} {version}" for name, version in found.get("libraries", {}).items())
    commit = str(found.get("git_commit", "unknown")) + (" with uncommitted changes" if found.get("git_dirty") else "")
    machine = [("CPU", f"{found.get('cpu', 'unknown')}, {found.get('cores', '?')} cores, "
                       f"{formats.bytes_(found.get('memory_bytes', 0))}"),
               ("Instruction sets", _listed(found.get("instruction_sets"))),
               ("System", ", ".join(str(part) for part in (found.get("os", "unknown"), found.get("kernel")) if part)),
               ("Hypervisor", found.get("hypervisor") or "none"), ("Commit", commit),
               ("Compiler", f"{found.get('compiler', 'unknown')}, {found.get('build_type', '')}"),
               ("Flags", f"{found.get('flags', '')}; solvers: {found.get('solver_flags', '') or 'no others'}"),
               ("Libraries", libraries or formats.DASH)]
    manifests = ", ".join(f"{m['name']} {m['version']} ({m['sha256'][:12]}…)" for m in info.get("manifests", []))
    campaign = [("Started", info.get("started", "not recorded")), ("Problems", manifests or formats.DASH),
                ("Tiers", ", ".join(formats.power(t) for t in info["tiers"]) + " on ρ"),
                ("Passes", f"at most {info.get('passes', '?')}, after the one that is judged; seed {info.get('seed', '?')}"),
                ("Filter", info.get("filter") or "none")]
    return {"machine": machine, "campaign": campaign}
