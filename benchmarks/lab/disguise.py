"""A scene in disguise: turned, moved, with bodies in another order and scaled masses. What is measured must not change."""

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.lab.ours import Kickdrift
from benchmarks.world.described import GROUND, Body, Floats, Joint, Scene


class Disguised:
    """kickdrift with a scene in disguise, which is taken off again from all that it returns.

    Parameters
    ----------
    scene : Scene
    step : float
        Seconds.
    seed : int
        Of the rotation, the displacement, the order and the scale of the masses. A planar scene is not turned.
    """

    def __init__(self, scene: Scene, step: float, seed: int) -> None:
        random = np.random.default_rng(seed)
        self._turn = Rotation.identity() if scene.planar else Rotation.random(random_state=random)
        self._moved = random.uniform(-5.0, 5.0, 3) * (1.0, not scene.planar, 1.0)
        self._scale = 10.0 ** random.uniform(-1.5, 1.5)
        self._order = random.permutation(len(scene.bodies))
        self._back = np.argsort(self._order)
        self._engine = Kickdrift(
            Scene(
                self._turn.apply(scene.gravity),
                [self._body(scene.bodies[index]) for index in self._order],
                [self._joint(joint) for joint in scene.joints],
                scene.planar,
            ),
            step,
        )

    def advance(self, count: int) -> None:
        """Take so many steps."""
        self._engine.advance(count)

    def push(self, body: int, force: Floats) -> None:
        """Let a force act on a body in the next step."""
        self._engine.push(int(self._back[body]), self._scale * self._turn.apply(force))

    def poses(self) -> Floats:
        """Positions and orientations, (N, 7)."""
        poses = self._engine.poses()[self._back]
        turned = Rotation.from_quat(poses[:, 3:], scalar_first=True)
        place = self._turn.inv().apply(poses[:, :3] - self._moved)
        return np.hstack([place, (self._turn.inv() * turned).as_quat(scalar_first=True)])

    def motions(self) -> Floats:
        """Velocities and angular velocities, (N, 6)."""
        motions = self._engine.motions()[self._back]
        return np.hstack([self._turn.inv().apply(part) for part in (motions[:, :3], motions[:, 3:])])

    def _body(self, body: Body) -> Body:
        turned = self._turn * Rotation.from_quat(body.orientation, scalar_first=True)
        return replace(
            body,
            position=self._turn.apply(body.position) + self._moved,
            orientation=turned.as_quat(scalar_first=True),
            mass=self._scale * body.mass,
            inertia=self._scale * body.inertia,
            velocity=self._turn.apply(body.velocity),
            angular_velocity=self._turn.apply(body.angular_velocity),
        )

    def _joint(self, joint: Joint) -> Joint:
        a, b = (end if end == GROUND else int(self._back[end]) for end in (joint.a, joint.b))
        return replace(
            joint,
            a=a,
            b=b,
            anchor=self._turn.apply(joint.anchor) + self._moved,
            axis=self._turn.apply(joint.axis),
            stiffness=self._scale * joint.stiffness,
            damping=self._scale * joint.damping,
            friction=self._scale * joint.friction,
            motor=None if joint.motor is None else (joint.motor[0], self._scale * joint.motor[1]),
        )
