"""A scene in MuJoCo, and MuJoCo's collision as the measure of how deep bodies are in each other."""

import numpy as np

from benchmarks.peers import package
from benchmarks.world.described import Floats, Scene, branches
from benchmarks.world.mjcf import driven_hinges, speed, text


def _pass_over(warning: str) -> None:
    """Leave a warning unsaid: what is lost to infinity shows in the poses."""


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
        library.set_mju_user_warning(_pass_over)
        self._model = library.MjModel.from_xml_string(text(scene, step, solver=solver, integrator=integrator))
        self._data = library.MjData(self._model)
        self._bodies = [self._model.body(f"b{i}").id for i in range(len(scene.bodies))]
        self._start(scene)
        library.mj_forward(self._model, self._data)

    def step(self) -> None:
        """Take a step."""
        self._library.mj_step(self._model, self._data)

    def advance(self, count: int) -> None:
        """Take so many steps."""
        for _ in range(count):
            self._library.mj_step(self._model, self._data)
        self._data.xfrc_applied[:] = 0.0

    def push(self, body: int, force: Floats) -> None:
        """Let a force act on a body in the next steps, until `advance` returns."""
        self._data.xfrc_applied[self._bodies[body], :3] += force

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
        found = branches(scene)[0]
        speeds = self._data.qvel
        for branch in found:
            at = self._first_freedom(branch.body)
            if at < 0 or (branch.joint is not None and branch.joint.kind == "fixed"):
                continue
            speeds[at : at + self._freedoms(branch.body)] = speed(scene, branch)
        self._data.ctrl[:] = [joint.target for _, joint in driven_hinges(found)]

    def _first_freedom(self, body: int) -> int:
        return int(self._model.body_dofadr[self._bodies[body]])

    def _freedoms(self, body: int) -> int:
        return int(self._model.body_dofnum[self._bodies[body]])


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
