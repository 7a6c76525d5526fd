"""What users do with joints: efforts, laws that are exchanged, pairs that pass through each other, and what cannot be."""

import signal

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.core.errors import ArgumentError
from kickdrift.scenes import worlds
from kickdrift.world import tables
from kickdrift.world.joints import registry
from kickdrift.world.tables import ASKED_APART, EXCLUDED, POSE

NAN, INF = float("nan"), float("inf")
STEP = 1 / 240
WEIGHTLESS = (0.0, 0.0, 0.0)


def two_balls(gravity=WEIGHTLESS):
    world = kd.World(gravity)
    return world, world.add_sphere(0.1, mass=2.0), world.add_sphere(0.1, position=(1, 0, 0), mass=1.0)


# Efforts


def test_a_torque_turns_a_wheel_by_its_moment_of_inertia():
    world = kd.World(WEIGHTLESS)
    wheel = world.add_box((1.0, 1.0, 0.1), mass=3.0)
    hinge = world.add_hinge(world.ground, wheel, anchor=(0, 0, 0), axis=(0, 0, 1))
    for _ in range(120):
        hinge.apply_effort(1.5)
        hinge.apply_effort(0.5)
        world.step(STEP)
    assert hinge.speed == pytest.approx(2.0 * 0.5 / (3.0 / 6), rel=1e-12)
    assert hinge.angle == pytest.approx(0.5 * hinge.speed * 0.5, rel=1e-12)
    world.advance(STEP, 60)
    assert hinge.speed == pytest.approx(2.0, rel=1e-12)  # an effort lasts for a step


def test_a_force_pushes_along_a_slider_and_its_opposite_pushes_back():
    world, a, b = two_balls()
    slider = world.add_slider(a, b, anchor=(0.5, 0, 0), axis=(1, 0, 0))
    for _ in range(60):
        slider.apply_effort(3.0)
        world.step(STEP)
    assert slider.speed == pytest.approx(3.0 * 0.25 * (1 / 1.0 + 1 / 2.0), rel=1e-12)
    assert np.abs(world.momentum()).max() < 1e-14
    assert np.abs(world.angular_momentum()).max() < 1e-14


@pytest.mark.parametrize("axis", [3, 4, 5])
def test_efforts_about_the_axes_of_a_ball_joint_keep_angular_momentum_and_do_work(axis):
    world, a, b = two_balls()
    joint = world.add_ball_joint(a, b, anchor=(0.4, 0.1, 0))
    work = 0.0
    for _ in range(50):
        before = world.angular_velocity.copy()
        joint.apply_effort(0.02, axis)
        load = world.tables.array(tables.LOAD)[:, 3:6].copy()
        world.step(STEP)
        work += STEP * 0.5 * (load * (before + world.angular_velocity)).sum()
    assert world.energy().kinetic == pytest.approx(work, rel=0.01)
    assert world.energy().kinetic > 1e-4
    assert np.abs(world.angular_momentum()).max() < 1e-14


def test_an_effort_wakes_what_sleeps():
    world = kd.World(WEIGHTLESS, sleeping=True)
    hinge = world.add_hinge(world.ground, world.add_sphere(0.1), anchor=(0, 0, 0), axis=(0, 0, 1))
    world.advance(STEP, 240)
    hinge.apply_effort(0.1)
    world.step(STEP)
    assert hinge.speed > 0


def test_computed_torques_hold_an_arm_up():
    arm = kd.World()
    first = arm.add_box((0.5, 0.05, 0.05), position=(0.25, 0, 0), mass=2.0)
    second = arm.add_box((0.5, 0.05, 0.05), position=(0.75, 0, 0), mass=1.0)
    shoulder = arm.add_hinge(arm.ground, first, anchor=(0, 0, 0), axis=(0, -1, 0))
    elbow = arm.add_hinge(first, second, anchor=(0.5, 0, 0), axis=(0, -1, 0))
    for _ in range(240):
        shoulder.apply_effort(9.81 * (2.0 * 0.25 + 1.0 * 0.75))
        elbow.apply_effort(9.81 * 1.0 * 0.25)
        arm.step(STEP)
    assert [shoulder.angle, elbow.angle] == pytest.approx([0, 0], abs=1e-8)


def test_efforts_that_cannot_be():
    world, a, b = two_balls()
    hinge = world.add_hinge(a, b, anchor=(0.5, 0, 0), axis=(0, 0, 1))
    ball = world.add_ball_joint(world.ground, a, anchor=(0, 0, 0))
    for action, word in (
        (lambda: hinge.apply_effort(NAN), "effort"),
        (lambda: hinge.apply_effort("much"), "effort"),
        (lambda: hinge.apply_effort(1.0, 0), "axis=0 is locked"),
        (lambda: hinge.apply_effort(1.0, 6), "axis=6"),
        (lambda: ball.apply_effort(1.0), "axis=None"),
    ):
        with pytest.raises(ArgumentError, match=word):
            action()
    world.step(STEP)
    assert not world.velocity.any()
    world.remove_joint(hinge)
    with pytest.raises(ArgumentError, match=r"gone|removed"):
        hinge.apply_effort(1.0)


# Pairs that pass through each other


def crossing(world):
    """Whether bodies that lie in each other are not pushed apart."""
    before = world.position.copy()
    world.step(STEP)
    return bool((world.position == before).all())


def test_joined_bodies_pass_through_each_other_also_after_restore(tmp_path):
    def make():
        world = kd.World(WEIGHTLESS)
        a, b = world.add_sphere(1.0), world.add_sphere(1.0, position=(0.5, 0, 0))
        return world, world.add_ball_joint(a, b, anchor=(0, 0, 0)), (a, b)

    world, joint, _ = make()
    before = world.snapshot()
    world.step(STEP)
    world.restore(before)
    assert crossing(world)  # from before the first step, when no one had looked at the joints
    world.restore(before)
    other = kd.load_world(world.save(tmp_path / "world"))
    assert crossing(other)
    world.remove_joint(joint)
    assert not crossing(world)

    world, joint, pair = make()
    world.exclude(*pair)
    world.step(STEP)
    world.remove_joint(joint)
    assert crossing(world)  # for it was asked for


def test_the_command_line_begins_like_a_world_that_was_never_restored():
    first, second = worlds.arm().world, worlds.arm().world
    before = first.snapshot()
    first.step(STEP)
    first.restore(before)
    for world in (first, second):
        world.advance(STEP, 20)
    assert (first.tables.array(POSE) == second.tables.array(POSE)).all()
    assert first.touching == second.touching


def test_pairs_of_a_removed_body_are_not_those_of_the_next_one():
    world = kd.World(WEIGHTLESS)
    a, b = world.add_sphere(1.0), world.add_sphere(1.0, position=(0.5, 0, 0))
    world.exclude(b, a)
    assert crossing(world)
    world.remove(b)
    assert len(world.tables.array(ASKED_APART)) == len(world.tables.array(EXCLUDED)) == 0
    assert world.add_sphere(1.0, position=(0.5, 0, 0)).index == b.index
    assert not crossing(world)


@pytest.mark.parametrize("other", ["itself", "gone", None])
def test_pairs_that_cannot_be(other):
    world, a, b = two_balls()
    world.remove(b)
    with pytest.raises(ArgumentError, match="body_b"):
        world.exclude(a, {"itself": a, "gone": b, None: None}[other])


def test_no_two_tables_have_one_place():
    places = [table.place for table in vars(tables).values() if isinstance(table, tables.Table)]
    assert len(set(places)) == len(places)
    assert 0 <= min(places) <= max(places) < len(tables.Tables().block) // 3


# What no joint can be

HINGE = {"anchor": (0.5, 0, 0), "axis": (0, 0, 1)}
UNIVERSAL = {"anchor": (0.5, 0, 0), "axis_a": (1, 0, 0), "axis_b": (0, 1, 0)}
ROD = {"anchor_a": (0, 0, 0), "anchor_b": (1, 0, 0)}
JOINTS = {
    "add_hinge": {
        "axis": [(0, 0, 0), (NAN, 0, 0), (1, 0), "up"],
        "anchor": ["here", (INF, 0, 0), (0, 0), None],
        "limits": [(1, -1), (NAN, 1), 1.0, ("a", "b"), (0, 1, 2), (INF, INF)],
        "motor": ["fast", 3.0],
        "drive": ["stiff", kd.Motor(1.0)],
        "friction": [-1.0, NAN, INF, "rough"],
        "breaking_force": [-1.0, NAN, "soon"],
        "breaking_torque": [-1.0, NAN],
    },
    "add_ball_joint": {
        "swing_limit": [0.0, 4.0, NAN, "wide"],
        "twist_limits": [(1, 0), (-4, 0), 1.0, (NAN, 0)],
        "drive": [3.0, kd.Drive(1.0, target=1.0), kd.Drive(1.0, maximum=2.0)],
    },
    "add_universal_joint": {"axis_b": [(1, 1, 0), (0, 0, 0)], "about_a": [3.0, None, kd.Axis(locked=True)]},
    "add_six_dof_joint": {"linear": [3, (1, 2, 3), (kd.Axis(),)], "swing_limit": ["x", -1.0], "axis_y": [(1, 0, 0)]},
    "add_distance_joint": {"anchor_b": [(0, 0, 0)], "length": [0.0, -1.0, NAN, "long"]},
    "add_rope_joint": {"length": [-1.0, INF]},
    "add_spring": {"stiffness": [0.0, -1.0], "hertz": [0.0, NAN, "A"], "damping_ratio": [-1.0, 1.0]},
}
BASES = {
    "add_hinge": HINGE, "add_ball_joint": {"anchor": (0.5, 0, 0)}, "add_universal_joint": UNIVERSAL,
    "add_six_dof_joint": {"anchor": (0.5, 0, 0)},
}  # fmt: skip


@pytest.mark.parametrize(
    ("method", "option", "value"),
    [
        (method, option, value)
        for method, options in JOINTS.items()
        for option, values in options.items()
        for value in values
    ],
)
def test_joints_that_cannot_be(method, option, value):
    world, a, b = two_balls()
    with pytest.raises(ArgumentError, match=option):
        getattr(world, method)(a, b, **{**BASES.get(method, ROD), option: value})
    assert len(world.joints) == 0


def test_bodies_that_cannot_be_joined():
    world, a, b = two_balls()
    world.remove(b)
    for pair in ((a, a), (a, b), (b, a), (None, None), (world.ground, None)):
        with pytest.raises(ArgumentError, match="body_"):
            world.add_hinge(*pair, **HINGE)
    with pytest.raises(ArgumentError, match="record"):
        world.add_joint(a, None, "hinge")
    assert len(world.joints) == 0


@pytest.mark.parametrize(
    ("method", "value"),
    [("set_motor", 3), ("set_drive", 3), ("set_limits", (2, 1)), ("set_friction", NAN), ("set_limits", 1)],
)
def test_laws_that_cannot_be_set(method, value):
    world, a, b = two_balls()
    hinge = world.add_hinge(a, b, **HINGE)
    with pytest.raises(ArgumentError, match=method.removeprefix("set_")):
        getattr(hinge, method)(value)


@pytest.mark.parametrize(
    "numbers",
    [
        {"stiffness": "x"},
        {"stiffness": None},
        {"damping": -1.0},
        {"target": NAN},
        {"maximum": -1.0},
        {"hertz": 0.0},
        {"hertz": 1.0, "stiffness": 1.0},
        {"damping_ratio": 1.0},
    ],
)
def test_drives_that_cannot_be(numbers):
    with pytest.raises(ArgumentError, match=next(iter(numbers))):
        kd.Drive(**numbers)


# Laws that are read back


LAWS = {
    "motor": kd.Motor(2.0, 3.0),
    "drive": kd.Drive(20.0, 3.0, target=0.4, speed=-0.1, maximum=7.0),
    "limits": (-0.5, 1.5),
    "friction": 0.25,
}


@pytest.mark.parametrize("flipped", [False, True], ids=["body moves", "ground is named second"])
@pytest.mark.parametrize("part", LAWS)
def test_laws_are_read_as_they_were_given(part, flipped):
    world = kd.World()
    box = world.add_box((1, 1, 1), mass=1.0)
    ends = (box, world.ground) if flipped else (world.ground, box)
    given = world.add_hinge(*ends, anchor=(0, 0, 0), axis=(0, 0, 1), **{part: LAWS[part]})
    later = world.add_hinge(*ends, anchor=(0, 0, 0), axis=(0, 0, 1))
    nothing = 0.0 if part == "friction" else None
    assert getattr(later, part)() == nothing
    getattr(later, f"set_{part}")(LAWS[part])
    for hinge in (given, later):
        assert getattr(hinge, part)() == getattr(hinge, part)(5) == LAWS[part]
        for other in set(LAWS) - {part}:
            assert getattr(hinge, other)() == (0.0 if other == "friction" else None)
    getattr(later, f"set_{part}")(nothing)
    assert getattr(later, part)() == nothing


def test_bodies_wake_where_ctrl_c_comes_while_a_law_is_set(monkeypatch):
    world = kd.World()
    hinge = world.add_hinge(None, world.add_box((1, 1, 1), mass=1.0), anchor=(0, 0, 0), axis=(0, 0, 1))
    write, woken = registry.write_law, []
    monkeypatch.setattr(registry, "write_law", lambda *law: (write(*law), signal.raise_signal(signal.SIGINT)))
    monkeypatch.setattr(registry.Joint, "wake", lambda joint: woken.append(joint))
    with pytest.raises(KeyboardInterrupt):
        hinge.set_drive(LAWS["drive"])
    assert hinge.drive() == LAWS["drive"]
    assert woken == [hinge]


def test_the_drive_that_is_read_does_the_same_as_the_one_given():
    def swing(back):
        world = kd.World()
        box = world.add_box((1, 1, 1), position=(1, 0, 0), mass=2.0)
        hinge = world.add_hinge(
            world.ground, box, anchor=(0, 0, 0), axis=(0, 1, 0), drive=kd.Drive(hertz=2.0, target=0.3)
        )
        if back:
            hinge.set_drive(hinge.drive())
        world.advance(STEP, 50)
        return hinge.angle

    assert swing(True) == swing(False)


def test_one_sided_limits_and_axes_of_no_joint():
    world = kd.World()
    box = world.add_box((1, 1, 1), mass=1.0)
    slider = world.add_slider(world.ground, box, anchor=(0, 0, 0), axis=(1, 0, 0), limits=(-INF, 2.0))
    assert slider.limits() == (-INF, 2.0)
    assert slider.limits(4) is None
    with pytest.raises(ArgumentError, match=r"axis=6 must be 0-2"):
        slider.drive(6)
    world.remove_joint(slider)
    with pytest.raises(ArgumentError, match="was removed"):
        slider.drive()


def test_the_ground_keeps_its_joints_when_it_is_not_removed():
    world = kd.World()
    bob = world.add_sphere(0.1, position=(1, 0, 0))
    joint = world.add_ball_joint(world.ground, bob, anchor=(0, 0, 0))
    with pytest.raises(ArgumentError, match="ground"):
        world.remove(world.ground)
    world.advance(1 / 60, 30)
    assert np.linalg.norm(bob.position) == pytest.approx(1.0, abs=1e-6)
    assert joint.force[2] > 0.0
