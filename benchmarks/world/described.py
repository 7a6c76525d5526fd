"""Scenes in words that every engine understands, and what all of them are measured by."""

from collections import deque
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
GROUND = -1


@dataclass(frozen=True)
class Body:
    """A body of one shape, its origin at its centre of mass.

    Attributes
    ----------
    kind : str
        "plane" (normal along its own z), "sphere", "capsule" (along its own z), "box", "hull" or "mesh".
    size : tuple of float
        None; radius; radius and half the length of the straight part; half extents; none for the last two.
    position, orientation : (3,) and (4,) arrays
        The latter as (w, x, y, z).
    mass : float
        kg; 0 for a body that never moves.
    inertia : (3,) array
        Moments about its own axes.
    points, faces : (N, 3) and (M, 3) arrays, optional
        Of a hull, which has no faces, and of a mesh.
    belt : (3,) array, optional
        Velocity at which the surface runs, though the body does not, m/s.
    rolling : float
        Lever of the normal force against rolling, m.
    """

    kind: str
    size: tuple[float, ...]
    position: Floats
    orientation: Floats
    mass: float
    inertia: Floats
    friction: float
    restitution: float
    velocity: Floats = field(default_factory=lambda: np.zeros(3))
    angular_velocity: Floats = field(default_factory=lambda: np.zeros(3))
    layer: int = 1
    mask: int = 0xFFFF
    points: Floats | None = None
    faces: NDArray[np.intp] | None = None
    belt: Floats | None = None
    rolling: float = 0.0


@dataclass(frozen=True)
class Joint:
    """A "ball", "hinge", "slider" or "fixed" joint between two bodies, placed where it is at the start.

    Attributes
    ----------
    a, b : int
        Bodies; `GROUND` may be the first.
    anchor, axis : (3,) arrays
        In the world.
    limits : (float, float), optional
        Of the angle, from the start.
    target, stiffness, damping : float
        Of a spring at the angle or along the axis; a ball has damping alone.
    motor : (float, float), optional
        Speed of b against a, and the most torque or force that it takes.
    friction : float
        Most torque or force of dry friction.
    """

    kind: str
    a: int
    b: int
    anchor: Floats
    axis: Floats
    limits: tuple[float, float] | None = None
    target: float = 0.0
    stiffness: float = 0.0
    damping: float = 0.0
    motor: tuple[float, float] | None = None
    friction: float = 0.0

    @property
    def driven(self) -> bool:
        """Whether a spring acts."""
        return self.stiffness > 0


class Load(NamedTuple):
    """A force on a body's centre, N, over a span of time, s."""

    body: int
    force: Floats
    begin: float = 0.0
    end: float = np.inf


@dataclass(frozen=True)
class Scene:
    """What an engine is given.

    Attributes
    ----------
    gravity : (3,) array
    bodies, joints : lists
    planar : bool
        Whether bodies move in the xz plane only, and turn about y.
    loads : tuple of Load
        Which whoever runs the scene applies.
    """

    gravity: Floats
    bodies: list[Body]
    joints: list[Joint]
    planar: bool = False
    loads: tuple[Load, ...] = ()

    @property
    def moving(self) -> NDArray[np.intp]:
        """Indices of the bodies that may move."""
        return np.array([i for i, body in enumerate(self.bodies) if body.mass > 0])


class Unsupported(Exception):  # noqa: N818 - not an error: the table has a dash
    """A scene that an engine has no means for; the message says which."""


@dataclass(frozen=True)
class Branch:
    """A body that hangs from another one, by the joint through which it was reached."""

    body: int
    parent: int
    joint: Joint | None


def branches(scene: Scene) -> tuple[list[Branch], list[Joint]]:
    """Make trees of the bodies, parents first, and say which joints close loops.

    Trees grow from the ground and from bodies that never move, all at once, then from the first of the others.
    """
    joints: dict[int, list[Joint]] = {}
    for joint in scene.joints:
        for end in (joint.a, joint.b):
            joints.setdefault(end, []).append(joint)
    found, used, seen = [], set(), {GROUND}
    waiting = deque([GROUND])
    for rest in (False, True):
        for root, body in enumerate(scene.bodies):
            if root in seen or (body.mass > 0) != rest:
                continue
            found.append(Branch(root, GROUND, None))
            seen.add(root)
            waiting.append(root)
            if rest:
                found += _growth(scene, joints, waiting, seen, used)
        found += _growth(scene, joints, waiting, seen, used)
    return found, [joint for joint in scene.joints if id(joint) not in used]


def _growth(
    scene: Scene, joints: dict[int, list[Joint]], waiting: deque[int], seen: set[int], used: set[int]
) -> list[Branch]:
    """Let trees grow, breadth first, and note what was seen and used."""
    found = []
    while waiting:
        parent = waiting.popleft()
        for joint in joints.get(parent, ()):
            child = joint.b if joint.a == parent else joint.a
            if id(joint) not in used and child not in seen and scene.bodies[child].mass > 0:
                used.add(id(joint))
                seen.add(child)
                found.append(Branch(child, parent, joint))
                waiting.append(child)
    return found


def rotation(q: Floats) -> Floats:
    """Matrix of a unit quaternion (w, x, y, z)."""
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def times(p: Floats, q: Floats) -> Floats:
    """Product of two quaternions."""
    return np.array([p[0] * q[0] - p[1:] @ q[1:], *(p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:]))])


def inverse(q: Floats) -> Floats:
    """Of a unit quaternion."""
    return q * np.array([1.0, -1.0, -1.0, -1.0])


def shortest_turn(a: Floats, b: Floats) -> Floats:
    """Quaternion that turns a unit vector onto another one."""
    q = np.array([1.0 + a @ b, *np.cross(a, b)])
    if q[0] < 1e-9:  # half a turn about whatever is at right angles
        q[1:] = np.cross(a, np.eye(3)[np.abs(a).argmin()])
    return q / np.linalg.norm(q)
