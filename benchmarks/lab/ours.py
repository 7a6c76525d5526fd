"""A scene of the lab in kickdrift, by its public names alone, so that the lab measures any version of it."""

from typing import Any

import numpy as np

import kickdrift as kd
from benchmarks.world.described import GROUND, Body, Floats, Joint, Scene


class Kickdrift:
    """kickdrift with its defaults.

    Parameters
    ----------
    scene : Scene
    step : float
        Seconds.
    **options
        Of the world.
    """

    def __init__(self, scene: Scene, step: float, **options: Any) -> None:
        if scene.planar:
            options["plane_normal"] = (0.0, 1.0, 0.0)
        self.world = world = kd.World(gravity=scene.gravity, **options)
        self._seconds = step
        self._bodies = [self._body(body) for body in scene.bodies]
        self._rows = np.array([body.index for body in self._bodies])
        for joint in scene.joints:
            ends = [world.ground if end == GROUND else self._bodies[end] for end in (joint.a, joint.b)]
            self._join(joint, *ends)

    def step(self) -> None:
        """Take a step."""
        self.world.step(self._seconds)

    def advance(self, count: int) -> None:
        """Take so many steps."""
        self.world.advance(self._seconds, count)

    def push(self, body: int, force: Floats) -> None:
        """Let a force act on a body in the next step."""
        self.world.apply_force(self._bodies[body], force)

    def poses(self) -> Floats:
        """Positions and orientations, (N, 7)."""
        return np.hstack([self.world.position, self.world.orientation])[self._rows]

    def motions(self) -> Floats:
        """Velocities and angular velocities, (N, 6)."""
        return np.hstack([self.world.velocity, self.world.angular_velocity])[self._rows]

    def _body(self, body: Body) -> Any:
        world = self.world
        options: dict[str, Any] = {
            "position": body.position, "friction": body.friction, "restitution": body.restitution,
            "layer": body.layer.bit_length() - 1, "collides_with": _layers(body.mask),
        }  # fmt: skip
        if body.belt is not None:
            options["surface_velocity"] = tuple(body.belt)
        if body.rolling > 0:
            options["rolling_resistance"] = body.rolling
        if body.kind == "plane":
            options["point"] = options.pop("position")
            return world.add_plane(_normal(body), **options)
        options["orientation"] = body.orientation
        if body.kind == "mesh":
            return world.add_mesh(body.points, body.faces, **options)
        if body.mass > 0:
            options |= {"mass": body.mass, "inertia": body.inertia, "angular_velocity": body.angular_velocity}
        elif np.any(body.velocity):
            options["kinematic"] = True
        else:
            options["static"] = True
        options["velocity"] = body.velocity
        if body.kind == "box":
            return world.add_box(2 * np.array(body.size), **options)
        if body.kind == "sphere":
            return world.add_sphere(body.size[0], **options)
        if body.kind == "capsule":
            return world.add_capsule(body.size[0], 2 * body.size[1], **options)
        return world.add_hull(body.points, **options)

    def _join(self, joint: Joint, a: Any, b: Any) -> None:
        world = self.world
        if joint.kind == "fixed":
            world.add_fixed_joint(a, b, joint.anchor)
            return
        options: dict[str, Any] = {"friction": joint.friction}
        if joint.driven or joint.damping > 0:
            target = {} if joint.kind == "ball" else {"target": joint.target}
            options["drive"] = kd.Drive(joint.stiffness, joint.damping, **target)
        if joint.kind == "ball":
            world.add_ball_joint(a, b, joint.anchor, **options)
            return
        if joint.motor is not None:
            options["motor"] = kd.Motor(*joint.motor)
        add = world.add_hinge if joint.kind == "hinge" else world.add_slider
        add(a, b, joint.anchor, joint.axis, limits=joint.limits, **options)


def _normal(body: Body) -> Floats:
    w, x, y, z = body.orientation
    return np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])


def _layers(mask: int) -> tuple[int, ...] | None:
    return None if mask == 0xFFFF else tuple(layer for layer in range(16) if mask >> layer & 1)
