"""What no world can be made of, and that a world stays as it was where it is asked for such things."""

import copy
import functools
import os
import subprocess
import sys

import numba
import numpy as np
import pytest

from kickdrift.core.errors import ArgumentError, KickdriftError, LostBodyError
from kickdrift.world.bodies.part import Part
from kickdrift.world.shapes.box import Box
from kickdrift.world.shapes.sphere import Sphere
from kickdrift.world.tables import MOTION, POSE
from kickdrift.world.world import World

NAN, INF = float("nan"), float("inf")
TETRAHEDRON = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
TRIANGLE = TETRAHEDRON[:3]


def refused(action, *words):
    """A sentence that names the argument."""
    with pytest.raises(ArgumentError) as caught:
        action()
    message = str(caught.value)
    assert message.endswith((".", ")"))
    for word in words:
        assert word in message


WORLDS = {
    "gravity": [(0, 0), "down", (0, 0, NAN), (INF, 0, 0), 9.81],
    "substeps": [0, -1, 2.5, "4", None],
    "margin": [-1.0, NAN, "wide", INF],
    "slop": [-1.0, NAN, INF],
    "contact_hertz": [-3.0, NAN],
    "contact_damping": [-1.0, NAN],
    "push_speed": [-1.0, NAN],
    "bounce_speed": [-1.0, NAN],
    "sleep_speed": [-1.0, NAN],
    "sleep_time": [-1.0, NAN],
    "plane_normal": [(0, 0, 0), (1, 0), (NAN, 0, 0)],
    "midpoint": ["no", 1, None],
    "sleeping": ["no", 0],
    "threads": [2, "all"],
}


@pytest.mark.parametrize(("argument", "value"), [(name, value) for name, values in WORLDS.items() for value in values])
def test_worlds_that_cannot_be(argument, value):
    refused(lambda: World(**{argument: value}), argument)


# Of a sphere of radius 1.
OPTIONS = {
    "position": [(0, 0, NAN), (0, 0), "here", (INF, 0, 0)],
    "orientation": [(0, 0, 0, 0), (0, 0, 1), (NAN, 0, 0, 1)],
    "velocity": [(INF, 0, 0), (1, 0), "fast"],
    "angular_velocity": [(0, NAN, 0), 3.0],
    "mass": [0, -1, NAN, INF, "heavy", 1e-310],
    "density": [0, -2, NAN, "thick"],
    "inertia": [(1, 1, -1), (0, 0, 0), (1, 1, 5), [[1, 0.5, 0], [0, 1, 0], [0, 0, 1]], (1, 1, NAN), (1, 1), "round"],
    "damping": [-1, NAN, "slow"],
    "angular_damping": [-1, INF],
    "static": ["no", 1],
    "sensor": ["no", 2, None],
    "friction": [-1, NAN, "rough"],
    "restitution": [-0.1, 1.1, NAN],
    "rolling_resistance": [-1, NAN],
    "surface_velocity": [(1, 0), (1, 0, NAN)],
    "layer": [62, -1, 1.5],
    "collides_with": [(99,), ("floor",)],
}


@pytest.mark.parametrize(("option", "value"), [(name, value) for name, values in OPTIONS.items() for value in values])
def test_bodies_that_cannot_be(option, value):
    world = World()
    refused(lambda: world.add_sphere(1.0, **{option: value}), "layer" if option == "collides_with" else option)
    assert len(world.position) == 1


SHAPES = {
    "sphere of no size": (lambda w: w.add_sphere(0.0), "radius"),
    "sphere of negative size": (lambda w: w.add_sphere(-1.0), "radius"),
    "sphere of no number": (lambda w: w.add_sphere("big"), "radius"),
    "sphere of nan": (lambda w: w.add_sphere(NAN), "radius"),
    "sphere without end": (lambda w: w.add_sphere(INF), "radius"),
    "capsule of no radius": (lambda w: w.add_capsule(0.0, 1.0), "radius"),
    "capsule of negative length": (lambda w: w.add_capsule(1.0, -1.0), "length"),
    "box of two edges": (lambda w: w.add_box((1, 1)), "size"),
    "box of a number": (lambda w: w.add_box(1.0), "size"),
    "flat box": (lambda w: w.add_box((1, 0, 1)), "size"),
    "box of nan": (lambda w: w.add_box((1, NAN, 1)), "size"),
    "hull of three points": (lambda w: w.add_hull(TRIANGLE), "points"),
    "flat hull": (lambda w: w.add_hull([*TRIANGLE, (1, 1, 0)]), "points"),
    "hull of a line": (lambda w: w.add_hull([(k, 0, 0) for k in range(5)]), "points"),
    "hull of one point": (lambda w: w.add_hull([(0, 0, 0)] * 8), "points"),
    "hull of nan": (lambda w: w.add_hull([*TRIANGLE, (0, 0, NAN)]), "points"),
    "hull of numbers": (lambda w: w.add_hull([1, 2, 3]), "points"),
    "hull of nothing": (lambda w: w.add_hull([]), "points"),
    "plane without a normal": (lambda w: w.add_plane((0, 0, 0)), "normal"),
    "mesh with a wrong row": (lambda w: w.add_mesh(TRIANGLE, [(0, 1, 3)]), "faces"),
    "mesh with a negative row": (lambda w: w.add_mesh(TRIANGLE, [(0, 1, -1)]), "faces"),
    "mesh of nothing": (lambda w: w.add_mesh(np.zeros((0, 3)), np.zeros((0, 3), int)), "vertices"),
    "mesh of a line": (lambda w: w.add_mesh([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1, 2)]), "face"),
    "mesh of nan": (lambda w: w.add_mesh([(0, 0, 0), (1, 0, 0), (0, NAN, 0)], [(0, 1, 2)]), "vertices"),
    "height field of a row": (lambda w: w.add_height_field([1, 2, 3], 1.0), "heights"),
    "height field of a point": (lambda w: w.add_height_field([[1.0]], 1.0), "heights"),
    "height field of nan": (lambda w: w.add_height_field([[1, 2], [3, NAN]], 1.0), "heights"),
    "height field without spacing": (lambda w: w.add_height_field([[1, 2], [3, 4]], 0.0), "spacing"),
    "body of no shapes": (lambda w: w.add_body([]), "shapes"),
    "mesh that moves": (lambda w: w.add_body(Part(Box((1, 1, 1))).shape, density=1.0, mass=1.0), "density"),
    "static and kinematic": (lambda w: w.add_sphere(1.0, static=True, kinematic=True), "static"),
    "static that moves": (lambda w: w.add_sphere(1.0, static=True, velocity=(1, 0, 0)), "velocity"),
    "part of no density": (lambda w: w.add_body([Part(Sphere(1.0), density=0.0)]), "density"),
}


@pytest.mark.parametrize("name", SHAPES)
def test_shapes_that_cannot_be(name):
    action, word = SHAPES[name]
    world = World()
    refused(lambda: action(world), word)
    assert len(world.position) == 1
    assert not world.shape_rows.shapes


@pytest.mark.parametrize("kind", ["orientation", "position"])
def test_parts_that_cannot_be(kind):
    refused(lambda: Part(Sphere(1.0), **{kind: (0, 0, 0, 0)}), kind)
    refused(lambda: Part(Sphere(1.0), **{kind: (NAN, 0, 0)}), kind)


@pytest.mark.parametrize("step", [0, -0.1, NAN, INF, None, [0.1], "short", 1j])
def test_steps_that_cannot_be(step):
    world = World()
    world.add_sphere(1.0)
    refused(lambda: world.step(step), "step")
    assert world.n_steps == 0
    assert world.time == 0.0


@pytest.mark.parametrize("count", [-1, 1.5, "many", None])
def test_counts_of_steps_that_cannot_be(count):
    world = World()
    refused(lambda: world.advance(0.1, count), "count")
    assert world.n_steps == 0


@pytest.mark.parametrize("arguments", [(0.0, 0.1), (-1.0, 0.1), (NAN, 0.1), (0.1, 1.0), (0.1, NAN), (0.1, 0.01, 0)])
def test_runs_that_cannot_be(arguments):
    refused(lambda: World().run(*arguments))


def test_handles_of_removed_bodies_and_of_other_worlds():
    world = World()
    old = world.add_sphere(1.0)
    world.remove(old)
    new = world.add_sphere(1.0)
    assert new.index == old.index
    for action in (
        lambda body: world.remove(body),
        lambda body: world.apply_force(body, (1, 0, 0)),
        lambda body: world.apply_torque(body, (1, 0, 0)),
        lambda body: world.add_hinge(new, body, anchor=(0, 0, 0), axis=(0, 0, 1)),
    ):
        for body in (old, World().add_sphere(1.0), 1):
            refused(lambda action=action, body=body: action(body), "body")
    refused(lambda: world.remove(world.ground), "ground")
    world.step(0.01)
    assert world.position[new.index, 2] < 0


def test_forces_that_cannot_be():
    world = World()
    ball = world.add_sphere(1.0)
    refused(lambda: world.apply_force(ball, (NAN, 0, 0)), "force")
    refused(lambda: world.apply_force(ball, (0, 0)), "force")
    refused(lambda: world.apply_force(ball, (1, 0, 0), (0, NAN, 0)), "point")
    refused(lambda: world.apply_torque(ball, (NAN, 0, 0)), "torque")
    for wrong in (None, 3, lambda: 0, lambda speed, force: 0, lambda velocity: 0):
        refused(lambda wrong=wrong: world.add_force(wrong), "force")
    world.step(0.01)
    assert world.velocity[1] == pytest.approx([0, 0, -0.0981], rel=1e-9)


def test_a_force_that_numba_cannot_compile():
    def odd(force):
        force[1, 0] += open("x").read()  # noqa: SIM115

    refused(lambda: World().add_force(odd), "force", "odd", "compiled")


@pytest.mark.parametrize("where", ["velocity", "position", "force"])
def test_a_world_that_lost_a_body_names_it_and_goes_on(where):
    world = World()
    world.add_plane()
    near, lost = world.add_sphere(0.1, position=(0, 0, 1)), world.add_sphere(0.1, position=(3, 0, 1), mass=1e-3)
    world.advance(1 / 60, 7)
    before = world.position.copy()
    if where == "force":
        world.apply_force(lost, (1.7e308, 0, 0))
    else:
        getattr(world, where)[lost.index] = (INF, 0, 0) if where == "velocity" else (NAN, 0, 0)
    with pytest.raises(LostBodyError, match=rf"body {lost.index} .* step 7"):
        world.advance(1 / 60, 10)
    assert world.n_steps == 7
    assert world.time == pytest.approx(7 / 60)
    assert (world.position[near.index] == before[near.index]).all()
    world.position[lost.index], world.velocity[lost.index] = before[lost.index], 0.0
    world.advance(1 / 60, 120)
    assert world.n_steps == 127
    assert world.position[[near.index, lost.index], 2] == pytest.approx([0.1, 0.1], abs=1e-3)


@pytest.mark.parametrize("size", [1e-120, 1e-16, 1e16, 1e120])
def test_sizes_whose_inertia_would_overflow(size):
    world = World()
    refused(lambda: world.add_sphere(size), "radius", "supported range")
    refused(lambda: world.add_box((1, size, 1)), "size[1]", "supported range")
    refused(lambda: world.add_capsule(0.1, size), "length", "supported range")
    refused(
        lambda: world.add_hull(size * np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)])),
        "points",
        "supported range",
    )
    assert len(world.position) == 1


def test_surfaces_that_reach_too_far():
    world, corners = World(), np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)])
    refused(lambda: world.add_mesh(1e200 * corners, [(0, 1, 2)]), "vertices[1]", "beyond")
    refused(lambda: world.add_height_field([[0, 0], [1e200, 0]], 1.0), "heights[1, 0]", "beyond")


@pytest.mark.parametrize("when", ["before", "after"])
def test_what_is_nowhere_hides_nothing_from_rays(when):
    world = World()
    world.add_plane()
    lost = world.add_sphere(0.1, position=(0, 0, 1))
    world.add_sphere(0.1, position=(1, 0, 1))
    if when == "after":
        world.step(1 / 60)
    world.position[lost.index] = NAN
    for ask in (lambda: world.ray_cast((1, 0, 5), (0, 0, -1)), lambda: world.overlap_sphere(0.2, (1, 0, 1))):
        with pytest.raises(KickdriftError, match=f"Body {lost.index} .* not finite"):
            ask()


def test_orientations_of_no_length_are_told_from_what_is_too_fast():
    world = World()
    box = world.add_box((1, 1, 1))
    world.orientation[box.index] = 0.0
    with pytest.raises(LostBodyError, match="orientation to zero"):
        world.step(1 / 60)


def test_an_orientation_that_is_not_finite_in_its_last_number_alone_is_found_where_nothing_moves():
    world = World()
    wall = world.add_box((1, 1, 1), static=True)
    world.orientation[wall.index, 3] = NAN
    with pytest.raises(LostBodyError, match="not finite"):
        world.step(1 / 60)


@pytest.mark.parametrize("where", ["position", "velocity"])
def test_what_is_not_finite_is_told_from_what_is_too_fast(where):
    world = World()
    ball = world.add_sphere(0.1)
    getattr(world, where)[ball.index] = NAN
    with pytest.raises(LostBodyError, match=r"set to .* not finite"):
        world.step(1 / 60)


def test_what_touched_and_held_before_a_body_was_lost_does_so_after():
    world = World()
    world.add_plane()
    resting = world.add_box((1, 1, 1), position=(0, 0, 0.5))
    hanging = world.add_sphere(0.1, position=(3, 0, 2))
    joint = world.add_ball_joint(world.ground, hanging, anchor=(3, 0, 2.5), breaking_force=1e4)
    lost = world.add_sphere(0.1, position=(6, 0, 2), mass=1e-3)
    world.advance(1 / 60, 30)
    touching = world.touching
    assert any(resting in pair for pair in touching)
    world.apply_force(hanging, (0, 0, -1e6))
    world.apply_force(lost, (1.7e308, 0, 0))
    with pytest.raises(LostBodyError, match=f"body {lost.index} .* too large"):
        world.step(1 / 60)
    assert world.touching == touching
    world.step(1 / 60)
    assert (world.events, world.broken, world.touching) == ([], [], touching)
    assert np.linalg.norm(joint.force) == pytest.approx(0.1**3 * 4 / 3 * np.pi * 1000 * 9.81, rel=1e-3)


def test_a_lost_body_can_be_removed():
    world = World()
    world.add_plane()
    world.add_sphere(0.1, position=(0, 0, 0.1))
    lost = world.add_sphere(0.1, position=(3, 0, 1), velocity=(1e300, 0, 0))
    with pytest.raises(LostBodyError, match=f"body {lost.index}"):
        world.advance(1e10, 1)
    world.remove(lost)
    world.advance(1 / 60, 10)
    assert np.isfinite(world.position[:3]).all()


def swing(planar):
    """Three rods that hang at each other, and another one beside them."""
    world = World(plane_normal=(0, 1, 0) if planar else None)
    world.add_plane()
    before = world.ground
    for k in range(3):
        rod = world.add_box((0.4, 0.1, 0.1), position=(0.25 + 0.5 * k, 0, 2))
        world.add_hinge(before, rod, anchor=(0.5 * k, 0, 2), axis=(0, 1, 0))
        before = rod
    world.add_box((0.4, 0.1, 0.1), position=(3, 0, 2), velocity=(0, 0, 5))
    world.advance(1 / 60, 20)
    return world


@pytest.mark.parametrize("planar", [False, True])
@pytest.mark.parametrize("where", ["velocity", "spin", "position", "force", "torque"])
def test_an_articulation_that_was_lost_goes_on_as_if_nothing_had_been(where, planar):
    world, undisturbed = swing(planar), swing(planar)
    rod, pose, motion = world.bodies.handle(3), world.tables.array(POSE).copy(), world.tables.array(MOTION).copy()
    match where:
        case "velocity":
            world.velocity[3] = (0, 0, INF)
        case "spin":
            world.angular_velocity[3] = (0, 1e200, 0)
        case "position":
            world.position[3] = (0, 0, NAN)
        case "force":
            world.apply_force(rod, (1e307, 0, 0))
        case "torque":
            world.apply_torque(rod, (0, 1e300, 0))
    with pytest.raises(LostBodyError, match=r"body 3 .* step 20"):
        world.advance(1 / 60, 5)
    world.tables.array(POSE)[:], world.tables.array(MOTION)[:] = pose, motion
    for each in (world, undisturbed):
        each.advance(1 / 60, 40)
    assert world.position == pytest.approx(undisturbed.position, abs=1e-9)


def test_a_force_that_raises_leaves_the_world_as_it_was_before_the_step():
    world = World()
    ball = world.add_sphere(0.1, position=(0, 0, 1))

    def force(t, force):
        if t > 0.1:
            raise ValueError("enough")

    world.add_force(force)
    with pytest.raises(KickdriftError, match=r"ValueError: enough in step 6"):
        world.advance(1 / 60, 20)
    assert world.n_steps == 6
    assert world.time == pytest.approx(0.1)
    assert world.position[ball.index, 2] == pytest.approx(1 - 4.905 * 0.1**2, abs=1e-12)


def test_a_force_that_writes_beside_its_array_is_stopped():
    world = World()
    world.add_sphere(0.1)

    def force(force):
        for k in range(len(force) + 5):
            force[k, 2] += 1.0

    world.add_force(force)
    with pytest.raises(KickdriftError, match="IndexError"):
        world.step(1 / 60)


def pair_of_boxes(static=False):
    world = World()
    return world, [world.add_box((1, 1, 1), position=(2 * k, 0, 0), static=static) for k in range(2)]


@pytest.mark.parametrize(
    ("what", "sentence"),
    [
        (lambda w, a, b: w.add_hinge(a, b, anchor=(0, 0, 0), axis=(0, 0, 1)).apply_effort(1.0, axis=4.0), "axis=4.0"),
        (lambda w, a, b: w.ray_cast((0, 0, 5), (0, 0, -1), limit="x"), "limit='x'"),
        (lambda w, a, b: w.ray_cast((0, 0, 5), (0, 0, -1), layers=3), "layers=3"),
        (lambda w, a, b: w.restore(3), "snapshot=3"),
        (lambda w, a, b: w.add_box((1, 1, 1), friction=None), "friction=None"),
        (lambda w, a, b: w.add_force(lambda position, foo: None), "from the enclosing scope"),
    ],
)
def test_wrong_kinds_of_arguments_are_refused_with_a_sentence(what, sentence):
    world, boxes = pair_of_boxes()
    with pytest.raises(ArgumentError, match=sentence):
        what(world, *boxes)


def test_a_joint_between_bodies_that_no_joint_moves_is_refused():
    world, boxes = pair_of_boxes(static=True)
    with pytest.raises(ArgumentError, match="both static or kinematic"):
        world.add_hinge(*boxes, anchor=(0, 0, 0), axis=(0, 0, 1))


def opens(force):
    with open("a") as file:
        force[0, 0] += len(file.name)


def sets(force):
    global _COUNT
    _COUNT = 1
    force[0, 0] += _COUNT


_COUNT = 0


def yields(force):
    yield force


class Pull:
    def __call__(self, force):
        force[0, 0] += 1.0

    def method(self, force):
        force[0, 0] += 1.0


@pytest.mark.parametrize(
    ("force", "words"),
    [
        (opens, r"force opens cannot be compiled: The 'with .*' construct is not supported"),
        (sets, r"force sets cannot be compiled: Use of unsupported opcode"),
        (yields, "is an async function or a generator"),
        (functools.partial(lambda force, k: None, k=1), "is a partial, a method or the like"),
        (Pull(), "is a partial, a method or the like"),
        (Pull().method, "is a partial, a method or the like"),
    ],
)
def test_forces_that_cannot_be_compiled(force, words):
    world = World()
    with pytest.raises(ArgumentError, match=words):
        world.add_force(force)
    assert world.forces == []


def test_forces_of_the_same_code_are_compiled_once_whatever_their_numbers():
    def made(size, along=(1.0, 0.0, 0.0)):
        along = np.array(along)

        def pull(force, times=1.0):
            for k in range(3):
                force[1, k] += size * times * along[k]

        return pull

    worlds = []
    for forces in ([made(1.0)], [made(2.0), made(3.0, (0.0, 0.0, 1.0))], [made(1.0, np.ones(4))]):
        worlds.append(World(gravity=(0, 0, 0)))
        worlds[-1].add_sphere(1.0, mass=1.0)
        for force in forces:
            worlds[-1].add_force(force)
    stages = [force.stage for world in worlds for force in world.forces]
    assert stages[0] is stages[1] is stages[2]
    assert stages[0] is not stages[3]  # whose array has another shape
    for world in worlds[:2]:
        world.advance(0.1, 10)
    assert worlds[0].velocity[1] == pytest.approx([1.0, 0.0, 0.0])
    assert worlds[1].velocity[1] == pytest.approx([2.0, 0.0, 3.0])
    again = copy.deepcopy(worlds[1])
    worlds[1].add_force(made(-5.0))
    for world in (worlds[1], again):
        world.advance(0.1, 10)
    assert worlds[1].velocity[1] == pytest.approx([-1.0, 0.0, 6.0])
    assert again.velocity[1] == pytest.approx([4.0, 0.0, 6.0])


def test_a_force_is_compiled_by_one_process_for_others(tmp_path):
    code = """
import kickdrift as kd, sys
from kickdrift.core.dispatcher import told_of_compiling
def made(size):
    def pull(force):
        force[1, 2] += size
    return pull
names = []
told_of_compiling.set(lambda: names.append(1))
world = kd.World()
world.add_force(made(float(sys.argv[1])))
print(len(names))
"""
    script = tmp_path / "script.py"
    script.write_text(code)
    counts = []
    for size in ("1.0", "2.0"):
        command = [sys.executable, str(script), size]
        environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
        done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
        counts.append(int(done.stdout))
    assert counts[0] > 0
    assert counts[1] == 0


@pytest.mark.parametrize("long", [0.3, 7.0])
def test_orientations_written_into_the_arrays_are_made_unit_ones(long):
    def world():
        made = World()
        made.add_box((4, 4, 1), position=(0, 0, 0), orientation=(1, 0.1, 0, 0), static=True)
        made.add_box((0.5, 0.5, 0.5), position=(0, 0, 1.0), name="box")
        made.add_box((0.5, 0.5, 0.5), position=(3, 0, 1.0), orientation=(1, 0.2, 0.1, 0))
        return made

    scaled, unit = world(), world()
    scaled.orientation[1:4] *= long
    for each in (scaled, unit):
        each.advance(1 / 60, 60)
    assert np.abs(scaled.position - unit.position).max() < 1e-9
    assert np.linalg.norm(scaled.orientation, axis=1) == pytest.approx(1.0, abs=1e-12)


def test_what_was_given_may_change_and_the_world_does_not():
    velocity, position = np.array([0.5, 0, 0]), np.zeros(3)
    world = World()
    part = Part(Box((1, 1, 1)), position=position, surface_velocity=velocity)
    world.add_body([part], position=(0, 0, 2))
    velocity[:] = position[:] = 7.0
    (placed,) = world.shape_rows.shapes.values()
    assert placed.surface.surface_velocity == (0.5, 0.0, 0.0)
    assert np.array_equal(placed.position, np.zeros(3))
    with pytest.raises(ValueError, match="read-only"):
        part.orientation[0] = 0.0
    with pytest.raises(ValueError, match="read-only"):
        placed.position[0] = 1.0


def test_a_compiled_force_has_the_globals_of_now_and_bounds():
    scope = {"njit": numba.njit, "strength": 1.0, "at": 0}
    exec("@njit\ndef pull(force):\n    for row in range(len(force)):\n        force[row + at, 0] += strength\n", scope)
    speeds = []
    for strength in (1.0, 5.0):
        scope["strength"] = strength
        world = World(gravity=(0, 0, 0))
        ball = world.add_sphere(1.0, mass=2.0)
        world.add_force(scope["pull"])
        world.step(0.1)
        speeds.append(ball.velocity[0])
    assert speeds == pytest.approx([0.05, 0.25])
    scope["at"] = 10**6
    world.add_force(scope["pull"])
    with pytest.raises(KickdriftError, match="IndexError"):
        world.step(0.1)


@pytest.mark.parametrize("name", ["add_hinge", "add_spring", "add_gear"])
def test_methods_that_add_joints_have_their_own_names_and_refuse_unknown_arguments(name):
    add = getattr(World, name)
    assert add.__name__ == name
    with pytest.raises(ArgumentError, match=f"ankor= is not an argument of {name}; it takes .*, breaking_force"):
        add(World(), None, None, ankor=1)
