#!/usr/bin/python3
"""Writes the literal problems of the tiers `friction-pathological` and `painleve`.

usage: friction_literals.py [-o FOLDER]

Files problems/friction-pathological.jsonl.gz and problems/painleve.jsonl.gz of FOLDER (default: this one) are written;
`lcpbench collection build` makes the manifests from them. Of the oracle (tests/data/oracle/friction*.jsonl) come small
problems that break something, their fractions rounded to doubles; the accelerations are made here, by the formulas of
docs/model.md sections 4 and 7, from numbers that are exact in doubles wherever a threshold is met. `literals.py` writes
what is published().
"""

import argparse
import gzip
import json
from fractions import Fraction
from pathlib import Path

_DATA = Path(__file__).resolve().parent
_ORACLE = _DATA.parent / "tests/data/oracle"

# Why records of the oracle are here, by category; others are left out.
BREAKS = {
    "breaks-desaxce": "The loop on the shift mu |w_t| does not converge.",
    "breaks-lemke3": "Lemke's method on the LCP of three rows a contact ends in a ray, and there is a solution.",
    "breaks-newton": "Newton's method along modes, with a line search, fails from f = 0.",
    "breaks-nsgs": "Sweeps with exact solves of each contact do not converge from f = 0.",
    "breaks-pgs": "Sweeps row by row do not converge from f = 0.",
    "breaks-tresca": "The loop of lagged bounds does not converge.",
    "fast-sliding": "Slip 16384 times the load: who divides by |b| takes f = 0 for an answer.",
    "impact": "Newton's law with e = 1: kinetic energy grows.",
    "keystone": "A wedge between two abutments, two contacts a face: redundant rows that all stick.",
    "large-mu": "Large coefficients of friction.",
    "large-redundant": "Rows that depend on each other, in 7 and 8 contacts.",
    "mixed": "Friction and bounded rows in one problem.",
    "normal-ray": "A wall closes on a disc: no solution, by a ray of normal forces.",
    "part-frictionless": "Coefficients of 0 among others.",
    "redundant": "Rows that depend on each other.",
    "several": "Solutions with different motions.",
    "three-solutions": "A rod that may part, stick or slip; all three are solutions.",
    "two-tangents": "Two tangent rows on one normal row.",
    "units": "Rows of one contact in different units: mu changes with them.",
    "very-redundant": "Rows that depend on each other, many more than the bodies can tell apart.",
    "wedge": "A disc in a wedge: forces in the cones that balance without a load.",
    "wedge-depth": "A disc in a wedge with depth at both walls: friction prevents what depth demands.",
}
# What each counterexample refutes.
REFUTES = {
    "ce01": "A covering vector of Lemke's path that is not in the interior of the dual cone ends in a ray at once.",
    "ce02": "Normal loads are roundings, and a jam carries forces of order 1.",
    "ce03": "One contact opens fast, another carries a load that is nothing beside it: f = 0 must not pass.",
    "ce04": "A_nn > mu |A_nt| and A singular: the motion is unique and f is not.",
    "ce05": "A_nn > mu A_nt, and the loop on the shift diverges all the same.",
    "ce06": "No solution, by a ray that is not 0 on a bounded row.",
    "ce07": "No solution, by a ray that is not 0 on a bounded row, beside friction.",
    "ce08": "A block that slides although it is steep enough to topple.",
    "ce09": "A block that topples about its edge and does not slide.",
    "ce10": "A wheel at a step that may climb, and may also stay.",
    "ce11": "Rows of one contact that depend on each other: 0/0 in the formula of stick, and no solution.",
    "ce12": "A joint that has drifted: no solution, though no contact asks for more than it has.",
    "ce13": "A wedge exactly at the threshold of jamming.",
    "ce14": "A normal row in other units, so that mu is 2^28.",
    "ce15": "A tangent row without mobility, A_tt = 0.",
    "ce16": "The exact answer, rounded to doubles, has a residual above the first estimate of the floor.",
    "ce17": "Friction twice as large as allowed where hardly any normal force is.",
    "ce18": "A coefficient of 10^6, and the contact slips under force.",
    "ce20": "A pyramid of discs that must fall.",
}


def doubles(value):
    """A number, text p/q, or nested lists of these."""
    if isinstance(value, list):
        return [doubles(item) for item in value]
    return None if value is None else float(Fraction(value))


def line(name, family, purpose, provenance, record, origin="placed", licence="Apache-2.0"):
    """A line of a tier's file; `record` has the problem's members."""
    numbers = {key: doubles(record[key]) for key in ("J", "invM", "A", "b")
               if key in record and not (key == "A" and "J" in record)}
    if "columns_per_body" in record:
        numbers["columns_per_body"] = record["columns_per_body"]
    if record.get("bilateral"):
        numbers["bilateral"] = record["bilateral"]
    if record.get("friction"):
        numbers["friction"] = {**record["friction"], "mu": doubles(record["friction"]["mu"])}
    if record.get("bounded"):
        bounds = {side: doubles(record["bounded"][side]) for side in ("lower", "upper")}
        numbers["bounded"] = {**record["bounded"], **bounds}
    return {"id": name, "n": len(record["b"]), **numbers, "family": family, "purpose": purpose, "origin": origin,
            "provenance": provenance, "licence": licence}


def of_oracle():
    lines = []
    for name in ("friction", "friction_counterexamples"):
        path = _ORACLE / f"{name}.jsonl"
        for record in map(json.loads, path.read_text(encoding="utf-8").splitlines()):
            purpose = BREAKS.get(record["category"]) or REFUTES.get(record["id"][:4])
            if purpose is None or record.get("level") == "acceleration":
                continue
            lines.append(line(record["id"], record["category"], purpose,
                              f"the oracle's record {record['id']} (tests/data/oracle/{path.name})", record))
    return lines


# ----- accelerations

GRAVITY = 10


class Accelerations:
    """A problem at the acceleration level, built contact by contact; ground is at rest."""

    def __init__(self):
        self.bodies = []  # inverse mass, inverse inertia, omega, force and torque
        self.rows, self.b, self.bilateral = [], [], []
        self.friction = {"row": [], "normal": [], "mu": [], "slip": []}

    def body(self, inverse_mass, inverse_inertia, omega=0, pull=(0, 0), torque=0):
        """A body under its weight and other forces by mass."""
        self.bodies.append((inverse_mass, inverse_inertia, omega, (pull[0], pull[1] - GRAVITY), torque))
        return len(self.bodies) - 1

    def _row(self, parts, gamma):
        row, load = {}, gamma
        for body, direction, arm in parts:
            turn = arm[0] * direction[1] - arm[1] * direction[0]
            row[body] = (*direction, turn)
            _, inverse_inertia, _, pull, torque = self.bodies[body]
            load += direction[0] * pull[0] + direction[1] * pull[1] + turn * inverse_inertia * torque
        self.rows.append(row)
        self.b.append(load)
        return len(self.rows) - 1

    def contact(self, body, arm, mu, slip=0, normal=(0, 1), curvature=None, ground=0, u=0):
        """A vertex (no curvature) or an edge on ground of some curvature, with slip speed u of the sign `slip`."""
        omega = self.bodies[body][2]
        tangent = (-normal[1], normal[0])
        own = (0, 1) if curvature is None else (1, curvature)
        D = own[0] * ground + own[1]
        numerator = own[1] * ground * u * u + 2 * u * own[0] * ground * omega - own[0] * omega * omega
        dot = [direction[0] * arm[0] + direction[1] * arm[1] for direction in (normal, tangent)]
        n = self._row([(body, normal, arm)], -omega * omega * dot[0] + numerator / D)
        t = self._row([(body, tangent, arm)], -omega * omega * dot[1])
        for key, value in zip(("row", "normal", "mu", "slip"), (t, n, mu, slip)):
            self.friction[key].append(value)
        return self

    def pin(self, body1, arm1, body2, arm2):
        for axis in ((1, 0), (0, 1)):
            gamma = 0
            for body, arm, sign in ((body1, arm1, -1), (body2, arm2, 1)):
                gamma += sign * self.bodies[body][2] ** 2 * (axis[0] * arm[0] + axis[1] * arm[1])
            opposite = (-axis[0], -axis[1])
            self.bilateral.append(self._row([(body1, axis, arm1), (body2, opposite, arm2)], gamma))
        return self

    def record(self):
        J = [[value for body in range(len(self.bodies)) for value in row.get(body, (0, 0, 0))] for row in self.rows]
        invM = [value for mass, inertia, *_ in self.bodies for value in (mass, mass, inertia)]
        friction = dict(self.friction)
        if not any(friction["slip"]):
            del friction["slip"]
        return {"J": J, "invM": invM, "b": self.b, "bilateral": self.bilateral, "friction": friction}


# Rods with half length 5, 13, 17: horizontal and vertical arm of the tip, inverse inertia; inverse masses are 1.
# Above mu = A_nn / A_nt, 2, 3.47, 1.07, friction presses the tip on harder than the normal force lifts it.
RODS = [((-4, -3), Fraction(1, 8)), ((-12, -5), Fraction(1, 64)), ((-8, -15), Fraction(1, 64))]


def sliding_rod(problem, rod, mu, omega, pull=(0, 0), slip=1):
    arm, inverse_inertia = rod
    body = problem.body(1, inverse_inertia, omega, pull)
    problem.contact(body, arm, mu, slip, u=slip)
    return body


def rods():
    """A rod's tip slides so that friction presses it on; below, at and above the coefficient of Painlevé."""
    lines = []
    for k, rod in enumerate(RODS):
        (x, y), inertia = rod
        threshold = (1 + x * x * inertia) / (x * y * inertia)
        # b_n = omega^2 (height of the centre) - g
        for label, omega in (("pressed", 0), ("lifting", 3)):
            for share in (Fraction(1, 2), Fraction(7, 8), 1, Fraction(5, 4), 2):
                if share == 1 and k > 0:  # not exact in doubles
                    continue
                problem = Accelerations()
                sliding_rod(problem, rod, threshold * share, omega)
                lines.append((f"rod-{k + 1}-{label}-mu-{float(share):g}", "sliding-rod",
                              "A sliding tip that friction presses on: one, no or two solutions.", problem))
        problem = Accelerations()
        sliding_rod(problem, rod, 2 * threshold, 0, (0, GRAVITY))
        lines.append((f"rod-{k + 1}-weightless", "sliding-rod",
                      "Above the coefficient of Painlevé without a load: f = 0 and nothing else.", problem))
    problem = Accelerations()
    sliding_rod(problem, RODS[0], 2, 0, (0, GRAVITY))
    lines.append(("rod-1-weightless-mu-1", "sliding-rod",
                  "At the coefficient of Painlevé without a load: any force is a solution.", problem))
    return lines


def resting_rods():
    """The same rods at rest: the direction of slip is not known."""
    lines = []
    for k, rod in enumerate(RODS):
        (x, y), inertia = rod
        threshold = (1 + x * x * inertia) / (x * y * inertia)
        for share in (Fraction(1, 2), Fraction(3, 2)):
            # Up by more than its weight and to the left, or down.
            for label, pull in (("raised", (-4, GRAVITY + 1)), ("pressed", (-4, 0)), ("pushed", (4, 0))):
                problem = Accelerations()
                body = problem.body(1, inertia, 0, pull)
                problem.contact(body, rod[0], threshold * share)
                lines.append((f"resting-rod-{k + 1}-{label}-mu-{float(share):g}", "resting-rod",
                              "A tip at rest: it may part, stick and slip, and more than one of these may be right.",
                              problem))
    return lines


def several_rods():
    """Independent rods: as many solutions as the product of theirs, none where one has none."""
    lines = []
    for count in (2, 4, 6):
        for label, last in (("all-lifting", 3), ("one-pressed", 0)):
            problem = Accelerations()
            for k in range(count):
                sliding_rod(problem, RODS[k % 3], 6, last if k == count - 1 else 3)
            lines.append((f"rods-{count}-{label}", "several-rods",
                          "Islands with two solutions each, one of them perhaps with none.", problem))
    for count in (2, 3):
        for mu in (1, 3, 6):
            # A chain of rods, each sliding on its lower tip and pinned to the next at its upper one's height.
            problem = Accelerations()
            bodies = [sliding_rod(problem, RODS[0], mu, 0) for _ in range(count)]
            for one, other in zip(bodies, bodies[1:]):
                problem.pin(one, (4, 3), other, (4, 3))
            lines.append((f"pinned-rods-{count}-mu-{mu}", "several-rods",
                          "Sliding tips of rods that are pinned to each other.", problem))
    return lines


def ladders_and_blocks():
    lines = []
    for mu in (Fraction(1, 4), 1, 3):
        for omega in (0, 1):
            # Falls: the foot slides to the right, the top down.
            problem = Accelerations()
            body = problem.body(1, Fraction(1, 8), omega)
            problem.contact(body, (3, -4), mu, -1, u=-1)
            problem.contact(body, (-3, 4), mu, -1, normal=(1, 0), u=-1)
            lines.append((f"falling-ladder-mu-{float(mu):g}-omega-{omega}", "ladder",
                          "A ladder that slides at both ends.", problem))
    for height in (1, 3):
        for mu in (Fraction(1, 4), Fraction(1, 2), 2):
            for slip in (1, 0):
                problem = Accelerations()
                body = problem.body(1, Fraction(1, 2), 0, (0 if slip else 4, 0))
                for x in (-1, 1):
                    problem.contact(body, (x, -height), mu, slip, u=slip)
                what = "sliding" if slip else "pushed"
                lines.append((f"{what}-block-height-{height}-mu-{float(mu):g}", "block",
                              "A block on two feet: tangent rows that depend on each other.", problem))
    return lines


def curved_ground():
    """Discs of radius 1 on ground of radius 3 and 4, slope tan 3/4, and ellipses on a plane."""
    lines = []
    normal = (Fraction(3, 5), Fraction(4, 5))
    # On a plane, and at rest anywhere, curvature and speed do not matter.
    for name, ground, omegas in (("hill", Fraction(1, 3), (1, 2, 5)), ("valley", Fraction(-1, 4), (1, 2, 5)),
                                 ("plane", Fraction(0), (0,))):
        for omega in omegas:
            for mu in (Fraction(1, 8), Fraction(1, 2)):
                problem = Accelerations()
                body = problem.body(1, 2, omega)
                problem.contact(body, (-normal[0], -normal[1]), mu, normal=normal, curvature=1, ground=ground)
                lines.append((f"rolling-{name}-omega-{omega}-mu-{float(mu):g}", "curved-ground",
                              "A disc that rolls on curved ground: curvature and speed decide whether it parts or slips.",
                              problem))
        problem = Accelerations()
        body = problem.body(1, 2, 1)
        problem.contact(body, (-normal[0], -normal[1]), Fraction(1, 2), -1, normal=normal, curvature=1, ground=ground,
                        u=-2)
        lines.append((f"sliding-{name}", "curved-ground", "A disc that slides on curved ground.", problem))
    # Semi-axes 2 and 1, touching at parameter with tan 3/4: arm, curvature a b / |c'|^3 at that point.
    cos, sin = Fraction(4, 5), Fraction(3, 5)
    speed_squared = 4 * sin * sin + cos * cos
    curvature = 2 / (float(speed_squared) ** 1.5)
    length = float(speed_squared) ** 0.5
    inward = (float(cos) / length, 2 * float(sin) / length)
    for omega in (0, 1, 2, 3):
        for mu in (Fraction(1, 4), 1):
            problem = Accelerations()
            body = problem.body(1, Fraction(4, 5), omega)
            problem.contact(body, (-2 * float(cos), -float(sin)), float(mu), normal=inward, curvature=curvature)
            lines.append((f"rocking-oval-omega-{omega}-mu-{float(mu):g}", "curved-ground",
                          "An oval that rolls on a slope: the contact's arm couples normal and tangential rows.", problem))
    return lines


def accelerations():
    provenance = "generated by data/friction_literals.py"
    made = rods() + resting_rods() + several_rods() + ladders_and_blocks() + curved_ground()
    return [line(name, family, purpose, provenance, problem.record()) for name, family, purpose, problem in made]


# ----- published examples

GENOT = "Génot, Brogliato, Eur. J. Mech. A/Solids 18 (1999) 653-677: "
GLOCKER = "Glocker, Dynamik von Starrkörpersystemen mit Reibung und Stößen, 1995, section 5.3.4: "
NGUYEN = "Nguyen, Int. J. Robotics Research 7(3) (1988) 3-16: "
WHITNEY = "Whitney, J. Dyn. Sys. Meas. Control 104 (1982) 65-77: "
KLARBRING = "Klarbring, Ingenieur-Archiv 60 (1990) 529-541: "


def painleve_rods():
    """Homogeneous rods at tan theta = 2, where the least coefficient of Painlevé is 4/3, and at the angles around it."""
    made = []
    for x, y in ((3, 4), (5, 12), (8, 15), (15, 8)):  # horizontal and vertical arm of the tip
        inertia = Fraction(3, x * x + y * y)  # 3 / l^2
        for mu in (1, Fraction(4, 3), Fraction(5, 3), 3):
            for omega in (0, Fraction(3, 2)):
                problem = Accelerations()
                body = problem.body(1, inertia, omega)
                problem.contact(body, (-x, -y), mu, 1, u=1)
                made.append((f"genot-brogliato-{y}-{x}-mu-{float(mu):.3g}-omega-{float(omega):g}", "painleve-rod",
                             GENOT + "homogeneous rods, paradoxes from mu = 4/3 on; angle and speed chosen here", problem))
    # m = s = 1, J = 1/3, g = 10, mu = 5/3.
    for x, y in ((Fraction(4, 5), Fraction(3, 5)), (Fraction(3, 5), Fraction(4, 5)), (Fraction(5, 13), Fraction(12, 13))):
        problem = Accelerations()
        problem.contact(problem.body(1, 3), (-x, -y), Fraction(5, 3), 1, u=1)
        made.append((f"glocker-rod-{float(y):.2g}", "painleve-rod",
                     GLOCKER + "impact without collision, mu = 5/3; angles chosen here", problem))
    return made


def wedges():
    """A disc between walls at an angle from the vertical: both cones hold it by themselves from mu = tan of it on. Rows
    have the length of the normal, so that numbers are exact in doubles, and what contradicts itself does so truly."""
    made = []
    for x, y, length in ((4, 3, 5), (12, 5, 13), (15, 8, 17)):
        for share in (Fraction(1, 2), 1, 2):
            if share == 1 and x > 4:  # not exact in doubles
                continue
            for label, pull, torque in (("pressed", (0, 0), 0), ("lifted", (0, GRAVITY + 1), 0),
                                        ("turned", (0, 0), 8), ("pushed", (30, 0), 0)):
                problem = Accelerations()
                body = problem.body(1, 2, 0, pull, torque)
                for sign in (1, -1):
                    arm = (-sign * Fraction(x, length), -Fraction(y, length))
                    problem.contact(body, arm, share * Fraction(y, x), normal=(sign * x, y))
                made.append((f"nguyen-wedge-{y}-{x}-mu-{float(share):g}-{label}", "wedge",
                             NGUYEN + "two contacts in each other's cones hold each other; loads chosen here", problem))
    return made


def pegs():
    """A peg of diameter d in a hole to depth l touches in two points: it wedges from mu = l / d on."""
    made = []
    for mu in (Fraction(1, 8), Fraction(1, 2), 1, 2):
        for label, pull, torque in (("down", (0, 0), 0), ("tilted", (0, 0), 8), ("out", (0, 3 * GRAVITY), 4),
                                    ("aside", (8, 0), 0)):
            problem = Accelerations()
            body = problem.body(1, Fraction(1, 4), 0, pull, torque)
            problem.contact(body, (-1, -4), mu, normal=(1, 0))
            problem.contact(body, (1, -3), mu, normal=(-1, 0))
            made.append((f"whitney-peg-mu-{float(mu):g}-{label}", "peg",
                         WHITNEY + "two-point contact of a peg in a hole, d = 2, l = 1; loads chosen here", problem))
    return made


def springs():
    """One contact on springs, w = displacement: several solutions, or none, from mu = A_nn / A_nt on."""
    made = []
    for mu in (1, 2, 4):
        for b in ((-1, 0), (-1, 1), (1, -2), (1, 1)):
            made.append((f"klarbring-springs-mu-{mu}-{b[0]}-{b[1]}", "springs",
                         KLARBRING + "one node on springs, by its compliance; numbers chosen here",
                         {"A": [[2, 1], [1, 1]], "b": list(b), "friction": {"row": [1], "normal": [0], "mu": [mu]}}))
    return made


def published():
    made = painleve_rods() + wedges() + pegs() + springs()
    return [line(name, family, "", source, of if isinstance(of, dict) else of.record(), "literature", "CC0-1.0")
            | {"base": family} for name, family, source, of in made]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", type=Path, default=_DATA)
    folder = parser.parse_args().output / "problems"
    for tier, lines in (("friction-pathological", of_oracle()), ("painleve", accelerations())):
        text = "".join(json.dumps(record) + "\n" for record in lines).encode()
        (folder / f"{tier}.jsonl.gz").write_bytes(gzip.compress(text, 9, mtime=0))
        print(f"{tier}: {len(lines)} literal problems")


if __name__ == "__main__":
    main()
