"""A table that people read: described once (shown_tables.py), written as Markdown, HTML and LaTeX.

Headers and cells are text in Markdown's marks: `key`, **best**, *word*. What follows a line break in a cell is a
detail: smaller in HTML, behind a semicolon elsewhere.
"""

import re
from dataclasses import dataclass

from markupsafe import Markup, escape

_CODE, _STRONG, _WORD = re.compile(r"`([^`]*)`"), re.compile(r"\*\*(.+?)\*\*"), re.compile(r"\*(.+?)\*")
_POWERS = str.maketrans({digit: rf"\textsuperscript{{{k}}}" for k, digit in enumerate("⁰¹²³⁴⁵⁶⁷⁸⁹")})
_LATEX = _POWERS | str.maketrans({
    "\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_", "{": r"\{", "}": r"\}",
    "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "<": r"\textless{}", ">": r"\textgreater{}", "–": "--",
    "µ": r"\textmu{}", "\u202f": r"\,", "·": r"\textperiodcentered{}", "✗": r"\texttimes{}", "×": r"\texttimes{}",
    "↓": r"\textdownarrow{}", "⌊": r"$\lfloor$", "≈": r"$\approx$",
    "η": r"$\eta$", "↕": r"$\updownarrow$", "⧖": r"$\bowtie$", "∞": r"$\infty$", "ρ": r"$\rho$", "…": r"\dots{}"})


@dataclass(frozen=True)
class Table:
    columns: list[str]
    rows: list[list]
    align: str = ""  # of every column l (words), w (long words) or r; default: words, then numbers

    @property
    def _sides(self) -> str:
        return self.align or "l" + "r" * (len(self.columns) - 1)

    def markdown(self, most: int | None = None) -> str:
        """@param most  rows; how many more there are is told"""
        lines = [_line(map(_cell, self.columns)), _line("---:" if side == "r" else "---" for side in self._sides)]
        lines += [_line(map(_cell, row)) for row in self.rows[:most]]
        left_out = len(self.rows) - len(self.rows[:most])
        return "\n".join(lines + ["", f"... and {left_out} more."] * bool(left_out)) + "\n"

    def html(self, of_class: str = "") -> Markup:
        """The first cell of a row is its header."""
        sides = {"r": ' class="r"', "w": ' class="wrap"', "l": ""}
        head = "".join(f"<th{sides[side]}>{html(text)}</th>" for side, text in zip(self._sides, self.columns))
        rows = []
        for row in self.rows:
            parts = (str(cell).partition("\n") for cell in row)
            cells = [f"{html(first)}<small>{html(detail)}</small>" if detail else html(first) for first, _, detail in parts]
            others = (f"<td{sides[side]}>{cell}</td>" for side, cell in zip(self._sides[1:], cells[1:]))
            rows.append(f"<tr><th>{cells[0]}</th>{''.join(others)}</tr>")
        return Markup(f'<div class="scroll"><table class="{of_class}">\n<thead><tr>{head}</tr></thead>\n<tbody>\n'
                      + "\n".join(rows) + "\n</tbody></table></div>")

    def latex(self) -> str:
        """With booktabs' rules, without caption or number: \\input stands within the author's own table environment."""
        lines = [r"\begin{footnotesize}", r"\setlength{\tabcolsep}{3pt}",
                 rf"\begin{{tabular}}{{@{{}}{self._sides.replace('w', 'l')}@{{}}}}", r"\toprule",
                 _latex_line(self.columns), r"\midrule", *map(_latex_line, self.rows), r"\bottomrule",
                 r"\end{tabular}", r"\end{footnotesize}"]
        return "\n".join(lines) + "\n"


def code(name: str) -> str:
    """A name from a file between Markdown's marks of code, without any mark that would end them."""
    return f"`{str(name).replace('`', chr(0x2019))}`"


def markdown(text: str) -> str:
    """Text in our marks as Markdown shows it: no tags or entities outside code, control characters as \\xNN."""
    return "".join(part if part.startswith("`") and _CODE.fullmatch(part) else _plain(part)
                   for part in re.split(r"(`[^`]*`)", _visible(text)))


def _plain(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;")


def _visible(text: str) -> str:
    return re.sub("[\x00-\x1f\x7f-\x9f\u2028\u2029]", lambda found: f"\\x{ord(found[0]):02x}", str(text))


def html(text: str) -> Markup:
    marked = _STRONG.sub(r"<b>\1</b>", _CODE.sub(r"<code>\1</code>", str(escape(text))))
    return Markup(_WORD.sub(r"<em>\1</em>", marked))


def latex(text: str) -> str:
    marked = _STRONG.sub(r"\\textbf{\1}", _CODE.sub(r"\\texttt{\1}", str(text).translate(_LATEX)))
    return _WORD.sub(r"\\emph{\1}", marked)


def _cell(text) -> str:
    return markdown(str(text).replace("\n", "; ")).replace("|", "\\|")


def _line(cells) -> str:
    return "| " + " | ".join(cells) + " |"


def _latex_line(cells) -> str:
    return " & ".join(latex(str(cell).replace("\n", "; ")) for cell in cells) + r" \\"
