"""The summary of what changed between two campaigns, as Markdown."""

import pandas as pd

from . import formats
from .statistics import pairwise
from .statistics.cells import FALSE_SUCCESS
from .statistics.changes import ALL, Changes
from .statistics.groups import COUNTED
from .statistics.intervals import MARGIN
from .statistics.load import Campaign
from .statistics.same import cell_name
from .table import Table, code, markdown

_SHOWN = 20  # rows of a table
_ENVIRONMENT = ("version", "git_commit", "git_dirty", "compiler", "flags", "solver_flags", "build_type", "cpu",
                "instruction_sets", "cores", "os", "kernel", "hypervisor", "library_threads", "libraries")


def summary(old_name: str, old: Campaign, new_name: str, new: Campaign, changes: Changes) -> str:
    lines = [markdown(f"# {old.info['name']}: {new_name} against {old_name}"), "", _judgement(changes), "", *_environment(old, new),
             *_verdicts(changes), *_speeds(changes), *_only_in_one(changes)]
    return "\n".join(lines).rstrip("\n") + "\n"


def _judgement(changes: Changes) -> str:
    found = [(len(changes.lost), "cell verified before and not now", "cells verified before and not now"),
             (len(changes.false_successes), "new false success", "new false successes"),
             (len(changes.slower), "comparison slower", "comparisons slower")]
    words = formats.words([formats.plural(count, one, many) for count, one, many in found if count])
    return f"**Regression**: {words}." if changes.regressed else \
        f"**No regression** in {formats.plural(len(changes.cells), 'cell')}."


def _environment(old: Campaign, new: Campaign) -> list[str]:
    """Only what differs."""
    a, b = (campaign.info.get("environment", {}) for campaign in (old, new))
    # Versions of libraries one by one.
    a, b = ({f"{key}.{name}" if name else key: value for key in _ENVIRONMENT if key in of
             for name, value in (of[key] if isinstance(of[key], dict) else {"": of[key]}).items()} for of in (a, b))
    rows = [[name, a.get(name, ""), b.get(name, "")] for name in dict.fromkeys([*a, *b]) if a.get(name) != b.get(name)]
    return _table(["environment", "old", "new"], rows) if rows else ["Both were run in the same environment.", ""]


def _verdicts(changes: Changes) -> list[str]:
    wrong = changes.cells.loc[changes.lost.index.union(changes.false_successes.index)]
    first = wrong["verdict_new"] == FALSE_SUCCESS
    wrong = pd.concat([wrong[first], wrong[~first]])
    lines = ["## Wrong", ""]
    if wrong.empty:
        lines += ["No cell lost its verified answer, and there is no new false success.", ""]
    else:
        lines += _table(["cell", "before", "now", "time before", "limit"],
                        [[code(_name(row)), _verdict(row, "old"), _verdict(row, "new"),
                          formats.seconds(row["time_s_old"]), formats.seconds(row["time_limit_s_new"])]
                         for _, row in wrong.iterrows()])
    if not changes.gained.empty:
        lines += ["Verified now, and not before:", ""]
        lines += _table(["cell", "before"], [[code(_name(row)), _verdict(row, "old")]
                                             for _, row in changes.gained.iterrows()])
    return lines


def _speeds(changes: Changes) -> list[str]:
    lines = []
    for title, table in (("Slower", changes.slower), ("Faster", changes.faster)):
        lines += [f"## {title}", ""]
        if table.empty:
            lines += ["No solver, nor a solver on a size class or a family.", ""]
            continue
        rows = [[code(row.solver), *("all" if part == ALL else code(part) for part in (row.size_class, row.family)),
                 row.set if row.set != COUNTED else "", formats.power(row.tier), row.problems,
                 f"{row.ratio:.3f} [{row.ratio_low:.3f}, {row.ratio_high:.3f}]", f"{row.p:.1g}"] for row in table.itertuples()]
        lines += _table(["solver", "rows", "family", "set that does not count", "tier", "problems", "new / old",
                         "p"], rows)
    return lines + [f"Out of {formats.plural(int(changes.speeds['p'].notna().sum()), 'comparison')}: solver × tier, over "
                    f"all problems, by size class and by family. Median ratio of the fresh times of answers that both "
                    f"verified, problems by their weight, with an interval by bootstrap over launches, families and "
                    f"bases; p of Wilcoxon's signed-rank test of bases, adjusted by Holm for all of them. A change needs "
                    f"p < {pairwise.LEVEL:g} and an interval beyond {100 * (MARGIN - 1):.0f} %.", ""]


def _only_in_one(changes: Changes) -> list[str]:
    rows = [[code(solver), name, len(own)] for name, table in (("OLD", changes.only_old), ("NEW", changes.only_new))
            for solver, own in table.groupby("solver", sort=False)]
    return ["## Only in one", "", "These cells were judged by nothing above.", "",
            *_table(["solver", "only in", "cells"], rows)] if rows else []


def _table(head: list[str], rows: list[list]) -> list[str]:
    """What is left out is counted."""
    return [Table(head, rows, "l" * len(head)).markdown(_SHOWN)]


def _name(row) -> str:
    return cell_name((row["problem"], row["solver"], row["tier"]))


def _verdict(row, when: str) -> str:
    """With the rule by which a cell was excluded."""
    rule = row[f"excluded_{when}"]
    return row[f"verdict_{when}"].replace("_", " ").replace(":", ": ") + (f": {rule}" if rule else "")
