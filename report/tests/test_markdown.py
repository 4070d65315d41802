"""What stands in Markdown: names from files show as they are, and never as tags, marks or control characters."""

import unittest

from lcpbench_report.table import Table, code, markdown


class Escapes(unittest.TestCase):
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


if __name__ == "__main__":
    unittest.main()
