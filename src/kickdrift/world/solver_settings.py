"""Settings of a world that can be changed between steps, and the residual that shows whether they should be."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.arguments import is_whole
from kickdrift.core.errors import ArgumentError
from kickdrift.world.argument_checks import choice, vector
from kickdrift.world.bodies.handle import Body
from kickdrift.world.bodies.registry import Bodies
from kickdrift.world.collision.broad_phase.filters_and_sensors import exclude
from kickdrift.world.deformables.registry import Cloths
from kickdrift.world.settings import GRAVITY, RESIDUAL, SUBSTEPS
from kickdrift.world.tables import ASKED_APART, SETTINGS, Tables
from kickdrift.world.world_lock import undivided

MOST_SUBSTEPS = 10_000


class Tunable:
    """The settings of a world that are attributes."""

    tables: Tables
    bodies: Bodies
    cloths: Cloths
    _sleeping: bool

    @property
    def gravity(self) -> NDArray[np.float64]:
        """Gravitational acceleration, (3,), m/s^2; a read-only array: assign another one to change it."""
        acceleration = self.tables.array(SETTINGS)[0, GRAVITY : GRAVITY + 3].copy()
        acceleration.flags.writeable = False
        return acceleration

    @gravity.setter
    @undivided
    def gravity(self, gravity: ArrayLike) -> None:
        self.tables.array(SETTINGS)[0, GRAVITY : GRAVITY + 3] = vector("gravity", gravity, 3)
        self.bodies.wake()
        self.cloths.wake()

    @property
    def substeps(self) -> int:
        """Number of equal parts of a step, in each of which contacts and joints are solved; can be set.

        More of them make contacts stiffer. Under a high stack, raise the number gradually: with few substeps its boxes overlap
        more, and a jump to many pushes them apart.
        """
        return int(self.tables.array(SETTINGS)[0, SUBSTEPS])

    @substeps.setter
    @undivided
    def substeps(self, substeps: int) -> None:
        if not is_whole(substeps, 1, MOST_SUBSTEPS):
            raise ArgumentError(f"substeps={substeps!r} must be a whole number from 1 to {MOST_SUBSTEPS}.")
        self.tables.array(SETTINGS)[0, SUBSTEPS] = substeps
        self.tables.altered = True

    @property
    def sleeping(self) -> bool:
        """Whether islands at rest are skipped; can be set, which wakes all bodies and cloths."""
        return self._sleeping

    @sleeping.setter
    @undivided
    def sleeping(self, sleeping: bool) -> None:
        self._sleeping = choice("sleeping", sleeping)
        self.tables.altered = True
        self.bodies.wake()
        self.cloths.wake()

    @property
    def residual(self) -> float:
        """The largest normal speed that the solver left at points of contact in the last step, m/s; read-only.

        Zero if every impulse is exact; otherwise the speed at which a loaded stack sinks or jitters. Contacts of bodies with
        joints are included. More substeps make it smaller.
        """
        return float(self.tables.array(SETTINGS)[0, RESIDUAL])

    @undivided
    def exclude(self, body_a: Body, body_b: Body) -> None:
        """Exclude two bodies from colliding; bodies connected by a joint never collide.

        Parameters
        ----------
        body_a, body_b : Body

        Raises
        ------
        ArgumentError
            For a body with itself, and removed bodies.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> one = world.add_sphere(radius=0.1, mass=1.0)
        >>> other = world.add_sphere(radius=0.1, position=(0.05, 0, 0), mass=1.0)
        >>> world.exclude(one, other)
        >>> world.step(1 / 60)
        >>> world.touching
        []
        """
        pair = (self.bodies.row(body_a, "body_a"), self.bodies.row(body_b, "body_b"))
        if pair[0] == pair[1]:
            raise ArgumentError(f"body_b={body_b!r} is body_a, but parts of one body never touch; give another body.")
        exclude(self.tables, [*self.tables.array(ASKED_APART).tolist(), pair])
        self.bodies.wake()
