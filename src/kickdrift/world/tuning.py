"""What may be changed between the steps of a world."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.errors import ArgumentError
from kickdrift.world.arguments import choice, vector
from kickdrift.world.bodies import Bodies
from kickdrift.world.settings import GRAVITY, SUBSTEPS
from kickdrift.world.tables import SETTINGS, Tables


class Tunable:
    """The settings of a world that are attributes."""

    tables: Tables
    bodies: Bodies
    _sleeping: bool

    @property
    def gravity(self) -> NDArray[np.float64]:
        """Acceleration of what falls, (3,), m/s^2; give another one to change it."""
        return self.tables.array(SETTINGS)[0, GRAVITY : GRAVITY + 3].copy()

    @gravity.setter
    def gravity(self, gravity: ArrayLike) -> None:
        self.tables.array(SETTINGS)[0, GRAVITY : GRAVITY + 3] = vector("gravity", gravity, 3)
        self.bodies.wake()

    @property
    def substeps(self) -> int:
        """Parts of a step in which contacts and joints are solved; give another number to change it."""
        return int(self.tables.array(SETTINGS)[0, SUBSTEPS])

    @substeps.setter
    def substeps(self, substeps: int) -> None:
        if isinstance(substeps, bool) or not (isinstance(substeps, int | np.integer) and substeps >= 1):
            raise ArgumentError(f"substeps={substeps!r} has to be a whole number from 1 on.")
        self.tables.array(SETTINGS)[0, SUBSTEPS] = substeps

    @property
    def sleeping(self) -> bool:
        """Whether islands that have rested are left alone; may be given anew, and False wakes all."""
        return self._sleeping

    @sleeping.setter
    def sleeping(self, sleeping: bool) -> None:
        self._sleeping = choice("sleeping", sleeping)
        if not sleeping:
            self.bodies.wake()
