"""Handles of bodies: what they say, what is set by them, names, and what they refuse."""

import copy
import gc
import pickle
import signal

import numpy as np
import pytest
from fuzz_interruptions import interrupted

import kickdrift as kd
from kickdrift.core.errors import ArgumentError, LostBodyError
from kickdrift.world.tables import BODY, MOTION, POSE

STEP = 1 / 60
NAN = float("nan")
WEIGHTLESS = (0.0, 0.0, 0.0)
POSES = ("position", "orientation", "velocity", "angular_velocity")


def spinning(world, **options):
    """A box of three different sides that tumbles."""
    return world.add_box(
        (0.2, 0.5, 1.0), position=(1, 2, 3), velocity=(0.1, 0, 0), angular_velocity=(1, 5, 0.3), mass=6.0, **options
    )


# What they say


def test_a_body_says_where_it_is_and_what_it_is_made_of():
    world = kd.World()
    box = spinning(world, name="brick", friction=0.3, restitution=0.7)
    world.advance(STEP, 7)
    for name in POSES:
        assert np.array_equal(getattr(box, name), getattr(world, name)[box.index])
    assert (box.mass, box.friction, box.restitution, box.name) == (6.0, 0.3, 0.7, "brick")
    assert np.allclose(box.inertia, np.diag((0.5**2 + 1.0, 0.2**2 + 1.0, 0.2**2 + 0.5**2)) / 2.0, 1e-14, 0)
    floor = world.add_plane(friction=0.9)
    assert (floor.mass, floor.friction, floor.name) == (np.inf, 0.9, None)
    assert np.isinf(np.diag(floor.inertia)).all()


def test_poses_and_velocities_are_live_also_where_tables_grow():
    world = kd.World(WEIGHTLESS)
    ball = world.add_sphere(0.1)
    assert ball.position[0] == 0.0
    for k in range(100):
        world.add_sphere(0.1, position=(k + 1, 0, 0))
    ball.position[2] = 3.0
    ball.position += (1, 0, 0)
    ball.velocity[:] = 1.0
    assert world.position[ball.index].tolist() == [1, 0, 3]
    assert world.velocity[ball.index].tolist() == [1, 1, 1]
    view = ball.position
    world.step(STEP)
    assert view[2] > 3.0


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("position", (0.3, 0, 2)), ("orientation", (3, 0, 4, 0)), ("velocity", (0, 0, 4)), ("angular_velocity", (0, 9, 1)),
    ],
)  # fmt: skip
def test_setting_is_writing_into_the_arrays_of_the_world_to_the_last_bit(name, value):
    def settled():
        world = kd.World(sleeping=True)
        world.add_plane()
        boxes = [world.add_box((0.3, 0.4, 0.5), position=(0, 0, 0.25 + 0.5 * k)) for k in range(2)]
        world.advance(STEP, 90)
        return world, boxes[1]

    (by_handle, box), (by_array, other) = settled(), settled()
    assert by_handle.tables.array(BODY)[box.index, 1] == 0  # it sleeps
    setattr(box, name, value)
    getattr(by_array, name)[other.index] = np.divide(value, 5.0) if name == "orientation" else value
    for world in (by_handle, by_array):
        world.advance(STEP, 20)
    assert by_handle.tables.array(BODY)[box.index, 1] == 1
    for table in (POSE, MOTION):
        assert np.array_equal(by_handle.tables.array(table), by_array.tables.array(table))
    assert not np.array_equal(by_handle.position, settled()[0].position)


# What is set by them


def test_a_new_mass_scales_the_inertia_and_leaves_a_free_body_its_motion():
    worlds = [kd.World(WEIGHTLESS) for _ in range(2)]
    heavy, other = (spinning(world) for world in worlds)
    for world in worlds:
        world.advance(STEP, 20)
    before = heavy.inertia
    heavy.mass = 60.0
    assert heavy.mass == 60.0
    assert np.array_equal(heavy.inertia, 10.0 * before)
    assert np.allclose(worlds[0].angular_momentum(), 10 * worlds[1].angular_momentum(), 1e-14, 0)
    for world in worlds:
        world.advance(STEP, 200)
    for name in POSES:  # free bodies do not know how heavy they are
        assert np.allclose(getattr(heavy, name), getattr(other, name), 0, 1e-10)
    heavy.velocity = 0.0, 0.0, 0.0
    worlds[0].apply_force(heavy, (6.0, 0, 0))
    worlds[0].step(STEP)
    assert heavy.velocity[0] == pytest.approx(6.0 / 60.0 * STEP, rel=1e-12)


def test_a_new_inertia_keeps_its_angular_momentum_and_answers_torques():
    world = kd.World(WEIGHTLESS)
    box = spinning(world)
    world.advance(STEP, 10)
    box.inertia = (1.0, 2.0, 2.5)
    spin, turning = world.angular_momentum(), world.energy().kinetic
    world.advance(STEP, 300)
    assert np.allclose(world.angular_momentum(), spin, 1e-12, 0)
    assert world.energy().kinetic == pytest.approx(turning, rel=1e-12)
    box.angular_velocity, box.orientation = (0, 0, 0), (1, 0, 0, 0)
    world.apply_torque(box, (0, 3.0, 0))
    world.step(STEP)
    assert box.angular_velocity == pytest.approx([0, 1.5 * STEP, 0], abs=1e-9)


def test_joints_follow_a_new_mass():
    def pendulum(mass):
        world = kd.World()
        rod = world.add_box((0.1, 0.1, 1.0), position=(0, 0, -0.5), mass=mass)
        load = world.add_sphere(0.1, position=(0, 0, -1), mass=1.0, velocity=(2, 0, 0))
        world.add_hinge(None, rod, anchor=(0, 0, 0), axis=(0, 1, 0))
        world.add_fixed_joint(rod, load, anchor=(0, 0, -1))
        return world, rod

    (changed, rod), (made, _) = pendulum(1.0), pendulum(50.0)
    changed.advance(STEP, 0)
    rod.mass = 50.0
    assert not changed.joints.arranged  # the heaviest body may be another one
    for world in (changed, made):
        world.advance(STEP, 60)
    assert np.allclose(changed.position, made.position, 0, 1e-12)


def test_friction_and_restitution_are_those_of_the_next_step():
    world = kd.World(sleeping=True)
    floor = world.add_plane(friction=0.5)
    box = world.add_box((1, 1, 0.2), position=(0, 0, 0.1), velocity=(3, 0, 0), friction=0.5)
    world.advance(STEP, 20)
    floor.friction = box.friction = 0.1
    before = box.velocity[0]
    world.advance(STEP, 20)
    assert (before - box.velocity[0]) / (20 * STEP) == pytest.approx(0.1 * 9.81, rel=0.01)
    ball = world.add_sphere(0.1, position=(0, 50, 0.2))
    ball.restitution = 1.0
    heights = [float(ball.position[2]) for _ in range(60) if world.step(STEP) is None]
    assert max(heights[20:]) == pytest.approx(0.2, rel=0.01)


@pytest.mark.parametrize("kind", ["plane", "mesh", "height field"])
def test_ground_of_every_kind_moves_where_it_is_placed(kind):
    world = kd.World()
    ground = {
        "plane": lambda: world.add_plane(),
        "mesh": lambda: world.add_mesh([(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)], [(0, 1, 2), (0, 2, 3)]),
        "height field": lambda: world.add_height_field(np.zeros((3, 3)), 9.0, position=(-9, -9, 0)),
    }[kind]()
    ball = world.add_sphere(0.1, position=(0.3, 0.2, 0.1))
    world.advance(STEP, 30)
    ground.position -= (0, 0, 0.5)
    assert world.ray_cast((2, 1, 5), (0, 0, -1)).point[2] == pytest.approx(-0.5)
    world.advance(STEP, 60)
    assert ball.position[2] == pytest.approx(-0.4, abs=0.01)
    ground.orientation = np.cos(0.1), 0, np.sin(0.1), 0
    world.advance(STEP, 60)
    assert ball.velocity[0] > 0.5  # it rolls down


def test_static_bodies_move_where_they_are_placed_and_wake_what_rested_on_them():
    world = kd.World(sleeping=True)
    shelf = world.add_box((1, 1, 0.1), position=(0, 0, 1), static=True)
    ball = world.add_sphere(0.1, position=(0, 0, 1.15))
    world.advance(STEP, 120)
    assert world.tables.array(BODY)[ball.index, 1] == 0
    shelf.position = 5, 0, 0
    assert world.ray_cast((5, 0, 5), (0, 0, -1)).body == shelf
    assert world.ray_cast((0, 0, 0.9), (0, 0, -1)) is None
    world.advance(STEP, 60)
    assert ball.position[2] < -1.0
    ball.position, ball.velocity = (5, 0, 0.5), (0, 0, 0)
    world.advance(STEP, 120)
    assert ball.position[2] == pytest.approx(0.15, abs=0.01)


# Locked rotations


def test_a_body_whose_rotation_is_locked_slides_and_never_tips():
    world = kd.World((4.0, 0, -9.81))
    world.add_plane(friction=0.3)
    q = (np.cos(0.3), 0, 0, np.sin(0.3))
    pole = world.add_box((0.1, 0.2, 2.0), position=(0, 0, 1), orientation=q, friction=0.3, locked_rotation=True)
    world.apply_torque(pole, (1e3, 1e3, 1e3))
    world.advance(STEP, 60)
    assert pole.orientation == pytest.approx(q, abs=1e-15)
    assert not pole.angular_velocity.any()
    assert pole.locked_rotation
    assert pole.velocity == pytest.approx([4.0 - 0.3 * 9.81, 0, 0], rel=0.01, abs=1e-3)


def test_a_ball_that_hits_a_locked_box_off_centre_bounces_like_a_point():
    world = kd.World(WEIGHTLESS)
    box = world.add_box((0.2, 1.0, 1.0), mass=2.0, locked_rotation=True, restitution=1.0, friction=0.0)
    ball = world.add_sphere(0.1, position=(1, 0.3, 0.4), velocity=(-3, 0, 0), mass=1.0, restitution=1.0, friction=0.0)
    world.advance(STEP, 60)
    assert box.velocity == pytest.approx([-2, 0, 0], abs=1e-9)
    assert ball.velocity == pytest.approx([1, 0, 0], abs=1e-9)


def test_a_pendulum_on_a_locked_body_swings_like_one_on_rails():
    def swing(locked):
        world = kd.World((0, 0, -9.81))
        cart = world.add_box((0.3, 0.2, 0.1), mass=1.0, locked_rotation=locked)
        rod = world.add_box(
            (0.05, 0.05, 1.0), position=(0, 0, -0.5), angular_velocity=(0, 2, 0), velocity=(-1, 0, 0), mass=0.5
        )
        slides, held = (kd.Axis(), kd.Axis(), kd.Axis(locked=True)), kd.Axis(locked=True)
        turns = (kd.Axis(),) * 3 if locked else (held,) * 3
        world.add_six_dof_joint(None, cart, anchor=(0, 0, 0), linear=slides, angular=turns)
        hinge = world.add_hinge(cart, rod, anchor=(0, 0, 0), axis=(0, 1, 0))
        world.advance(1 / 240, 240)
        return hinge.angle, cart.position[0], np.abs(cart.orientation - (1, 0, 0, 0)).max()

    (angle, place, turned), (expected, where, _) = swing(True), swing(False)
    assert angle == pytest.approx(expected, abs=1e-7)
    assert place == pytest.approx(where, abs=1e-7)
    assert turned < 1e-12
    assert abs(angle) > 0.1


def test_rotation_is_locked_and_unlocked_between_steps_and_kept(tmp_path):
    world = kd.World(WEIGHTLESS)
    box = spinning(world)
    inertia = box.inertia
    box.locked_rotation = True
    assert not box.angular_velocity.any()
    then = world.snapshot()
    box.mass = 3.0
    assert box.locked_rotation
    world.apply_torque(box, (1, 2, 3))
    world.advance(STEP, 3)
    assert not box.angular_velocity.any()
    with pytest.raises(ArgumentError, match="rotation is locked"):
        box.angular_velocity = 1, 0, 0
    box.locked_rotation = False
    assert np.array_equal(box.inertia, inertia / 2)
    box.orientation = 1, 0, 0, 0
    world.apply_torque(box, (0, 3.0, 0))
    world.step(STEP)
    assert box.angular_velocity == pytest.approx([0, 3.0 / box.inertia[1, 1] * STEP, 0], abs=1e-9)
    world.restore(then)
    assert box.locked_rotation
    assert kd.load_world(world.save(tmp_path / "world")).bodies.handle(box.index).locked_rotation


def test_rotations_that_cannot_be_locked():
    world = kd.World()
    for options in (
        {"locked_rotation": True, "static": True},
        {"locked_rotation": True, "kinematic": True},
        {"locked_rotation": True, "angular_velocity": (0, 0, 1)},
        {"locked_rotation": "yes"},
        {"locked_rotation": 1},
        {"locked_rotation": None},
    ):
        with pytest.raises(ArgumentError, match="locked_rotation"):
            world.add_box((1, 1, 1), **options)
    assert len(world.position) == 1
    wall, box = world.add_box((1, 1, 1), static=True), world.add_box((1, 1, 1))
    assert not wall.locked_rotation
    with pytest.raises(ArgumentError, match="forces do not move"):
        wall.locked_rotation = True
    with pytest.raises(ArgumentError, match="locked_rotation"):
        box.locked_rotation = 1


# Names


def test_names_find_bodies_and_joints_and_are_shown():
    world = kd.World()
    ball = world.add_sphere(0.1, name="ball")
    floor = world.add_plane(name="floor")
    hinge = world.add_hinge(None, ball, anchor=(0, 0, 0), axis=(0, 1, 0), name="pivot")
    assert world.body("ball") == ball
    assert world.body("floor") == floor
    assert world.joint("pivot") == hinge
    assert repr(ball) == "Body(index=1, generation=1, name='ball')"
    assert repr(hinge) == "Joint(index=0, generation=0, name='pivot')"
    with pytest.raises(ArgumentError, match="did you mean 'ball'"):
        world.body("bal")
    with pytest.raises(ArgumentError, match="known: pivot"):
        world.joint("x")
    ball.name = "sphere"
    assert world.body("sphere") == ball
    with pytest.raises(ArgumentError, match="'ball'"):
        world.body("ball")
    ball.name = "sphere"  # its own
    ball.name = None
    assert repr(ball) == "Body(index=1, generation=1)"


def test_worlds_iterate_over_the_handles_of_their_bodies_and_joints():
    world = kd.World()
    first, second = (world.add_sphere(0.1, position=(x, 0, 0), mass=1.0) for x in (0, 1))
    hinge, ball = world.add_hinge(None, first, (0, 0, 0), (0, 1, 0)), world.add_ball_joint(first, second, (0.5, 0, 0))
    assert list(world.bodies) == [world.ground, first, second]
    assert list(world.joints) == [hinge, ball]
    world.remove(first)
    assert list(world.bodies) == [world.ground, second]
    assert (len(world.bodies), len(world.joints), list(world.joints)) == (2, 0, [])


def test_a_name_is_free_again_once_its_body_or_joint_is_gone():
    world = kd.World()
    ball = world.add_sphere(0.1, name="ball")
    world.add_ball_joint(ball, None, anchor=(0, 0, 0), name="joint")
    world.remove(ball)
    with pytest.raises(ArgumentError, match=r"'ball'.* was removed"):
        world.apply_force(ball, (0, 0, 1))
    again = world.add_sphere(0.1, name="ball")
    assert world.body("ball") == again != ball
    world.add_ball_joint(again, None, anchor=(0, 0, 0), name="joint")


def test_a_name_is_the_old_or_the_new_one_wherever_ctrl_c_comes():
    world = kd.World()
    ball, lines = world.add_sphere(1.0), 0
    for line in range(1, 1000):
        ball.name = "old"
        lines = interrupted(world, lambda world: setattr(ball, "name", "new"), line)
        assert ball.name in ("old", "new")
        assert world.body(ball.name) == ball
        if line > lines:
            break
    assert ball.name == "new"


@pytest.mark.parametrize(("setting", "value"), [("gravity", (0, 0, -1.0)), ("sleeping", False)])
def test_all_wake_where_ctrl_c_comes_while_a_setting_changes(setting, value, monkeypatch):
    world, woken = kd.World(), []
    monkeypatch.setattr(world.bodies, "wake", lambda: (signal.raise_signal(signal.SIGINT), woken.append("bodies")))
    monkeypatch.setattr(world.cloths, "wake", lambda: woken.append("cloths"))
    with pytest.raises(KeyboardInterrupt):
        setattr(world, setting, value)
    assert woken == ["bodies", "cloths"]


def test_names_are_in_snapshots_files_and_recordings(tmp_path):
    world = kd.World()
    ball = world.add_sphere(0.1, position=(0, 0, 1), name="ball")
    world.add_slider(None, ball, anchor=(0, 0, 0), axis=(0, 0, 1), name="rail")
    then = world.snapshot()
    ball.name = "other"
    later = world.add_sphere(0.1, position=(3, 0, 0), name="later")
    recording = world.run(0.1, STEP)
    assert recording.row("later") == later.index
    assert kd.load(recording.save(tmp_path / "recording")).row("other") == ball.index
    with pytest.raises(ArgumentError, match="known: later, other"):
        recording.row("x")
    world.restore(then)
    assert world.body("ball") == ball
    assert ball.name == "ball"
    with pytest.raises(ArgumentError, match="'later'"):
        world.body("later")
    world.add_sphere(0.1, name="later")
    loaded = kd.load_world(world.save(tmp_path / "world"))
    assert loaded.body("ball").position.tolist() == [0, 0, 1]
    assert loaded.joint("rail").position == 0.0
    assert loaded.body("later").index == 2


def test_a_lost_body_is_called_by_its_name():
    world = kd.World()
    world.add_sphere(0.1, velocity=(1e308, 0, 0), name="comet")
    with pytest.raises(LostBodyError, match="body 1, 'comet', was lost"):
        world.step(1e9)


@pytest.mark.parametrize("name", ["", 3, b"ball", ("a",), True])
def test_names_that_cannot_be(name):
    world = kd.World()
    ball = world.add_sphere(0.1)
    for act in (
        lambda: world.add_sphere(0.1, name=name),
        lambda: world.add_hinge(None, ball, anchor=(0, 0, 0), axis=(1, 0, 0), name=name),
        lambda: setattr(ball, "name", name),
    ):
        with pytest.raises(ArgumentError, match="name="):
            act()
    assert len(world.position) == 2
    assert len(world.joints) == 0


def test_no_two_have_one_name():
    world = kd.World()
    first, second = world.add_sphere(0.1, name="ball"), world.add_box((1, 1, 1), name="box")
    anywhere = {"anchor": (0, 0, 0), "axis": (0, 0, 1)}
    world.add_hinge(first, None, **anywhere, name="ball")  # joints have names of their own
    for act in (
        lambda: world.add_capsule(0.1, 1.0, name="ball"),
        lambda: world.add_plane(name="box"),
        lambda: world.add_slider(second, None, **anywhere, name="ball"),
        lambda: setattr(second, "name", "ball"),
    ):
        with pytest.raises(ArgumentError, match="belongs to another"):
            act()
    assert len(world.position) == 3
    assert len(world.joints) == 1


# What they refuse


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("position", [(0, 0), (NAN, 0, 0), "here", None, 3.0, (np.inf, 0, 0)]),
        ("orientation", [(0, 0, 0, 0), (1, 0, 0), (NAN, 0, 0, 1), "up"]),
        ("velocity", [(0, 0), (np.inf, 0, 0), None, 3.0]),
        ("angular_velocity", [(1, 2), (0, NAN, 0), "fast"]),
        ("mass", [0.0, -1.0, NAN, np.inf, "heavy", None, True, (1,)]),
        ("inertia", [(1, 1), (0, 1, 1), (1, 1, 3), (NAN, 1, 1), "round", [[1, 2], [2, 1]]]),
        ("friction", [-0.1, NAN, np.inf, "rough", None, True]),
        ("restitution", [-0.1, 1.1, NAN, "high"]),
    ],
)
def test_values_that_a_body_cannot_have_leave_it_as_it_was(name, values):
    world = kd.World()
    box = spinning(world)
    before = np.array(getattr(box, name))
    for value in values:
        with pytest.raises(ArgumentError, match=name):
            setattr(box, name, value)
        assert np.array_equal(getattr(box, name), before)


def test_what_nothing_moves_has_no_mass_and_velocity_to_set():
    world = kd.World()
    wall, lift = world.add_box((1, 1, 1), static=True), world.add_box((1, 1, 1), kinematic=True)
    for body, name, value, why in (
        (wall, "velocity", (1, 0, 0), "static"),
        (wall, "angular_velocity", (1, 0, 0), "static"),
        (wall, "mass", 1.0, "forces do not move"),
        (lift, "inertia", (1, 1, 1), "forces do not move"),
        (world.ground, "position", (1, 0, 0), "ground"),
        (world.ground, "orientation", (1, 0, 0, 0), "ground"),
        (world.ground, "velocity", (1, 0, 0), "static"),
        (world.ground, "friction", 0.3, "no shapes|has none"),
    ):
        with pytest.raises(ArgumentError, match=why):
            setattr(body, name, value)
    with pytest.raises(ArgumentError, match="no shapes"):
        world.ground.friction  # noqa: B018
    wall.velocity = (0, 0, 0)
    lift.velocity = (0, 0, 1)
    world.step(STEP)
    assert lift.position[2] == pytest.approx(STEP)
    with pytest.raises(AttributeError):
        wall.index = 3
    with pytest.raises(AttributeError):
        wall.postion = (0, 0, 0)


def test_the_frictions_of_a_compound_are_one_once_they_are_set():
    world = kd.World()
    parts = [kd.Part(kd.Sphere(0.1), friction=0.2), kd.Part(kd.Sphere(0.1), position=(1, 0, 0), friction=0.4)]
    body = world.add_body(parts)
    with pytest.raises(ArgumentError, match=r"shapes of friction 0\.2, 0\.4"):
        body.friction  # noqa: B018
    body.friction = 0.3
    assert body.friction == 0.3
    assert body.restitution == 0.0


def test_all_but_the_name_raises_once_the_body_is_gone():
    world = kd.World()
    ball = world.add_sphere(0.1, name="a ball")
    ball.name = "ball"
    assert ball.position[0] == 0.0  # it knows where to look
    world.remove(ball)
    for name in (*POSES, "mass", "inertia", "friction", "restitution"):
        with pytest.raises(ArgumentError, match="was removed"):
            getattr(ball, name)
    for name in (*POSES, "mass", "inertia", "friction", "restitution", "name"):
        with pytest.raises(ArgumentError, match="was removed"):
            setattr(
                ball,
                name,
                "x"
                if name == "name"
                else (1.0, 1.0, 1.0, 1.0)[: 4 if name == "orientation" else 3]
                if name in (*POSES, "inertia")
                else 0.5,
            )
    world.add_sphere(0.2)  # in its row
    with pytest.raises(ArgumentError, match="was removed"):
        ball.position  # noqa: B018
    assert ball.name == "ball"
    assert repr(ball) == "Body(index=1, generation=1, name='ball')"


def test_a_joint_that_breaks_is_called_by_its_name():
    world = kd.World()
    ball = world.add_sphere(0.1, mass=1.0)
    rope = world.add_fixed_joint(None, ball, anchor=(0, 0, 0), breaking_force=5.0, name="thread")
    world.step(STEP)
    assert repr(world.broken) == "[Joint(index=0, generation=0, name='thread')]"
    assert world.broken == [rope]
    with pytest.raises(ArgumentError, match=r"'thread'.* has broken"):
        rope.force  # noqa: B018


def test_handles_follow_tables_that_grow_and_go_back():
    world = kd.World(WEIGHTLESS)
    before = world.snapshot()
    ball = world.add_sphere(0.1, velocity=(1, 0, 0))
    slider = world.add_slider(None, ball, anchor=(0, 0, 0), axis=(1, 0, 0))
    assert (slider.speed, ball.velocity[0]) == (1.0, 1.0)  # now they know where to look
    then = world.snapshot()
    for k in range(50):
        body = world.add_sphere(0.1, position=(0, k + 1, 0))
        world.add_slider(None, body, anchor=(0, k + 1, 0), axis=(1, 0, 0))
    ball.velocity = 2, 0, 0
    slider.apply_effort(1.0)
    world.step(STEP)
    assert slider.speed == pytest.approx(2.0 + STEP / ball.mass, rel=1e-12)
    assert slider.position == pytest.approx(ball.position[0], rel=1e-12)
    world.restore(then)
    assert (slider.speed, ball.velocity[0], slider.position) == (1.0, 1.0, 0.0)
    world.restore(before)
    for read in (lambda: ball.velocity, lambda: slider.speed, lambda: slider.apply_effort(1.0)):
        with pytest.raises(ArgumentError, match=r"not in this world|of another world|was removed"):
            read()


def push(position, force):
    for body in range(len(force)):
        force[body, 0] += 100.0


CHANGES = {
    "substeps": lambda world: setattr(world, "substeps", 9),
    "force": lambda world: world.add_force(push),
    "bouncing body": lambda world: world.add_sphere(0.1, position=(0, 0, 0.36), velocity=(0, 0, -5), restitution=1.0),
    "new kind of shape": lambda world: world.add_capsule(0.1, 0.1, position=(0, 0, 0.3)),
    "restitution": lambda world: setattr(world.body("faller"), "restitution", 1.0),
    "sleeping": lambda world: setattr(world, "sleeping", True),
}


@pytest.mark.parametrize("change", CHANGES)
def test_the_next_step_minds_what_was_changed(change):
    def falling():
        world = kd.World(sleep_speed=0.5, sleep_time=STEP)
        world.add_plane()
        world.add_sphere(0.2, position=(0, 0, 0.2), velocity=(0.1, 0, 0))
        world.add_sphere(0.2, position=(2, 0, 0.3), velocity=(0, 0, -5), name="faller")
        world.step(STEP / 8)
        return world

    worlds = [falling() for _ in range(3)]
    for world in worlds[:2]:
        CHANGES[change](world)
    worlds[1].restore(worlds[1].snapshot())  # after which the step is put together anew
    for world in worlds:
        for _ in range(24):
            world.step(STEP / 8)
    first, second, without = (world.position[:4].copy() for world in worlds)
    assert np.array_equal(first, second)
    assert not np.array_equal(first, without)


def test_handles_are_equal_where_they_are_of_one_body():
    world = kd.World()
    ball, box = world.add_sphere(0.1), world.add_box((1, 1, 1))
    assert ball == world.bodies.handle(ball.index) != box
    assert {ball: 1}[world.bodies.handle(ball.index)] == 1
    assert ball != (ball.index, ball.generation)
    assert ball != world.add_ball_joint(ball, None, anchor=(0, 0, 0))
    assert copy.copy(ball) is ball
    assert ball != kd.World().ground


def two_worlds():
    """Worlds of which each has a ball in row 1."""
    worlds = kd.World(), kd.World()
    return *worlds, *(world.add_sphere(0.1, position=(0, 0, 5)) for world in worlds)


@pytest.mark.parametrize(
    "use",
    [
        lambda world, body: world.remove(body),
        lambda world, body: world.apply_force(body, (1, 0, 0)),
        lambda world, body: world.add_hinge(None, body, anchor=(0, 0, 0), axis=(1, 0, 0)),
        lambda world, body: world.exclude(world.ground, body),
        lambda world, body: world.ray_cast((0, 0, 0), (0, 0, 1), ignore=body),
    ],
)
def test_a_body_of_another_world_is_refused(use):
    world, other, ball, others = two_worlds()
    assert ball != others
    with pytest.raises(ArgumentError, match="of another world"):
        use(world, others)
    use(other, others)


class Lamp(kd.World):
    """A world that takes an argument, and keeps its handles."""

    def __init__(self, height):
        super().__init__(sleeping=True)
        self.height = height
        self.bulb = self.add_sphere(0.1, position=(0, 0, height), name="bulb")
        self.cord = self.add_distance_joint(None, self.bulb, anchor_a=(1, 0, height + 1), anchor_b=(0, 0, height))


def whole(way):
    return {"deepcopy": copy.deepcopy, "pickle": lambda what: pickle.loads(pickle.dumps(what))}[way]


@pytest.mark.parametrize("way", ["copy", "deepcopy", "pickle"])
def test_a_copied_world_goes_on_by_itself_with_the_same_bits(way):
    lamp = Lamp(3.0)
    lamp.advance(STEP, 20)
    again = copy.copy(lamp) if way == "copy" else whole(way)(lamp)
    assert type(again) is Lamp
    assert (again.height, again.time, again.body("bulb").name) == (3.0, lamp.time, "bulb")
    before = lamp.position.copy()
    again.advance(STEP, 30)
    assert np.array_equal(lamp.position, before)
    lamp.advance(STEP, 30)
    assert np.array_equal(lamp.position, again.position)
    assert not np.array_equal(lamp.position, before)


@pytest.mark.parametrize("way", ["deepcopy", "pickle"])
def test_handles_that_are_copied_with_their_world_belong_to_the_copy(way):
    lamp = Lamp(3.0)
    parts = {"first": lamp.bulb, "lamp": lamp, "cord": lamp.cord, "gone": lamp.add_sphere(0.1)}
    lamp.remove(parts["gone"])
    again = whole(way)(parts)
    assert again["first"] == again["lamp"].bulb != lamp.bulb
    assert again["cord"] == again["lamp"].cord != lamp.cord
    again["first"].position = 0, 0, 7
    assert again["lamp"].position[1, 2] == 7 != lamp.position[1, 2]
    with pytest.raises(ArgumentError, match="was removed"):
        again["gone"].velocity = 0, 0, 0
    alone = whole(way)(lamp.bulb)
    assert np.array_equal(alone.position, lamp.bulb.position)


def test_a_handle_of_a_world_that_is_gone_is_not_copied():
    bulb = Lamp(3.0).bulb
    gc.collect()
    with pytest.raises(TypeError, match="belongs to a world that no longer exists"):
        pickle.dumps(bulb)


def pull(position, force):
    for body in range(len(force)):
        force[body, 0] -= position[body, 0]


def test_snapshots_and_worlds_with_forces_are_pickled_with_the_functions():
    lamp = Lamp(3.0)
    lamp.add_force(pull)
    lamp.advance(STEP, 20)
    snapshot = pickle.loads(pickle.dumps(lamp.snapshot()))
    again = pickle.loads(pickle.dumps(lamp))
    lamp.advance(STEP, 20)
    again.advance(STEP, 20)
    assert np.array_equal(lamp.position, again.position)
    again.restore(snapshot)
    again.advance(STEP, 20)
    assert np.array_equal(lamp.position, again.position)
    with pytest.raises(ValueError, match="read-only"):
        snapshot.tables["POSE"][0, 0] = 1.0


def test_contact_points_are_where_bodies_press_on_each_other():
    world = kd.World()
    assert world.contact_points.shape == (0, 3)
    world.add_plane()
    box = world.add_box((2, 4, 1), position=(1, 2, 0.5), mass=1.0)
    ball = world.add_sphere(0.5, position=(1, 2, 1.5), mass=1.0)
    world.add_box((9, 9, 9), static=True, sensor=True)
    world.advance(1 / 60, 30)
    points = {tuple(point) for point in world.contact_points.round(2) + 0.0}
    assert points == {(0, 0, 0), (0, 4, 0), (2, 0, 0), (2, 4, 0), (1, 2, 1)}
    box.position, ball.position = (0, 0, 5), (0, 0, 9)
    world.step(1 / 60)
    assert len(world.contact_points) == 0
