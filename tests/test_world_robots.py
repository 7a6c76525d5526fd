"""Robots from MJCF and URDF: what MuJoCo makes of the files is what the world has, and moves like it."""

import builtins
from pathlib import Path

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

from kickdrift.core.errors import ArgumentError, FileFormatError, MissingExtraError  # noqa: E402
from kickdrift.io.robot_file import load_robot  # noqa: E402
from kickdrift.world.collision.filters import may_touch  # noqa: E402
from kickdrift.world.joints.axis import Drive  # noqa: E402
from kickdrift.world.joints.layout import ANCHOR_A, ANCHOR_B, BODY_A, BODY_B, FRAME_A, LOWER, UPPER  # noqa: E402
from kickdrift.world.joints import layout  # noqa: E402
from kickdrift.world.shapes.mass import rotation_matrix  # noqa: E402
from kickdrift.world.tables import EXCLUDED, INERTIA, JOINT, JOINT_AXES, JOINT_NUMBERS  # noqa: E402
from kickdrift.world.world import World  # noqa: E402

FILES = Path(__file__).parent / "data" / "robots"
NAMES = ["arm.xml", "arm.urdf", "quadruped.xml", "quadruped.urdf"]


def reference(path, floating=False):
    """The file in MuJoCo alone, at its reference pose."""
    spec = mujoco.MjSpec.from_file(str(path))
    spec.compiler.fusestatic = False
    if floating:
        spec.worldbody.first_body().add_freejoint()
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


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
        np.testing.assert_array_equal(law[[LOWER, UPPER]], limits)
        assert law[layout.FRICTION] == model.dof_frictionloss[model.jnt_dofadr[row]]
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


def swing(path, duration, steps, pushes):
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
    errors, moved = swing(FILES / name, 0.4, (100, 400), ())
    print(errors, moved)
    assert moved > 0.3
    assert errors[0] < 0.02
    assert errors[1] < 0.3 * errors[0]
