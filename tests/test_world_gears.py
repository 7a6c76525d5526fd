"""Gears between joints: ratios, torques against theory, what is conserved, and what cannot be."""

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.core.errors import ArgumentError
from kickdrift.scenes import worlds
from kickdrift.world.joints.gear import Gear
from kickdrift.world.layout import AWAKE
from kickdrift.world.tables import BODY

NAN, INF = float("nan"), float("inf")
STEP = 1 / 240
WEIGHTLESS = (0.0, 0.0, 0.0)
UP = (0, 0, 1)
FREE, LOCKED = kd.Axis(), kd.Axis(locked=True)


def two_wheels(ratio=-2.0, **options):
    """Two wheels on hinges with moments of 0.01 and 0.06 kg m^2, and their gear."""
    world = kd.World(WEIGHTLESS, **options)
    a = world.add_cylinder(0.1, 0.05, mass=2.0)
    b = world.add_cylinder(0.2, 0.05, position=(0.3, 0, 0), mass=3.0)
    hinges = [world.add_hinge(None, wheel, anchor=(x, 0, 0), axis=UP) for wheel, x in ((a, 0.0), (b, 0.3))]
    return world, *hinges, world.add_gear(*hinges, ratio, name="mesh")


def gear_box():
    """Two wheels on a box that floats, with axes that are not parallel."""
    world = kd.World(WEIGHTLESS)
    box = world.add_box((1.0, 0.2, 0.2), mass=1.0)
    a = world.add_cylinder(0.1, 0.05, position=(-0.2, 0, 0.3), mass=2.0)
    b = world.add_cylinder(0.2, 0.05, position=(0.2, 0, 0.3), mass=3.0)
    first = world.add_hinge(box, a, anchor=(-0.2, 0, 0.3), axis=UP)
    second = world.add_hinge(box, b, anchor=(0.2, 0, 0.3), axis=(0.3, 0, 1))
    return world, first, second, world.add_gear(first, second, 3.0)


def screw(pitch, gravity=(0, 0, -9.81)):
    world = kd.World(gravity)
    nut = world.add_cylinder(0.1, 0.05, mass=2.0)
    joint = world.add_six_dof_joint(
        None, nut, anchor=(0, 0, 0), linear=(LOCKED, LOCKED, FREE), angular=(LOCKED, LOCKED, FREE)
    )
    return world, joint, world.add_gear(joint, joint, pitch / (2 * np.pi), axis_a=2, axis_b=5)


def test_wheels_that_turn_by_turns_in_a_substep_stay_in_mesh():
    world, first, second, gear = two_wheels(-2.0)
    world.angular_velocity[1:, 2] = 8000.0, -4000.0
    world.advance(STEP, 240)
    assert first.angle == pytest.approx(8000.0, rel=1e-6)
    assert second.angle == pytest.approx(-4000.0, rel=1e-6)
    assert abs(gear.effort) < 1e-6


@pytest.mark.parametrize("ratio", [-2.0, 0.5, 7.3, -1e-2])
def test_a_torque_turns_both_wheels_by_their_moments(ratio):
    world, first, second, gear = two_wheels(ratio)
    for _ in range(240):
        first.apply_effort(0.05)
        world.step(STEP)
    assert first.speed == pytest.approx(0.05 / (0.01 + 0.06 / ratio**2), abs=1e-9)
    assert first.speed == pytest.approx(ratio * second.speed, abs=1e-9)
    of_second = 0.06 / ratio**2 / (0.01 + 0.06 / ratio**2)
    assert gear.effort == pytest.approx(-0.05 * of_second, rel=1e-9)  # what the first wheel passes on


def test_the_load_may_be_at_either_wheel():
    world, first, second, gear = two_wheels(-2.0)
    for _ in range(240):
        second.apply_effort(0.2)
        world.step(STEP)
    assert second.speed == pytest.approx(0.2 / (0.06 + 0.01 * 4), rel=1e-9)
    assert gear.effort == pytest.approx(0.01 * first.speed, rel=1e-9)  # all that turns the first wheel


def test_ratios_do_not_drift_under_load():
    world, first, second, _ = two_wheels(-2.7)
    second.set_friction(0.3)
    first.set_motor(kd.Motor(40.0, maximum=2.0))
    turned = 0.0
    for _ in range(2400):
        world.step(STEP)
        assert abs(first.angle + 2.7 * second.angle) < 1e-9
        turned = first.angle
    assert turned > 390.0
    assert first.speed == pytest.approx(40.0, rel=1e-9)
    assert first.effort == pytest.approx(0.3 / 2.7, rel=1e-9)  # the motor bears the friction of the other wheel


def test_a_gear_box_on_the_loose_turns_with_its_wheels():
    world, first, second, _ = gear_box()
    for _ in range(120):
        first.apply_effort(0.5)
        world.step(STEP)
    energy = world.energy().total
    for _ in range(2400):
        world.step(STEP)
        assert abs(first.angle - 3.0 * second.angle) < 1e-9
    assert first.angle > 100.0
    assert world.energy().total == pytest.approx(energy, rel=1e-5)
    assert np.abs(world.momentum()).max() < 1e-12
    assert np.abs(world.angular_momentum()).max() < 1e-12
    assert np.abs(world.angular_velocity[1]).max() > 1.0  # the housing bears its part


def test_a_gear_couples_bodies_that_nothing_else_joins():
    world = kd.World(WEIGHTLESS)
    bodies = [world.add_box((0.3, 0.2, 0.1), position=(i, 0, 0), mass=1.0 + i) for i in range(4)]
    first = world.add_hinge(bodies[0], bodies[1], anchor=(0.5, 0, 0), axis=UP)
    second = world.add_hinge(bodies[2], bodies[3], anchor=(2.5, 0, 0), axis=(0, 1, 0))
    world.add_gear(first, second, -1.5)
    for _ in range(60):
        first.apply_effort(1.0)
        world.step(STEP)
    energy = world.energy().total
    world.advance(STEP, 1200)
    assert first.angle == pytest.approx(-1.5 * second.angle, rel=1e-9)
    assert abs(second.angle) > 1.0
    assert world.energy().total == pytest.approx(energy, rel=1e-5)
    assert np.abs(world.momentum()).max() < 1e-12
    assert np.abs(world.angular_momentum()).max() < 1e-12


@pytest.mark.parametrize("turned_about", ["body", "ground"])
def test_a_rack_falls_as_its_pinion_lets_it(turned_about):
    world = kd.World()
    pinion = world.add_cylinder(0.1, 0.05, mass=2.0)
    rack = world.add_box((0.02, 0.05, 1.0), position=(0.11, 0, 0), mass=1.0)
    bodies = (None, pinion) if turned_about == "body" else (pinion, None)
    hinge = world.add_hinge(*bodies, anchor=(0, 0, 0), axis=(0, -1, 0))
    slider = world.add_slider(rack, None, anchor=(0.11, 0, 0), axis=UP)
    gear = world.add_gear(slider, hinge, 0.1)
    world.advance(STEP, 240)
    moment = 2.0 * (3 * 0.1**2 + 0.05**2) / 12
    fall = 9.81 / (1.0 + moment / 0.1**2)
    assert slider.speed == pytest.approx(-fall, rel=1e-9)
    assert slider.position == pytest.approx(0.1 * hinge.angle, rel=1e-9)
    assert gear.effort == pytest.approx(9.81 - fall, rel=1e-9)


def test_a_nut_winds_down_its_screw():
    lead = 0.02 / (2 * np.pi)
    world, joint, _ = screw(0.02)
    world.advance(STEP, 480)
    assert world.velocity[1, 2] == pytest.approx(-2 * 9.81 * 2.0 / (2.0 + 0.01 / lead**2), rel=1e-7)
    assert joint.positions[2] == pytest.approx(lead * joint.angles[2], rel=1e-9)
    assert joint.angles[2] < -10.0


def test_wheels_that_spin_freely_keep_their_energy():
    world, first, second, _ = two_wheels(-2.0)
    first.apply_effort(3.0)
    world.step(STEP)
    energy = world.energy().total
    world.advance(STEP, 2400)
    assert world.energy().total == pytest.approx(energy, rel=1e-9)
    assert first.speed == pytest.approx(-2.0 * second.speed, rel=1e-9)


def test_a_limit_of_one_wheel_stops_the_other():
    world, first, second, _ = two_wheels(-2.0)
    second.set_limits((-0.5, 0.5))
    for _ in range(480):
        first.apply_effort(0.1)
        world.step(STEP)
    assert first.angle == pytest.approx(1.0, abs=1e-6)
    assert second.effort == pytest.approx(0.2, rel=1e-6)


def test_wheels_in_a_dense_net_follow_each_other():
    def run(geared):
        world = worlds.joint_grid(size=14)
        ends = [world.bodies.handle(row) for row in (1, 2)]
        hinges = []
        for end in ends:
            at = world.position[end.index]
            wheel = world.add_cylinder(0.05, 0.02, position=at, mass=0.1)
            hinges.append(world.add_hinge(end, wheel, anchor=at, axis=UP))
        if geared:
            world.add_gear(*hinges, -2.0)
        hinges[0].set_motor(kd.Motor(5.0, maximum=1.0))
        world.advance(STEP, 120)
        assert world.joints.sequential
        return hinges

    first, second = run(geared=True)
    assert first.angle == pytest.approx(-2.0 * second.angle, abs=0.02)
    assert first.angle > 1.0
    assert abs(run(geared=False)[1].angle) < 0.1


def test_gears_begin_from_where_joints_stand():
    world = kd.World(WEIGHTLESS)
    hinges = [
        world.add_hinge(None, world.add_sphere(0.1, position=(x, 0, 0)), anchor=(x, 0, 0), axis=UP) for x in (0, 1)
    ]
    hinges[0].angle = 0.7
    world.add_gear(*hinges, 2.0)
    for _ in range(120):
        hinges[1].apply_effort(0.05)
        world.step(STEP)
    assert hinges[1].angle > 0.05
    assert hinges[0].angle - 0.7 == pytest.approx(2.0 * hinges[1].angle, rel=1e-9)


def test_a_gear_breaks_by_the_torque_on_its_first_joint():
    for torque, holds in ((0.04, True), (0.06, False)):
        world = kd.World(WEIGHTLESS)
        wheels = [world.add_cylinder(0.1, 0.05, position=(x, 0, 0), mass=2.0) for x in (0, 1)]
        hinges = [world.add_hinge(None, wheel, anchor=(x, 0, 0), axis=UP) for x, wheel in enumerate(wheels)]
        gear = world.add_gear(*hinges, 1.0, breaking_torque=0.025)
        for _ in range(10):
            hinges[0].apply_effort(torque)
            world.step(STEP)
        assert (hinges[1].speed == pytest.approx(hinges[0].speed)) is holds
        assert len(world.joints) == (3 if holds else 2)
        if not holds:
            with pytest.raises(ArgumentError, match="broken"):
                gear.effort  # noqa: B018


def test_gears_go_with_their_joints_and_bodies():
    for remove in ("joint", "body", "gear"):
        world, first, second, gear = two_wheels()
        if remove == "joint":
            world.remove_joint(second)
        elif remove == "body":
            world.remove(world.bodies.handle(2))
        else:
            world.remove_joint(gear)
        assert len(world.joints) == (2 if remove == "gear" else 1)
        with pytest.raises(ArgumentError, match="joint"):
            world.remove_joint(gear)
        first.apply_effort(0.05)
        world.step(STEP)
        assert first.speed == pytest.approx(0.05 / 0.01 * STEP, rel=1e-9)


def test_geared_bodies_sleep_and_wake_together():
    world, first, second, _ = two_wheels(sleeping=True)
    world.add_sphere(0.1, position=(9, 0, 0))
    bodies = world.tables.array(BODY)
    first.apply_effort(0.05)
    world.advance(STEP, 60)
    assert bodies[1:, AWAKE].all()
    first.set_friction(5.0)
    world.advance(STEP, 240)
    assert not bodies[1:, AWAKE].any()
    second.apply_effort(20.0)
    world.step(STEP)
    assert bodies[1:, AWAKE].tolist() == [1, 1, 0]
    assert abs(first.speed) > 0.01
    assert first.speed == pytest.approx(-2.0 * second.speed, rel=1e-9)


def test_snapshots_and_files_go_on_with_the_same_bits(tmp_path):
    world, first, _, _ = gear_box()
    for _ in range(30):
        first.apply_effort(0.5)
        world.step(STEP)
    snapshot, path = world.snapshot(), world.save(tmp_path / "box")
    world.advance(STEP, 60)
    ends = [world.position.tobytes() + world.orientation.tobytes()]
    world.restore(snapshot)
    loaded = kd.load_world(path)
    for again in (world, loaded):
        again.advance(STEP, 60)
        ends.append(again.position.tobytes() + again.orientation.tobytes())
    assert len(set(ends)) == 1


def test_geared_joints_are_not_placed():
    world, first, second, gear = two_wheels()
    for joint in (first, second):
        with pytest.raises(ArgumentError, match="joint"):
            joint.angle = 1.0
    world.remove_joint(gear)
    first.angle = 1.0
    assert first.angle == pytest.approx(1.0)


def two_geared_pairs():
    """Two pairs of boxes that float, each with a hinge, and the gear of both hinges."""
    world = kd.World(WEIGHTLESS)
    boxes = [world.add_box((1, 1, 1), position=(3 * k, 0, 0), mass=1.0) for k in range(4)]
    hinges = [world.add_hinge(*boxes[k : k + 2], anchor=(3 * k + 1.5, 0, 0), axis=UP) for k in (0, 2)]
    world.add_gear(*hinges, -2.0)
    return world, boxes, hinges


def test_geared_joints_of_floating_bodies_are_not_placed_either():
    _, _, (first, second) = two_geared_pairs()
    for joint in (first, second):
        with pytest.raises(ArgumentError, match="geared"):
            joint.angle = 0.5
        with pytest.raises(ArgumentError, match="geared"):
            joint.speed = 0.5


def test_a_gear_is_no_obstacle_to_placing_other_joints():
    world, boxes, (first, second) = two_geared_pairs()
    between = world.add_hinge(boxes[1], boxes[2], anchor=(4.5, 0, 0), axis=UP)
    between.angle = 0.5
    world.step(STEP)
    assert between.angle == pytest.approx(0.5)
    assert (first.angle, second.angle) == pytest.approx((0.0, 0.0), abs=1e-12)


def test_what_a_gear_has_not():
    world, _, _, gear = two_wheels()
    assert world.joint("mesh") == gear
    assert (gear.speed, gear.angle) == (0.0, 0.0)
    for axis in (None, 0, 3):
        for call in (
            lambda axis: gear.apply_effort(1.0, axis), lambda axis: gear.set_motor(kd.Motor(1.0, 1.0), axis),
            lambda axis: gear.place(1.0, axis),
        ):  # fmt: skip
            with pytest.raises(ArgumentError, match="locked"):
                call(axis)


def test_a_gear_of_sliders_cannot_be_geared_itself():
    world = kd.World(WEIGHTLESS)
    boxes = [world.add_box((1, 1, 1), position=(3 * k, 0, 0), mass=1.0) for k in range(3)]
    sliders = [world.add_slider(None, box, anchor=box.position, axis=UP) for box in boxes]
    gear = world.add_gear(sliders[0], sliders[1], -2.0)
    with pytest.raises(ArgumentError, match="locked"):
        world.add_gear(gear, sliders[2], 1.0, axis_a=0)


@pytest.mark.parametrize(
    ("match", "change"),
    [
        ("ratio", {"ratio": 0.0}), ("ratio", {"ratio": NAN}), ("ratio", {"ratio": INF}), ("ratio", {"ratio": "2"}),
        ("joint_b", {"joint_b": "first"}), ("joint_b=", {"joint_b": None}), ("joint_a=3", {"joint_a": 3}),
        ("another world", {"joint_b": "elsewhere"}), ("removed", {"joint_b": "gone"}),
        ("axis_b=2 .* cannot be geared", {"joint_b": "rope"}), ("axis_b=None", {"joint_b": "ball"}),
        ("axis_b=3 .* cannot be geared", {"joint_b": "ball", "axis_b": 3}), ("axis_a=3 .* locked", {"axis_a": 3}),
        ("locked", {"joint_b": "gear"}), ("axis=7", {"axis_a": 7}), ("breaking_torque", {"breaking_torque": -1.0}),
        ("name", {"name": "mesh"}),
    ],
)  # fmt: skip
def test_gears_that_cannot_be(match, change):
    world, first, second, gear = two_wheels()
    bodies = [world.add_sphere(0.1, position=(x, 5, 0)) for x in (0, 1)]
    gone = world.add_hinge(None, bodies[0], anchor=(0, 5, 0), axis=UP)
    world.remove_joint(gone)
    joints = {
        "first": first, "gear": gear, "gone": gone, "elsewhere": two_wheels()[1],
        "rope": world.add_rope_joint(*bodies, anchor_a=(0, 5, 0), anchor_b=(1, 5, 0), length=2.0),
        "ball": world.add_ball_joint(None, bodies[0], anchor=(0, 5, 0)),
    }  # fmt: skip
    given = {"joint_a": first, "joint_b": second, "ratio": 2.0, **change}
    given = {key: joints.get(value, value) if key.startswith("joint") else value for key, value in given.items()}
    before = len(world.joints)
    with pytest.raises(ArgumentError, match=match):
        world.add_gear(**given)
    assert len(world.joints) == before
    with pytest.raises(ArgumentError, match="add_gear"):
        world.add_joint(*bodies, Gear(first, second, 2.0))


def test_a_planetary_gear_turns_as_willis_says():
    """Sun and planet on a carrier, the ring held: the sun turns 1 + z_ring / z_sun times as fast as the carrier."""
    sun_teeth, planet_teeth, ring_teeth = 20, 30, 80
    world = kd.World(WEIGHTLESS)
    carrier = world.add_box((0.4, 0.1, 0.02), mass=1.0)
    sun = world.add_cylinder(0.08, 0.02, mass=2.0)
    planet = world.add_cylinder(0.12, 0.02, position=(0.2, 0, 0), mass=3.0)
    arm = world.add_hinge(None, carrier, anchor=(0, 0, 0), axis=UP)
    of_sun = world.add_hinge(carrier, sun, anchor=(0, 0, 0), axis=UP)
    of_planet = world.add_hinge(carrier, planet, anchor=(0.2, 0, 0), axis=UP)
    world.add_gear(of_sun, of_planet, -planet_teeth / sun_teeth)
    world.add_gear(of_planet, arm, -ring_teeth / planet_teeth)  # the ring turns backwards, seen from the carrier
    for _ in range(240):
        world.apply_force(sun, (0, 0.5, 0), point=(0.1, 0, 0))  # a couple of 0.1 N m
        world.apply_force(sun, (0, -0.5, 0), point=(-0.1, 0, 0))
        world.step(STEP)
    ratio = 1 + ring_teeth / sun_teeth
    moments = 0.5 * 2.0 * 0.08**2, 1.0 * (0.4**2 + 0.1**2) / 12 + 3.0 * 0.2**2, 0.5 * 3.0 * 0.12**2
    felt = moments[0] + (moments[1] + moments[2] * (1 - ring_teeth / planet_teeth) ** 2) / ratio**2
    assert sun.angular_velocity[2] == pytest.approx(0.1 / felt, rel=1e-6)
    assert sun.angular_velocity[2] == pytest.approx(ratio * arm.speed, rel=1e-9)


def test_a_housing_that_is_moved_takes_its_wheels_with_it():
    world = kd.World(WEIGHTLESS)
    table = world.add_box((1, 1, 0.1), kinematic=True, angular_velocity=(0, 0, 2.0))
    wheels = [world.add_cylinder(0.1, 0.05, position=(x, 0, 0.3), mass=2.0) for x in (0.3, -0.3)]
    hinges = [world.add_hinge(table, wheel, anchor=wheel.position, axis=UP) for wheel in wheels]
    world.add_gear(*hinges, -1.0)
    world.advance(STEP, 480)
    for hinge in hinges:  # both would lag behind alike, which the gear does not let them
        assert hinge.angle == pytest.approx(0.0, abs=1e-6)
    assert wheels[0].angular_velocity[2] == pytest.approx(2.0, rel=1e-6)


def test_wheels_that_press_on_something_keep_their_ratio():
    world = kd.World()
    world.add_plane(friction=0.5)
    hinges = []
    for side in (-1, 1):
        jaw = world.add_box((0.05, 0.2, 0.5), position=(0.15 * side, 0, 0.3), mass=0.5)
        hinges.append(world.add_hinge(None, jaw, anchor=(0.15 * side, 0, 0.55), axis=(0, 1, 0)))
    block = world.add_box((0.2, 0.2, 0.2), position=(0, 0, 0.1), mass=1.0)
    world.add_gear(*hinges, -1.0)
    for _ in range(240):
        hinges[0].apply_effort(-20.0)  # closes both jaws, of which one only is driven
        world.step(STEP)
        assert hinges[0].angle == pytest.approx(-hinges[1].angle, abs=1e-9)
    assert abs(block.position[0]) < 1e-3
    assert 0.01 < abs(hinges[0].angle) < 0.2
