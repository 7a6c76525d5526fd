"""Conserved quantities of a world: energy, momentum and angular momentum."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.rotations import cross, matrices
from kickdrift.world import settings
from kickdrift.world.bodies.registry import Bodies
from kickdrift.world.deformables.energy import cloth_angular_momentum, cloth_energy, cloth_momentum
from kickdrift.world.layout import ANGULAR_VELOCITY, BODY_INERTIA, MASS, ORIENTATION, POSITION, VELOCITY
from kickdrift.world.tables import INERTIA, MOTION, POSE, SETTINGS, Tables

Floats = NDArray[np.float64]


class Energy(NamedTuple):
    """Energy of dynamic bodies and of cloths, ropes and soft bodies, J.

    Attributes
    ----------
    kinetic : float
        Translational and rotational.
    potential : float
        Of gravity, zero at the origin, plus the elastic energy of cloths, ropes and soft bodies. That of springs and drives
        at joints is not part of it, nor is that of force functions.
    """

    kinetic: float
    potential: float

    @property
    def total(self) -> float:
        """Sum of both."""
        return self.kinetic + self.potential


class ConservedQuantities:
    """The methods of a world that measure what it conserves."""

    tables: Tables
    bodies: Bodies

    def energy(self) -> Energy:
        """Measure kinetic and potential energy.

        Returns
        -------
        Energy
            ``energy().kinetic``, ``.potential`` and ``.total``, J.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> ball = world.add_sphere(radius=0.1, mass=2.0, velocity=(3, 0, 0))
        >>> world.energy().kinetic
        9.0
        """
        return energy(self.tables, self.bodies)

    def momentum(self) -> Floats:
        """Measure the momentum.

        Returns
        -------
        (3,) array
            kg m/s.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> ball = world.add_sphere(radius=0.1, mass=2.0, velocity=(3, 0, 0))
        >>> world.momentum()
        array([6., 0., 0.])
        """
        return momentum(self.tables, self.bodies)

    def angular_momentum(self) -> Floats:
        """Measure the angular momentum about the origin.

        Returns
        -------
        (3,) array
            kg m^2/s.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> ball = world.add_sphere(radius=0.1, mass=2.0, position=(0, 1, 0), velocity=(3, 0, 0))
        >>> world.angular_momentum()
        array([ 0.,  0., -6.])
        """
        return angular_momentum(self.tables, self.bodies)


def energy(tables: Tables, bodies: Bodies) -> Energy:
    """Measure the energy of dynamic bodies and of cloths, J."""
    rows = bodies.moving()
    mass, velocity = tables.array(INERTIA)[rows, MASS], tables.array(MOTION)[rows, VELOCITY : VELOCITY + 3]
    turn = tables.array(MOTION)[rows, ANGULAR_VELOCITY : ANGULAR_VELOCITY + 3]
    kinetic = 0.5 * mass @ np.sum(velocity**2, axis=1) + 0.5 * np.sum(turn * _spin(tables, rows))
    gravity = tables.array(SETTINGS)[0, settings.GRAVITY : settings.GRAVITY + 3]
    of_cloths = cloth_energy(tables)
    potential = -mass @ (tables.array(POSE)[rows, POSITION : POSITION + 3] @ gravity)
    return Energy(float(kinetic) + of_cloths[0], float(potential) + of_cloths[1])


def momentum(tables: Tables, bodies: Bodies) -> Floats:
    """Measure the momentum, (3,), kg m/s."""
    rows = bodies.moving()
    total: Floats = tables.array(INERTIA)[rows, MASS] @ tables.array(MOTION)[rows, VELOCITY : VELOCITY + 3]
    return total + cloth_momentum(tables)


def angular_momentum(tables: Tables, bodies: Bodies) -> Floats:
    """Measure the angular momentum about the origin, (3,), kg m^2/s."""
    rows = bodies.moving()
    push = tables.array(INERTIA)[rows, MASS, None] * tables.array(MOTION)[rows, VELOCITY : VELOCITY + 3]
    total: Floats = (cross(tables.array(POSE)[rows, POSITION : POSITION + 3], push) + _spin(tables, rows)).sum(axis=0)
    return total + cloth_angular_momentum(tables)


def _spin(tables: Tables, rows: NDArray[np.intp]) -> Floats:
    """Return the angular momentum of each body about its centre of mass, (N, 3), kg m^2/s."""
    xx, yy, zz, xy, xz, yz = tables.array(INERTIA)[rows, BODY_INERTIA : BODY_INERTIA + 6].T
    moments = np.stack((xx, xy, xz, xy, yy, yz, xz, yz, zz), axis=-1).reshape(-1, 3, 3)
    turn = matrices(tables.array(POSE)[rows, ORIENTATION : ORIENTATION + 4])
    spin: Floats = np.einsum(
        "nij,njk,nlk,nl->ni", turn, moments, turn, tables.array(MOTION)[rows, ANGULAR_VELOCITY : ANGULAR_VELOCITY + 3]
    )
    return spin
