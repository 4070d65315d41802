"""A report in Markdown, for logs of builds, for messages, and to be kept with the source; and the headline of README.md
and docs/results.md.
"""

from . import choice, shown_tables
from .fairness import limitations
from .formats import DASH, plural, power
from .headline_table import Headline, headline
from .inputs import Inputs
from .statistics.class_times import LEAST_FOR_P99
from .statistics.rivals import PORTFOLIO
from .summary import false_successes, peers
from .table import Table, markdown

ABLATION_WORDS = ("These versions are in no other table or figure: our solvers without their own check; peers with a check and, where "
         "it fails, one more solve with a shifted diagonal; our solvers built for the baseline instruction set, for which "
         "Debian builds the peers' libraries. Time: of the version over its solver, median over the problems that both verify. "
         "Right and false: of the version, then of its solver. False: false successes and answers below the tier.")

FRONT_WORDS = ("The front of single peers: no other peer is both faster and right on as much of the class (what it does not "
               "take as it is given is not right here). A ratio whose interval contains 1 is undecided.")
FLAG_WORDS = ("At equal flags: Debian compiles peers for any x86-64, and ours are compiled for the machine above. Here ours are "
              "compiled for less, or peers for the machine.")
SEALED_WORDS = ("Families and engines of data/sealed.json are for measuring only: tools of development leave them out since 2026-11-28 "
                "(limits that are older were chosen with them). At the main tier; times over that of the fastest right peer of "
                "the problem, medians.")
LITERATURE_WORDS = "Published problems, which count in nothing else: share verified, and time over that of the fastest right solver."

FRICTION_WORDS = ("Problems with friction, sliding or bounded rows. They are in no other table and in no mean, for most solvers do not take "
                  "such rows and refuse them by name. Right: share verified against Coulomb's law, of the problems that the solver "
                  "takes and that are not known to have no solution; ✗ with the number of false successes and of false claims of "
                  "infeasibility, on all it takes. A relaxed answer that solves its own model and not Coulomb's law is not right, "
                  "and no false success. Median time: at the main tier, of the same problems; what is not verified is infinite. "
                  "Ratios are of times, problem by problem where the other is right.")
FRICTION_CLASS_WORDS = ("Without problems that are meant to break something or have no solution. Choose: of our solvers that verify nearly "
                        "as much as any (99 % of the most), the one with the least geometric mean of fresh times, failures entered "
                        "with the time limit. Times are fresh times at the main tier, medians with what is not verified infinite; over "
                        "plain problems: the median over that of problems of the class without friction.")
FRICTION_MOTION_WORDS = ("Scenes driven by solvers that are exact, loose, or stopped early. `pgs@10`: solves end after 10 sweeps; `@cold`: they start "
                         "from 0, others from the forces of the step before. Distance: largest of a centre of mass from the same "
                         "motion driven at 1e-12. Creep: sum over the steps of the largest slip that friction could have held. Lost "
                         "gap: largest in which a contact bears force after a step. Energy that friction creates is over the largest kinetic energy, or what the loads give bodies at rest in one step."
                         "")
FRICTION_ERROR_WORDS = ("Of wrong answers at the strictest tier. ρ: median against Coulomb's law, and against the solver's own "
                        "model where it has one. Parts: mean share of the sum of squares (docs/friction.md section 4).")

ORIGIN_WORDS = ("Share of the problems that is verified, and median time over that of the fastest right solver of each problem, "
         "at the main tier; ✗: fails on half. Own scenes and motions are this project's; engines' problems were recorded from "
         "scenes of their own; literature is what others published. In parentheses: problems.")


def caption(inputs: Inputs, found: Headline) -> str:
    """What a cell says, by which rule it is bold, and where it was measured."""
    return (f"Fresh times at tier {power(found.tier)}. A fresh time is one interval from the caller's arrays (J by rows, "
            "inverse masses, b, kinds of rows) to f. Validation, forms of A, ordering, factorizations, fallbacks and the "
            "solver's own check are inside. The solver object has solved other problems before, but never this one. Peers "
            "are timed in the same way, each in a process of its own; a launch is a new process. The time of a class is the "
            "median over its problems, whose times are medians over launches; each of k variants of one base has weight 1/k, "
            "origins of problems are balanced, and an answer that is not verified counts as infinitely slow. "
            "*Problems*: how many, and in parentheses how many their weights are worth. *Peers*: solvers and settings of other "
            "projects that had a turn. *Right*: share verified. **Bold**: no other solver is both faster and right on as much. "
            "Ratios are our time over theirs, problem by problem where theirs is right, with 95 % intervals by bootstrap over "
            f"launches, families and bases{_where(inputs)}.{_narrower(inputs)}")


def short_caption(inputs: Inputs, found: Headline) -> str:
    """What outcomes() says, for the front page."""
    portfolio = "a portfolio of peers (one code after the other until an answer passes its check) and " if found.rival == PORTFOLIO else ""
    return (f"{shown_tables.key(found.own)} against {portfolio}the fastest peer of each problem, by size class, at tier {power(found.tier)}"
            f"{_where(inputs)}. A time is from the caller's arrays to f, of a problem not seen before; an answer that "
            "is not verified is infinitely slow. Intervals (95 %) are over launches and problems.")


def _narrower(inputs: Inputs) -> str:
    """Which commands narrow the intervals of a first look."""
    quick = next((campaign.info for campaign in inputs.campaigns if campaign.info["name"] == "quick"), None)
    return (f" Few problems and at most {quick['passes']} launches of a solver make wide intervals: `make report RUN_OPTIONS='--launches 10'` "
            "narrows them in some minutes, `make report SUITE=standard`, with far more problems, in hours.") if quick else ""


def _where(inputs: Inputs) -> str:
    """Machine, commit and date of the first campaign that has them."""
    known = [campaign.info for campaign in inputs.campaigns if campaign.info.get("environment")]
    return f" ({_measured(known[0], ['cpu', 'compiler'], *_widest(known[0]), 'one thread')})" if known else ""


def _widest(info: dict) -> list[str]:
    """What the machine has for vectors, which our kernels are chosen by."""
    has = str((info.get("environment") or {}).get("instruction_sets") or "").split()
    return [next((name for flag, name in (("avx512f", "AVX-512"), ("avx2", "AVX2")) if flag in has), "SSE2")] if has else []


def _measured(info: dict, keys: list[str], *words: str) -> str:
    """What campaign.json says of these keys of the environment, the words, commit and date."""
    environment = info.get("environment") or {}
    commit = str(environment.get("git_commit") or "")[:12]
    changes = " with changes" if environment.get("git_dirty") else ""
    parts = [*map(environment.get, keys), *words, commit and f"commit {commit}{changes}",
             str(info.get("started") or "")[:10]]
    return ", ".join(str(part) for part in parts if part)


def details(inputs: Inputs, found: Headline) -> str:
    lines = [f"The 99 % quantile, of single solves in all launches, is given for classes with at least {LEAST_FOR_P99} problems. "
             f"{false_successes(inputs)}", "",
             "Own solvers first, then the best solver of each peer library, with a second one where the best is not run on "
             "larger problems. The columns are numbers of rows. After a time stands the share verified, where that is not all, "
             "and of how many problems, where the solver's budget ended before every problem had its turn (their order is "
             f"drawn at random) or it does not take the others as they are given. {shown_tables.NOT_ASKED_MARK}: it takes none "
             f"of them, and was not asked. ✗: half or more failed. {DASH}: not run at that size, by a rule declared before the "
             "run.", "",
             shown_tables.by_solver(found).markdown()]
    if found.left_out:
        lines.append(f"{plural(len(found.left_out), 'other solver or setting', 'other solvers and settings')} are in the report.\n")
    if absent := [shown_tables.key(entry["key"]) for entry in inputs.solvers if not entry["available"]]:
        lines.append(f"Not in this build: {', '.join(absent)}.\n")
    return "\n".join(lines)


def full_headline(inputs: Inputs, found: Headline) -> str:
    parts = [caption(inputs, found), "", shown_tables.classes(found).markdown(), peers(found), ""]
    for words, table in ((FRONT_WORDS, shown_tables.front(found)), (FLAG_WORDS, shown_tables.equal_flags(inputs))):
        parts += [words, "", table.markdown()] if table else []
    return "\n".join([*parts, details(inputs, found)])


def ablation(inputs: Inputs) -> str:
    """The table of all size classes together."""
    table = shown_tables.ablation(inputs, all_only=True)
    return "This campaign has no ablations.\n" if table is None else f"{ABLATION_WORDS}\n\n{table.markdown()}"


def render(inputs: Inputs, lines: list[str], changes: str = "") -> str:
    """@param lines    what the report finds, a sentence each; they come first
    @param changes  against an earlier run, in Markdown (changes_markdown)
    """
    parts = ["# LCPBench: " + markdown(", ".join(inputs.names)), ""]
    parts += [f"- {markdown(line)}" for line in lines] + [""] * bool(lines)
    tier = power(choice.main_tier(inputs))
    if len(inputs.cells):
        parts += _part("Which backend", shown_tables.choices(inputs), "Of our solvers that verify nearly as much as any (99 % of "
                       "the most), the one with the least geometric mean of fresh times, failures entered with the time limit. "
                       "Redundant: rows of A depend on each other.")
        found = headline(inputs)
        if found.classes:  # none where no problem counts, as those that are meant to break something
            parts += ["## Times", "", full_headline(inputs, found)]
        parts += _part("By origin of the problems", shown_tables.origins(inputs), ORIGIN_WORDS)
        parts += _part("Sealed and open problems", shown_tables.sealed(inputs), SEALED_WORDS)
        parts += _part("Literature", shown_tables.literature(inputs), LITERATURE_WORDS)
        parts += _part("Friction", shown_tables.friction(inputs), f"{FRICTION_WORDS} {shown_tables.not_taking_friction(inputs)}".strip())
        parts += _part("Friction by size", shown_tables.friction_classes(inputs), FRICTION_CLASS_WORDS)
        if inputs.friction is not None:
            parts += _part("Friction, sealed and open problems", shown_tables.sealed(inputs.friction), SEALED_WORDS)
            parts += _part("Friction, every solver by size", shown_tables.by_solver(headline(inputs.friction)),
                           f"Marks as above. {false_successes(inputs.friction)}")
        parts += _part("Errors of answers with friction", shown_tables.friction_errors(inputs), FRICTION_ERROR_WORDS)
        parts += _part("Ablations", shown_tables.ablation(inputs, all_only=True), ABLATION_WORDS)
        parts += _part("Verified and false", shown_tables.coverage(inputs), "Share of the problems that are verified; ✗ with the "
                       "number of false successes: answers that a solver called solved and that are not; ↓ with the number of "
                       "those of a solver that was not asked for this tier; ⌊ with the number of failures that ask for less than the "
                       "rounding floor of the answer's own forces, where no solver passes; "
                       f"{shown_tables.NOT_ASKED_MARK} with the number of problems that it does not take as they are given: it was not "
                       "asked, and the share is of the others.")
        problems = shown_tables.pathological(inputs)["problem"].nunique()
        parts += _part("Problems that are meant to break something", shown_tables.robustness(inputs),
                       f"{problems} problems at tier {tier}; what is missing to that number failed honestly.")
    parts += _part("Sequences of motions", shown_tables.sequences(inputs), f"Latency of a step from a warm start at tier {tier}, "
                   "one interval from its arrays to f, and by how much a cold start takes longer.")
    for index, (scene, level, table) in enumerate(shown_tables.motions(inputs.friction_motion, friction=True)):
        parts += _part(f"Motion with friction: {scene}, {level} level", table, FRICTION_MOTION_WORDS if index == 0 else "")
    parts += _environment(inputs)
    parts += ["## Limitations that affect fairness", "",
              *(f"- **{subject}.** {sentence}" for subject, sentence in limitations(inputs)), ""]
    parts += ["## Compared with an earlier run", "",
              *([changes.replace("\n#", "\n##").replace("# ", "### ", 1)] if changes else []),
              "    lcpbench compare OLD NEW", "",
              "reads two campaign folders of one plan and tells what became slower, faster or wrong; its exit status is "
              "1 for a regression.", ""]
    if inputs.notes:
        parts += ["## Notes", "", *(f"- {markdown(note)}" for note in inputs.notes), ""]
    return "\n".join(parts)


def _part(title: str, table: Table | None, words: str) -> list[str]:
    return [] if table is None else [f"## {title}", "", words, "", table.markdown()]


def _environment(inputs: Inputs) -> list[str]:
    lines = ["## Measured", ""]
    for name, campaign in zip(inputs.names, inputs.campaigns):
        count = f"{len(campaign.problems)} problems" if campaign.problems else f"{len(campaign.sequences)} sequences"
        told = _measured(campaign.info, ["cpu", "os", "compiler", "flags", "solver_flags"])
        lines.append(markdown(f"- {name}: " + "; ".join(filter(None, [count, told]))))
    return [*lines, ""]
