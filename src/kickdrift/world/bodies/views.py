"""Positions and velocities of the bodies of a world, as views into its tables."""

import numpy as np
from numpy.typing import NDArray

from kickdrift.world import layout
from kickdrift.world.bodies.handle import Body
from kickdrift.world.bodies.registry import Bodies
from kickdrift.world.tables import MOTION, POSE, Tables

Floats = NDArray[np.float64]


class BodyViews:
    """The attributes of a world that are arrays with one row per body."""

    tables: Tables
    bodies: Bodies

    @property
    def ground(self) -> Body:
        """The ground, which never moves: row 0, to which joints can be attached."""
        return self.bodies.ground

    @property
    def position(self) -> Floats:
        """Centres of mass, (N, 3), m, one row per body; row 0 is the ground.

        This is a live view, as are the other arrays: writing into it moves the bodies. Get it again after adding bodies.
        """
        return self.tables.array(POSE)[:, layout.POSITION : layout.POSITION + 3]

    @property
    def orientation(self) -> Floats:
        """Quaternions (w, x, y, z) that turn the bodies' axes into the world's, (N, 4)."""
        return self.tables.array(POSE)[:, layout.ORIENTATION : layout.ORIENTATION + 4]

    @property
    def velocity(self) -> Floats:
        """Velocities of the centres of mass, (N, 3), m/s."""
        return self.tables.array(MOTION)[:, layout.VELOCITY : layout.VELOCITY + 3]

    @property
    def angular_velocity(self) -> Floats:
        """Angular velocities in the world's axes, (N, 3), rad/s."""
        return self.tables.array(MOTION)[:, layout.ANGULAR_VELOCITY : layout.ANGULAR_VELOCITY + 3]
