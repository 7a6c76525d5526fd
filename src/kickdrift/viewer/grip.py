"""A grip on a body: the spring by which a mouse pulls it."""

import math

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from kickdrift.core.rotations import turned
from kickdrift.world.bodies.handle import Body
from kickdrift.world.joints.layout import BODY_A, BODY_B, JOINT_KIND, REMOVED_JOINT
from kickdrift.world.layout import BODY_KIND, DYNAMIC, MASS
from kickdrift.world.tables import BODY, INERTIA, JOINT
from kickdrift.world.world import World

Floats = NDArray[np.float64]
_HERTZ = 3.0  # of the spring: what hangs on it hangs 28 mm below the mouse


class Grip:
    """A spring with a damper from a point of a body to where it is pulled.

    Parameters
    ----------
    world : World
    body : Body
        One that forces move.
    point : (3,) array
        The point, in the world, m.
    step : float
        Of the world, s: the force is the same all through a step.

    Attributes
    ----------
    target : (3,) array
        Where the point is pulled to, in the world, m.

    Notes
    -----
    With M the mass of the body and of all that joints hold to it, the force is K d - C v, d the way to the target and v the
    velocity of the point: K = M w^2 and C = 2 M w, critically damped at 3 Hz.

    The least effective mass m of the body at the point limits both. In an explicit step h a free body has, in the direction
    in which that is the mass, v' = (1 - h C / m) v + h K / m d and d' = d - h v': for C = m / h, d shrinks by 1 - h^2 K / m,
    and so K <= m / (2 h^2). Joints and contacts only add to the effective mass, and it does not change as the body turns.
    Where the body turns by an angle a in a step, the force no longer opposes the velocity of the point, and would drive the
    spin of a needle: its torque is divided by 1 + a^2.
    """

    def __init__(self, world: World, body: Body, point: Floats, step: float) -> None:
        self._world, self.body = world, body
        self._arm = turned(body.orientation * (1.0, -1.0, -1.0, -1.0), point - body.position)
        self.target: Floats = point
        self._step = step
        rate, mass, least = 2.0 * math.pi * _HERTZ, _joined_mass(world, body), _least_mass(body, self._arm)
        self._stiffness = min(mass * rate**2, 0.5 * least / step**2)
        self._damping = min(2.0 * mass * rate, least / step)

    @property
    def point(self) -> Floats:
        """Where the point is now, in the world, m."""
        point: Floats = self.body.position + turned(self.body.orientation, self._arm)
        return point

    def pull(self) -> None:
        """Apply its force during the next step."""
        point, body = self.point, self.body
        velocity = body.velocity + np.cross(body.angular_velocity, point - body.position)
        force = self._stiffness * (self.target - point) - self._damping * velocity
        turn = self._step * float(np.linalg.norm(body.angular_velocity))
        self._world.apply_force(body, force)
        self._world.apply_torque(body, np.cross(point - body.position, force) / (1.0 + turn * turn))


def _least_mass(body: Body, arm: Floats) -> float:
    """Return the least effective mass at a point, by all directions: F accelerates it by F / m + (I^-1 (r x F)) x r."""
    inverse = np.eye(3) / body.mass
    if not body.locked_rotation:
        cross = np.cross(arm, np.eye(3)).T  # cross @ F = r x F
        inverse += cross.T @ np.linalg.solve(body.inertia, cross)
    return 1.0 / float(np.linalg.eigvalsh(inverse)[-1])


def _joined_mass(world: World, body: Body) -> float:
    """Return the mass of a body and of all that joints hold to it, kg."""
    moves = world.tables.array(BODY)[:, BODY_KIND] == DYNAMIC
    joints = world.tables.array(JOINT)
    a, b = joints[joints[:, JOINT_KIND] != REMOVED_JOINT][:, [BODY_A, BODY_B]].T
    held = moves[a] & moves[b]
    graph = coo_array((held[held], (a[held], b[held])), shape=(moves.size, moves.size))
    _, islands = connected_components(graph, directed=False)
    joined = moves & (islands == islands[body.index])
    return float(world.tables.array(INERTIA)[joined, MASS].sum())
