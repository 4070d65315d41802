"""Looks of solvers: distinct, and the same in every campaign."""

import unittest

from lcpbench_report.style import solver_styles

OWN = ("dantzig", "auto", "semismooth-newton", "lemke", "bpp", "active-set", "pgs", "psor", "nncg", "apgd", "ipopt-qp",
       "ipopt-ncp", "ipm", "hybrid", "new-one", "another")
PEERS = ("bullet-dantzig", "bullet-dantzig-cfm", "bullet-lemke", "ode-dantzig", "ode-new", "dart-dantzig", "dart-pgs",
         "dart-pgs-default", "siconos-lexicolemke", "siconos-newton-fb", "siconos-pgs", "siconos-nsgs-sbm",
         "siconos-avi", "petsc-rsls", "petsc-ssls", "tao-bntr", "tao-tron", "cgal-qp", "clp", "clp-default")


def entries(own=OWN, peers=PEERS):
    return [{"key": key, "origin": "own" if key in own else "peer"} for key in (*own, *peers)]


class Style(unittest.TestCase):
    def setUp(self):
        self.styles = solver_styles(entries())

    def test_looks_differ(self):
        for keys, look in ((OWN, lambda s: (s.colour, s.marker)), (OWN, lambda s: (s.colour, s.dash)),
                           (("auto", "dantzig", "bpp", "ipm", "pgs", "lemke"), lambda s: s.colour),  # the important ones
                           (OWN + PEERS, lambda s: (s.colour, s.marker, s.dash))):
            self.assertEqual(len({look(self.styles[key]) for key in keys}), len(keys))

    def test_a_library_has_one_colour_and_no_other_has_it(self):
        colours = {}
        for key in PEERS:
            colours.setdefault(key.split("-")[0], set()).add(self.styles[key].colour)
        self.assertTrue(all(len(found) == 1 for found in colours.values()))
        self.assertEqual(len(set.union(*colours.values())), len(colours))

    def test_a_solver_looks_the_same_in_a_campaign_of_few(self):
        few = solver_styles(entries(("pgs", "nncg"), ("tao-tron", "siconos-avi", "clp")))
        for key, style in few.items():
            self.assertEqual(style, self.styles[key])

    def test_a_variant_has_its_solvers_colour_and_marker_and_another_dash(self):
        styles = solver_styles([*entries(), {"key": "pgs-tuned", "origin": "own", "base": "pgs"},
                                {"key": "mine", "origin": "own", "base": "pgs"},
                                {"key": "clp-tuned", "origin": "peer", "base": "clp"}])
        for variant, base in (("pgs-tuned", "pgs"), ("mine", "pgs"), ("clp-tuned", "clp"), ("clp-default", "clp")):
            self.assertEqual(styles[variant].colour, styles[base].colour)
            self.assertEqual(styles[variant].marker, styles[base].marker)
            self.assertNotEqual(styles[variant].dash, styles[base].dash)
        self.assertEqual(len({str(styles[key].dash) for key in ("pgs", "pgs-tuned", "mine")}), 3)

    def test_ours_are_strong(self):
        self.assertEqual([self.styles[key].strong for key in ("ode-dantzig", "auto")], [False, True])
