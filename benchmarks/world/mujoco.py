"""A scene in MuJoCo, and MuJoCo's collision as the measure of how deep bodies are in each other."""

import numpy as np

from benchmarks.peers import package
from benchmarks.world.described import Floats, Scene, branches, rotation
from benchmarks.world.mjcf import driven_hinges, text


class Mujoco:
    """MuJoCo with its defaults but for the integrator; springs are position actuators.

    Parameters
    ----------
    scene : Scene
    step : float
        Seconds.
    solver : str
        "CG" where "Newton", its default, breaks down: that of 4.0.0 does with many contacts and joints.
    integrator : str
        "RK4" where energy is to be kept.
    """

    def __init__(self, scene: Scene, step: float, solver: str = "Newton", integrator: str = "implicitfast") -> None:
        self._library = library = package("mujoco")
        self._model = library.MjModel.from_xml_string(text(scene, step, solver=solver, integrator=integrator))
        self._data = library.MjData(self._model)
        self._bodies = [self._model.body(f"b{i}").id for i in range(len(scene.bodies))]
        self._start(scene)
        library.mj_forward(self._model, self._data)

    def step(self) -> None:
        """Take a step."""
        self._library.mj_step(self._model, self._data)

    def poses(self) -> Floats:
        """Positions and orientations, (N, 7)."""
        self._library.mj_kinematics(self._model, self._data)  # a step leaves those before it
        return np.hstack([self._data.xipos[self._bodies], self._data.xquat[self._bodies]])

    def motions(self) -> Floats:
        """Velocities and angular velocities, (N, 6)."""
        library = self._library
        for stage in (library.mj_kinematics, library.mj_comPos, library.mj_comVel):
            stage(self._model, self._data)
        found, row = np.empty((len(self._bodies), 6)), np.empty(6)
        for i, body in enumerate(self._bodies):
            library.mj_objectVelocity(self._model, self._data, library.mjtObj.mjOBJ_BODY, body, row, 0)
            found[i] = *row[3:], *row[:3]
        return found

    def _start(self, scene: Scene) -> None:
        for body, joint in zip(scene.bodies, map(self._free_joint, self._bodies), strict=True):
            if joint >= 0:
                turn = rotation(body.orientation)
                self._data.qvel[joint : joint + 6] = *body.velocity, *(turn.T @ body.angular_velocity)
        self._data.ctrl[:] = [joint.target for _, joint in driven_hinges(branches(scene)[0])]

    def _free_joint(self, body: int) -> int:
        joint = self._model.body_jntadr[body]
        free = joint >= 0 and self._model.jnt_type[joint] == self._library.mjtJoint.mjJNT_FREE
        return int(self._model.jnt_dofadr[joint]) if free else -1


class Depths:
    """How deep bodies are in each other, by MuJoCo's collision, whoever moved them."""

    def __init__(self, scene: Scene) -> None:
        self._library = library = package("mujoco")
        self._model = library.MjModel.from_xml_string(text(scene, 0.001, free=True))
        self._data = library.MjData(self._model)
        self._moving = scene.moving

    def deepest(self, poses: Floats) -> float:
        """Largest penetration in m, of poses (N, 7)."""
        self._data.qpos[:] = poses[self._moving].ravel()
        for stage in (self._library.mj_kinematics, self._library.mj_comPos, self._library.mj_collision):
            stage(self._model, self._data)
        return max(0.0, -float(np.min(self._data.contact.dist, initial=0.0)))
