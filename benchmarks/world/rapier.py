"""A scene in rapier3d: 32-bit numbers, one object a body."""

import numpy as np

from benchmarks.peers import package
from benchmarks.world.described import GROUND, Body, Floats, Joint, Scene, inverse, rotation, shortest_turn, times


class Rapier:
    """rapier3d with its defaults, but that nothing sleeps.

    Parameters
    ----------
    scene : Scene
    step : float
        Seconds.
    threads : int
        Of the pool of this world.
    reduced : bool
        Whether joints make multibodies, in the coordinates of the joints, rather than act by impulses.
    """

    def __init__(self, scene: Scene, step: float, threads: int = 1, reduced: bool = False) -> None:
        self._library = library = package("rapier3d")
        self._world = library.PhysicsWorld(gravity=tuple(scene.gravity))
        self._world.set_num_threads(threads)
        self._world.integration_parameters.dt = step
        self._bodies = [self._world.add_body(self._body(body), [self._shape(body)]) for body in scene.bodies]
        self._ground = self._world.add_body(library.RigidBody.fixed()) if scene.joints else None
        joints = self._world.multibody_joints if reduced else self._world.impulse_joints
        for joint in scene.joints:
            joints.insert(self._handle(joint.a), self._handle(joint.b), self._joint(scene, joint))
        self.step = self._world.step

    def poses(self) -> Floats:
        """Positions and orientations, (N, 7)."""
        rows = []
        for handle in self._bodies:
            body = self._world.rigid_bodies[handle]
            x, q = body.translation, body.rotation
            rows.append((x.x, x.y, x.z, q.w, q.i, q.j, q.k))
        return np.array(rows)

    def motions(self) -> Floats:
        """Velocities and angular velocities, (N, 6)."""
        rows = []
        for handle in self._bodies:
            body = self._world.rigid_bodies[handle]
            v, w = body.linvel, body.angvel
            rows.append((v.x, v.y, v.z, w.x, w.y, w.z))
        return np.array(rows)

    def _handle(self, body: int) -> object:
        return self._ground if body == GROUND else self._bodies[body]

    def _body(self, body: Body) -> object:
        if body.mass == 0:
            made = self._library.RigidBody.fixed()
        else:
            made = self._library.RigidBody.dynamic().can_sleep(False).gyroscopic_forces(True)
            made = made.linvel(tuple(body.velocity)).angvel(tuple(body.angular_velocity))
        return made.translation(tuple(body.position)).rotation(_turn(body.orientation))

    def _shape(self, body: Body) -> object:
        collider, library = self._library.Collider, self._library
        if body.kind == "plane":
            made = collider.halfspace((0.0, 0.0, 1.0))
        elif body.kind == "sphere":
            made = collider.ball(*body.size)
        elif body.kind == "capsule":
            made = collider.capsule_z(body.size[1], body.size[0])
        else:
            made = collider.cuboid(*body.size)
        if body.mass > 0:
            made = made.mass_properties(library.MassProperties((0.0, 0.0, 0.0), body.mass, tuple(body.inertia)))
        group = library.Group.from_bits
        groups = library.InteractionGroups(group(body.layer), group(body.mask))
        return made.friction(body.friction).restitution(body.restitution).collision_groups(groups)

    def _joint(self, scene: Scene, joint: Joint) -> object:
        library = self._library
        masks, axes = library.JointAxesMask, library.JointAxis
        locked = masks.LOCKED_SPHERICAL_AXES if joint.kind == "ball" else masks.LOCKED_REVOLUTE_AXES
        made = library.GenericJointBuilder(locked).contacts_enabled(False)
        made = made.local_frame1(self._frame(scene, joint, joint.a)).local_frame2(self._frame(scene, joint, joint.b))
        if joint.limits:
            made = made.limits(axes.ANG_X, *joint.limits)
        for free in (axes.ANG_X, axes.ANG_Y, axes.ANG_Z) if joint.kind == "ball" else (axes.ANG_X,):
            if joint.damping > 0:
                made = made.motor_model(free, library.MotorModel.FORCE_BASED)
                made = made.motor_position(free, joint.target, joint.stiffness, joint.damping)
        return made.build()

    def _frame(self, scene: Scene, joint: Joint, body: int) -> object:
        """Where a joint, x along its axis, lies in a body."""
        turn = shortest_turn(np.array([1.0, 0.0, 0.0]), joint.axis)
        at = joint.anchor
        if body != GROUND:
            back = inverse(scene.bodies[body].orientation)
            turn, at = times(back, turn), rotation(back) @ (at - scene.bodies[body].position)
        return self._library.Isometry3(tuple(at), self._library.Rotation3(*turn))


def _turn(q: Floats) -> tuple[float, ...]:
    """Rotation vector of a quaternion."""
    sine = np.linalg.norm(q[1:])
    return tuple(q[1:] * (2 * np.arctan2(sine, q[0]) / sine)) if sine > 0 else (0.0, 0.0, 0.0)
