"""What a report is made of: one campaign's folder or several, whose problems do not overlap, and a study of motion."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from pathlib import Path

import pandas as pd

from . import studies
from .errors import ReportError
from .statistics import tables
from .statistics.cells import Measured, measured
from .statistics.friction import refusers, with_friction
from .statistics.load import load_campaign
from .statistics.model import INFEASIBLE, LITERATURE, Campaign
from .statistics.rivals import is_own
from .style import Look, solver_styles

PATHOLOGICAL = "pathological"  # the set of problems that are meant to break something
# With friction: such, and those that may have no solution or several.
_NOT_OF_ENGINES = ("friction-pathological", "painleve")


@dataclass(eq=False)
class Inputs:
    """All tables in memory. Rows of every table keep the order of the folders."""

    names: list[str]  # of the folders
    campaigns: list[Campaign]
    measured: Measured
    motion: pd.DataFrame | None = None  # studies.read_motion, of scenes without friction
    friction_motion: pd.DataFrame | None = None  # of those with friction
    notes: list[str] = field(default_factory=list)

    @cached_property
    def cells(self) -> pd.DataFrame:
        return tables.without_builds(self.measured.cells)

    @cached_property
    def ours(self) -> str:
        """The own solver that is compared with the peers."""
        return tables.main_own(self.own)

    @cached_property
    def solvers(self) -> list[dict]:
        """The entries of campaign.json, each key once, in the order of the campaign with the most; also those that are
        not in the build: colours must not depend on what was built."""
        entries: dict[str, dict] = {}
        for campaign in sorted(self.campaigns, key=lambda campaign: -len(campaign.info["solvers"])):
            entries |= {key: entry for key, entry in campaign.solvers.items()
                        if not entries.get(key, {}).get("available")}
        return list(entries.values())

    @cached_property
    def keys(self) -> list[str]:
        """Solvers that ran on anything."""
        ran = {*self.cells["solver"], *(solver for campaign in self.campaigns for _, solver, *_ in campaign.passes)}
        return [entry["key"] for entry in self.solvers if entry["key"] in ran]

    @cached_property
    def entries(self) -> dict[str, dict]:
        """The entries of `solvers`, by key."""
        return {entry["key"]: entry for entry in self.solvers}

    @cached_property
    def own(self) -> list[str]:
        return [key for key in self.keys if is_own(self.entries[key])]

    @cached_property
    def portfolio(self) -> dict[str, list[str]]:
        """Of the first campaign that has one."""
        return next((campaign.portfolio for campaign in self.campaigns if campaign.portfolio), {})

    @cached_property
    def peers(self) -> list[str]:
        return [key for key in self.keys if key not in self.own]

    def in_order(self, solvers) -> list[str]:
        """These, as the registry has them."""
        there = set(solvers)
        return [key for key in self.keys if key in there]

    @cached_property
    def counted(self) -> pd.DataFrame:
        """The cells of problems that count."""
        return self.cells[self.cells["counts"].astype(bool)]

    @cached_property
    def friction(self) -> "Inputs | None":
        """Problems with friction or bounded rows as if they were the only ones and counted: what the tables of times make
        of them. Of solvers that take some; without literature and what is meant to break something or has no solution.
        None without any."""
        cells = with_friction(self.cells) if len(self.cells) else self.cells
        if len(cells):
            left_out = (cells["set"].isin(_NOT_OF_ENGINES) | (cells["origin"] == LITERATURE)
                        | (cells["reference_status"] == INFEASIBLE) | cells["solver"].isin(refusers(self.cells)))
            cells = cells[~left_out].assign(counts=True)
        return replace(self, measured=self.measured._replace(cells=cells)) if len(cells) else None

    @cached_property
    def styles(self) -> dict[str, Look]:
        return solver_styles(self.solvers)

    @cached_property
    def problems(self) -> dict[str, dict]:
        """problems.jsonl of all folders, by name."""
        return {name: about for campaign in self.campaigns for name, about in campaign.problems.items()}

    @cached_property
    def size_classes(self) -> list[dict]:
        """Those of campaign.json, smallest first; every campaign has the same."""
        return self.campaigns[0].info["size_classes"]

    @cached_property
    def tiers(self) -> list[float]:
        """The tiers of the cells that were run, the loosest first."""
        return sorted(set(self.cells["tier"]), reverse=True)

    @cached_property
    def analysis(self) -> tables.Tables:
        """The tables of statistics.tables (RESULTS.md), by name; those of cells over all folders together."""
        makers = tables.makers_of(self.measured, self.solvers, self.ours, self.portfolio) if len(self.cells) else {}
        for campaign in self.campaigns:
            if campaign.passes:  # of one at most
                makers |= {name: partial(table, campaign) for name, table in tables.STEP_TABLES.items()}
        return tables.Tables(makers)


def load_inputs(folders: list[Path], motion: Sequence[Path] = ()) -> Inputs:
    """@param motion  folders of `lcpbench motion`
    @throws ReportError for the first thing that does not fit
    """
    moved = _by_friction(studies.read_motion(*motion)) if motion else (None, None)
    # What is meant to break solvers is shown, but says nothing of what a motion is like.
    campaigns = [load_campaign(folder, PATHOLOGICAL) for folder in folders]
    seen: dict[str, str] = {}
    for folder, campaign in zip(folders, campaigns):
        for name in [*campaign.problems, *campaign.sequences]:
            if name in seen:
                raise ReportError(str(folder), f"problem {name!r} is in {seen[name]} too",
                                  "campaigns of different problems; `lcpbench merge` joins parts of one")
            seen[name] = str(folder)
    if sum(bool(campaign.sequences) for campaign in campaigns) > 1:
        raise ReportError(str(folders[-1]), "a second campaign of sequences", "at most one")
    notes = [f"{folder.name}: {note}" for folder, campaign in zip(folders, campaigns) for note in campaign.notes]
    return Inputs([folder.resolve().name for folder in folders], campaigns, _joined([*map(measured, campaigns)]), *moved, notes)


def _by_friction(motion: pd.DataFrame) -> tuple[pd.DataFrame | None, pd.DataFrame | None]:
    """Scenes without and with friction; None where there are none."""
    has = motion["creep"].notna().groupby([motion["scene"], motion["level"]]).transform("any")
    return tuple(part if len(part) else None for part in (motion[~has], motion[has]))


def _joined(parts: list[Measured]) -> Measured:
    """Without empty parts, whose columns have no type."""
    times: dict[tuple, list[pd.DataFrame]] = {}
    for key, of in (item for part in parts for item in part.rounds.items()):
        times.setdefault(key, []).append(of)
    return Measured(*(pd.concat([one for one in tables_ if len(one)] or list(tables_[:1]), ignore_index=True)
                      for tables_ in zip(*(part[:2] for part in parts))), {key: pd.concat(of) for key, of in times.items()})
