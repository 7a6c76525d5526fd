"""The handle of a body, which reads and sets its properties."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.world.argument_checks import choice, number, unit_quaternion, vector
from kickdrift.world.handle import Handle
from kickdrift.world.tables import MOTION, POSE

if TYPE_CHECKING:
    from kickdrift.world.bodies.registry import Bodies

Floats = NDArray[np.float64]


class _Views(NamedTuple):
    """Views of a body's columns in the tables, valid for one version of these."""

    version: int
    position: Floats
    orientation: Floats
    velocity: Floats
    angular_velocity: Floats


class Body(Handle):
    """A body of a world.

    Attributes
    ----------
    index : int
        Its row in `World.position` and the other arrays.
    generation : int
        How many bodies were added before it; tells its handle from those of earlier occupants of its row.

    Notes
    -----
    Poses and velocities are live views of the rows of `World.position` and the like: writing into them moves the body; copy
    values that are to be kept. Assign the pose of a static body as a whole (``wall.position = ...``), so that collision
    detection is updated. Once the body has been removed, access to its state raises `ArgumentError`, as does assigning an
    invalid value.

    Examples
    --------
    >>> import kickdrift as kd
    >>> world = kd.World()
    >>> ball = world.add_sphere(radius=0.1, position=(0, 0, 1), mass=2.0)
    >>> ball.velocity = (3, 0, 0)
    >>> ball.velocity[2] = 4
    >>> world.energy().kinetic
    25.0
    """

    __slots__ = ("_bodies", "_views")
    registered_in = "bodies"

    def __init__(self, index: int, generation: int, bodies: Bodies) -> None:
        self._index, self._generation, self._bodies = index, generation, bodies
        self._last_name = bodies.names.of(index)
        self._views: _Views | None = None

    @property
    def bodies(self) -> Bodies:
        """The bodies of its world."""
        return self._bodies

    @property
    def _registry(self) -> Bodies:
        return self._bodies

    @property
    def position(self) -> Floats:
        """Centre of mass, (3,), m; can be set."""
        return self._current_views().position

    @position.setter
    def position(self, position: ArrayLike) -> None:
        self._bodies.place(self, slice(0, 3), vector("position", position, 3))

    @property
    def orientation(self) -> Floats:
        """Quaternion (w, x, y, z) that turns the body's axes into the world's, (4,); can be set."""
        return self._current_views().orientation

    @orientation.setter
    def orientation(self, orientation: ArrayLike) -> None:
        self._bodies.place(self, slice(3, 7), unit_quaternion("orientation", orientation))

    @property
    def velocity(self) -> Floats:
        """Velocity of the centre of mass, (3,), m/s; can be set, except for static bodies."""
        return self._current_views().velocity

    @velocity.setter
    def velocity(self, velocity: ArrayLike) -> None:
        self._bodies.move(self, slice(0, 3), vector("velocity", velocity, 3))

    @property
    def angular_velocity(self) -> Floats:
        """Angular velocity in the world's axes, (3,), rad/s; can be set, except for static bodies."""
        return self._current_views().angular_velocity

    @angular_velocity.setter
    def angular_velocity(self, angular_velocity: ArrayLike) -> None:
        self._bodies.move(self, slice(3, 6), vector("angular_velocity", angular_velocity, 3))

    @property
    def mass(self) -> float:
        """Mass, kg; infinite for static and kinematic bodies. Setting it scales the inertia; velocities do not change."""
        return self._bodies.mass(self).mass

    @mass.setter
    def mass(self, mass: float) -> None:
        self._bodies.change_mass(self, mass=number("mass", mass, "kg", zero=False))

    @property
    def inertia(self) -> Floats:
        """Inertia about the centre of mass in the body's axes, (3, 3), kg m^2, a copy; can be set, also as (3,)."""
        return self._bodies.mass(self).inertia

    @inertia.setter
    def inertia(self, inertia: ArrayLike) -> None:
        self._bodies.change_mass(self, inertia=inertia)

    @property
    def locked_rotation(self) -> bool:
        """Whether it cannot rotate; can be set, and True stops its rotation."""
        return self._bodies.locked(self)

    @locked_rotation.setter
    def locked_rotation(self, locked: bool) -> None:
        self._bodies.change_mass(self, locked=choice("locked_rotation", locked))
        if locked:
            self._current_views().angular_velocity[:] = 0.0

    @property
    def friction(self) -> float:
        """Coefficient of friction of its shapes; setting it applies to all. ArgumentError if they differ."""
        return self._bodies.surface(self, "friction")

    @friction.setter
    def friction(self, friction: float) -> None:
        self._bodies.change_surface(self, "friction", friction)

    @property
    def restitution(self) -> float:
        """Restitution of its shapes, from 0 to 1; setting it applies to all. ArgumentError if they differ."""
        return self._bodies.surface(self, "restitution")

    @restitution.setter
    def restitution(self, restitution: float) -> None:
        self._bodies.change_surface(self, "restitution", restitution)

    def _current_views(self) -> _Views:
        """Return views of the row; they are made again only after rows have been removed or tables have moved in memory."""
        views, tables = self._views, self._bodies.tables
        if views is None or views.version != tables.version:
            row = self._bodies.row(self)
            pose, motion = tables.row(POSE, row), tables.row(MOTION, row)
            views = self._views = _Views(tables.version, pose[:3], pose[3:7], motion[:3], motion[3:6])
        return views
