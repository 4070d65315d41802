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

_PLOTLY_SYMBOLS = {"o": "circle", "s": "square", "^": "triangle-up", "D": "diamond", "v": "triangle-down",
                   "P": "cross", "X": "x", "*": "star"}

# The markers as SVG paths in a box from -5 to 5, for legends in HTML.
MARKER_PATHS = {
    "o": "M-4 0a4 4 0 1 0 8 0a4 4 0 1 0-8 0Z", "s": "M-3.6-3.6h7.2v7.2h-7.2Z", "^": "M0-4.4L4.4 3.8H-4.4Z",
    "D": "M0-4.8L4.8 0L0 4.8L-4.8 0Z", "v": "M0 4.4L4.4-3.8H-4.4Z",
    "P": "M-1.6-4.5h3.2v2.9h2.9v3.2h-2.9v2.9h-3.2v-2.9h-2.9v-3.2h2.9Z",
    "X": "M-4.4-2.2L-2.2-4.4L0-2.2L2.2-4.4L4.4-2.2L2.2 0L4.4 2.2L2.2 4.4L0 2.2L-2.2 4.4L-4.4 2.2L-2.2 0Z",
    "*": "M0-5L1.2-1.6H4.8L1.9.6L3 4.1L0 2L-3 4.1L-1.9.6L-4.8-1.6H-1.2Z",
}


@dataclass(frozen=True)
class SolverStyle:
    colour: str
    marker: str
    dash: object
    own: bool

    @property
    def plotly_symbol(self) -> str:
        """The marker's name in Plotly; peers' are hollow."""
        return _PLOTLY_SYMBOLS[self.marker] + ("" if self.own else "-open")

    @property
    def plotly_dash(self) -> str:
        """The dash in Plotly's notation, lengths in pixels of a line 1.4 px wide."""
        return "solid" if self.dash == _SOLID else ",".join(f"{1.4 * length:g}px" for length in self.dash[1])


def solver_styles(solvers: list[dict]) -> dict[str, SolverStyle]:
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
            styles[key] = SolverStyle(colour, markers[base], _SOLID if base == key else varied, False)
        elif key not in styles:
            parent = styles.get(base) or SolverStyle(OWN_COLOURS[0], _MARKERS[0], _SOLID, True)
            styles[key] = replace(parent, dash=varied)
    return {solver["key"]: styles[solver["key"]] for solver in solvers}


def _own_styles(keys: list[str]) -> dict[str, SolverStyle]:
    """Colours by turns; of a colour every solver has the next marker and dash."""
    styles = {}
    for index, key in enumerate([*KNOWN, *(key for key in keys if key not in KNOWN)]):
        turn, colour = divmod(index, len(OWN_COLOURS))
        # Colour c begins with marker c, so that markers differ where colours do as well.
        marker = _MARKERS[(colour + turn * (len(_MARKERS) - len(OWN_COLOURS) + 1)) % len(_MARKERS)]
        styles[key] = SolverStyle(OWN_COLOURS[colour], marker, _OWN_DASHES[turn % len(_OWN_DASHES)], True)
    return styles
