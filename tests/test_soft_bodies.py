"""Soft bodies: against bars that are pulled, hang and vibrate; conservation laws; impacts, inversion and rest; bad input."""

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.core.errors import ArgumentError, UnknownNameError
from kickdrift.world.deformables.tetrahedra import box_mesh, tetrahedral_mesh
from kickdrift.world.tables import CLOTH

STEP = 1 / 60


def jelly(world, height=0.4, **options):
    given = {"density": 1000.0, "young_modulus": 2e4, "poisson_ratio": 0.4, "damping": 5e-3, **options}
    return world.add_soft_box((0.3, 0.3, 0.3), (4, 4, 4), position=(0, 0, height), **given)


def inverted(body):
    corners = body.position[body.tetrahedra]
    return int((np.linalg.det(corners[:, 1:] - corners[:, :1]) < 0.0).sum())


@pytest.mark.parametrize(("cells", "modulus", "poisson_ratio"), [(5, 1e6, 0.0), (10, 1e6, 0.0), (10, 5e5, 0.3)])
def test_a_hanging_bar_stretches_by_its_own_weight(cells, modulus, poisson_ratio):
    world = kd.World(substeps=8)
    bar = world.add_soft_box(
        (0.1, 0.1, 1.0),
        (1, 1, cells),
        young_modulus=modulus,
        poisson_ratio=poisson_ratio,
        damping=2e-2,
        linear_damping=8.0,
    )
    z = bar.position[:, 2].copy()
    bar.pin(np.flatnonzero(z > 0.5 - 1e-9))
    world.advance(STEP, 200)
    extension = -0.5 - bar.position[z < 1e-9 - 0.5, 2].mean()
    assert extension == pytest.approx(1000.0 * 9.81 / (2 * modulus), rel=0.02)


@pytest.mark.parametrize("poisson_ratio", [-0.3, 0.0, 0.3, 0.45])
def test_a_bar_that_is_pulled_gets_thinner_by_the_poisson_ratio(poisson_ratio):
    world, modulus = kd.World(gravity=(0, 0, 0), substeps=8), 1e5
    bar = world.add_soft_box(
        (1.0, 0.2, 0.2),
        (10, 2, 2),
        young_modulus=modulus,
        poisson_ratio=poisson_ratio,
        damping=1e-2,
        linear_damping=6.0,
    )
    x, y = bar.position[:, 0].copy(), bar.position[:, 1].copy()
    ends = [np.flatnonzero(sign * x > 0.5 - 1e-9) for sign in (1, -1)]
    bar.pin(np.concatenate(ends))
    for end, sign in zip(ends, (1, -1), strict=True):
        bar.position[end, 0] += sign * 5e-4
    world.advance(STEP, 120)
    inner = np.flatnonzero(np.abs(x) < 0.21)
    strain = np.polyfit(x[inner], bar.position[inner, 0], 1)[0] - 1.0
    across = np.polyfit(y[inner], bar.position[inner, 1], 1)[0] - 1.0
    assert across == pytest.approx(-poisson_ratio * strain, abs=0.02 * strain)
    slices = [np.flatnonzero(np.abs(x - at) < 1e-9) for at in (0.0, 0.1)]
    corners = bar.position[bar.tetrahedra]
    assert len(slices[0]) == 9
    f = (corners[:, 1:] - corners[:, :1]).transpose(0, 2, 1) @ at_rest(bar)
    inside = np.abs(x[bar.tetrahedra].mean(axis=1)) < 0.2
    assert f[inside, 0, 0].mean() == pytest.approx(1.0 + strain, rel=1e-5)
    assert stress(f[inside].mean(axis=0), modulus, poisson_ratio) == pytest.approx(modulus * strain, rel=0.03)


def at_rest(bar):
    mesh = tetrahedral_mesh(*box_mesh(np.array([1.0, 0.2, 0.2]), (10, 2, 2)))
    assert np.array_equal(mesh.tetrahedra, bar.tetrahedra)
    return mesh.to_rest


def stress(f, modulus, ratio):
    """Hooke's law along x."""
    mu = modulus / 2 / (1 + ratio)
    return 2 * mu * ratio / (1 - 2 * ratio) * (np.trace(f) - 3.0) + 2 * mu * (f[0, 0] - 1.0)


@pytest.mark.parametrize(("cells", "poisson_ratio"), [(10, 0.0), (20, 0.3)])
def test_a_free_bar_vibrates_along_its_length(cells, poisson_ratio):
    world, speed = kd.World(gravity=(0, 0, 0), substeps=8), np.sqrt(1e5 / 1000.0)
    bar = world.add_soft_box((1.0, 0.1, 0.1), (cells, 1, 1), young_modulus=1e5, poisson_ratio=poisson_ratio)
    x = bar.position[:, 0].copy()
    bar.velocity[:, 0] = 1e-3 * np.cos(np.pi * (x + 0.5))
    shifts = []
    for _ in range(700):
        world.advance(1 / 1000, 1)
        shifts.append(bar.position[x > 0.5 - 1e-9, 0].mean() - 0.5)
    s = np.array(shifts)
    k = np.flatnonzero((s[1:] > 0) & (s[:-1] <= 0))
    crossings = (k + s[k] / (s[k] - s[k + 1])) / 1000
    assert np.diff(crossings).mean() == pytest.approx(2.0 / speed, rel=0.006)


@pytest.mark.parametrize("spread", [0.01, 0.1])  # with the latter tetrahedra are inverted
@pytest.mark.parametrize("kind", ["rope", "soft body"])
def test_forces_are_the_gradient_of_the_energy(kind, spread):
    world, rng = kd.World(gravity=(0, 0, 0), substeps=1), np.random.default_rng(0)
    if kind == "rope":
        body = world.add_rope(0.1 * rng.normal(size=(8, 3)).cumsum(axis=0), bending_stiffness=0.1)
    else:
        body = world.add_soft_box((0.2, 0.3, 0.2), (2, 2, 2), young_modulus=1e4, poisson_ratio=0.3)
    body.position[:] += rng.normal(scale=spread, size=body.position.shape)
    assert kind == "rope" or (inverted(body) > 0) == (spread > 0.05)
    start, way, shift = body.position.copy(), rng.normal(size=body.position.shape), 1e-6
    energies = []
    for sign in (1, -1):
        body.position[:] = start + sign * shift * way
        energies.append(world.energy().potential)
    body.position[:] = start
    force = body.mass[:, None] * velocities_after(world, body, 1e-9) / 1e-9
    assert (force * way).sum() == pytest.approx((energies[1] - energies[0]) / (2 * shift), rel=1e-5)
    assert force.sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-9 * np.abs(force).max())


def velocities_after(world, body, step):
    world.advance(step, 1)
    return body.velocity.copy()


def test_energy_is_zero_at_rest_and_positive_elsewhere():
    world, rng = kd.World(gravity=(0, 0, 0)), np.random.default_rng(0)
    body = jelly(world)
    assert world.energy().total == pytest.approx(0.0, abs=1e-10)
    start = body.position.copy()
    for _ in range(20):
        body.position[:] = start + rng.normal(scale=0.02, size=start.shape)
        assert world.energy().total > 0.0
    body.position[:] = start @ np.linalg.qr(rng.normal(size=(3, 3)))[0] + 5.0  # a rotation, or a reflection
    assert world.energy().total == pytest.approx(0.0, abs=1e-8) or inverted(body) == len(body.tetrahedra)


def test_a_free_jelly_keeps_momentum_and_angular_momentum():
    world, rng = kd.World(gravity=(0, 0, 0)), np.random.default_rng(0)
    body = jelly(world)
    body.velocity[:] = 0.3 * rng.normal(size=body.velocity.shape) + np.cross((1.0, 2.0, 3.0), body.position)
    momentum, spin, energy = world.momentum(), world.angular_momentum(), world.energy().total
    world.advance(STEP, 1000)
    assert world.momentum() == pytest.approx(momentum, abs=1e-12)
    assert world.angular_momentum() == pytest.approx(spin, abs=1e-12)
    assert 0.0 < world.energy().total < energy  # which damping takes


def test_without_damping_energy_stays():
    world, rng = kd.World(gravity=(0, 0, 0), substeps=16), np.random.default_rng(0)
    body = jelly(world, damping=0.0)
    body.velocity[:] = 0.3 * rng.normal(size=body.velocity.shape)
    energy, drifts = world.energy().total, []
    for _ in range(20):
        world.advance(STEP, 20)
        drifts.append(world.energy().total / energy - 1.0)
    assert drifts == pytest.approx(np.zeros(20), abs=0.01)


def test_volume_is_kept_as_the_poisson_ratio_approaches_one_half():
    changes = []
    for ratio in (0.0, 0.3, 0.49):
        world = kd.World(gravity=(0, 0, 0), substeps=16)
        body = jelly(world, poisson_ratio=ratio, linear_damping=8.0)
        x, volume = body.position[:, 0].copy(), body.volume
        ends = np.flatnonzero(np.abs(x) > 0.15 - 1e-9)
        body.pin(ends)
        body.position[ends, 0] *= 1.1
        world.advance(STEP, 60)
        changes.append(body.volume / volume - 1.0)
    assert changes[0] > changes[1] > changes[2] > 0.0
    assert changes[2] < 0.01


def test_a_jelly_falls_and_rests_and_sleeps_and_carries_a_box():
    world = kd.World(sleeping=True)
    world.add_plane()
    body = jelly(world, height=0.16, linear_damping=3.0)
    world.advance(STEP, 200)
    assert body.position[:, 2].min() == pytest.approx(0.0025, abs=1e-4)
    assert np.abs(body.velocity).max() == 0.0
    top = body.position[:, 2].max()
    box = world.add_box((0.2, 0.2, 0.1), position=(0, 0, top + 0.055), density=300.0)
    world.advance(STEP, 300)
    assert box.position[2] > 0.8 * top
    assert box.position[:2] == pytest.approx([0, 0], abs=0.02)
    assert np.abs(box.velocity).max() == 0.0
    below = body.position[(np.abs(body.position[:, :2]) < 0.1).all(axis=1), 2].max()
    assert box.position[2] - 0.05 == pytest.approx(below + 0.0025, abs=2e-3)
    assert body.position[:, 2].max() < top  # its weight compresses it
    body.velocity[:, 0] = 1.0
    world.advance(STEP, 2)
    assert np.abs(box.velocity).max() > 0.0


@pytest.mark.parametrize("speed", [6.0, 30.0, 100.0])
def test_a_violent_impact_inverts_a_jelly_which_recovers(speed):
    world = kd.World()
    world.add_plane()
    body = jelly(world, linear_damping=1.0)
    volume, most = body.volume, 0
    body.velocity[:, 2] = -speed
    for _ in range(150):
        world.advance(STEP, 1)
        most = max(most, inverted(body))
    assert np.isfinite(body.position).all()
    assert most > (50 if speed > 10.0 else 0)
    assert inverted(body) == 0
    assert body.volume == pytest.approx(volume, rel=0.1)


def test_a_jelly_whose_vertices_are_anywhere_recovers():
    world = kd.World(gravity=(0, 0, 0))
    body = jelly(world, damping=1e-2, linear_damping=1.0)
    volume = body.volume
    body.position[:] = np.random.default_rng(0).uniform(-0.15, 0.15, body.position.shape)
    assert inverted(body) > 100
    world.advance(STEP, 200)
    assert inverted(body) == 0
    assert body.volume == pytest.approx(volume, rel=0.01)


def test_soft_bodies_ropes_and_cloths_collide():
    world = kd.World()
    world.add_plane()
    low, high = jelly(world, 0.16, linear_damping=2.0), jelly(world, 0.5, linear_damping=2.0)
    sheet = world.add_cloth_grid((0.5, 0.5), (9, 9), position=(0, 0, 0.7), linear_damping=1.0)
    rope = world.add_rope(np.linspace((-0.3, 0, 0.75), (0.3, 0, 0.75), 16), radius=0.01, linear_damping=1.0)
    world.advance(STEP, 60)
    middle = [body.position[:, 2].mean() for body in (low, high)]
    assert middle[1] > middle[0] + 0.2
    assert sheet.position[40, 2] > high.position[:, 2].max() - 0.03
    assert rope.position[8, 2] > sheet.position[40, 2]


def test_a_soft_body_hangs_on_a_body():
    world = kd.World(gravity=(0, 0, -9.81))
    ball = world.add_sphere(0.1, position=(0, 0, 1), mass=1.0)
    body = jelly(world, 0.7)
    body.pin(np.flatnonzero(body.position[:, 2] > 0.85 - 1e-9), ball)
    momentum = world.momentum()
    world.advance(STEP, 30)
    fallen = (1.0 + body.mass.sum()) * 9.81 * 0.5
    assert world.momentum() - momentum == pytest.approx([0, 0, -fallen], abs=1e-9 * fallen)


def test_soft_bodies_are_restored_and_saved_and_recorded(tmp_path):
    world = kd.World()
    world.add_plane()
    body = world.add_soft_box((0.2, 0.2, 0.2), (2, 2, 2), position=(0, 0, 0.2), name="jelly", young_modulus=2e4)
    world.add_cloth_grid((0.3, 0.3), (4, 4), position=(0, 0, 0.5))
    recording = world.run(0.2, STEP)
    assert recording.about.system == "world of 1 body, 1 soft body and 1 cloth"
    before = world.snapshot()
    world.save(tmp_path / "world.npz")
    world.advance(STEP, 30)
    after = body.position.copy()
    world.restore(before)
    world.advance(STEP, 30)
    assert np.array_equal(body.position, after)
    loaded = kd.load_world(tmp_path / "world.npz")
    loaded.advance(STEP, 30)
    assert np.array_equal(loaded.soft_body("jelly").position, after)
    recording.save(tmp_path / "recording.npz")
    drawn = kd.load(tmp_path / "recording.npz").appearance.cloths[0]
    assert (drawn.kind, drawn.radius, drawn.name) == ("soft body", 0.0, "jelly")
    assert np.array_equal(drawn.triangles, body.triangles)


def test_the_surface_of_a_box_faces_outward():
    world = kd.World()
    body = world.add_soft_box((0.2, 0.3, 0.4), (2, 3, 4))
    assert body.volume == pytest.approx(0.2 * 0.3 * 0.4)
    assert body.mass.sum() == pytest.approx(24.0)
    assert len(body.triangles) == 4 * (2 * 3 + 2 * 4 + 3 * 4)
    assert body.tetrahedra.shape == (6 * 24, 4)


def test_a_body_too_stiff_for_the_step_is_softened_and_says_so():
    world = kd.World()
    body = world.add_soft_box((0.1, 0.1, 0.1), (4, 4, 4), young_modulus=1e11, name="steel")
    with pytest.warns(kd.UnsolvedWarning, match="Of soft body 'steel'"):
        recording = world.run(0.05, STEP)
    assert "Of soft body 'steel'" in recording.message
    assert "young_modulus" in recording.message
    assert body.young_modulus < 1e11


def test_handles_of_soft_bodies():
    world = kd.World()
    body, rope = world.add_soft_box(cells=(1, 1, 1), name="jelly"), world.add_rope([(5, 0, 0), (6, 0, 0)], name="line")
    assert world.soft_body("jelly") == body
    assert body.poisson_ratio == 0.4
    body.friction = 0.1
    assert body.friction == 0.1
    with pytest.raises(UnknownNameError, match="known: jelly"):
        world.soft_body("line")
    world.remove_cloth(body)
    assert rope.index == 0
    rope.pin([0])
    world.advance(STEP, 10)
    assert rope.tension.shape == (1,)
    with pytest.raises(ArgumentError, match="was removed"):
        body.position  # noqa: B018


CORNERS = [(0.0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)]


@pytest.mark.parametrize(
    ("vertices", "tetrahedra", "options", "words"),
    [
        (CORNERS[:4], [(0, 2, 1, 3)], {}, "tetrahedron 0 is inverted"),
        ([*CORNERS[:3], (1, 1, 0)], [(0, 1, 2, 3)], {}, "tetrahedron 0 has no volume"),
        (CORNERS, [(0, 1, 2, 3)], {}, "vertex 4 is in no tetrahedron"),
        (CORNERS[:4], [(0, 1, 2, 4)], {}, "indices go from 0 to 3"),
        (CORNERS[:4], [(0, 1, 2, -1)], {}, "indices go from 0 to 3"),
        (CORNERS[:4], [(0, 1, 2, 2)], {}, "has a vertex twice"),
        (CORNERS[:4], [(0, 1, 2)], {}, r"must be an \(M, 4\) array"),
        (CORNERS[:4], [], {}, r"must be an \(M, 4\) array"),
        (CORNERS[:4], [(0.0, 1, 2, 3)], {}, "whole numbers"),
        (CORNERS[:4], [(0, 1, 2, 3), (0, 1, 2)], {}, "whole numbers"),
        (CORNERS[:4], [(0, 1, 2, 3)] * 2, {}, "on one side of the triangle"),
        (CORNERS[:4], [(0, 1, 2, 3)] * 3, {}, "tetrahedra 0, 1 and 2 share one triangle"),
        (CORNERS, [(0, 1, 2, 3), (0, 1, 2, 4)], {}, "on one side of the triangle"),
        ([*CORNERS[:3], (0, 0, np.nan)], [(0, 1, 2, 3)], {}, "vertex 3 is at .* not finite"),
        ([*CORNERS[:3], (0, 0, 1e16)], [(0, 1, 2, 3)], {}, "vertex 3 is at .* farther"),
        ([(0, 0), (1, 0)], [(0, 1, 2, 3)], {}, "shape"),
        (
            [*CORNERS[:4], (0, -1, 0), (0, 0, -1)],
            [(0, 1, 2, 3), (0, 1, 4, 5)],
            {},
            "4 triangles at the edge of vertices 0 and",
        ),
        (None, None, {"poisson_ratio": 0.5}, "poisson_ratio=0.5 must be from"),
        (None, None, {"poisson_ratio": -1.0}, "poisson_ratio=-1.0 must be from"),
        (None, None, {"poisson_ratio": np.nan}, "poisson_ratio=nan"),
        (None, None, {"poisson_ratio": "soft"}, "poisson_ratio='soft'"),
        (None, None, {"young_modulus": 0.0}, "young_modulus"),
        (None, None, {"young_modulus": np.inf}, "young_modulus"),
        (None, None, {"density": -1.0}, "density"),
        (None, None, {"thickness": 0.0}, "thickness"),
        (None, None, {"damping": -1.0}, "damping"),
        (None, None, {"stretch_stiffness": 1.0}, "stretch_stiffness= is not an option of a soft body"),
        (None, None, {"self_collision": "no"}, "self_collision"),
    ],
)
def test_bad_soft_bodies_are_refused(vertices, tetrahedra, options, words):
    world = kd.World()
    given = (CORNERS[:4], [(0, 1, 2, 3)]) if vertices is None else (vertices, tetrahedra)
    with pytest.raises(ArgumentError, match=words):
        world.add_soft_body(*given, **options)
    assert len(world.tables.array(CLOTH)) == 0


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"size": (1, 1, 0)}, "size"), ({"size": (1, 1)}, "size"), ({"cells": (1, 1)}, "cells"),
        ({"cells": (1, 1, 0)}, "cells"),
        ({"cells": (1.5, 1, 1)}, "cells"),
        ({"cells": (300, 300, 300)}, "more than"), ({"orientation": (0, 0, 0, 0)}, "orientation"),
        ({"position": (np.nan, 0, 0)}, "position"),
    ],
)  # fmt: skip
def test_bad_soft_boxes_are_refused(options, words):
    with pytest.raises(ArgumentError, match=words):
        kd.World().add_soft_box(**options)
