"""One colour, marker and dash per solver; the same in every figure and table.

Own solvers have saturated colours, filled markers and thick lines. Peers have the muted colours, one per library, and
hollow markers, one per method; a variant of a method (default options, diagonal shift) has its dash changed. So the
eye finds the library first, then the method, then the variant.
"""

from dataclasses import dataclass

# Okabe and Ito (2008), safe for the common kinds of colour blindness; yellow left out: too pale on white.
_OWN = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
# Tol (2021), "muted", made for the same, without its palest.
_PEERS = ("#332288", "#117733", "#882255", "#AA4499", "#999933", "#44AA99", "#CC6677", "#661100", "#6699CC")
_MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")
_SOLID = "-"
_DASHES = {"default": (0, (1.5, 2)), "cfm": (0, (4, 2))}
ORACLE_COLOUR = "#000000"

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
    def marker_path(self) -> str:
        return MARKER_PATHS[self.marker]

    @property
    def dash_array(self) -> str:
        """For SVG; '' is solid."""
        return "" if self.dash == _SOLID else " ".join(map(str, self.dash[1]))


def level_colours(count: int) -> list[str]:
    """Backgrounds for `count` tiers, the strictest (first) the strongest; dark text reads on all of them."""
    strong, faint = (0x9E, 0xC9, 0xE8), (0xE9, 0xF3, 0xFA)
    shares = [i / max(count - 1, 1) for i in range(count)]
    return ["#" + "".join(f"{round(a + (b - a) * share):02x}" for a, b in zip(strong, faint)) for share in shares]


def solver_styles(solvers: list[dict]) -> dict[str, SolverStyle]:
    """By key, of the solvers of run.json; those that are missing count, so that styles do not depend on the build."""
    libraries: dict[str, dict[str, str]] = {}  # library -> method -> marker
    styles, own = {}, 0
    for solver in solvers:
        key = solver["key"]
        if solver["origin"] == "own":
            styles[key] = SolverStyle(_OWN[own % len(_OWN)], _MARKERS[own % len(_MARKERS)], _SOLID, True)
            own += 1
            continue
        library = solver["source"] if solver["origin"] == "peer" else key
        markers = libraries.setdefault(library, {})
        colour = _PEERS[list(libraries).index(library) % len(_PEERS)]
        method, _, variant = key.rpartition("-")
        if variant not in _DASHES or not method:
            method, variant = key, ""
        marker = markers.setdefault(method, _MARKERS[len(markers) % len(_MARKERS)])
        styles[key] = SolverStyle(colour, marker, _DASHES.get(variant, _SOLID), False)
    return styles
