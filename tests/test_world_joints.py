"""Joints against exact solutions: pendulums, tops, linkages, chains with heavy ends."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation
from scipy.special import ellipj, ellipk

from kickdrift.scenes import worlds
from kickdrift.world.joints.layout import ANCHOR_A, ANCHOR_B, BODY_A, BODY_B
from kickdrift.world.joints.limits_motors_options import Motor
from kickdrift.world.tables import JOINT, JOINT_NUMBERS
from kickdrift.world.world import World

G = 9.81
STEP = 1 / 60
ROD = (0.1, 0.1, 1.0)
ROD_INERTIA = (1.0 + 0.01) / 12  # of 1 kg, at right angles to its length


def hanging(angle):
    """Direction of a rod that hangs from its top at an angle from the vertical, and its orientation."""
    return np.array([math.sin(angle), 0.0, -math.cos(angle)]), (math.cos(angle / 2), 0.0, -math.sin(angle / 2), 0.0)


def orders(errors):
    return np.log2(np.abs(errors[:-1]) / np.abs(errors[1:]))


def anchors(world):
    """Where the joints of a world are in their first and in their second bodies, two (N, 3) arrays."""
    joints, numbers = world.tables.array(JOINT), world.tables.array(JOINT_NUMBERS)
    points = []
    for column, at in ((BODY_A, ANCHOR_A), (BODY_B, ANCHOR_B)):
        bodies = joints[:, column]
        turns = Rotation.from_quat(world.orientation[bodies], scalar_first=True)
        points.append(world.position[bodies] + turns.apply(numbers[:, at : at + 3]))
    return points


def gaps(world):
    a, b = anchors(world)
    return np.linalg.norm(b - a, axis=1)


def swing(angle, substeps, midpoint=True):
    """Error of a pendulum's angle after 2 s, let go at rest."""
    rate = math.sqrt(0.5 * G / (ROD_INERTIA + 0.25))
    world, (along, turn) = World(substeps=substeps, midpoint=midpoint), hanging(angle)
    rod = world.add_box(ROD, position=along / 2, orientation=turn, mass=1.0)
    hinge = world.add_hinge(world.ground, rod, anchor=(0, 0, 0), axis=(0, -1, 0))
    world.advance(STEP, 120)
    k = math.sin(angle / 2)
    return angle + hinge.angle - 2 * math.asin(k * ellipj(2.0 * rate + ellipk(k * k), k * k)[0])


@pytest.mark.parametrize("angle", [0.3, 1.5, 2.8])
def test_a_pendulum_swings_as_jacobi_says_to_second_order(angle):
    errors = np.array([swing(angle, substeps) for substeps in (2, 4, 8, 16)])
    assert np.abs(errors[-1]) < 1e-5
    assert orders(errors) == pytest.approx(2.0, abs=0.1)
    whole_kicks = np.array([swing(angle, substeps, midpoint=False) for substeps in (4, 8, 16)])
    assert orders(whole_kicks) == pytest.approx(1.0, abs=0.1)


def period(angle, substeps):
    world, (along, turn) = World(substeps=1), hanging(angle)
    rod = world.add_box(ROD, position=along / 2, orientation=turn, mass=1.0)
    hinge = world.add_hinge(world.ground, rod, anchor=(0, 0, 0), axis=(0, -1, 0))
    h = STEP / substeps
    angles = []
    for _ in range(round(9.0 / h)):
        world.step(h)
        angles.append(angle + hinge.angle)
    angles = np.array(angles)
    falls = np.flatnonzero((angles[:-1] > 0) & (angles[1:] <= 0))
    first, last = (
        brentq(lambda s, k=k: np.polyval(np.polyfit(range(-2, 4), angles[k - 2 : k + 4], 5), s), 0, 1) + k
        for k in falls[[0, -1]]
    )
    return (last - first) / (len(falls) - 1) * h


@pytest.mark.parametrize("angle", [0.5, 2.5])
def test_the_period_of_a_pendulum_is_that_of_the_elliptic_integral(angle):
    small = 2 * math.pi / math.sqrt(0.5 * G / (ROD_INERTIA + 0.25))
    exact = small * 2 / math.pi * ellipk(math.sin(angle / 2) ** 2)
    errors = np.array([period(angle, substeps) / exact - 1 for substeps in (2, 4, 8)])
    assert np.abs(errors[1:]).max() < 2e-4
    assert orders(errors) == pytest.approx(2.0, abs=0.1)
    assert abs(small / exact - 1) > 0.01  # what a linear pendulum would miss


# Moments of inertia about a body's own axes, and its centre of mass from the ball joint that holds it
TOPS = {
    "spherical pendulum": (np.array([1e-3, 1e-3, 1e-3]), np.array([0.3, 0.0, -0.4])),
    "top of unequal moments": (np.array([0.3, 0.5, 0.7]), np.array([0.2, 0.1, -0.4])),
}


def top(name, substeps, duration=1.0):
    """Error of the orientation of a heavy body that turns about a fixed point, rad."""
    own, arm = TOPS[name]
    mass, spin = 2.0, np.array([1.0, -2.0, 3.0])
    moments = np.diag(own) + mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))

    def rates(_, y):
        frame = Rotation.from_quat(y[:4], scalar_first=True).as_matrix()
        w = frame @ np.linalg.solve(moments, frame.T @ y[4:])
        turn = 0.5 * np.concatenate(([-w @ y[1:4]], y[0] * w + np.cross(w, y[1:4])))
        return np.concatenate((turn, np.cross(frame @ arm, (0, 0, -mass * G))))

    start = np.concatenate(((1, 0, 0, 0), moments @ spin))
    exact = solve_ivp(rates, (0, duration), start, method="DOP853", rtol=1e-12, atol=1e-12).y[:4, -1]
    world = World(substeps=substeps)
    body = world.add_box(
        (0.1, 0.1, 0.1), position=arm, mass=mass, inertia=own, velocity=np.cross(spin, arm), angular_velocity=spin
    )
    world.add_ball_joint(world.ground, body, anchor=(0, 0, 0))
    world.advance(STEP, round(duration / STEP))
    turned = Rotation.from_quat(world.orientation[body.index], scalar_first=True)
    return (turned * Rotation.from_quat(exact, scalar_first=True).inv()).magnitude()


@pytest.mark.parametrize("name", TOPS)
def test_a_heavy_top_turns_as_eulers_equations_say_to_second_order(name):
    errors = np.array([top(name, substeps) for substeps in (4, 8, 16)])
    assert errors[-1] < 1e-3
    assert orders(errors) == pytest.approx(2.0, abs=0.1)


def double_pendulum(substeps, angles=(math.pi / 2, 0.6), duration=2.0):
    """Error of the centres of mass of two rods, m."""

    def accelerations(y):
        a, b, va, vb = y
        c, s = 0.5 * math.cos(a - b), 0.5 * math.sin(a - b)
        moments = np.array([[ROD_INERTIA + 1.25, c], [c, ROD_INERTIA + 0.25]])
        torques = (-s * vb * vb - 1.5 * G * math.sin(a), s * va * va - 0.5 * G * math.sin(b))
        return np.linalg.solve(moments, torques)

    start = np.array([*angles, 0.0, 0.0])
    exact = solve_ivp(
        lambda _, y: np.concatenate((y[2:], accelerations(y))), (0, duration), start,
        method="DOP853", rtol=1e-12, atol=1e-12,
    ).y[:2, -1]  # fmt: skip
    (first, turn_a), (second, turn_b) = map(hanging, angles)
    world = World(substeps=substeps)
    a = world.add_box(ROD, position=first / 2, orientation=turn_a, mass=1.0)
    b = world.add_box(ROD, position=first + second / 2, orientation=turn_b, mass=1.0)
    world.add_hinge(world.ground, a, anchor=(0, 0, 0), axis=(0, -1, 0))
    world.add_hinge(a, b, anchor=first, axis=(0, -1, 0))
    world.advance(STEP, round(duration / STEP))
    first, second = (hanging(angle)[0] for angle in exact)
    return np.linalg.norm(world.position[[a.index, b.index]] - [first / 2, first + second / 2])


def test_a_double_pendulum_is_of_second_order():
    errors = np.array([double_pendulum(substeps) for substeps in (2, 4, 8, 16)])
    assert errors[-1] < 1e-3
    assert orders(errors) == pytest.approx(2.0, abs=0.1)


def test_a_double_pendulum_keeps_its_energy():
    worst = []
    for substeps in (4, 8):
        world = worlds.two_link_arm(angles=(2.5, 0.4)).world
        world.substeps = substeps
        start = world.energy().total
        energies = []
        for _ in range(60):
            world.advance(STEP, 30)
            energies.append(world.energy().total - start)
        worst.append(np.abs(energies).max())
    # It does not drift, and its error is of second order.
    assert worst[0] < 0.003 * 2 * G
    assert worst[0] / worst[1] > 3.0


@pytest.mark.parametrize("joint", ["hinge", "hinge with limits", "ball", "rod", "rope"])
def test_a_short_pendulum_keeps_its_energy_throughout_a_swing(joint):
    """With the whole kick before the drift it would oscillate by more than 1 %."""
    for midpoint in (True, False):
        world, (along, turn) = World(midpoint=midpoint), hanging(1.4)
        bob = world.add_box((0.02, 0.02, 0.1), position=0.05 * along, orientation=turn, mass=1.0, collides_with=())
        if joint.startswith("hinge"):
            limits = (-3.1, 0.1) if "limits" in joint else None
            world.add_hinge(None, bob, anchor=(0, 0, 0), axis=(0, -1, 0), limits=limits)
        elif joint == "ball":
            world.add_ball_joint(None, bob, anchor=(0, 0, 0))
        else:
            add = world.add_distance_joint if joint == "rod" else world.add_rope_joint
            add(None, bob, anchor_a=(0, 0, 0), anchor_b=0.05 * along)
        start, off, fastest = world.energy().total, 0.0, 0.0
        for _ in range(120):
            world.step(STEP)
            off, fastest = max(off, abs(world.energy().total - start)), max(fastest, world.energy().kinetic)
        assert off < 0.01 * fastest if midpoint else off > 0.012 * fastest


@pytest.mark.parametrize("links", [20, 60])
@pytest.mark.parametrize("angle", [0.0, math.pi / 2])
def test_a_chain_with_an_end_a_thousand_times_as_heavy_does_not_stretch(links, angle):
    length = 0.5
    world = worlds.chain(links=links, length=length, ratio=1000.0, angle=angle).world
    widest = total = 0.0
    for _ in range(150):
        world.advance(STEP, 2)
        found = gaps(world)
        widest, total = max(widest, found.max()), max(total, found.sum())
    assert widest <= 1e-3 * length
    assert total <= 1e-3 * length * links
    assert np.isfinite(world.velocity).all()
    if angle == 0.0:
        force = world.joints.handle(0).force
        assert force == pytest.approx([0.0, 0.0, (links + 1000.0) * G], rel=1e-9, abs=1e-6)
    else:
        assert world.position[-1, 2] < -0.1 * links * length  # it has swung


def test_a_slider_falls_along_its_axis():
    world = World()
    body = world.add_box((0.1, 0.1, 0.1), angular_velocity=(0, 0, 0), mass=3.0)
    axis = np.array([0.6, 0.0, -0.8])
    slider = world.add_slider(world.ground, body, anchor=(0.0, 1.0, 0.0), axis=axis)
    world.advance(STEP, 60)
    assert slider.speed == pytest.approx(0.8 * G, rel=1e-12)
    assert slider.position == pytest.approx(0.4 * G, rel=1e-12)
    assert world.position[body.index] == pytest.approx(slider.position * axis, abs=1e-12)
    assert world.orientation[body.index] == pytest.approx([1, 0, 0, 0], abs=1e-12)
    assert slider.force == pytest.approx(3.0 * G * np.array([0.8 * 0.6, 0.0, 0.6 * 0.6]), abs=1e-9)


def test_a_rod_keeps_its_length_and_a_rope_lets_go():
    world = World()
    options = {"mass": 1.0, "collides_with": ()}
    bob = world.add_sphere(0.1, position=(1.0, 0.0, 0.0), **options)
    rod = world.add_distance_joint(world.ground, bob, anchor_a=(0, 0, 0), anchor_b=(1.0, 0.0, 0.0))
    ball = world.add_sphere(0.1, position=(5.0, 0.0, 0.0), **options)
    rope = world.add_rope_joint(world.ground, ball, anchor_a=(5.0, 0.0, 0.5), anchor_b=(5.0, 0.0, 0.0), length=2.0)
    world.advance(STEP, 24)  # 0.4 s: 0.78 m, and the rope is slack
    assert rope.force == pytest.approx([0, 0, 0], abs=1e-12)
    assert world.velocity[ball.index, 2] == pytest.approx(-0.4 * G, rel=1e-12)
    lengths, farthest = [], 0.0
    for _ in range(120):
        world.step(STEP)
        lengths.append([rod.position, rope.position])
        farthest = min(farthest, world.position[bob.index, 0])
    assert np.abs(lengths)[:, 0].max() < 1e-9
    assert np.max(lengths, axis=0)[1] < 1e-9
    assert rope.force == pytest.approx([0, 0, G], rel=1e-9)
    assert farthest < -0.99  # the other one has swung to the other side


def test_a_universal_joint_turns_its_second_shaft_as_cardan_said():
    bend = math.radians(50)
    world = World((0, 0, 0))
    along = np.array([math.cos(bend), math.sin(bend), 0.0])
    turn = (math.cos(bend / 2), 0.0, 0.0, math.sin(bend / 2))
    drive = world.add_box((1.0, 0.1, 0.1), position=(-0.5, 0, 0), mass=1.0)
    driven = world.add_box((1.0, 0.1, 0.1), position=along / 2, orientation=turn, mass=1.0)
    first = world.add_hinge(world.ground, drive, anchor=(-1, 0, 0), axis=(1, 0, 0), motor=Motor(2.0))
    second = world.add_hinge(world.ground, driven, anchor=along, axis=along)
    # The cross's first axis is z, in the driving shaft, and its second one lies in the plane of both shafts.
    world.add_universal_joint(drive, driven, anchor=(0, 0, 0), axis_a=(0, 0, 1), axis_b=np.cross((0, 0, 1), along))
    angles = []
    for _ in range(240):
        world.step(STEP)
        angles.append((first.angle, second.angle, second.speed / first.speed))
    a, b, ratio = np.array(angles).T
    assert a[-1] == pytest.approx(8.0, rel=1e-3)
    exact = np.unwrap(np.arctan2(math.cos(bend) * np.sin(a), np.cos(a)))
    assert b == pytest.approx(exact, abs=1e-6)
    assert ratio == pytest.approx(math.cos(bend) / (1 - (math.sin(bend) * np.sin(a)) ** 2), rel=1e-5)
    assert ratio.min() < 0.65 < 1.5 < ratio.max()  # the shafts of a joint that keeps speeds equal would have 1
