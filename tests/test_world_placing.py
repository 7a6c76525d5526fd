"""Signs of joints, and joints that are placed with what hangs on them."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import kickdrift as kd
from kickdrift.core.errors import ArgumentError
from kickdrift.world.joint_gaps import widest_gap

STEP = 1 / 240
NAN, INF = float("nan"), float("inf")
WEIGHTLESS = (0.0, 0.0, 0.0)
Y, Z = (0, 1, 0), (0, 0, 1)


# Signs

ORDERS = {
    "ground first": lambda w, body: (None, body),
    "ground last": lambda w, body: (body, None),
    "static first": lambda w, body: (w.add_sphere(0.1, position=(0, 9, 0), static=True), body),
    "kinematic last": lambda w, body: (body, w.add_sphere(0.1, position=(0, 9, 0), kinematic=True)),
}


@pytest.fixture(params=ORDERS)
def order(request):
    return ORDERS[request.param]


def wheel(order, **laws):
    """A wheel of 0.5 kg m^2 on a hinge about z."""
    world = kd.World(WEIGHTLESS)
    body = world.add_box((1.0, 1.0, 0.1), mass=3.0)
    return world, body, world.add_hinge(*order(world, body), anchor=(0, 0, 0), axis=Z, **laws)


def test_a_hinge_turns_to_the_same_side_whichever_body_was_named_first(order):
    world, body, hinge = wheel(order)
    assert str(hinge.angle) == "0.0"
    body.angular_velocity = 0, 0, 2.0
    assert hinge.speed == 2.0
    world.advance(STEP, 24)
    assert hinge.angle == pytest.approx(0.2, rel=1e-12)
    assert hinge.angles == pytest.approx([0, 0, 0.2], abs=1e-12)
    hinge.apply_effort(3.0)
    world.step(STEP)
    assert hinge.speed == pytest.approx(2.0 + 3.0 / 0.5 * STEP, rel=1e-12)


def test_motors_drives_and_limits_have_the_same_side(order):
    world, _, hinge = wheel(order, motor=kd.Motor(speed=2.0, maximum=1.0), limits=(-0.1, 0.5))
    world.step(STEP)
    assert hinge.effort == pytest.approx(1.0, rel=1e-9)
    assert hinge.torque == pytest.approx([0, 0, 1.0], abs=1e-9)
    world.advance(STEP, 480)
    assert hinge.angle == pytest.approx(0.5, abs=1e-6)
    hinge.set_motor(kd.Motor(speed=-1.0, maximum=1.0))
    world.advance(STEP, 480)
    assert hinge.angle == pytest.approx(-0.1, abs=1e-6)
    hinge.set_motor(None)
    hinge.set_limits((-0.2, 0.7))
    hinge.set_drive(kd.Drive(stiffness=200.0, damping=20.0, target=0.3))
    world.advance(STEP, 960)
    assert hinge.angle == pytest.approx(0.3, abs=1e-6)


def test_sliders_and_forces_have_the_same_side(order):
    world = kd.World((0, 0, -10.0))
    cart = world.add_box((1, 1, 1), mass=2.0)
    slider = world.add_slider(*order(world, cart), anchor=(0, 0, 0), axis=(1, 0, 0))
    slider.apply_effort(4.0)
    world.step(STEP)
    assert slider.speed == pytest.approx(4.0 / 2.0 * STEP, rel=1e-12)
    assert cart.velocity[0] == pytest.approx(slider.speed, rel=1e-12)
    assert slider.position == pytest.approx(cart.position[0], rel=1e-12)
    assert slider.positions[2] == slider.position
    assert slider.force == pytest.approx([0, 0, 20.0], abs=1e-9)  # it carries the cart


@pytest.mark.parametrize("swap", [False, True])
def test_joints_of_several_axes_have_the_same_side(swap):
    def pair(body):
        return (body, None) if swap else (None, body)

    def turned(rotvec, add):
        world = kd.World(WEIGHTLESS)
        body = world.add_box((0.2, 0.3, 0.4), mass=1.0)
        joint = add(world, *pair(body))
        body.orientation = np.roll(Rotation.from_rotvec(rotvec).as_quat(), 1)
        world.step(1e-9)
        return joint.angles

    cross = turned(
        (0.3, 0, 0), lambda w, a, b: w.add_universal_joint(a, b, anchor=(0, 0, 0), axis_a=(1, 0, 0), axis_b=Y)
    )
    assert cross == pytest.approx([0.3, 0, 0], abs=1e-7)
    free = turned(
        (0.1, -0.2, 0.3),
        lambda w, a, b: w.add_six_dof_joint(a, b, anchor=(0, 0, 0), angular=(kd.Axis(friction=1e-9),) * 3),
    )
    assert free == pytest.approx([0.1, -0.2, 0.3], abs=1e-7)
    twist = turned((0, 0, 0.3), lambda w, a, b: w.add_ball_joint(a, b, anchor=(0, 0, 0), twist_limits=(-0.1, 0.5)))
    assert twist == pytest.approx([0, 0, 0.3], abs=1e-7)
    swing = turned((0.2, 0, 0), lambda w, a, b: w.add_ball_joint(a, b, anchor=(0, 0, 0), swing_limit=0.5))
    assert swing == pytest.approx([0.2, 0, 0], abs=1e-7)
    hinge = turned((0, 0, 0.4), lambda w, a, b: w.add_six_dof_joint(
        a, b, anchor=(0, 0, 0), angular=(kd.Axis(locked=True), kd.Axis(locked=True), kd.Axis(limits=(-0.1, 0.5)))
    ))  # fmt: skip
    assert hinge == pytest.approx([0, 0, 0.4], abs=1e-7)


@pytest.mark.parametrize("swap", [False, True])
def test_ropes_are_as_long_from_both_ends(swap):
    world = kd.World(WEIGHTLESS)
    ball = world.add_sphere(0.1, position=(1, 0, 0), velocity=(-1, 0, 0))
    ends = {"anchor_a": (1, 0, 0), "anchor_b": (0, 0, 0)} if swap else {"anchor_a": (0, 0, 0), "anchor_b": (1, 0, 0)}
    rope = world.add_rope_joint(*((ball, None) if swap else (None, ball)), **ends, length=1.5)
    world.step(0.1)
    assert rope.position == pytest.approx(0.9 - 1.5, abs=1e-9)
    assert rope.speed == pytest.approx(-1.0, abs=1e-9)


def test_between_two_bodies_that_move_b_is_measured_against_a():
    world = kd.World(WEIGHTLESS)
    a, b = world.add_sphere(0.1), world.add_sphere(0.1, position=(1, 0, 0))
    there, back = (world.add_hinge(*pair, anchor=(0.5, 0, 0), axis=Z) for pair in ((a, b), (b, a)))
    b.angular_velocity = 0, 0, 1.0
    assert there.speed == -back.speed == 1.0


# Placing


def tree(seed, swap=False, floating=False):
    """A hand of seven links on hinges and a slider, in any pose, all moving."""
    rng = np.random.default_rng(seed)
    world = kd.World()
    size, place = (rng.uniform(0.1, 0.3, (7, 3)), rng.normal(size=(7, 3)))
    bodies = [world.add_box(size[k], position=place[k], collides_with=()) for k in range(7)]
    joints = []
    for k, body in enumerate(bodies):
        parent = None if k == 0 else bodies[(k - 1) // 2]
        if floating and parent is None:
            continue
        add = world.add_slider if k == 2 else world.add_hinge
        pair = (body, parent) if swap else (parent, body)
        joints.append(add(*pair, anchor=rng.normal(size=3), axis=rng.normal(size=3)))
    world.velocity[1:] = rng.normal(size=(7, 3))
    world.angular_velocity[1:] = rng.normal(size=(7, 3))
    world.advance(STEP, 20)  # after which they fit
    return world, bodies, joints


def readings(joints):
    return np.array([joint.position if k == _SLIDER else joint.angle for k, joint in enumerate(joints)])


_SLIDER = 2


@pytest.mark.parametrize("swap", [False, True])
@pytest.mark.parametrize("which", range(7))
def test_a_joint_is_placed_with_what_hangs_on_it_and_nothing_else_changes(which, swap):
    world, bodies, joints = tree(which, swap)
    before, rates, gap = readings(joints), np.array([joint.speed for joint in joints]), widest_gap(world.tables)
    poses = world.position.copy(), world.orientation.copy()
    if which == _SLIDER:
        joints[which].position = -0.8
    else:
        joints[which].angle = -0.8
    before[which] = -0.8
    assert readings(joints) == pytest.approx(before, abs=1e-12)
    assert np.array([joint.speed for joint in joints]) == pytest.approx(rates, abs=1e-11)
    assert widest_gap(world.tables) == pytest.approx(gap, abs=1e-12)
    velocities = world.velocity.copy()
    hanging = {which} | {k for k in range(7) if (k - 1) // 2 == which} | {k for k in range(7) if which == 0}
    for k, body in enumerate(bodies):
        still = np.array_equal(poses[0][body.index], body.position) and np.array_equal(
            poses[1][body.index], body.orientation
        )
        assert still == (k not in hanging)
    world.step(1e-6)
    assert np.abs(world.velocity - velocities).max() < 1e-4  # joints find nothing to put right
    assert readings(joints) == pytest.approx(before, abs=1e-4)
    assert widest_gap(world.tables) < gap + 1e-6


def test_the_side_that_is_measured_moves_where_nothing_is_held():
    _, bodies, joints = tree(3, floating=True)
    spin, rates = bodies[0].angular_velocity.copy(), [joint.speed for joint in joints]
    root = bodies[0].position.copy()
    joints[0].angle = 2.0
    assert joints[0].angle == pytest.approx(2.0, abs=1e-12)
    assert [joint.speed for joint in joints] == pytest.approx(rates, abs=1e-11)
    assert np.array_equal(root, bodies[0].position)
    assert np.array_equal(spin, bodies[0].angular_velocity)


def test_a_pendulum_that_is_placed_swings_like_one_that_was_made_there():
    def pendulum(angle):
        world = kd.World()
        place = (0.5 * math.sin(angle), 0, 0.5 * math.cos(angle))
        rod = world.add_box(
            (0.1, 0.2, 1.0), position=place, orientation=(math.cos(angle / 2), 0, math.sin(angle / 2), 0), mass=1.0
        )
        return world, world.add_hinge(rod, None, anchor=(0, 0, 0), axis=Y)

    (made, first), (placed, second) = pendulum(0.7), pendulum(0.0)
    second.angle = 0.7
    for world in (made, placed):
        world.advance(STEP, 240)
    assert second.angle == pytest.approx(first.angle + 0.7, abs=1e-9)
    assert placed.energy().total == pytest.approx(made.energy().total, abs=1e-9)
    assert np.allclose(placed.position, made.position, 0, 1e-9)


def test_turns_are_counted_from_where_a_joint_is_placed():
    world, _, hinge = wheel(ORDERS["ground last"])
    hinge.angle = 20.0
    assert hinge.angle == pytest.approx(20.0, abs=1e-12)
    hinge.speed = 3.0
    world.advance(STEP, 240)
    assert hinge.angle == pytest.approx(23.0, rel=1e-9)


def test_a_speed_is_given_to_what_hangs_on_a_joint():
    world, bodies, joints = tree(5)
    rates = [joint.speed for joint in joints]
    for k, joint in enumerate(joints):
        joint.speed = rates[k] = float(k)
        assert [one.speed for one in joints] == pytest.approx(rates, abs=1e-11)
    for joint in joints:
        joint.speed = 0.0
    assert np.abs(world.velocity[1:]).max() < 1e-5  # what the joints were off by when they were made goes on
    assert len(bodies) == 7


def test_the_second_axis_of_a_cross_and_axes_of_six_are_placed_by_their_number():
    world = kd.World(WEIGHTLESS)
    shaft = world.add_box((0.1, 0.1, 1.0), position=(0, 0, 0.5))
    cross = world.add_universal_joint(None, shaft, anchor=(0, 0, 0), axis_a=(1, 0, 0), axis_b=Y)
    cross.place(0.4, axis=3)
    cross.place(-0.6, axis=4)
    assert cross.angles == pytest.approx([0.4, -0.6, 0], abs=1e-12)
    expected = (Rotation.from_rotvec((0.4, 0, 0)) * Rotation.from_rotvec((0, -0.6, 0))).apply((0, 0, 0.5))
    assert shaft.position == pytest.approx(expected, abs=1e-12)
    cross.place(0.1, axis=3)
    assert cross.angles == pytest.approx([0.1, -0.6, 0], abs=1e-12)
    cart = world.add_box((1, 1, 1))
    locked, free = kd.Axis(locked=True), kd.Axis()
    planar = world.add_six_dof_joint(cart, None, (0, 0, 0), linear=(free, free, locked), angular=(locked, locked, free))
    planar.place(0.5, axis=5)
    planar.place(2.0, axis=0)  # along an axis of the cart, which was named first
    assert planar.positions == pytest.approx([2, 0, 0], abs=1e-12)
    assert planar.angles == pytest.approx([0, 0, 0.5], abs=1e-12)
    assert cart.position == pytest.approx([2 * math.cos(0.5), 2 * math.sin(0.5), 0], abs=1e-12)


def test_ropes_are_placed_and_springs_do_not_hold():
    world = kd.World(WEIGHTLESS)
    arm = world.add_box((1, 0.1, 0.1), position=(0.5, 0, 0))
    load = world.add_sphere(0.1, position=(1, 0, -1))
    hinge = world.add_hinge(arm, None, anchor=(0, 0, 0), axis=Z, limits=(-1, 1))
    rope = world.add_rope_joint(arm, load, anchor_a=(1, 0, 0), anchor_b=(1, 0, -1), length=1.5)
    spring = world.add_spring(load, None, anchor_a=(1, 0, -1), anchor_b=(1, 0, -2), stiffness=10.0)
    hinge.angle = 0.5
    assert load.position == pytest.approx([math.cos(0.5), math.sin(0.5), -1], abs=1e-12)
    assert spring.position == pytest.approx(math.hypot(1, 2 * math.sin(0.25)) - 1, abs=1e-12)
    rope.position = -0.2
    assert load.position[2] == pytest.approx(-1.3, abs=1e-12)
    with pytest.raises(ArgumentError, match="negative distance"):
        rope.position = -1.6


def test_placing_wakes():
    world = kd.World(WEIGHTLESS, sleeping=True)
    rod = world.add_box((1, 0.1, 0.1), position=(0.5, 0, 0))
    hinge = world.add_hinge(rod, None, anchor=(0, 0, 0), axis=Z)
    world.advance(STEP, 240)
    hinge.angle, hinge.speed = 0.3, 0.5
    world.advance(STEP, 24)
    assert hinge.angle == pytest.approx(0.35, abs=1e-7)


def test_what_is_part_of_a_loop_or_held_on_both_sides_cannot_be_placed():
    world = kd.World(WEIGHTLESS)
    a, b, c = (world.add_sphere(0.1, position=(k, 0, 0)) for k in range(3))
    joints = [
        world.add_hinge(*pair, anchor=(k, 0, 0), axis=Z, name=f"hinge {k}")
        for k, pair in enumerate(((a, b), (b, c), (c, a)))
    ]
    free = world.add_ball_joint(None, a, anchor=(0, 0, 0))
    before = world.position.copy()
    for k, joint in enumerate(joints):
        with pytest.raises(ArgumentError, match=f"'hinge {k}'.*part of a loop"):
            joint.angle = 0.1
        with pytest.raises(ArgumentError, match="part of a loop"):
            joint.speed = 0.1
    world.remove_joint(joints[2])
    held = world.add_hinge(c, None, anchor=(2, 0, 0), axis=Z)
    for joint in (joints[0], held):
        with pytest.raises(ArgumentError, match="neither side can move alone"):
            joint.angle = 0.1
    assert np.array_equal(world.position, before)
    world.remove_joint(free)
    held.angle = 0.1
    assert held.angle == pytest.approx(0.1)
    joints[0].angle = 0.2  # a moves, for b is held
    assert b.position == pytest.approx([2 - math.cos(0.1), -math.sin(0.1), 0])
    assert joints[0].angle == pytest.approx(0.2)


@pytest.mark.parametrize(
    ("make", "act", "word"),
    [
        ("hinge", lambda j: setattr(j, "angle", NAN), "angle=nan"),
        ("hinge", lambda j: setattr(j, "angle", INF), "angle=inf"),
        ("hinge", lambda j: setattr(j, "angle", "up"), "angle='up'"),
        ("hinge", lambda j: setattr(j, "angle", None), "angle=None"),
        ("hinge", lambda j: setattr(j, "angle", (1, 2)), "angle="),
        ("hinge", lambda j: setattr(j, "angle", 1.5), "angle=1.5 is beyond the joint's limits, -0.5 to 1"),
        ("hinge", lambda j: setattr(j, "angle", -0.7), "beyond"),
        ("hinge", lambda j: setattr(j, "speed", NAN), "speed=nan"),
        ("hinge", lambda j: setattr(j, "position", 0.1), "turns and has no position"),
        ("hinge", lambda j: j.place(0.1, axis=0), "axis=0 is locked"),
        ("hinge", lambda j: j.place(0.1, axis=7), "axis=7"),
        ("slider", lambda j: setattr(j, "angle", 0.1), "slides and has no angle"),
        ("slider", lambda j: j.place(0.1, axis=5), "axis=5 is locked"),
        ("ball", lambda j: setattr(j, "angle", 0.1), "axis=None is ambiguous"),
        ("ball", lambda j: j.place(0.1, axis=4), "three open angular axes"),
        ("fixed", lambda j: setattr(j, "angle", 0.1), "axis=None"),
        ("fixed", lambda j: j.place(0.1, axis=3), "locked"),
        ("rope", lambda j: j.place(0.1, axis=0), "along a line"),
        ("rope", lambda j: j.place(0.1, axis=4), "three open angular axes"),
        ("rope", lambda j: setattr(j, "position", 0.1), "beyond"),
        ("distance", lambda j: setattr(j, "position", 0.1), "locked"),
    ],
)
def test_places_that_cannot_be(make, act, word):
    world = kd.World(WEIGHTLESS)
    body = world.add_sphere(0.1, position=(1, 0, 0))
    at, rod = {"anchor": (0, 0, 0)}, {"anchor_a": (1, 0, 0), "anchor_b": (0, 0, 0)}
    joint = {
        "hinge": lambda: world.add_hinge(body, None, **at, axis=Z, limits=(-0.5, 1.0)),
        "slider": lambda: world.add_slider(body, None, **at, axis=Z),
        "ball": lambda: world.add_ball_joint(body, None, **at),
        "fixed": lambda: world.add_fixed_joint(body, None, **at),
        "rope": lambda: world.add_rope_joint(body, None, **rod),
        "distance": lambda: world.add_distance_joint(body, None, **rod),
    }[make]()
    with pytest.raises(ArgumentError, match=word):
        act(joint)
    assert world.position[body.index].tolist() == [1, 0, 0]
    world.remove_joint(joint)
    for name in ("angle", "position", "speed"):
        with pytest.raises(ArgumentError, match="was removed"):
            setattr(joint, name, 0.1)
