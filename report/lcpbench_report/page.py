"""Puts the page together: figures, tables and words into page.html.j2, with style and script inline."""

import math
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from . import figures, floors, formats, motion, motion_figure, svg, tables
from .cells import BENCHMARK, SINGLE_RUN, Cells
from .limitations import limitations
from .load import Results
from .style import ORACLE_COLOUR, level_colours, solver_styles
from .summary import summary_lines

# Shown first: the tier that every solver here is meant for.
_FIRST_TIER = 1e-6
_HERE = Path(__file__).resolve().parent


def render(cells: Cells) -> str:
    """The page as text; the same for the same results."""
    results = cells.results
    environment = Environment(loader=FileSystemLoader(_HERE), autoescape=True, undefined=StrictUndefined,
                              trim_blocks=True, lstrip_blocks=True)
    environment.filters["formula"] = formats.formula
    styles = solver_styles(results.run["solvers"])
    accuracy = tables.accuracy(cells)
    context = {
        "css": Markup((_HERE / "style.css").read_text(encoding="utf-8")),
        "script": Markup((_HERE / "page.js").read_text(encoding="utf-8")),
        "run": results.run, "facts": _run_facts(results), "solvers": results.solvers, "styles": styles,
        "missing": results.missing, "sizes": tables.all_sizes(cells), "summary": summary_lines(cells),
        "headline": [{"tier": formats.tier(tier), "rows": tables.headline(cells, tier)}
                     for tier in reversed(results.tiers)],
        "rankings": tables.rankings(cells), "accuracy": accuracy, "shown": _nonzero(accuracy, cells),
        "map": tables.residual_map(cells), "failures": tables.failures(cells), "scenes": _scenes(results, cells),
        "tiers": [formats.tier(t) for t in reversed(results.tiers)],
        "timing": _timing_figures(cells, styles), "profiles": _profiles(cells, styles),
        "motion": _motion(results, styles), "described": _solvers(results),
        "limitations": limitations(cells), "sources": _time_sources(cells),
        "verdicts": tables.verdicts(cells), "levels": level_colours(len(results.tiers)),
        "floors": {"known": floors.known(cells), "shown": floors.shown(cells), "mark": floors.MARK,
                   "any": floors.at_floor(cells) > 0},
        "oracle_colour": ORACLE_COLOUR,
        "plot": "plot" if len(figures.panel_groups(results.solvers, styles)) > 1 else "plot wide",
        "first_tier": formats.tier(min(results.tiers, key=lambda tier: abs(math.log(tier / _FIRST_TIER)))),
    }
    return environment.get_template("page.html.j2").render(context)


def _run_facts(results: Results) -> list[tuple[str, str]]:
    run = results.run
    libraries = ", ".join(f"{name} {version}" for name, version in run["libraries"].items())
    limit = "none" if run["time_limit_s"] is None else f"at most {run['time_limit_s']:g}\u202fs per solve"
    seeds = sorted(set(results.problems["seed"]))
    shown = ", ".join(map(str, seeds[:8])) + (f", … ({len(seeds)} in all)" if len(seeds) > 8 else "")
    return [
        ("Suite", run["suite"]),
        ("Commit", run["git_commit"] + (" with uncommitted changes" if run["git_dirty"] else ", clean tree")),
        ("Started", f"{run['started']}, {_duration(run['wall_s'])}"),
        ("CPU", f"{run['cpu']}, {formats.plural(run['cores'], 'core')}, {formats.bytes_(run['memory_bytes'])}"),
        ("System", run["os"]),
        ("Compiler", f"{run['compiler']}, {run['build_type']}"),
        ("Flags", run["flags"] + (f"; solvers: {run['solver_flags']}" if run.get("solver_flags") else "")),
        ("Libraries", libraries or formats.DASH),
        ("Tiers", ", ".join(formats.tier(t) for t in results.tiers) + " on rho"),
        ("Limits", limit),
        ("Size limits", "; ".join(f"{r['solver']} up to n = {r['largest']} ({r['reason']})"
                                  for r in run.get("size_limits", [])) or "none"),
        ("Repetitions", f"{run['repetitions']} of at least {run['min_time_s']:g}\u202fs each, fewer of long solves "
         "(timing); up to five of short solves (accuracy)"),
        ("Seeds", f"{shown}; of the campaign {run['seed'] if run['seed'] is not None else formats.DASH}"),
    ]


def _duration(wall_s: float | None) -> str:
    if wall_s is None:
        return "not finished"
    return f"took {formats.seconds(wall_s)}" if wall_s < 120 else f"took {wall_s / 60:.0f} min"


def _nonzero(accuracy: list[dict], cells: Cells) -> dict[str, bool]:
    """Which of the rare columns of the accuracy table have anything to say."""
    rows = [row for row in accuracy if not row["absent"]]
    return {"false_infeasible": any(row["false_infeasible"] for row in rows),
            "infeasible": "infeasible" in tables.other_claims(cells),
            "unclaimed": any(row["unclaimed"] for row in rows),
            "at_floor": any(row["at_floor"] for row in rows),
            "excluded": any(row["excluded"] for row in rows),
            "w_error": any(row["w_error_max"] != formats.DASH for row in rows)}


def _timing_figures(cells: Cells, styles: dict) -> list[dict]:
    solve_limits, setup_limits = figures.solve_limits(cells), figures.setup_limits(cells)
    titles = {s["key"]: s["title"] for s in cells.results.run["scenes"]}
    found = []
    for family in cells.results.families:
        panels = []
        for tier in reversed(cells.results.tiers):
            picture = figures.solve_figure(cells, family, tier, styles, solve_limits)
            name = formats.tier(tier)
            label = f"Solve time against n for {family} at tier {name}"
            panels.append({"tier": name, "svg": Markup(svg.embed(picture, f"solve-{family}-{name}", label)),
                           "rows": tables.family_table(cells, family, tier)})
        setup = figures.setup_figure(cells, family, styles, setup_limits)
        found.append({"family": family, "title": titles.get(family, family), "panels": panels,
                      "sizes": cells.sizes(family), "oracle": tables.oracle_row(cells, family),
                      "setup": Markup(svg.embed(setup, f"setup-{family}", f"Set-up time against n for {family}"))})
    return found


def _solvers(results: Results) -> list[dict]:
    """Those of the build, by origin."""
    entries = {entry["key"]: entry for entry in results.run["solvers"]}
    return [entries[key] | {"title": tables.ORIGIN_TITLES[entries[key]["origin"]]} for key in results.solvers]


def _profiles(cells: Cells, styles: dict) -> list[dict]:
    found = []
    for tier in reversed(cells.results.tiers):
        times, repeated = cells.problem_times(tier)
        name = formats.tier(tier)
        runs = cells.runs[(cells.runs["tier"] == tier) & (cells.runs["excluded"] != "")]
        excluded = [f"{solver} {count}" for solver in cells.results.solvers
                    if (count := int((runs["solver"] == solver).sum()))]
        picture = figures.profile_figure(times, styles)
        found.append({"tier": name,
                      "svg": Markup(svg.embed(picture, f"profile-{name}", f"Performance profile at {name}")),
                      "problems": len(times), "unsolved": int((times == float("inf")).all(axis=1).sum()),
                      "repeated": repeated, "excluded": ", ".join(excluded), "cut": figures.profile_cut(times),
                      "shares": [(s, formats.percent(float((times[s] < float("inf")).mean()))) for s in times.columns]})
    return found


def _motion(results: Results, styles: dict) -> list[dict]:
    if results.motion is None:
        return []
    found = []
    for scene, level in motion.scenes(results.motion):
        table = motion.of_scene(results.motion, scene, level)
        used = [solver for solver in results.solvers if solver in set(table["solver"])]
        label = f"Energy error and penetration over time for {scene} at the {level} level"
        name = "".join(c if c.isalnum() else "-" for c in scene.lower())
        rows = motion.summary(table, used)
        found.append({"scene": scene, "level": level, "solvers": used, "rows": rows,
                      "joints": any(row["joint"] != "0" for row in rows),
                      "stops": [row for row in rows if row["stopped"]],
                      "svg": Markup(svg.embed(motion_figure.figure(table, styles), f"motion-{name}-{level}", label))})
    return found


def _scenes(results: Results, cells: Cells) -> list[dict]:
    files = {scene["key"]: scene["picture"] for scene in results.run["scenes"]}
    found = []
    for scene in tables.scenes(cells):
        key = scene["family"]
        text = results.pictures.get(key)
        picture = Markup(svg.embed(text, f"scene-{key}", f"Picture of {scene['title']}", files[key])) if text else ""
        found.append({**scene, "svg": picture})
    return found


def _time_sources(cells: Cells) -> dict[str, int]:
    sources = [cell.time_source for cell in cells.all()]
    return {"benchmark": sources.count(BENCHMARK), "single": sources.count(SINGLE_RUN)}
