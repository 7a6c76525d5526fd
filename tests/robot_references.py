"""What MuJoCo alone makes of a robot's file, and how it falls there."""

import mujoco
import numpy as np

from kickdrift.io.robot_file import load_robot


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


def positions(robot):
    """Of those of a robot's joints that have one axis, by name."""
    both = {name: (*joint.positions, *joint.angles) for name, joint in robot.joints.items()}
    return {name: both[name][axis] for name, axis in robot.axes.items() if axis >= 0}


def falls(path, duration=0.3, counts=(100, 400)):
    """Positions of joints in MuJoCo after a fall, and how far off those here are with steps of each size."""
    model, data = reference(path)
    model.opt.timestep, model.opt.integrator = duration / 3000, mujoco.mjtIntegrator.mjINT_RK4
    for _ in range(3000):
        mujoco.mj_step(model, data)
    errors = []
    for count in counts:
        robot = load_robot(path)
        robot.world.advance(duration / count, count)
        there = {
            name: data.joint(name).qpos[0] - model.qpos0[model.joint(name).qposadr[0]] for name in positions(robot)
        }
        errors.append(max(abs(value - there[name]) for name, value in positions(robot).items()))
    return np.array(list(there.values())), np.array(errors)
