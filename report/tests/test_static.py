"""Figures and tables for papers."""

import gzip
import io
import re
import shutil
import subprocess
import unittest
import xml.etree.ElementTree

import pandas as pd

from lcpbench_report import static
from lcpbench_report.inputs import load_inputs
from lcpbench_report.static import write_static
from lcpbench_report.table import Table, code, html, latex, markdown
from .cases import SharedFolderCase, inputs_of
from .synthetic_campaign import write_campaign
from .synthetic_report import FAILING, FIGURES, write_friction_motion, write_motion, write_problems, write_steps

TABLES = {"headline", "front", "coverage", "sequences"}
_DRAWN = "{http://www.w3.org/2000/svg}path"


class Static(SharedFolderCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        campaigns = [write_problems(cls.path / "standard"), write_steps(cls.path / "sequences")]
        cls.inputs = load_inputs(campaigns, [write_motion(cls.path / "motion"), write_friction_motion(cls.path / "slipping")])
        cls.written = write_static(cls.inputs, cls.path / "out")

    def test_every_figure_is_there_twice_and_what_is_returned_was_written(self):
        for suffix in (".svg", ".pdf"):
            self.assertEqual({path.stem for path in self.written if path.suffix == suffix}, set(FIGURES))
        on_disk = {path for path in (self.path / "out").rglob("*") if path.is_file()}
        self.assertEqual(set(self.written), on_disk)

    def test_figures_are_not_empty(self):
        for path in self.written:
            if path.suffix == ".svg":
                tree = xml.etree.ElementTree.parse(path)
                # Lines of data, beyond frames, ticks and letters.
                clipped = [e for e in tree.iter() if e.get("clip-path")]
                self.assertGreater(len(clipped), 3, path.name)
                self.assertGreater(sum(1 for _ in tree.iter(_DRAWN)), 20, path.name)
            elif path.suffix == ".pdf":
                self.assertTrue(path.read_bytes().startswith(b"%PDF"))

    def test_the_same_inputs_give_the_same_bytes(self):
        again = write_static(self.inputs, self.path / "again")
        self.assertEqual(len(again), len(self.written))
        for old, new in zip(self.written, again):
            self.assertEqual(old.read_bytes(), new.read_bytes(), old.name)

    def test_without_sequences_those_tables_are_left_out(self):
        inputs = load_inputs([self.path / "standard"])
        names = {path.stem for path in static.write_tables(inputs, self.path / "less") if path.suffix == ".tex"}
        self.assertEqual(names, TABLES - {"sequences"})

    def test_of_sequences_or_of_problems_apart_alone_there_are_their_parts_only(self):
        apart = inputs_of(write_campaign, {"auto": 1.0, "pgs": 2.0}, copies=1, change_problem=lambda of: of | {"set": "pathological"})
        for inputs, there in ((inputs_of(write_steps), {"latency", "deadline", "sequences"}), (apart, {"pathological", "scaling"})):
            written = write_static(inputs, self.path / "alone")
            self.assertEqual({path.stem for path in written if path.suffix in (".svg", ".tex")}, there)

    def test_csv_tables_are_those_of_the_analysis(self):
        table = pd.read_csv(self.path / "out/tables/coverage.csv")
        self.assertEqual(len(table), len(self.inputs.analysis["coverage"]))
        self.assertEqual({path.name.split(".")[0] for path in self.written if ".csv" in path.suffixes},
                         {*self.inputs.analysis, "motion", "friction-motion"})

    def test_large_tables_are_compressed(self):
        table = pd.DataFrame({"a": range(200_000), "ok": [True] * 200_000})
        path = static._write_csv(table, self.path / "large.csv")
        self.assertEqual(path.name, "large.csv.gz")
        self.assertFalse((self.path / "large.csv").exists())
        self.assertTrue(pd.read_csv(io.BytesIO(gzip.decompress(path.read_bytes()))).equals(table))

    def test_latex_tables_are_well_formed(self):
        found = {path.stem: path.read_text(encoding="utf-8") for path in self.written if path.suffix == ".tex"}
        self.assertEqual(set(found), TABLES)
        for name, text in found.items():
            for environment in re.findall(r"\\begin\{(\w+)\}", text):
                self.assertIn(rf"\end{{{environment}}}", text)
            columns = len(re.search(r"\\begin\{tabular\}\{@\{\}(\w+)@\{\}\}", text)[1])
            body = text.split(r"\midrule")[1].split(r"\bottomrule")[0].strip().splitlines()
            self.assertGreater(len(body), 1, name)
            for line in body:
                self.assertEqual(len(re.findall(r"(?<!\\)&", line)) + 1, columns, f"{name}: {line}")
                self.assertTrue(line.endswith(r"\\"), line)
            header = text.split(r"\toprule")[1].split(r"\midrule")[0].strip()
            self.assertEqual(len(re.findall(r"(?<!\\)&", header)) + 1, columns, f"{name}: {header}")
            plain = text.replace(r"\{", "").replace(r"\}", "")
            self.assertEqual(plain.count("{"), plain.count("}"), name)
            self.assertTrue(text.isascii(), name)

    @unittest.skipUnless(shutil.which("pdflatex"), "no LaTeX here (texlive-latex-recommended has what it takes)")
    def test_latex_sets_every_table_within_the_page(self):
        tables = [path for path in self.written if path.suffix == ".tex"]
        folder = self.path / "latex"
        folder.mkdir(exist_ok=True)
        lines = [r"\documentclass[twocolumn]{article}", r"\usepackage{booktabs}", r"\usepackage{textcomp}",
                 r"\usepackage[a4paper, margin=2cm]{geometry}", r"\begin{document}"]
        lines += [rf"\begin{{table*}}\centering\input{{{path}}}\end{{table*}}\clearpage" for path in tables]
        (folder / "all.tex").write_text("\n".join([*lines, r"\end{document}"]), encoding="utf-8")
        found = subprocess.run(["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "all.tex"], cwd=folder,
                               capture_output=True, text=True, errors="replace", check=False)
        self.assertEqual(found.returncode, 0, found.stdout[-2000:])
        log = (folder / "all.log").read_text(encoding="utf-8", errors="replace")
        self.assertNotIn("Overfull", log)
        self.assertIn(f"({len(tables)} pages", log)

    def test_false_successes_are_told_in_latex(self):
        text = (self.path / "out/tables/coverage.tex").read_text(encoding="utf-8")
        row = next(line for line in text.splitlines() if rf"\texttt{{{FAILING}}}" in line)
        counted = self.inputs.analysis["coverage"]
        mine = counted[(counted["set"] == "counted") & (counted["solver"] == FAILING)].sort_values("tier")
        cells = [cell.strip(" \\") for cell in row.split("&")]
        told = [re.search(r"texttimes\{\} (\d+)", cell) for cell in cells[1:]]
        self.assertEqual([int(found[1]) if found else 0 for found in told], list(mine["false_successes"][::-1]))


class Formats(unittest.TestCase):
    """One table in three formats."""

    TABLE = Table(["solver", "time", "why"], [["`time_s`", "**1.2 µs**", "a|b < 50 %\nnext `x`"], ["`b`", "–", ""]], "lrl")

    def test_markdown(self):
        self.assertEqual(self.TABLE.markdown(1), "| solver | time | why |\n| --- | ---: | --- |\n"
                         "| `time_s` | **1.2 µs** | a\\|b &lt; 50 %; next `x` |\n\n... and 1 more.\n")

    def test_html(self):
        text = self.TABLE.html("choose")
        self.assertIn('<table class="choose">', text)
        self.assertIn('<tr><th><code>time_s</code></th><td class="r"><b>1.2 µs</b></td>'
                      "<td>a|b &lt; 50 %<small>next <code>x</code></small></td></tr>", text)
        self.assertEqual(html("*Right*: <&"), "<em>Right</em>: &lt;&amp;")

    def test_latex(self):
        self.assertIn(r"\texttt{time\_s} & \textbf{1.2 \textmu{}s} & a|b \textless{} 50 \%; next \texttt{x} \\", self.TABLE.latex())
        self.assertEqual(latex("a_b & 50 % #1 ${x}~^<\\"),
                         r"a\_b \& 50 \% \#1 \$\{x\}\textasciitilde{}\textasciicircum{}\textless{}\textbackslash{}")
        self.assertTrue(latex("4–10⁴ µs\u202f% ✗ ↓ · × ∞ ρ …").isascii())


class Escapes(unittest.TestCase):
    """Names from files show as they are, and never as tags, marks or control characters."""

    def test_text(self):
        for text, shown in (("plain **bold** `a<b`", "plain **bold** `a<b`"),
                            ("<script>alert(1)</script>", "&lt;script>alert(1)&lt;/script>"),
                            ("a & &lt;", "a &amp; &amp;lt;"),
                            ("\x1b[31mred\n# heading", r"\x1b[31mred\x0a# heading"),
                            ("a\x9bb", r"a\x9bb"),
                            ("one ` alone <b>", "one ` alone &lt;b>"),
                            ("Ärger ρ ≤ 1e-6", "Ärger ρ ≤ 1e-6")):
            with self.subTest(text):
                self.assertEqual(markdown(text), shown)

    def test_a_name_cannot_end_its_code(self):
        self.assertEqual(code("a`<b>`"), "`a’<b>’`")
        self.assertEqual(markdown(code("a`<b>")), "`a’<b>`")

    def test_cells_stay_in_their_table(self):
        table = Table(["solver", "<i>"], [[code("a|b`<script>\x1b"), "x|y\n<b>"]])
        self.assertEqual(table.markdown().splitlines(),
                         ["| solver | &lt;i> |", "| --- | ---: |", r"| `a\|b’<script>\x1b` | x\|y; &lt;b> |"])
