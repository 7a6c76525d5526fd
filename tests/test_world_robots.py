"""Robots from MJCF and URDF: what MuJoCo makes of the files is what the world has, and moves like it."""

import re
import sys
from pathlib import Path

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

from robot_references import falls, reference  # noqa: E402

from kickdrift.core.errors import ArgumentError, FileFormatError, MissingExtraError  # noqa: E402
from kickdrift.io.robot_file import load_robot  # noqa: E402
from kickdrift.io.robots.omissions import gathered  # noqa: E402
from kickdrift.io.world_file import load_world  # noqa: E402
from kickdrift.world.joints import layout  # noqa: E402
from kickdrift.world.joints.layout import ANCHOR_A, ANCHOR_B, BODY_A, BODY_B, FRAME_A, LOWER_LIMIT, UPPER_LIMIT  # noqa: E402
from kickdrift.world.joints.limits_motors_options import Drive  # noqa: E402
from kickdrift.world.shapes.mass_properties import rotation_matrix  # noqa: E402
from kickdrift.world.shapes.plane import Plane  # noqa: E402
from kickdrift.world.shapes.sphere import Sphere  # noqa: E402
from kickdrift.world.tables import ASKED_APART, INERTIA, JOINT, JOINT_AXES, JOINT_NUMBERS, SHAPE  # noqa: E402
from kickdrift.world.world import World  # noqa: E402

FILES = Path(__file__).parent / "data" / "robots"
NAMES = ["arm.xml", "arm.urdf", "quadruped.xml", "quadruped.urdf"]


def text(tmp_path, inside, rest="", name="robot.xml"):
    path = tmp_path / name
    path.write_text(f"<mujoco><worldbody>{inside}</worldbody>{rest}</mujoco>")
    return path


BALL = '<geom size="0.1" mass="1"/>'


@pytest.mark.parametrize("name", NAMES)
def test_masses_centres_and_inertias_are_those_of_mujoco(name):
    floating = name == "quadruped.urdf"
    robot = load_robot(FILES / name, floating=floating)
    model, data = reference(FILES / name, floating)
    table, moved = robot.world.tables.array(INERTIA), 0.0
    for head in np.unique(model.body_weldid)[1:]:
        members = np.flatnonzero(model.body_weldid == head)
        masses, centres = model.body_mass[members], data.xipos[members]
        total, centre = masses.sum(), masses @ centres / masses.sum()
        inertia = np.zeros((3, 3))
        for body, mass, arm in zip(members, masses, centres - centre, strict=True):
            axes = data.ximat[body].reshape(3, 3)
            inertia += axes @ np.diag(model.body_inertia[body]) @ axes.T
            inertia += mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        handles = {robot.bodies[model.body(body).name] for body in members}
        assert len(handles) == 1
        row = handles.pop().index
        turn = rotation_matrix(robot.world.orientation[row])
        xx, yy, zz, xy, xz, yz = table[row, 1:7]
        here = turn @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ turn.T
        np.testing.assert_allclose(robot.world.position[row], centre, 0.0, 1e-12)
        np.testing.assert_allclose(turn, data.xmat[head].reshape(3, 3), 0.0, 1e-12)
        np.testing.assert_allclose(here, inertia, 0.0, 1e-12)
        assert table[row, 0] == pytest.approx(total, rel=1e-12)
        moved += table[row, 0]
    assert moved == pytest.approx(model.body_mass[model.body_weldid > 0].sum(), rel=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_anchors_and_axes_are_those_of_mujoco(name):
    floating = name == "quadruped.urdf"
    robot = load_robot(FILES / name, floating=floating)
    model, data = reference(FILES / name, floating)
    world = robot.world
    hinges = [row for row in range(model.njnt) if int(model.jnt_type[row]) == int(mujoco.mjtJoint.mjJNT_HINGE)]
    assert list(robot.joints) == [model.joint(row).name for row in hinges]
    for row in hinges:
        joint = robot.joints[model.joint(row).name]
        numbers = world.tables.array(JOINT_NUMBERS)[joint.index]
        parent, child = world.tables.array(JOINT)[joint.index, [BODY_A, BODY_B]]
        assert child == robot.bodies[model.body(model.jnt_bodyid[row]).name].index
        for body, column in ((parent, ANCHOR_A), (child, ANCHOR_B)):
            anchor = world.position[body] + rotation_matrix(world.orientation[body]) @ numbers[column : column + 3]
            np.testing.assert_allclose(anchor, data.xanchor[row], 0.0, 1e-12)
        frame = rotation_matrix(world.orientation[parent]) @ rotation_matrix(numbers[FRAME_A : FRAME_A + 4])
        np.testing.assert_allclose(frame[:, 2], data.xaxis[row], 0.0, 1e-12)
        law = world.tables.array(JOINT_AXES)[6 * joint.index + robot.axes[model.joint(row).name]]
        limits = model.jnt_range[row] if model.jnt_limited[row] else (-np.inf, np.inf)
        np.testing.assert_array_equal(law[[LOWER_LIMIT, UPPER_LIMIT]], limits)
        assert law[layout.JOINT_FRICTION] == model.dof_frictionloss[model.jnt_dofadr[row]]
        assert robot.axes[model.joint(row).name] == 5
        assert joint.angle == 0.0


def test_a_place_moves_and_turns_everything():
    there = load_robot(FILES / "arm.xml")
    turn = np.array([0.8, 0.0, 0.6, 0.0])
    moved = load_robot(FILES / "arm.xml", position=(1.0, 2.0, 3.0), orientation=turn)
    for name in ("upper", "lower"):
        row = there.bodies[name].index
        expected = (1.0, 2.0, 3.0) + rotation_matrix(turn) @ there.world.position[row]
        np.testing.assert_allclose(moved.world.position[row], expected, 0.0, 1e-12)
    columns = [*range(ANCHOR_B, ANCHOR_B + 3)]
    before, after = (robot.world.tables.array(JOINT_NUMBERS) for robot in (there, moved))
    np.testing.assert_allclose(after[:, columns], before[:, columns], 0.0, 1e-12)


def swing(path, duration, steps):
    """Angles of both, from the same pose and speeds."""
    model, data = reference(path)
    model.opt.timestep, model.opt.integrator = duration / 4000, mujoco.mjtIntegrator.mjINT_RK4
    model.dof_damping[:], model.dof_frictionloss[:] = 0.0, 0.0
    for _ in range(4000):
        mujoco.mj_step(model, data)
    errors = []
    for count in steps:
        robot = load_robot(path)
        for joint in robot.joints.values():
            joint.set_drive(None)
            joint.set_friction(0.0)
        robot.world.advance(duration / count, count)
        errors.append(max(abs(joint.angle - q) for joint, q in zip(robot.joints.values(), data.qpos, strict=True)))
    return np.array(errors), np.abs(data.qpos).min()


@pytest.mark.parametrize("name", ["arm.xml", "arm.urdf"])
def test_arms_swing_as_in_mujoco(name):
    """A double pendulum in space: the error falls with the step, from one that is small already."""
    errors, moved = swing(FILES / name, 0.4, (100, 400))
    assert moved > 0.3
    assert errors[0] < 2e-3
    assert errors[1] < 0.3 * errors[0]


def test_what_floats_falls_and_springs_and_servos_act_as_in_mujoco(tmp_path):
    inside = """<body name="trunk" quat="0.9 0.1 0.3 0.2"><freejoint/>
      <inertial pos="0.1 0 0" mass="2" diaginertia="0.05 0.06 0.03"/>
      <body name="a" pos="0.2 0 0"><joint name="spring" axis="0 1 0" stiffness="3" springref="40" damping="0.05"/>
        <inertial pos="0 0 -0.2" mass="0.5" diaginertia="0.01 0.01 0.002"/></body>
      <body name="b" pos="-0.2 0 0"><joint name="servo" axis="1 0 1" damping="0.1" ref="20"/>
        <inertial pos="0 0.1 -0.2" mass="0.7" diaginertia="0.01 0.02 0.012"/></body></body>"""
    path = text(tmp_path, inside, '<actuator><position name="s" joint="servo" kp="2" kv="0.02" gear="1.5"/></actuator>')
    model, data = reference(path)
    model.opt.timestep, model.opt.integrator = 1e-4, mujoco.mjtIntegrator.mjINT_RK4
    for _ in range(3000):
        mujoco.mj_step(model, data)
    errors = []
    for count in (100, 400):
        robot = load_robot(path)
        robot.world.advance(0.3 / count, count)
        angles = [
            robot.joints["spring"].angle - data.qpos[7],
            robot.joints["servo"].angle + np.radians(20) - data.qpos[8],
        ]
        places = [
            robot.world.position[robot.bodies[name].index] - data.body(name).xipos for name in ("trunk", "a", "b")
        ]
        errors.append(max(np.abs(angles).max(), np.abs(places).max()))
    assert np.abs(data.qpos[7:]).max() > 0.2
    assert errors[0] < 5e-3
    assert errors[1] < 0.3 * errors[0]


def test_motors_and_servos_can_be_read_and_set(tmp_path):
    inside = f'<body><joint name="j" axis="0 1 0" damping="0.5" stiffness="3" springref="0.2"/>{BALL}</body>'
    rest = """<compiler angle="radian"/><actuator>
      <position name="p" joint="j" kp="10" kv="1" gear="2" forcerange="-4 4" ctrlrange="-1 1"/>
      <motor name="m" joint="j" gear="3"/></actuator>"""
    robot = load_robot(text(tmp_path, inside, rest))
    servo, motor = robot.actuators["p"], robot.actuators["m"]
    assert (servo.servo, motor.servo, motor.gear, motor.gain, motor.maximum) == (True, False, 3.0, 1.0, np.inf)
    assert servo.control_range == (-1.0, 1.0)
    assert robot.joints["j"].axis() == 5
    drive = servo.drive(0.3)
    # kp gear^2 + stiffness; kv gear^2 + damping; gear kp u + stiffness springref
    assert drive.stiffness == pytest.approx(43.0)
    assert drive.damping == pytest.approx(4.5)
    assert drive.target == pytest.approx((6.0 + 0.6) / 43.0)
    assert drive.maximum == 8.0
    assert any("maximum force" in note for note in robot.notes)
    with pytest.raises(ArgumentError, match="control=1"):
        motor.drive(1.0)
    assert motor.effort(0.5) == 1.5
    robot.joints["j"].apply_effort(motor.effort(0.5))
    robot.world.step(1e-3)
    assert robot.joints["j"].speed != 0.0
    with pytest.raises(ArgumentError, match="servo"):
        servo.effort(1.0)
    assert servo.drive(9.0) == servo.drive(1.0)
    assert servo.drive(-9.0) == servo.drive(-1.0)
    velocity = f'<body><joint name="j" axis="0 1 0"/>{BALL}</body>'
    path = text(tmp_path, velocity, '<actuator><velocity name="v" joint="j" kv="2"/></actuator>')
    assert load_robot(path).actuators["v"].drive(1.5) == Drive(damping=2.0, speed=1.5)


def test_a_servo_without_a_gear_does_nothing(tmp_path):
    inside = f'<body><joint name="j" axis="0 1 0"/>{BALL}</body>'
    rest = '<actuator><position name="p" joint="j" kp="10" gear="0"/></actuator>'
    robot = load_robot(text(tmp_path, inside, rest))
    assert robot.joints["j"].drive() is None
    assert robot.actuators["p"].effort(1.0) == 0.0


def test_controls_and_efforts_are_clipped_as_in_mujoco(tmp_path):
    inside = f'<body><joint name="j" axis="0 1 0" actuatorfrcrange="-50 5"/>{BALL}</body>'
    motors = {"control": 'gear="3" ctrlrange="-0.4 0.5"', "force": 'gear="-3" forcerange="-1 20"', "free": 'gear="100"'}
    rest = "".join(f'<motor name="{name}" joint="j" {numbers}/>' for name, numbers in motors.items())
    rest += '<general name="general" joint="j" gainprm="2" biasprm="0.3 0 0" biastype="affine" ctrlrange="-1 1"/>'
    path = text(tmp_path, inside, f"<actuator>{rest}</actuator>")
    model, data = reference(path)
    robot = load_robot(path)
    for name in (*motors, "general"):
        for control in (-30.0, -0.6, -0.2, 0.0, 0.45, 0.7, 30.0):
            data.ctrl[:] = 0.0
            data.ctrl[model.actuator(name).id] = control
            mujoco.mj_forward(model, data)
            general = 0.0 if name == "general" else 0.3  # which is there at the control zero
            if -50.0 < data.qfrc_actuator[0] < 5.0:
                assert robot.actuators[name].effort(control) == pytest.approx(
                    data.qfrc_actuator[0] - general, abs=1e-12
                )
            else:
                assert robot.actuators[name].effort(control) == data.qfrc_actuator[0]
    off = text(tmp_path, inside, f"<option><flag clampctrl='disable'/></option><actuator>{rest}</actuator>")
    assert load_robot(off).actuators["control"].effort(-2.0) == -6.0


def test_joints_between_the_same_two_bodies_are_one(tmp_path):
    planar = f"""<body name="b" pos="0 0 1"><joint name="x" type="slide" axis="1 0 0" range="-1 2" limited="true"/>
      <joint name="z" type="slide" axis="0 0 1"/><joint name="turn" axis="0 1 0" damping="0.5"/>{BALL}</body>"""
    robot = load_robot(text(tmp_path, planar))
    assert len(set(robot.joints.values())) == 1
    joint, world = robot.joints["x"], robot.world
    frame = world.tables.array(JOINT_NUMBERS)[joint.index, layout.AXES : layout.AXES + 18].reshape(6, 3)
    for name, way in (("x", (1, 0, 0)), ("z", (0, 0, 1)), ("turn", (0, 1, 0))):
        np.testing.assert_allclose(frame[robot.axes[name]], way, 0.0, 1e-12)
    law = world.tables.array(JOINT_AXES)[6 * joint.index + robot.axes["x"]]
    np.testing.assert_array_equal(law[[LOWER_LIMIT, UPPER_LIMIT]], (-1.0, 2.0))
    assert world.tables.array(JOINT)[joint.index, layout.LOCKED].bit_count() == 3
    cross = f'<body><joint name="u" axis="1 0 0"/><joint name="v" axis="0 0 1"/>{BALL}</body>'
    robot = load_robot(text(tmp_path, cross))
    frame = robot.world.tables.array(JOINT_NUMBERS)[0, layout.AXES : layout.AXES + 18].reshape(6, 3)
    np.testing.assert_allclose(frame[robot.axes["u"]], (1, 0, 0), 0.0, 1e-12)
    np.testing.assert_allclose(frame[robot.axes["v"]], (0, 0, 1), 0.0, 1e-12)


SEVERAL = {
    "three hinges through one point": ('axis="1 0 0"', 'axis="0 0 1"', 'axis="0 1 0" damping="0.01"'),
    "hinges askew and apart": (
        'axis="1 0.2 0"',
        'axis="1 1 0" pos="0 0.1 0" stiffness="2"',
        'axis="0 1 1" pos="0.1 0 0"',
    ),
    "a hinge that turns slides": (
        'axis="0 1 0"',
        'type="slide" axis="1 0 0"',
        'type="slide" axis="1 1 0" stiffness="30"',
    ),
    "a ball that slides": ('type="ball"', 'type="slide" axis="0.3 0 1" stiffness="50" damping="1"'),
}
LIMB = """<body name="limb" pos="0.1 0 1" quat="0.9 0 0 0.3">{}
  <inertial pos="0.02 0.05 -0.2" mass="0.7" fullinertia="0.012 0.01 0.004 0.001 0 0.0005"/></body>"""


def limb(tmp_path, joints, armatures=()):
    """A body that hangs at the world by several joints."""
    rotors = [*armatures, *[0.0] * len(joints)]
    lines = [f'<joint name="j{k}" {joint} armature="{rotors[k]}"/>' for k, joint in enumerate(joints)]
    return text(tmp_path, LIMB.format("".join(lines)))


@pytest.mark.parametrize("joints", SEVERAL.values(), ids=SEVERAL)
def test_several_joints_at_one_body_move_as_in_mujoco(tmp_path, joints):
    path = limb(tmp_path, joints)
    there, errors = falls(path)
    assert np.abs(there).max() > 0.1
    assert errors[0] < 5e-3
    assert errors[1] < 0.3 * errors[0]
    robot = load_robot(path)
    assert set(robot.joints) == {f"j{k}" for k in range(len(joints))}
    assert set(robot.between) <= set(robot.joints)
    assert sum("moves a small intermediate body" in note for note in robot.notes) == 1


@pytest.mark.parametrize("joints", SEVERAL.values(), ids=SEVERAL)
def test_small_bodies_take_nothing_from_the_whole(tmp_path, joints):
    robot = load_robot(limb(tmp_path, joints))
    _, data = reference(limb(tmp_path, joints))
    world, numbers = robot.world, robot.world.tables.array(INERTIA)
    rows = world.bodies.moving()
    assert len(rows) == 1 + len(robot.between)
    masses, centres = numbers[rows, 0], world.position[rows]
    assert masses.sum() == pytest.approx(0.7, rel=1e-14)
    assert masses.max() > 0.999 * masses.sum()
    np.testing.assert_allclose(masses @ centres / masses.sum(), data.body("limb").xipos, 0.0, 1e-14)
    total = np.zeros((3, 3))
    for row, mass, arm in zip(rows, masses, centres - data.body("limb").xipos, strict=True):
        xx, yy, zz, xy, xz, yz = numbers[row, 1:7]
        turn = rotation_matrix(world.orientation[row])
        total += turn @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ turn.T
        total += mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    axes = data.body("limb").ximat.reshape(3, 3)
    expected = axes @ np.diag(reference(limb(tmp_path, joints))[0].body("limb").inertia) @ axes.T
    np.testing.assert_allclose(total, expected, 0.0, 1e-15)


@pytest.mark.parametrize(
    ("joints", "armatures"),
    [
        (("axis='0.3 1 0'",), (0.05,)),
        (("axis='1 0 0'", "axis='0 1 0'"), (0.05,)),
        (("type='slide' axis='1 0 0'", "axis='0 1 0'"), (0.5,)),
    ],
    ids=["hinge", "first of two hinges", "slide at right angles to gravity"],
)
def test_rotors_resist_as_in_mujoco(tmp_path, joints, armatures):
    path = limb(tmp_path, joints, armatures)
    there, errors = falls(path)
    without, _ = falls(limb(tmp_path, joints))
    assert np.abs(there - without).max() > 0.01
    assert errors.max() < 5e-6


def test_the_rotor_of_a_second_slide_is_left_out(tmp_path):
    robot = load_robot(limb(tmp_path, ("type='slide' axis='1 0 0'", "type='slide' axis='0 1 0'"), (0.0, 0.5)))
    assert any("left out: armature of joint 'j1'" in note for note in robot.notes)
    assert robot.world.tables.array(INERTIA)[robot.world.bodies.moving(), 0].sum() == pytest.approx(0.7, rel=1e-12)


def test_rotors_whose_parents_turn_are_said_to_resist_that_too(tmp_path):
    inside = f'<body><joint name="a" axis="0 1 0" armature="1"/>{BALL}<body>{{}}{BALL}</body></body>'
    robot = load_robot(text(tmp_path, inside.format('<joint name="b" axis="0 1 0" armature="2"/>')))
    assert [note for note in robot.notes if "armature" in note] == [
        "armature of joint 'b' is added to the inertia of what it moves, so that it also resists rotation of the parent"
    ]
    about_y = robot.world.tables.array(INERTIA)[robot.world.bodies.moving(), 2]
    np.testing.assert_allclose(about_y, 0.4 * 0.1**2 + np.array([1.0, 2.0]), rtol=1e-12)


TWO = f'<body name="a"><joint axis="0 1 0"/>{BALL}<body name="b" pos="1 0 0"><joint axis="0 1 0"/>{BALL}</body></body>'


def test_connect_and_weld_close_loops(tmp_path):
    rest = """<equality><connect name="c" body1="b" anchor="0.5 0 0"/><weld name="w" body1="a" body2="b"/>
      <joint name="gear" joint1="joint" active="false"/></equality>"""
    inside = TWO.replace("<joint axis", '<joint name="joint" axis', 1)
    robot = load_robot(text(tmp_path, inside, rest))
    world, (c, w) = robot.world, (robot.closures["c"].index, robot.closures["w"].index)
    numbers, joints = world.tables.array(JOINT_NUMBERS), world.tables.array(JOINT)
    rows = [robot.bodies[name].index for name in ("a", "b")]
    assert joints[c, [BODY_A, BODY_B]].tolist() == [rows[1], 0]
    np.testing.assert_allclose(numbers[c, ANCHOR_B : ANCHOR_B + 3], (1.5, 0, 0), 0.0, 1e-12)
    np.testing.assert_allclose(numbers[c, ANCHOR_A : ANCHOR_A + 3], (0.5, 0, 0), 0.0, 1e-12)
    assert joints[c, layout.LOCKED] == 7
    assert joints[w, [BODY_A, BODY_B]].tolist() == rows
    assert joints[w, layout.LOCKED] == 63
    assert any("'gear' is left out" in note for note in robot.notes)


def test_a_loop_that_is_open_is_refused(tmp_path):
    path = text(tmp_path, TWO, '<equality><weld body1="a" body2="b" relpose="1 0 0.1 1 0 0 0"/></equality>')
    with pytest.raises(ArgumentError, match=r"violated by 0\.1 m"):
        load_robot(path)


def test_parents_and_excluded_bodies_do_not_touch(tmp_path):
    inside = TWO + f'<body name="c" pos="0 3 0"><freejoint/>{BALL}</body>'
    rest = '<contact><exclude body1="c" body2="b"/></contact>'
    world = World()
    first = load_robot(text(tmp_path, inside, rest), world)
    second = load_robot(text(tmp_path, inside, rest), world, position=(0.0, 0.0, 5.0))
    pairs = [[robot.bodies[name].index for name in names] for robot in (first, second) for names in ("ab", "bc")]
    assert world.tables.array(ASKED_APART).tolist() == sorted(pairs)
    flag = '<option><flag filterparent="disable"/></option>'
    assert len(load_robot(text(tmp_path, TWO, flag)).world.tables.array(ASKED_APART)) == 0


def test_links_of_a_urdf_do_not_touch_the_base_that_they_hang_at(tmp_path):
    ball = "<collision><geometry><sphere radius='0.2'/></geometry></collision>"
    hinges = "".join(
        f'<joint name="{b}" type="continuous"><parent link="{a}"/><child link="{b}"/><axis xyz="0 1 0"/></joint>'
        for a, b in ("ab", "bc")
    )
    links = "".join(link((1, 1, 1), shapes=ball, name=name) for name in "abc")
    path = tmp_path / "robot.urdf"
    path.write_text(f"<robot name='r'>{links}{hinges}</robot>")
    robot = load_robot(path)
    a, b, c = (robot.bodies[name].index for name in "abc")
    assert robot.world.tables.array(ASKED_APART).tolist() == [[a, b], [b, c]]
    assert [note for note in robot.notes if "overlap" in note] == [
        "bodies 'a', 'c' overlap by 0.4 m in the reference pose and will push each other apart; move or exclude them"
    ]
    path.write_text(
        f"<robot name='r'>{link((1, 1, 1), name='a')}{links[len(link((1, 1, 1), shapes=ball)) :]}{hinges}</robot>"
    )
    assert load_robot(path).world.tables.array(ASKED_APART).min() > 0


def test_layers_meet_where_bit_masks_do(tmp_path):
    masks = [(1, 1), (2, 1), (0, 1), (4, 4), (2, 2), (1, 0)]
    inside = "".join(
        f'<geom name="g{k}" size="0.1" pos="{k} 0 0" contype="{a}" conaffinity="{b}"/>'
        for k, (a, b) in enumerate(masks)
    )
    for world in (World(), World()):
        world.add_sphere(0.1)
        if world.tables.array(SHAPE).size:
            world.add_sphere(0.1, layer=3)
        load_robot(text(tmp_path, inside), world)
        rows = world.tables.array(SHAPE)[2:, [4, 5]]
        for i, (a, b) in enumerate(masks):
            for j, (c, d) in enumerate(masks):
                met = bool(rows[i, 0] & rows[j, 1]) and bool(rows[j, 0] & rows[i, 1])
                assert met == bool(a & d or b & c)
        strangers = [bool(row[1] & 1 << 3) for row in rows]
        assert strangers == [bool(a | b) and bool((a | b) & 1) for a, b in masks]


def test_geoms_become_shapes(tmp_path):
    cube = " ".join(f"{x} {y} {z}" for x in (-1, 1) for y in (-1, 1) for z in (-1, 1))
    heights = "0 0.5 1 0 0.25 0.5"
    inside = """<geom type="hfield" hfield="h" pos="0 0 -3"/><geom type="plane" size="1 1 1" pos="0 0 -9"/>
      <body name="b"><freejoint/><geom type="mesh" mesh="m"/><geom type="cylinder" size="0.1 0.2" pos="3 0 0"/>
      <geom type="ellipsoid" size="0.1 0.2 0.3" pos="6 0 0"/><geom type="capsule" size="0.1 0.2" pos="9 0 0"/>
      <geom type="box" size="0.1 0.2 0.3" pos="12 0 0"/><geom size="0.5" contype="0" conaffinity="0"/></body>"""
    assets = f'''<asset><mesh name="m" vertex="{cube}"/>
      <hfield name="h" nrow="2" ncol="3" size="2 1 0.4 0.1" elevation="{heights}"/></asset>'''
    robot = load_robot(text(tmp_path, inside, assets))
    *shapes, shown = [placed.shape for placed in robot.world.shape_rows.shapes.values()]
    kinds = [type(shape).__name__ for shape in shapes]
    assert kinds == ["HeightField", "Plane", "Hull", "Cylinder", "Hull", "Capsule", "Box"]
    assert shown.radius == 0.5
    terrain, _, mesh, cylinder, ellipsoid, capsule, box = shapes
    assert terrain.heights.shape == (3, 2)
    assert terrain.spacing == (2.0, 2.0)
    assert terrain.heights.max() == pytest.approx(0.4)
    assert mesh.mass_properties().volume == pytest.approx(8.0)
    assert (cylinder.radius, cylinder.length) == (0.1, 0.4)
    assert ellipsoid.mass_properties().volume == pytest.approx(4 / 3 * np.pi * 0.006, rel=0.1)
    assert (capsule.radius, capsule.length) == (0.1, 0.4)
    np.testing.assert_allclose(box.numbers, (0.1, 0.2, 0.3))
    assert sum("collides as" in note for note in robot.notes) == 2


def test_includes_and_classes_count(tmp_path):
    (tmp_path / "parts").mkdir()
    part = (
        '<body name="b" childclass="light"><joint class="stiff"/><geom type="capsule" fromto="0 0 0 0.3 0 0.4"/></body>'
    )
    (tmp_path / "parts" / "arm.xml").write_text(f"<mujocoinclude>{part}</mujocoinclude>")
    classes = '<default class="light"><geom size="0.05" mass="3"/><joint damping="1"/></default>'
    classes += '<default class="stiff"><joint axis="0 1 0" damping="2" range="-10 20"/></default>'
    rest = f"<default>{classes}</default>"
    robot = load_robot(text(tmp_path, '<include file="parts/arm.xml"/>', rest))
    (placed,) = robot.world.shape_rows.shapes.values()
    assert (placed.shape.radius, placed.shape.length) == (0.05, pytest.approx(0.5))
    assert robot.world.tables.array(INERTIA)[robot.bodies["b"].index, 0] == pytest.approx(3.0)
    law = robot.world.tables.array(JOINT_AXES)[6 * robot.joints["joint 0"].index + 5]
    np.testing.assert_allclose(
        law[[LOWER_LIMIT, UPPER_LIMIT, layout.DRIVE_DAMPING]], [np.radians(-10), np.radians(20), 2.0]
    )


def test_what_is_for_show_is_drawn_and_touches_nothing(tmp_path):
    inside = """<geom type="plane" size="1 1 1"/><body name="b" pos="0 0 0.1"><freejoint/>
      <inertial pos="0 0 0.03" mass="2" diaginertia="0.01 0.01 0.01"/>
      <geom size="0.1"/><geom size="0.1" contype="0" conaffinity="0"/>
      <geom size="0.2" pos="0 0 0.3" contype="0" conaffinity="0"/>
      <geom size="0.4" pos="0 0 0.3" contype="0" conaffinity="0" group="3"/></body>
      <body pos="5 0 0"><geom size="0.3" contype="0" conaffinity="0"/></body>"""
    robot = load_robot(text(tmp_path, inside))
    world, row = robot.world, robot.bodies["b"].index
    recording = world.run(1.0, step=0.01)
    drawn = [part.shape.radius for part in recording.appearance.parts if part.body == row]
    assert drawn == [0.1, 0.2]
    assert world.position[row, 2] == pytest.approx(0.13, abs=5e-3)
    assert world.ray_cast((0.0, 0.0, 3.0), (0.0, 0.0, -1.0)).distance == pytest.approx(2.8, abs=5e-3)
    assert world.ray_cast((5.0, 0.0, 3.0), (0.0, 0.0, -1.0)).distance == pytest.approx(3.0)
    assert world.overlap_sphere(0.05, (0.0, 0.0, 0.45)) == []
    again = load_world(world.save(tmp_path / "world.npz"))
    assert [type(placed.shape) for placed in again.shape_rows.shapes.values()] == [Plane, Sphere, Sphere, Sphere]
    count = len(world.shape_rows.shapes)
    world.remove(robot.bodies["b"])
    assert len(world.shape_rows.shapes) == count - 2
    world.add_sphere(0.1)
    world.step(0.01)


def test_visuals_of_links_are_drawn_where_mujoco_can(tmp_path):
    path = tmp_path / "robot.urdf"
    shapes = (
        BOX.format("collision") + BOX.format("visual") + "<visual><geometry><sphere radius='0.7'/></geometry></visual>"
    )
    path.write_text(f"<robot name='r'>{link((1, 1, 1), shapes=shapes)}</robot>")
    robot = load_robot(path, floating=True)
    box, ball = (placed for placed in robot.world.shape_rows.shapes.values())
    assert ball.shape.radius == 0.7
    np.testing.assert_allclose(box.shape.numbers, (0.1, 0.2, 0.3))
    assert robot.world.tables.array(INERTIA)[robot.bodies["a"].index, 0] == 2.0
    assert robot.notes == ()
    path.write_text(path.read_text().replace("<sphere radius='0.7'/>", "<mesh filename='missing.dae'/>"))
    robot = load_robot(path, floating=True)
    assert len(robot.world.shape_rows.shapes) == 1
    assert any("visual geom" in note and "missing.dae" in note for note in robot.notes)


def test_surfaces_have_the_friction_of_their_geoms(tmp_path):
    inside = """<body><freejoint/><geom size="0.1" friction="0.7 0.1 0.05"/>
      <geom size="0.1" pos="1 0 0" friction="0.4 0.1 0.05" condim="6"/><geom size="0.1" pos="2 0 0" condim="1"/></body>"""
    robot = load_robot(text(tmp_path, inside))
    surfaces = [placed.surface for placed in robot.world.shape_rows.shapes.values()]
    assert [(s.friction, s.rolling_resistance) for s in surfaces] == [(0.7, 0.0), (0.4, 0.05), (0.0, 0.0)]
    assert any("geometric mean" in note for note in robot.notes)
    assert any("torsional" in note for note in robot.notes)


def test_the_root_of_a_urdf_is_fixed_or_floats():
    fixed, free = (load_robot(FILES / "quadruped.urdf", floating=floating) for floating in (False, True))
    assert len(fixed.world.bodies.moving()) == 12
    assert len(free.world.bodies.moving()) == 13
    assert fixed.bodies["FL_foot"] == fixed.bodies["FL_calf"]
    assert list(load_robot(FILES / "quadruped.xml").actuators)[:2] == ["FL_abduction", "FL_hip_pitch"]


def link(inertia, mass=2.0, shapes="", name="a"):
    """A link of a URDF file, whose centre of mass is not its origin."""
    moments = dict(zip(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), (*inertia, 0, 0, 0), strict=False))
    numbers = " ".join(f'{key}="{value}"' for key, value in moments.items())
    inertial = f'<inertial><origin xyz="0.1 0 0"/><mass value="{mass}"/><inertia {numbers}/></inertial>'
    return f'<link name="{name}">{inertial}{shapes}</link>'


BOX = "<{0}><geometry><box size='0.2 0.4 0.6'/></geometry></{0}>"


def test_inertias_that_are_none_come_from_the_shapes(tmp_path):
    path = tmp_path / "robot.urdf"
    path.write_text(f"<robot name='r'>{link((0, 0, 0), shapes=BOX.format('collision'))}</robot>")
    robot = load_robot(path, floating=True)
    row = robot.bodies["a"].index
    expected = np.array([0.52, 0.4, 0.2]) * 2.0 / 12.0
    np.testing.assert_allclose(robot.world.tables.array(INERTIA)[row, :7], [2.0, *expected, 0, 0, 0], 0.0, 1e-14)
    np.testing.assert_allclose(robot.world.position[row], (0.1, 0.0, 0.0), 0.0, 1e-14)
    assert any("inertia of body 'a'" in note for note in robot.notes)
    for shapes in ("", BOX.format("visual")):
        path.write_text(f"<robot name='r'>{link((1, 1, 0), shapes=shapes)}</robot>")
        with pytest.raises(FileFormatError, match="Element name 'a'"):
            load_robot(path, floating=True)


def test_inertias_beyond_those_of_bodies_are_kept(tmp_path):
    path = tmp_path / "robot.urdf"
    path.write_text(f"<robot name='r'>{link((0.1, 0.2, 0.9, 0.01, 0.02, 0.03))}</robot>")
    robot = load_robot(path, floating=True)
    numbers = robot.world.tables.array(INERTIA)[robot.bodies["a"].index, :7]
    np.testing.assert_allclose(numbers, [2.0, 0.1, 0.2, 0.9, 0.01, 0.02, 0.03], 0.0, 1e-12)
    assert any("inertia of body 'a' is impossible" in note for note in robot.notes)
    inertial = '<inertial pos="0 0 0" quat="0.8 0.6 0 0" mass="1" diaginertia="0.1 0.2 0.9"/>'
    robot = load_robot(text(tmp_path, f"<body name='b'><freejoint/>{inertial}</body>"))
    xx, yy, zz, xy, xz, yz = robot.world.tables.array(INERTIA)[robot.bodies["b"].index, 1:7]
    turn = rotation_matrix((0.8, 0.6, 0.0, 0.0))
    np.testing.assert_allclose(
        [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], turn @ np.diag((0.1, 0.2, 0.9)) @ turn.T, 0.0, 1e-14
    )


def test_materials_that_there_are_not_do_no_harm(tmp_path):
    geoms = '<geom size="0.1" material="steel"/><geom size="0.2" material="none"/>'
    rest = '<asset><material name="steel"/></asset>'
    robot = load_robot(text(tmp_path, f"<body><freejoint/>{geoms}</body>", rest))
    assert len(robot.world.shape_rows.shapes) == 2
    assert robot.notes == ("left out: material 'none', which the file does not have",)


def test_files_of_packages_are_found_above_a_robot_scaled_or_named(tmp_path):
    cube = [f"v {x} {y} {z}" for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    faces = "124 143 567 786 156 125 348 374 157 137 246 268"
    folder = tmp_path / "arm_description"
    (folder / "meshes").mkdir(parents=True)
    (folder / "urdf").mkdir()
    (folder / "meshes" / "cube.obj").write_text("\n".join([*cube, *("f " + " ".join(face) for face in faces.split())]))
    path = folder / "urdf" / "arm.urdf"
    for package in ("arm_description/", ""):
        mesh = f"<geometry><mesh filename='package://{package}meshes/cube.obj' scale='0.5 1 2'/></geometry>"
        path.write_text(f"<robot name='r'>{link((1, 1, 1), shapes=f'<collision>{mesh}</collision>')}</robot>")
        (placed,) = load_robot(path, folder=folder).world.shape_rows.shapes.values()
        assert placed.shape.mass_properties().volume == pytest.approx(8.0)
    path.write_text(path.read_text().replace("cube.obj", "ball.obj"))
    with pytest.raises(FileFormatError, match=r"meshes/ball\.obj"):
        load_robot(path)


def test_gravity_is_that_of_the_file_or_of_the_world(tmp_path):
    path = text(tmp_path, "", '<option gravity="0 0 -1.62"/>')
    robot = load_robot(path)
    body = robot.world.add_sphere(0.1, position=(0.0, 0.0, 1.0), mass=2.0)
    assert robot.world.energy().potential == pytest.approx(2.0 * 1.62)
    assert body.index > 0
    assert any("gravity is" in note for note in load_robot(path, World()).notes)
    assert load_robot(path, World(gravity=(0.0, 0.0, -1.62))).notes == ()


@pytest.mark.parametrize(
    ("inside", "rest", "word"),
    [
        (
            f'<body><joint name="j" type="slide" axis="0 0 1" armature="0.1"/>{BALL}</body>',
            "",
            "left out: armature of joint 'j'",
        ),
        (
            f'<body><joint name="j" type="free" armature="0.1"/>{BALL}</body>',
            "",
            "left out: armature of free joint 'j'",
        ),
        (f'<body gravcomp="1"><freejoint/>{BALL}</body>', "", "gravity compensation"),
        (f"<body><freejoint/>{BALL}</body>", '<option density="1.2"/>', "medium"),
        (f'<body><joint name="j" type="ball" range="0 60" limited="true"/>{BALL}</body>', "", "limit of ball 'j'"),
        (f'<body><joint name="j" type="free" damping="2"/>{BALL}</body>', "", "damping of free joint"),
        (f'<body><joint name="j" axis="0 0 1" ref="20"/>{BALL}</body>', "", "0.349066 in the file"),
        (
            f'<body><joint name="j" axis="0 0 1"/>{BALL}</body>',
            '<tendon><fixed name="t"><joint joint="j" coef="1"/></fixed></tendon>'
            '<actuator><motor name="m" tendon="t"/></actuator>',
            "tendons.*drive no hinge or slide, 'm'",
        ),
        (
            f'<body><joint name="j" axis="0 0 1"/>{BALL}</body>',
            '<actuator><position name="m" joint="j" timeconst="0.1"/></actuator>',
            "actuator 'm' is left out",
        ),
        (
            f'<body><joint name="j" axis="0 0 1"/>{BALL}</body>',
            '<actuator><position name="m" joint="j" forcerange="-1 2"/></actuator>',
            "larger of its two limits in both",
        ),
    ],
)
def test_what_is_left_out_is_said(tmp_path, inside, rest, word):
    notes = load_robot(text(tmp_path, inside, rest)).notes
    assert re.search(word, "; ".join(notes)), notes


@pytest.mark.parametrize(
    ("content", "word"),
    [
        (None, "cannot be read"),
        ("", "neither MJCF nor URDF"),
        ("<sdf/>", "neither MJCF nor URDF"),
        ("\0\1\2", "neither MJCF nor URDF"),
        ("<mujoco>", "can read: XML parse error"),
        ("<mujoco><worldbody><body><geom/></worldbody></mujoco>", "can read"),
        ("<mujoco><wordbody/></mujoco>", "wordbody"),
        ("<mujoco><worldbody><body><joint/></body></worldbody></mujoco>", "mass and inertia of moving bodies"),
        ("<mujoco><worldbody><geom type='mesh' mesh='m'/></worldbody></mujoco>", "can read"),
        ("<mujoco><worldbody><body><freejoint/><geom size='nan'/></body></worldbody></mujoco>", "can read"),
        ("<robot name='r'><link name='a'/><link name='a'/></robot>", "can read"),
        ("<robot name='r'><joint name='j' type='revolute'/></robot>", "can read"),
    ],
)
def test_files_that_are_no_robots_are_refused(tmp_path, content, word):
    path = tmp_path / "bad.xml"
    if content is not None:
        path.write_text(content)
    with pytest.raises(FileFormatError, match=word) as caught:
        load_robot(path)
    assert repr(str(path)) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_two_servos_of_a_joint_are_refused_and_leave_the_world_alone(tmp_path):
    rest = "<actuator><position joint='j'/><velocity joint='j'/></actuator>"
    inside = f'<body><joint axis="0 0 1"/>{BALL}</body><body><joint name="j" axis="0 1 0"/>{BALL}</body>'
    world = World()
    with pytest.raises(ArgumentError, match="joint 'j' has two servos"):
        load_robot(text(tmp_path, inside, rest), world)
    assert len(world.position) == 1
    assert len(world.joints) == 0


def test_arguments_are_checked():
    with pytest.raises(ArgumentError, match="floating=True"):
        load_robot(FILES / "arm.xml", floating=True)
    with pytest.raises(ArgumentError, match="world=3"):
        load_robot(FILES / "arm.xml", 3)
    with pytest.raises(ArgumentError, match="position="):
        load_robot(FILES / "arm.xml", position=(1.0, 2.0))
    with pytest.raises(ArgumentError, match="orientation="):
        load_robot(FILES / "arm.xml", orientation=(0.0, 0.0, 0.0, 0.0))
    with pytest.raises(FileFormatError, match="names no file"):
        load_robot("a\0b")


def test_without_mujoco_the_sentence_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(MissingExtraError, match=r"kickdrift\[robots\]"):
        load_robot(FILES / "arm.xml")


def test_what_is_noted_of_many_is_said_once():
    notes = ["joint 'a' is stiff", "geoms differ", "joint 'b' is stiff", "joint 'a' is stiff", "mesh 'a' is stiff"]
    assert gathered(notes) == ("joint 'a' is stiff; likewise 'b'", "geoms differ", "mesh 'a' is stiff")
    notes = load_robot(FILES / "quadruped.xml").notes
    assert len(notes) == 2
    assert all(repr(name) in notes[1] for name in load_robot(FILES / "quadruped.xml").actuators)


OUTSIDE = {
    "an include": ("<include file='../other.xml'/>", ""),
    "an include by its number": ("<include file='&#46;./other.xml'/>", ""),
    "a mesh": ("<body><geom type='mesh' mesh='m'/></body>", "<asset><mesh name='m' file='../other.stl'/></asset>"),
    "a folder of meshes": (
        "<body><geom type='mesh' mesh='m'/></body>",
        "<compiler meshdir='..'/><asset><mesh name='m' file='other.stl'/></asset>",
    ),
    "a link": ("<body><geom type='mesh' mesh='m'/></body>", "<asset><mesh name='m' file='link.stl'/></asset>"),
    "a height field": (
        "<geom type='hfield' hfield='h'/>",
        "<asset><hfield name='h' file='../other.stl' size='1 1 1 1'/></asset>",
    ),
    "a model": ("<body name='a'/>", "<asset><model name='n' file='../other.xml'/></asset>"),
}


def tetrahedron(path):
    """Write a mesh as a binary STL file."""
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype="<f4")
    facets = b"".join(
        np.zeros(3, "<f4").tobytes() + corners[list(face)].tobytes() + b"\0\0"
        for face in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))
    )
    path.write_bytes(bytes(80) + np.uint32(4).tobytes() + facets)


@pytest.mark.parametrize("name", OUTSIDE)
def test_a_file_reads_nothing_outside_of_its_folder(name, tmp_path):
    inside = tmp_path / "robot"
    inside.mkdir()
    (tmp_path / "other.xml").write_text(
        "<mujoco><worldbody><body name='b'><geom size='.1'/></body></worldbody></mujoco>"
    )
    tetrahedron(tmp_path / "other.stl")
    (inside / "link.stl").symlink_to(tmp_path / "other.stl")
    path = text(inside, *OUTSIDE[name])
    with pytest.raises(FileFormatError, match="pass folder=, a folder that contains all files that it may read"):
        load_robot(path)
    if name not in ("a height field", "an include", "an include by its number"):
        assert load_robot(path, folder=tmp_path).bodies is not None


def test_a_package_above_its_folder_is_read_if_that_is_asked_for(tmp_path):
    (tmp_path / "p" / "urdf").mkdir(parents=True)
    tetrahedron(tmp_path / "p" / "part.stl")
    mesh = "<geometry><mesh filename='package://p/part.stl'/></geometry>"
    path = tmp_path / "p" / "urdf" / "a.urdf"
    path.write_text(f"<robot name='r'><link name='l'><collision>{mesh}</collision></link></robot>")
    with pytest.raises(FileFormatError, match=r"'package://p/part.stl' is in .* pass folder="):
        load_robot(path)
    assert len(load_robot(path, folder=tmp_path / "p").world.shape_rows.shapes) == 1


@pytest.mark.parametrize(
    "inside",
    [
        "<replicate count='1000000'><body><geom size='.1'/></body></replicate>",
        "<replicate count='200'><replicate count='200'><body><geom size='.1'/></body></replicate></replicate>",
        "<body><composite type='cable' count='100000 1 1' size='1'/></body>",
        "<include file='part.xml'/>",
    ],
)
def test_a_file_that_repeats_itself_without_end_is_refused(inside, tmp_path):
    (tmp_path / "part.xml").write_text("<mujoco><worldbody><replicate count='99999999999'/></worldbody></mujoco>")
    with pytest.raises(FileFormatError, match=r"replicates parts \d+ times"):
        load_robot(text(tmp_path, inside))
    few = "<replicate count='3' offset='0 0 1'><body><freejoint/><geom size='.1'/></body></replicate>"
    assert len(load_robot(text(tmp_path, few)).bodies) == 4
