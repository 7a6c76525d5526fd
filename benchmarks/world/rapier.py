"""A scene in rapier3d: 32-bit numbers, one object a body."""

import numpy as np

from benchmarks.peers import package
from benchmarks.world.described import (
    GROUND,
    Body,
    Floats,
    Joint,
    Scene,
    Unsupported,
    inverse,
    rotation,
    shortest_turn,
    times,
)

_STIFF_MOTOR = 1e6  # N s/m or N m s: the motor reaches its speed at once, if its maximum lets it


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
        # What is locked to a plane has no answer to a hinge's rows about other axes, and they throw it away: scenes with
        # joints stay in their plane by themselves.
        self._planar = scene.planar and not scene.joints
        self._pushed: set[int] = set()
        self._bodies = [self._world.add_body(self._body(body), [self._shape(body)]) for body in scene.bodies]
        self._ground = self._world.add_body(library.RigidBody.fixed()) if scene.joints else None
        joints = self._world.multibody_joints if reduced else self._world.impulse_joints
        for joint in scene.joints:
            joints.insert(self._handle(joint.a), self._handle(joint.b), self._joint(scene, joint))
        self.step = self._world.step

    def advance(self, count: int) -> None:
        """Take so many steps."""
        for _ in range(count):
            self.step()
        if self._pushed:
            for body in self._pushed:
                self._world.rigid_bodies[self._bodies[body]].reset_forces()
            self._pushed.clear()

    def push(self, body: int, force: Floats) -> None:
        """Let a force act on a body in the next steps, until `advance` returns."""
        self._world.rigid_bodies[self._bodies[body]].add_force(tuple(force))
        self._pushed.add(body)

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
            runs = body.velocity if body.belt is None else rotation(body.orientation) @ body.belt
            made = self._library.RigidBody.fixed()
            if np.any(runs):  # a belt is a body that runs: long enough, nobody sees the difference
                made = self._library.RigidBody.kinematic_velocity_based().linvel(tuple(runs))
        else:
            made = self._library.RigidBody.dynamic().can_sleep(False).gyroscopic_forces(True)
            made = made.linvel(tuple(body.velocity)).angvel(tuple(body.angular_velocity))
            if self._planar:
                made = made.enabled_translations((True, False, True)).enabled_rotations((False, True, False))
        return made.translation(tuple(body.position)).rotation(_turn(body.orientation))

    def _shape(self, body: Body) -> object:
        collider, library = self._library.Collider, self._library
        if body.kind == "plane":
            made = collider.halfspace((0.0, 0.0, 1.0))
        elif body.kind == "sphere":
            made = collider.ball(*body.size)
        elif body.kind == "capsule":
            made = collider.capsule_z(body.size[1], body.size[0])
        elif body.kind == "box":
            made = collider.cuboid(*body.size)
        elif body.kind == "hull":
            made = collider.convex_hull(body.points)
        else:
            made = collider.trimesh(body.points, body.faces)
        if body.mass > 0:
            made = made.mass_properties(library.MassProperties((0.0, 0.0, 0.0), body.mass, tuple(body.inertia)))
        if body.rolling > 0:
            raise Unsupported("rolling resistance")
        group = library.Group.from_bits
        groups = library.InteractionGroups(group(body.layer), group(body.mask))
        rules = library.CoefficientCombineRule
        made = made.friction(body.friction).friction_combine_rule(rules.GEOMETRIC_MEAN)
        made = made.restitution(body.restitution).restitution_combine_rule(rules.MAX)
        return made.collision_groups(groups)

    def _joint(self, scene: Scene, joint: Joint) -> object:
        library = self._library
        masks, axes = library.JointAxesMask, library.JointAxis
        locked, free = {
            "ball": (masks.LOCKED_SPHERICAL_AXES, (axes.ANG_X, axes.ANG_Y, axes.ANG_Z)),
            "hinge": (masks.LOCKED_REVOLUTE_AXES, (axes.ANG_X,)),
            "slider": (masks.LOCKED_PRISMATIC_AXES, (axes.LIN_X,)),
            "fixed": (masks.LOCKED_FIXED_AXES, ()),
        }[joint.kind]
        made = library.GenericJointBuilder(locked).contacts_enabled(False)
        made = made.local_frame1(self._frame(scene, joint, joint.a)).local_frame2(self._frame(scene, joint, joint.b))
        if joint.limits:
            made = made.limits(free[0], *joint.limits)
        speed, most = joint.motor or (0.0, joint.friction)
        for axis in free:
            if joint.damping > 0 or joint.driven:
                made = made.motor_model(axis, library.MotorModel.FORCE_BASED)
                made = made.motor_position(axis, joint.target, joint.stiffness, joint.damping)
            elif most > 0:
                made = made.motor_model(axis, library.MotorModel.FORCE_BASED)
                made = made.motor_velocity(axis, speed, _STIFF_MOTOR).motor_max_force(axis, most)
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
