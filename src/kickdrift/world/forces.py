"""Applying forces in a world: for one step, or as functions compiled into the step."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.core.compilation import Function
from kickdrift.world.argument_checks import vector
from kickdrift.world.bodies.handle import Body
from kickdrift.world.bodies.registry import Bodies
from kickdrift.world.deformables.wind_functions import WINDS
from kickdrift.world.force_functions import Force, force_of
from kickdrift.world.layout import LOAD_FORCE, LOAD_TORQUE, POSITION
from kickdrift.world.tables import LOAD, POSE, Tables
from kickdrift.world.world_lock import alone, undivided


class AppliesForces:
    """The methods of a world that apply forces, and let winds blow."""

    tables: Tables
    bodies: Bodies
    forces: list[Force]

    @alone
    def apply_force(self, body: Body, force: ArrayLike, point: ArrayLike | None = None) -> None:
        """Apply a force to a body during the next step; forces add up.

        Parameters
        ----------
        body : Body
        force : (3,) array_like
            N, in the world's axes.
        point : (3,) array_like, optional
            Point of application, in the world, m; the centre of mass by default.

        Raises
        ------
        ArgumentError
            For a static, kinematic or removed body, and for numbers that are not finite.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> ball = world.add_sphere(radius=0.1, mass=2.0)
        >>> world.apply_force(ball, (0, 0, 2 * 9.81))
        >>> world.step(1 / 60)
        >>> bool(abs(ball.velocity).max() < 1e-12)
        True
        """
        row, f = self.bodies.moved_row(body), vector("force", force, 3)
        at = None if point is None else vector("point", point, 3)
        load = self.tables.row(LOAD, row)
        load[LOAD_FORCE : LOAD_FORCE + 3] += f
        if at is not None:
            load[LOAD_TORQUE : LOAD_TORQUE + 3] += np.cross(at - self.tables.row(POSE, row)[POSITION : POSITION + 3], f)

    @alone
    def apply_torque(self, body: Body, torque: ArrayLike) -> None:
        """Apply a torque to a body during the next step; torques add up.

        Parameters
        ----------
        body : Body
        torque : (3,) array_like
            N m, in the world's axes.

        Raises
        ------
        ArgumentError
            For a static, kinematic or removed body, and for numbers that are not finite.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> disk = world.add_cylinder(radius=0.5, length=0.1, mass=8.0)
        >>> world.apply_torque(disk, (0, 0, 6.0))
        >>> world.step(1 / 60)
        >>> disk.angular_velocity.round(6)
        array([0. , 0. , 0.1])
        """
        row, t = self.bodies.moved_row(body), vector("torque", torque, 3)
        self.tables.row(LOAD, row)[LOAD_TORQUE : LOAD_TORQUE + 3] += t

    def add_force(self, force: Function) -> None:
        """Apply a force function of your own in every substep, compiled into the step.

        It is called at both ends of each substep: free bodies, and jointed ones without motors, drives and friction, then move
        as in the velocity Verlet method. Its result must depend on its arguments alone, because it is called more often than
        that: once for the search for contacts, and again where a step is repeated or done in parts. It does not wake sleeping
        bodies (``World(sleeping=True)``), even when it changes; `apply_force` does.

        Parameters
        ----------
        force : callable
            Its argument names declare what it needs, in any order: `t`, `position`, `orientation`, `velocity`,
            `angular_velocity`, `mass`, and `force` (N) and `torque` (N m), to which it adds in place; arrays with one row
            per body, in the world's axes. Numbers and arrays that it captures keep their present values.

        Raises
        ------
        ArgumentError
            If it is not a function, has an argument with an unknown name or neither `force` nor `torque`, or cannot be
            compiled.

        Examples
        --------
        >>> import kickdrift as kd
        >>> def drag(velocity, force):
        ...     for body in range(len(force)):
        ...         for k in range(3):
        ...             force[body, k] -= 0.5 * velocity[body, k]
        >>> world = kd.World()
        >>> ball = world.add_sphere(radius=0.1, mass=1.0)
        >>> world.add_force(drag)
        >>> world.advance(1 / 60, 1200)
        >>> round(float(ball.velocity[2]), 1)
        -19.6
        """
        self._keep_force(force_of(force))  # Ctrl-C need not wait for the compiler

    def add_wind(self, wind: Function) -> None:
        """Add a wind, as a Python function that is compiled into the step; it adds to `Cloth.wind` of every cloth.

        `kickdrift.gusts` returns such a function, for a gusting wind. Sleeping cloths are not woken by it.

        Parameters
        ----------
        wind : callable
            Its argument names declare what it needs, in any order: `t` (s), `position` (m), `velocity` (m/s), and `wind`
            (m/s), to which it adds in place; arrays with one row per vertex of all cloths. The wind must depend on its
            arguments only. Numbers and arrays that it captures keep their present values.

        Raises
        ------
        ArgumentError
            If it is not a function, has an argument with an unknown name, has no `wind`, or cannot be compiled.

        Examples
        --------
        >>> import numpy as np
        >>> import kickdrift as kd
        >>> def storm(t, position, wind):
        ...     for i in range(len(wind)):
        ...         wind[i, 0] += 8.0 * np.tanh(position[i, 2]) * (1.0 - np.exp(-t))
        >>> world = kd.World(gravity=(0, 0, 0))
        >>> leaf = world.add_cloth_grid(
        ...     size=(0.1, 0.1), vertices=(3, 3), position=(0, 0, 2), drag=1.2
        ... )
        >>> leaf.position[:] = leaf.position[:, ::-1] + (0, 0, 2)
        >>> world.add_wind(storm)
        >>> world.advance(1 / 60, 300)
        >>> bool(5.0 < leaf.velocity[:, 0].min() < 8.0)
        True
        """
        self._keep_force(force_of(wind, WINDS))

    @undivided
    def _keep_force(self, force: Force) -> None:
        self.forces.append(force)
        self.tables.altered = True
