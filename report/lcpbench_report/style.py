"""One colour, marker and dash per solver, by the order of the registry; the same in every figure and table."""

from dataclasses import dataclass

# Okabe and Ito (2008), safe for the common kinds of colour blindness; yellow left out: too pale on white.
_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
_MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")
_DASHES = ("-", (0, (5, 2)), (0, (1, 1.5)))  # changes when the colours have run out

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

    @property
    def marker_path(self) -> str:
        return MARKER_PATHS[self.marker]


def level_colours(count: int) -> list[str]:
    """Backgrounds for `count` tiers, the strictest (first) the strongest; dark text reads on all of them."""
    strong, faint = (0x9E, 0xC9, 0xE8), (0xE9, 0xF3, 0xFA)
    shares = [i / max(count - 1, 1) for i in range(count)]
    return ["#" + "".join(f"{round(a + (b - a) * share):02x}" for a, b in zip(strong, faint)) for share in shares]


def solver_styles(solvers: list[str]) -> dict[str, SolverStyle]:
    return {key: SolverStyle(_COLOURS[i % len(_COLOURS)], _MARKERS[i % len(_MARKERS)],
                             _DASHES[(i // len(_COLOURS)) % len(_DASHES)]) for i, key in enumerate(solvers)}
