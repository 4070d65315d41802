"""One colour, marker and dash per solver; the same in every figure and table.

Own solvers have saturated colours, filled markers and thick lines. There are more of them than colours that can be told
apart: no two share both colour and marker, those that share a colour differ in their dash, and the six that most
questions are about share none. Peers have the muted colours, one per library, and hollow
markers, one per method; a variant of a method (default options, diagonal shift, other settings) has its dash changed.
So the eye finds the library first, then the method, then the variant.
"""

from dataclasses import dataclass, replace

from .solver_facts import KNOWN, LIBRARIES, MARKERS, VARIANTS, library, method

# Okabe and Ito (2008), safe for the common kinds of colour blindness; yellow left out: too pale on white.
OWN_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
# Tol (2021), "muted", made for the same, without its palest.
PEER_COLOURS = ("#332288", "#117733", "#882255", "#AA4499", "#999933", "#44AA99", "#CC6677", "#661100", "#6699CC")
_MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")
_SOLID = "-"
_DASHES = dict(zip(VARIANTS, ((0, (1.5, 2)), (0, (4, 2)), (0, (5, 1.5, 1, 1.5)))))
_VARIANT = (0, (8, 2))  # with other settings, under a key of its own
# For the second, third, ... own solver with a colour.
_OWN_DASHES = (_SOLID, (0, (5, 1.6)), (0, (1.4, 1.2)), (0, (6, 1.5, 1.2, 1.5)))
ORACLE_COLOUR = "#000000"


@dataclass(frozen=True)
class Look:
    """Of a trace, in Matplotlib's letters."""

    colour: str
    marker: str = ""
    dash: object = _SOLID  # None: no line
    strong: bool = True  # filled markers, thick lines
    size: float = 7  # of a marker [px]
    opacity: float = 1


def solver_styles(solvers: list[dict]) -> dict[str, Look]:
    """By key, of a campaign's solvers; those that are missing count, so that styles do not depend on the build."""
    styles = _own_styles([s["key"] for s in solvers if s["origin"] == "own" and method(s) == s["key"]])
    libraries: dict[str, dict[str, str]] = {name: {} for name in LIBRARIES}  # library -> method -> marker
    for solver in solvers:
        key, base, of = solver["key"], method(solver), library(solver)
        varied = _DASHES.get(key.rpartition("-")[2], _VARIANT)
        if solver["origin"] != "own":
            markers = libraries.setdefault(of, {})
            colour = PEER_COLOURS[list(libraries).index(of) % len(PEER_COLOURS)]
            if base not in markers:
                wanted = (MARKERS.get(base.removeprefix(of + "-")), *_MARKERS)
                free = [marker for marker in wanted if marker and marker not in markers.values()]
                markers[base] = free[0] if free else _MARKERS[len(markers) % len(_MARKERS)]
            styles[key] = Look(colour, markers[base], _SOLID if base == key else varied, False)
        elif key not in styles:
            parent = styles.get(base) or Look(OWN_COLOURS[0], _MARKERS[0], _SOLID, True)
            styles[key] = replace(parent, dash=varied)
    return {solver["key"]: styles[solver["key"]] for solver in solvers}


def _own_styles(keys: list[str]) -> dict[str, Look]:
    """Colours by turns; of a colour every solver has the next marker and dash."""
    styles = {}
    for index, key in enumerate([*KNOWN, *(key for key in keys if key not in KNOWN)]):
        turn, colour = divmod(index, len(OWN_COLOURS))
        # Colour c begins with marker c, so that markers differ where colours do as well.
        marker = _MARKERS[(colour + turn * (len(_MARKERS) - len(OWN_COLOURS) + 1)) % len(_MARKERS)]
        styles[key] = Look(OWN_COLOURS[colour], marker, _OWN_DASHES[turn % len(_OWN_DASHES)], True)
    return styles
