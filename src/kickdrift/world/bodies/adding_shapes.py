"""Adding bodies of one shape to a world: one method per shape that can move."""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike

from kickdrift.core.signatures import shows_parameters_of
from kickdrift.world.bodies.adding import AddsBodies
from kickdrift.world.bodies.handle import Body
from kickdrift.world.shapes.box import Box
from kickdrift.world.shapes.capsule import Capsule
from kickdrift.world.shapes.cone import Cone
from kickdrift.world.shapes.cylinder import Cylinder
from kickdrift.world.shapes.hull import Hull
from kickdrift.world.shapes.sphere import Sphere


class AddsShapes(AddsBodies):
    """The methods of a world that add a body of one shape, which can move."""

    @shows_parameters_of(AddsBodies.add_body)
    def add_sphere(self, radius: float, **options: Any) -> Body:
        """Add a ball.

        Parameters
        ----------
        radius : float
            m.
        **options
            As in `add_body`.

        Returns
        -------
        Body

        Raises
        ------
        ArgumentError
            For a radius that is not positive and finite, and as `add_body`.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> ball = world.add_sphere(
        ...     radius=0.1, position=(0, 0, 1), density=1000.0, restitution=0.8
        ... )
        >>> round(ball.mass, 3)
        4.189
        """
        return self.add_body(Sphere(radius), **options)

    @shows_parameters_of(AddsBodies.add_body)
    def add_capsule(self, radius: float, length: float, **options: Any) -> Body:
        """Add a cylinder along z with hemispherical caps.

        Parameters
        ----------
        radius, length : float
            m; the length is that of the cylinder between the caps.
        **options
            As in `add_body`.

        Returns
        -------
        Body

        Raises
        ------
        ArgumentError
            For lengths that are not positive and finite, and as `add_body`.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> rod = world.add_capsule(radius=0.1, length=1.0, position=(0, 0, 1), mass=2.0)
        >>> rod.mass
        2.0
        """
        return self.add_body(Capsule(radius, length), **options)

    @shows_parameters_of(AddsBodies.add_body)
    def add_cylinder(self, radius: float, length: float, **options: Any) -> Body:
        """Add a cylinder about z, centred at its origin.

        Parameters
        ----------
        radius, length : float
            m.
        **options
            As in `add_body`.

        Returns
        -------
        Body

        Raises
        ------
        ArgumentError
            For lengths that are not positive and finite, and as `add_body`.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> can = world.add_cylinder(radius=0.1, length=0.3, position=(0, 0, 0.15), mass=1.0)
        >>> round(float(can.inertia[2, 2]), 6)
        0.005
        """
        return self.add_body(Cylinder(radius, length), **options)

    @shows_parameters_of(AddsBodies.add_body)
    def add_cone(self, radius: float, length: float, **options: Any) -> Body:
        """Add a cone about z, with its tip above.

        The position passed in is halfway between base and tip; the position of the body is its centre of mass.

        Parameters
        ----------
        radius, length : float
            Of the base, and from the base to the tip, m.
        **options
            As in `add_body`.

        Returns
        -------
        Body

        Raises
        ------
        ArgumentError
            For lengths that are not positive and finite, and as `add_body`.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> cone = world.add_cone(radius=0.1, length=0.4, mass=1.0)
        >>> cone.position.round(6)
        array([ 0. ,  0. , -0.1])
        """
        return self.add_body(Cone(radius, length), **options)

    @shows_parameters_of(AddsBodies.add_body)
    def add_box(self, size: ArrayLike, **options: Any) -> Body:
        """Add a box, centred at its origin.

        Parameters
        ----------
        size : (3,) array_like
            Lengths of its edges, m.
        **options
            As in `add_body`.

        Returns
        -------
        Body

        Raises
        ------
        ArgumentError
            For lengths that are not positive and finite, and as `add_body`.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> box = world.add_box(size=(1, 1, 1), position=(0, 0, 0.5), mass=50.0, friction=0.6)
        >>> box.position
        array([0. , 0. , 0.5])
        """
        return self.add_body(Box(size), **options)

    @shows_parameters_of(AddsBodies.add_body)
    def add_hull(self, points: ArrayLike, **options: Any) -> Body:
        """Add the convex hull of some points.

        The position passed in is that of the origin of the points; the position of the body is its centre of mass.

        Parameters
        ----------
        points : (N, 3) array_like
            m.
        **options
            As in `add_body`.

        Returns
        -------
        Body

        Raises
        ------
        ArgumentError
            For points that are not finite, fewer than four or all in one plane, for hulls of more than 128 corners,
            and as `add_body`.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> wedge = world.add_hull([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], density=600.0)
        >>> round(wedge.mass, 6)
        100.0
        """
        return self.add_body(Hull(points), **options)
