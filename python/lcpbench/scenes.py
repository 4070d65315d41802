"""Scenes: bodies with curved edges that touch, the terms of every contact, the problem, pictures and motions.

The mathematics and the names are those of docs/model.md: n points from body 2 to body 1, d is the gap, u the slip,
kappa signed curvatures, D and gamma the terms of section 4; SI units, angles counter-clockwise.
"""

from __future__ import annotations

import html
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from . import _core

__all__ = ["Animation", "Body", "Edge", "Row", "Scene", "generate", "scene_families"]

Vec2 = tuple[float, float]


@dataclass(frozen=True)
class Edge:
    """An edge of an outline, or a feature of a contact, in its body's frame.

    kind     "vertex", "straight", "arc", "ellipse", "superellipse" or "bezier"
    numbers  by name: points [m] as pairs, lengths [m], angles [rad], side "convex" or "concave"
    s_begin, s_end  the piece of the curve, by its parameter; material lies on the left of travel. None of a feature,
             which stands for all of its line, circle or curve
    """

    kind: str
    numbers: dict[str, Any]
    s_begin: float | None = None
    s_end: float | None = None


@dataclass(frozen=True)
class Body:
    """A rigid body: inertia, state and load at the instant, in the world's frame."""

    name: str
    mass: float  # [kg]
    inertia: float  # about the centre of mass [kg m^2]
    fixed: bool  # inverse mass and inertia are 0; it may move as prescribed
    x: Vec2  # centre of mass [m]
    theta: float  # [rad]
    v: Vec2  # [m/s]
    omega: float  # [rad/s]
    force: Vec2  # applied at the centre of mass [N]
    torque: float  # [N m]
    acceleration: Vec2  # prescribed, of a fixed body [m/s^2]
    alpha: float  # likewise [rad/s^2]
    edges: tuple[Edge, ...]  # the outline


@dataclass(frozen=True)
class Row:
    """A row of J and what it is made of: d' = J v, d'' = J a + gamma (docs/model.md sections 1 to 7).

    Of the level of forces b = J M^-1 F + gamma, of a time step h b = J (v + h M^-1 F) + max(d, 0) / h;
    of a tangent less the speeds of belts, of a torque less its motor's.
    Terms that a kind does not have are None.
    """

    kind: str  # "contact", "tangent" (friction), "path joint", "pin" (two rows), "torque" (of a pin), "rod" or "rope"
    constraint: int  # a contact and its tangent are one, and the two rows of a pin
    bilateral: bool  # w = 0, f free
    body1: int
    body2: int
    feature1: Edge
    feature2: Edge
    friction: float  # mu of the contact
    p1: Vec2  # closest points [m]
    p2: Vec2
    n: Vec2  # unit normal from body 2 to body 1; of a tangent row t = (-n_y, n_x), of a pin its axis
    R1: Vec2  # contact arms p - x [m]
    R2: Vec2
    d: float  # gap [m]
    d_dot: float  # J v [m/s]; of a tangent row the slip u
    gamma: float  # velocity-product term [m/s^2]
    b: float  # of the problem
    kappa1: float | None = None  # signed curvature [1/m], > 0 convex; None of a vertex
    kappa2: float | None = None
    D: float | None = None  # r1 s2 + s1 r2 + d s1 s2, > 0 at a local minimum of the distance
    u: float | None = None  # slip [m/s]
    omega_n: float | None = None  # n' = omega_n t [rad/s]


def _edge(of: dict) -> Edge:
    return Edge(**of)


class Scene:
    """One instant of a scene family or a scene file; `lcpbench.generate` makes it. Immutable.

    In a notebook it shows itself as a picture with the forces of `solve()`.
    """

    def __init__(self, core: _core.Scene):
        self._core = core

    def __repr__(self) -> str:
        moving = sum(not body.fixed for body in self.bodies)
        return f"<Scene {self.name!r}: {moving} movable bodies, {len(self.problem)} rows, {self.kind}>"

    @property
    def name(self) -> str:
        return self._core.name

    @property
    def kind(self) -> str:
        """What the problem stands for: "acceleration" (f forces [N], w gap accelerations [m/s^2]), or, where contacts
        have friction, "time_step" (f impulses [N s], w velocities at its end [m/s])."""
        return "time_step" if self._core.is_time_step else "acceleration"

    @property
    def step(self) -> float:
        """The time step [s]."""
        return self._core.step

    @cached_property
    def problem(self) -> _core.Problem:
        """The problem of this instant, by J and the inverse masses; `problem.A` is the Delassus matrix."""
        return self._core.problem

    @cached_property
    def bodies(self) -> tuple[Body, ...]:
        return tuple(Body(**{**of, "edges": tuple(map(_edge, of["edges"]))}) for of in self._core.bodies())

    @cached_property
    def rows(self) -> tuple[Row, ...]:
        """A Row for every row of J. `pandas.DataFrame(scene.rows)` is a table of them."""
        return tuple(Row(**{**of, "feature1": _edge(of["feature1"]), "feature2": _edge(of["feature2"])})
                     for of in self._core.rows())

    @property
    def contacts(self) -> tuple[Row, ...]:
        """The normal rows of contacts, in the order in which `replace` takes their friction."""
        return tuple(row for row in self.rows if row.kind == "contact")

    @property
    def J(self):
        """(n, 3 bodies): the contact Jacobian as a SciPy csr_array, columns by body, fixed ones included."""
        return self.problem.J

    @property
    def A(self) -> np.ndarray:
        """(n, n): A = J M^-1 J^T [1/kg]."""
        return self.problem.A

    @property
    def b(self) -> np.ndarray:
        """(n,)"""
        return self.problem.b

    @property
    def gamma(self) -> np.ndarray:
        """(n,): velocity-product terms [m/s^2]; part of b at the level of accelerations only."""
        return np.array([row.gamma for row in self.rows])

    @property
    def forces(self) -> np.ndarray:
        """(bodies, 3): applied force [N] and torque [N m] of every body; a copy, for `replace`."""
        return np.array([(*body.force, body.torque) for body in self.bodies]).reshape(-1, 3)

    @property
    def velocities(self) -> np.ndarray:
        """(bodies, 3): velocity [m/s] and spin [rad/s] of every body; a copy, for `replace`."""
        return np.array([(*body.v, body.omega) for body in self.bodies]).reshape(-1, 3)

    def replace(self, *, forces=None, velocities=None, friction=None) -> Scene:
        """The same bodies and contacts under other applied forces, velocities and coefficients of friction.

        forces      (bodies, 3), in place of all applied forces, weight included
        velocities  (bodies, 3)
        friction    a number for all contacts, or one for each of `contacts`
        Its motion starts from this instant, with these forces held constant.
        Raises ValueError naming the argument.
        """
        if friction is not None and np.ndim(friction) == 0:
            friction = np.full(len(self.contacts), float(friction))
        return Scene(self._core.replace(forces, velocities, friction))

    def solve(self, solver: str = "auto", **options) -> _core.Result:
        """lcpbench.solve of the problem."""
        return _core.solve(self.problem, solver=solver, **options)

    def svg(self, result=None, caption: str | None = None) -> str:
        """The picture as an SVG document: bodies, contacts, forces; with friction the cones, sticking and sliding
        contacts in different colours. Of time steps, impulses are shown as forces over the step.

        result  of `solve`, or of any solver; None: that of solve(); False: without forces
        """
        if result is False:
            return self._core.svg(caption=caption or "")
        result = self.solve() if result is None else result
        return self._core.svg(result.f, result.w, result.status if caption is None else caption)

    def _repr_svg_(self) -> str:
        return self.svg()

    def animation(self, duration: float = 5, fps: float = 60, *, solver: str = "auto", tolerance: float = 1e-9,
                  budget: float = 60) -> Animation:
        """The motion that starts here, as a page with play, pause, speed, forces and an energy plot.

        A family moves under gravity and its drives, as `lcpbench scene --animate` has it; a scene of `replace` from its
        instant under its forces.
        duration  [s]
        fps       frames per second of the motion's time
        solver    drives it, at `tolerance`
        budget    wall-clock seconds; a longer motion is stopped
        """
        return Animation(self.name, *self._core.animation(solver, duration, fps, tolerance, budget))

    def to_file(self, path: str | os.PathLike) -> None:
        """Writes what moves as a scene file (docs/scene_files.md); `generate(path)` reads it back."""
        Path(path).write_text(self._core.file_text(), encoding="utf-8")


@dataclass(frozen=True)
class Animation:
    """A recorded motion; in a notebook it shows itself.

    html     one page that needs nothing else, neither network nor server
    stopped  why the motion ended before its time; "" where it did not
    """

    name: str
    html: str
    stopped: str

    def __repr__(self) -> str:
        return f"<Animation {self.name!r}, {len(self.html)} bytes{', stopped: ' if self.stopped else ''}{self.stopped}>"

    def _repr_html_(self) -> str:
        return (f'<iframe srcdoc="{html.escape(self.html)}" title="{html.escape(self.name)}" '
                'style="width: 100%; height: 860px; border: 0"></iframe>')

    def to_file(self, path: str | os.PathLike) -> None:
        """Writes the page."""
        Path(path).write_text(self.html, encoding="utf-8")


def generate(scene: str | os.PathLike | Mapping, size: int = 24, seed: int = 1, friction: float | None = None, *,
             level: str = "", step: float | None = None) -> Scene:
    """One instant of a scene.

    scene     a family (`scene_families()`), the path of a scene file (with a "/", or ending in .json), or a mapping
              that holds what a scene file does (docs/scene_files.md)
    size      of a family: number of rows
    seed      of a family: the same seed gives the same bits
    friction  coefficient of every contact; None: the scene's own. With friction the problem is a time step
    level     of the motion, "acceleration" or "velocity"; "": the scene's own
    step      [s]; None: the scene's own
    Raises ValueError naming the argument, or place and member of the file.
    """
    if isinstance(scene, Mapping):
        return Scene(_core.read_scene(json.dumps(scene), friction, level, step))
    return Scene(_core.load_scene(os.fspath(scene), size, seed, friction, level, step))


def scene_families() -> list[dict[str, Any]]:
    """The families: scene (their key), title, friction (whether their contacts have any), purpose."""
    return _core.scene_families()
