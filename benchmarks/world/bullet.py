"""A scene in PyBullet: joints that make trees as links of multibodies, others as constraints."""

import numpy as np

from benchmarks.peers import package
from benchmarks.world.described import GROUND, Body, Branch, Floats, Joint, Scene, branches, inverse, rotation, times


class Bullet:
    """PyBullet with its defaults, but without damping; where joints have springs, its motors hold them instead.

    Parameters
    ----------
    scene : Scene
    step : float
        Seconds.
    """

    def __init__(self, scene: Scene, step: float) -> None:
        self._library = library = package("pybullet")
        self._client = library.connect(library.DIRECT)
        library.setGravity(*scene.gravity, physicsClientId=self._client)
        library.setTimeStep(step, physicsClientId=self._client)
        self._scene = scene
        self._links: dict[int, tuple[int, int]] = {}  # by body: multibody and link, which is -1 for its base
        self._shapes: dict[tuple[object, ...], int] = {}
        found, closing = branches(scene)
        for tree in _trees(found):
            self._add(tree)
        for joint in closing:
            self._close(joint)
        for joint in scene.joints:
            self._part(joint)

    def close(self) -> None:
        """Let go of the memory."""
        self._library.disconnect(self._client)

    def step(self) -> None:
        """Take a step."""
        self._library.stepSimulation(self._client)

    def poses(self) -> Floats:
        """Positions and orientations, (N, 7)."""
        rows = []
        for body in range(len(self._scene.bodies)):
            multibody, link = self._links[body]
            if link < 0:
                x, q = self._library.getBasePositionAndOrientation(multibody, self._client)
            else:
                x, q = self._library.getLinkState(multibody, link, 0, 1, self._client)[:2]
            rows.append((*x, q[3], *q[:3]))
        return np.array(rows)

    def motions(self) -> Floats:
        """Velocities and angular velocities, (N, 6)."""
        rows = []
        for body in range(len(self._scene.bodies)):
            multibody, link = self._links[body]
            if link < 0:
                v, w = self._library.getBaseVelocity(multibody, self._client)
            else:
                v, w = self._library.getLinkState(multibody, link, 1, 1, self._client)[6:8]
            rows.append((*v, *w))
        return np.array(rows)

    def _add(self, tree: list[Branch]) -> None:
        """Make a multibody of a tree; one that hangs from the ground has a base without a shape."""
        library, scene = self._library, self._scene
        hangs = tree[0].joint is not None
        links = tree if hangs else tree[1:]
        place = {GROUND: (0, np.zeros(3), np.array([1.0, 0, 0, 0]))}  # number from the base on, origin, orientation
        base: dict[str, object] = {"baseMass": 0.0}
        if not hangs:
            body = scene.bodies[tree[0].body]
            base = {
                "baseMass": body.mass,
                "baseCollisionShapeIndex": self._shape(body, np.zeros(3)),
                "basePosition": body.position,
                "baseOrientation": _last(body.orientation),
            }
            place[tree[0].body] = (0, body.position, body.orientation)
        columns: dict[str, list[object]] = {name: [] for name in _COLUMNS}
        for number, branch in enumerate(links, start=1):
            body, joint = scene.bodies[branch.body], branch.joint
            assert joint is not None
            parent, origin, turn = place[branch.parent]
            back, own = rotation(inverse(turn)), rotation(inverse(body.orientation))
            centre = own @ (body.position - joint.anchor)
            sign = 1.0 if joint.b == branch.body else -1.0
            kind = library.JOINT_SPHERICAL if joint.kind == "ball" else library.JOINT_REVOLUTE
            values = (
                body.mass, self._shape(body, centre), -1, back @ (joint.anchor - origin),
                _last(times(inverse(turn), body.orientation)), centre, [0, 0, 0, 1], parent, kind,
                own @ (sign * joint.axis),
            )  # fmt: skip
            for name, value in zip(_COLUMNS, values, strict=True):
                columns[name].append(value)
            place[branch.body] = (number, joint.anchor, body.orientation)
        flags = library.URDF_USE_SELF_COLLISION | library.URDF_USE_SELF_COLLISION_EXCLUDE_PARENT if links else 0
        multibody = library.createMultiBody(**base, **columns, flags=flags, physicsClientId=self._client)
        if not hangs:
            self._finish(tree[0].body, multibody, -1)
        for number, branch in enumerate(links):
            self._finish(branch.body, multibody, number, branch.joint.damping if branch.joint else 0.0)
            self._free(multibody, number, branch)

    def _finish(self, index: int, multibody: int, link: int, damping: float = 0.0) -> None:
        library, body = self._library, self._scene.bodies[index]
        self._links[index] = multibody, link
        # The coefficients of two bodies are multiplied.
        dynamics = {"lateralFriction": np.sqrt(body.friction), "restitution": np.sqrt(body.restitution)}
        if body.mass > 0:
            dynamics |= {"linearDamping": 0.0, "angularDamping": 0.0, "jointDamping": damping}
            dynamics |= {"localInertiaDiagonal": list(body.inertia)}
        library.changeDynamics(multibody, link, **dynamics, physicsClientId=self._client)
        library.setCollisionFilterGroupMask(multibody, link, body.layer, body.mask, self._client)
        if link < 0 and body.mass > 0:
            library.resetBaseVelocity(multibody, body.velocity, body.angular_velocity, self._client)

    def _free(self, multibody: int, link: int, branch: Branch) -> None:
        """Turn off the motor that a joint begins with, and turn on its spring."""
        library, joint = self._library, branch.joint
        assert joint is not None
        if joint.kind == "ball":
            library.setJointMotorControlMultiDof(
                multibody, link, library.POSITION_CONTROL, targetPosition=[0, 0, 0, 1], positionGain=0, velocityGain=0,
                force=[0, 0, 0], physicsClientId=self._client,
            )  # fmt: skip
            return
        library.setJointMotorControl2(multibody, link, library.VELOCITY_CONTROL, force=0, physicsClientId=self._client)
        if joint.limits:
            low, high = joint.limits if joint.b == branch.body else (-joint.limits[1], -joint.limits[0])
            library.changeDynamics(
                multibody, link, jointLowerLimit=low, jointUpperLimit=high, physicsClientId=self._client
            )
        if joint.driven:
            target = joint.target if joint.b == branch.body else -joint.target
            library.setJointMotorControl2(
                multibody, link, library.POSITION_CONTROL, targetPosition=target, force=1e4,
                physicsClientId=self._client,
            )  # fmt: skip

    def _shape(self, body: Body, offset: Floats) -> int:
        library = self._library
        key = (body.kind, body.size, tuple(offset))
        if key not in self._shapes:
            size: dict[str, object] = {}
            if body.kind == "box":
                kind, size = library.GEOM_BOX, {"halfExtents": body.size}
            elif body.kind == "sphere":
                kind, size = library.GEOM_SPHERE, {"radius": body.size[0]}
            elif body.kind == "capsule":
                kind, size = library.GEOM_CAPSULE, {"radius": body.size[0], "height": 2 * body.size[1]}
            else:
                kind, size = library.GEOM_PLANE, {"planeNormal": [0, 0, 1]}
            self._shapes[key] = library.createCollisionShape(
                kind, **size, collisionFramePosition=list(offset), physicsClientId=self._client
            )
        return self._shapes[key]

    def _close(self, joint: Joint) -> None:
        library, scene = self._library, self._scene
        ends = []
        for index in (joint.a, joint.b):
            body = scene.bodies[index]
            ends.append(rotation(inverse(body.orientation)) @ (joint.anchor - body.position))
        (a, link_a), (b, link_b) = self._links[joint.a], self._links[joint.b]
        library.createConstraint(
            a, link_a, b, link_b, library.JOINT_POINT2POINT, [0, 0, 0], ends[0], ends[1], physicsClientId=self._client
        )

    def _part(self, joint: Joint) -> None:
        if GROUND not in (joint.a, joint.b):
            (a, link_a), (b, link_b) = self._links[joint.a], self._links[joint.b]
            self._library.setCollisionFilterPair(a, b, link_a, link_b, 0, self._client)


_COLUMNS = (
    "linkMasses",
    "linkCollisionShapeIndices",
    "linkVisualShapeIndices",
    "linkPositions",
    "linkOrientations",
    "linkInertialFramePositions",
    "linkInertialFrameOrientations",
    "linkParentIndices",
    "linkJointTypes",
    "linkJointAxis",
)


def _trees(found: list[Branch]) -> list[list[Branch]]:
    """Group branches by the root that they grow from, each tree depth first: so PyBullet numbers its links."""
    children: dict[int, list[Branch]] = {}
    for branch in found:
        children.setdefault(branch.parent, []).append(branch)
    trees = []
    for root in children[GROUND]:
        tree, waiting = [], [root]
        while waiting:
            branch = waiting.pop()
            tree.append(branch)
            waiting += reversed(children.get(branch.body, ()))
        trees.append(tree)
    return trees


def _last(q: Floats) -> list[float]:
    """(x, y, z, w) of (w, x, y, z)."""
    return [q[1], q[2], q[3], q[0]]
