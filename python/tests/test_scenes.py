"""Scenes: the paper's terms give the rows of the problem, and the problem the forces that pictures show."""

import json
import math
import xml.etree.ElementTree as ElementTree

import lcpbench
import numpy as np
import pytest

FAMILIES = [family["scene"] for family in lcpbench.scene_families()]


def cross(a, b):
    return a[0] * b[1] - a[1] * b[0]


def terms(row, scene):
    """J's entries, gamma and omega_n of a contact by docs/model.md section 4, from the row's own terms."""
    body1, body2 = scene.bodies[row.body1], scene.bodies[row.body2]
    r1, s1 = (0, 1) if row.kappa1 is None else (1, row.kappa1)
    r2, s2 = (0, 1) if row.kappa2 is None else (1, row.kappa2)
    w1, w2, u, d = body1.omega, body2.omega, row.u, row.d
    D = r1 * s2 + s1 * r2 + d * s1 * s2
    turning = r1 * s2 * w1 + s1 * r2 * w2
    curved = (s1 * s2 * u**2 + 2 * u * turning - r1 * r2 * (w1 - w2) ** 2 - d * (r1 * s2 * w1**2 + s1 * r2 * w2**2)) / D
    gamma = -(w1**2) * np.dot(row.n, row.R1) + w2**2 * np.dot(row.n, row.R2) + curved
    return D, gamma, (s1 * s2 * u + turning) / D


@pytest.mark.parametrize("family", FAMILIES)
def test_the_terms_of_a_row_give_j_gamma_and_b(family):
    for seed in (1, 2):
        scene = lcpbench.generate(family, 20, seed)
        J = scene.J.toarray()
        assert J.shape == (len(scene.rows), 3 * len(scene.bodies))
        v = scene.velocities.reshape(-1)
        inverse_mass = np.array(scene.problem.inverse_mass)
        free = inverse_mass * scene.forces.reshape(-1)
        for k, body in enumerate(scene.bodies):
            assert np.all(inverse_mass[3 * k:3 * k + 3] == ([0] * 3 if body.fixed else [1 / body.mass] * 2 + [1 / body.inertia]))
            if body.fixed:
                free[3 * k:3 * k + 3] = [*body.acceleration, body.alpha]
        for i, row in enumerate(scene.rows):
            expected = np.zeros(3 * len(scene.bodies))
            expected[3 * row.body1:3 * row.body1 + 3] = [*row.n, cross(row.R1, row.n)]
            expected[3 * row.body2:3 * row.body2 + 3] = [-row.n[0], -row.n[1], -cross(row.R2, row.n)]
            np.testing.assert_allclose(J[i], expected, atol=1e-12 * (1 + abs(expected).max()))
            assert row.d_dot == pytest.approx(J[i] @ v, abs=1e-9 * (1 + abs(v).max()))
            if row.kind in ("contact", "path joint"):
                D, gamma, omega_n = terms(row, scene)
                assert D == pytest.approx(row.D, rel=1e-9)
                assert gamma == pytest.approx(row.gamma, rel=1e-9, abs=1e-9)
                assert omega_n == pytest.approx(row.omega_n, rel=1e-9, abs=1e-9)
            if scene.kind == "acceleration":
                assert row.b == pytest.approx(J[i] @ free + row.gamma, rel=1e-9, abs=1e-9 * (1 + abs(free).max()))
        np.testing.assert_allclose(scene.A, J @ np.diag(inverse_mass) @ J.T, rtol=1e-9, atol=1e-9 * abs(scene.A).max())
        assert np.array_equal(scene.b, [row.b for row in scene.rows])


def test_the_same_seed_gives_the_same_bits_and_another_seed_others():
    one, again, other = (lcpbench.generate("disc-pile", 30, seed) for seed in (5, 5, 6))
    assert np.array_equal(one.b, again.b) and one.bodies == again.bodies
    assert not np.array_equal(one.b, other.b)


def test_friction_makes_a_time_step_with_a_tangent_row_a_contact():
    plain, rough = lcpbench.generate("disc-pile", 30), lcpbench.generate("disc-pile", 30, friction=0.4)
    assert (plain.kind, rough.kind) == ("acceleration", "time_step")
    assert plain.problem.friction is None
    assert len(rough.rows) == 2 * len(plain.rows) == 2 * len(rough.contacts)
    assert set(rough.problem.friction["mu"]) == {0.4}
    tangents = [row for row in rough.rows if row.kind == "tangent"]
    for tangent, contact in zip(tangents, rough.contacts):
        assert tangent.constraint == contact.constraint
        assert tangent.n == pytest.approx((-contact.n[1], contact.n[0]))
        assert tangent.d_dot == pytest.approx(contact.u, abs=1e-12)
    assert rough.solve().verdict.passes


def test_own_forces_velocities_and_friction_replace_those_of_the_scene():
    block = lcpbench.generate({"lcpbench_scene": 1, "gravity": [0, -10], "bodies": [
        {"name": "floor", "fixed": True, "shape": {"chains": [[[9, 0], [-9, 0]]]}},
        {"name": "block", "shape": {"box": {"width": 2, "height": 1}}, "mass": 3, "inertia": 1, "position": [0, 0.5]}]})
    assert block.solve().f == pytest.approx([15, 15])
    forces = block.forces
    forces[1] = [0, -40, 0]
    heavier = block.replace(forces=forces)
    assert heavier.solve().f == pytest.approx([20, 20])
    assert block.forces[1] == pytest.approx([0, -30, 0])  # unchanged
    # A push of 6 N: mu = 0.3 holds 12 N, mu = 0.1 only 4 N, and the block slides.
    forces[1] = [6, -40, 0]
    held, slides = (block.replace(forces=forces, friction=mu) for mu in (0.3, 0.1))
    tangents = [i for i, row in enumerate(held.rows) if row.kind == "tangent"]
    result = held.solve()
    assert result.w[tangents] == pytest.approx([0, 0], abs=1e-12)
    tangent = held.rows[tangents[0]]
    t = tangent.n[0] if tangent.body1 == 1 else -tangent.n[0]  # of the force on the block
    assert t * sum(result.f[tangents]) == pytest.approx(-6 * held.step)
    result = slides.solve()
    assert t * result.w[tangents] == pytest.approx([2 / 3 * slides.step] * 2)
    assert t * sum(result.f[tangents]) == pytest.approx(-4 * slides.step)
    assert "slides (2)" in slides.svg() and "slides" not in held.svg()
    moving = block.replace(velocities=[[0, 0, 0], [1, 0, 0]], friction=[0.5, 0.2])
    assert [row.friction for row in moving.contacts] == [0.5, 0.2]
    assert [row.u for row in moving.contacts] == pytest.approx([t, t])


@pytest.mark.parametrize("family", FAMILIES)
def test_pictures_show_the_forces_of_the_answer(family):
    scene = lcpbench.generate(family, 16)
    result = scene.solve()
    root = ElementTree.fromstring(scene.svg(result, caption="auto"))
    text = " ".join("".join(element.itertext()) for element in root.iter("{http://www.w3.org/2000/svg}text"))
    assert scene.name in text and f"{len(scene.rows)} rows, auto" in text
    contacts = [i for i, row in enumerate(scene.rows) if row.kind == "contact"]
    if contacts and any(result.f[contacts] > 1e-6 * result.f[contacts].max()):
        assert "active" in text or "slides" in text
    assert ("friction cone" in text) == (scene.kind == "time_step" and any(result.f[contacts] > 0))
    assert "active" not in scene.svg(False)
    assert scene._repr_svg_().startswith("<svg")


def test_a_scene_file_and_a_family_in_motion_are_the_same_scene(tmp_path):
    scene = lcpbench.generate("rockers", 12, 3)
    scene.to_file(tmp_path / "rockers.json")
    again = lcpbench.generate(tmp_path / "rockers.json")
    assert [body.name for body in again.bodies] == [body.name for body in scene.bodies]
    assert json.loads((tmp_path / "rockers.json").read_text())["lcpbench_scene"] == 1


def test_an_animation_is_a_page_of_its_own(tmp_path):
    scene = lcpbench.generate("card-house", 30)
    animation = scene.animation(duration=0.2, fps=20)
    assert animation.stopped == ""
    assert animation.html.startswith("<!DOCTYPE html") and "http://" not in animation.html.replace("http://www.w3.org", "")
    shown = animation._repr_html_()
    assert shown.startswith("<iframe srcdoc=") and shown.count('"') == 6  # the page within is escaped
    animation.to_file(tmp_path / "house.html")
    assert (tmp_path / "house.html").read_text() == animation.html
    shallow = scene.replace(velocities=np.zeros((len(scene.bodies), 3)))
    assert shallow.animation(duration=0.1, fps=20).html != animation.html


@pytest.mark.parametrize("arguments, what", [
    ({"scene": "no-such-scene"}, "no-such-scene"),
    ({"scene": "disc-pile", "size": 0}, "size"),
    ({"scene": "disc-pile", "friction": -1}, "friction"),
    ({"scene": "disc-pile", "friction": math.nan}, "friction"),
    ({"scene": "disc-pile", "step": 0}, "step"),
    ({"scene": "disc-pile", "level": "height"}, "height"),
    ({"scene": "./no-such-file.json"}, "no-such-file"),
    ({"scene": {"lcpbench_scene": 1, "bodies": [{"name": "a", "shape": {"disc": {"radius": -1}}}]}}, "/bodies/0/shape/disc/radius"),
])
def test_mistakes_are_named(arguments, what):
    with pytest.raises(ValueError, match=what):
        lcpbench.generate(**arguments)


def test_replacements_that_do_not_fit_are_named():
    scene = lcpbench.generate("disc-pile", 10)
    for arguments in ({"forces": [[0, 0, 0]]}, {"velocities": np.zeros((len(scene.bodies), 2))}, {"friction": [0.1]},
                      {"friction": -1.0}):
        with pytest.raises(ValueError, match=next(iter(arguments))):
            scene.replace(**arguments)
