#!/usr/bin/python3
"""A tiny engine that records what it meets: discs that fall into a box, as a recording of LCPBench on standard output.

usage: record_discs.py [DISCS [STEPS]] > discs.jsonl

It shows what a recorder of your own engine has to do (docs/recording.md): a header, and a line a step with the state
before the velocity solve. The engine is the least that makes contacts: semi-implicit Euler steps, impulses by sweeps.
"""

import json
import math
import random
import sys

STEP, GRAVITY, RADIUS, WIDTH = 1 / 60, -9.81, 0.5, 6.0
SWEEPS, RECORD_EVERY = 20, 10
MARGIN = 0.05  # contacts are met from this gap on
WALLS = (("floor", (0.0, 1.0), 0.0), ("left", (1.0, 0.0), 0.0), ("right", (-1.0, 0.0), -WIDTH))  # n . x = distance


def contacts_of(x):
    """[(first, second, point, normal from first to second, gap, name)]; -1 is the world."""
    found = []
    for i, (px, py) in enumerate(x):
        for name, (nx, ny), distance in WALLS:
            gap = nx * px + ny * py - distance - RADIUS
            if gap < MARGIN:
                found.append((-1, i, (px - nx * RADIUS, py - ny * RADIUS), (nx, ny), gap, f"{name} {i}"))
        for j in range(i + 1, len(x)):
            dx, dy = x[j][0] - px, x[j][1] - py
            apart = math.hypot(dx, dy)
            if apart - 2 * RADIUS < MARGIN:
                n = (dx / apart, dy / apart)
                found.append((i, j, (px + n[0] * apart / 2, py + n[1] * apart / 2), n, apart - 2 * RADIUS, f"{i} {j}"))
    return found


def record(number, x, v, masses, contacts):
    """The line of a step. Discs do not spin here: nothing rubs."""
    still = [0.0] * len(x)
    print(json.dumps({
        "step": number,
        "bodies": {"x": x, "q": still, "v": v, "omega": still, "force": [[0.0, m * GRAVITY] for m in masses],
                   "torque": still},
        "contacts": [{"b": [i, j], "p": p, "n": n, "gap": gap, "mu": 0.0, "id": name,
                      "shape": ["wall" if i < 0 else "circle", "circle"], "radius": [None if i < 0 else RADIUS, RADIUS]}
                     for i, j, p, n, gap, name in contacts],
        "joints": []}))


def step(x, v, masses, contacts):
    """Velocities by sweeps over the contacts, which may not close by more than their gap; then positions."""
    for velocity in v:
        velocity[1] += STEP * GRAVITY
    impulses = [0.0] * len(contacts)
    for _ in range(SWEEPS):
        for k, (i, j, _, (nx, ny), gap, _) in enumerate(contacts):
            parting = nx * v[j][0] + ny * v[j][1] - (nx * v[i][0] + ny * v[i][1] if i >= 0 else 0)
            inverse = 1 / masses[j] + (1 / masses[i] if i >= 0 else 0)
            change = max(-impulses[k], -(parting + max(gap, 0) / STEP) / inverse)
            impulses[k] += change
            for body, sign in ((i, -1), (j, 1)):
                if body >= 0:
                    v[body][0] += sign * change * nx / masses[body]
                    v[body][1] += sign * change * ny / masses[body]
    for place, velocity in zip(x, v):
        place[0] += STEP * velocity[0]
        place[1] += STEP * velocity[1]


def main(discs=20, steps=300):
    rng = random.Random(1)
    x = [[0.6 + 1.2 * (k % 4) + rng.uniform(0, 0.1), 1 + 1.2 * (k // 4)] for k in range(discs)]
    v = [[0.0, 0.0] for _ in x]
    masses = [rng.uniform(0.5, 2) for _ in x]
    print(json.dumps({
        "lcpbench_recording": 1, "engine": "discs", "engine_version": "1", "licence": "Apache-2.0", "scene": "box",
        "source": "examples/record_discs.py", "dimension": 2, "gravity": [0, GRAVITY], "time_step": STEP,
        "bodies": [{"inverse_mass": 1 / m, "inverse_inertia": 2 / (m * RADIUS**2)} for m in masses]}))
    for number in range(steps):
        contacts = contacts_of(x)
        if number % RECORD_EVERY == 0:
            record(number, x, v, masses, contacts)
        step(x, v, masses, contacts)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:3]))
