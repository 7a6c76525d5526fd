"""Adding bodies of one shape to a world: one method per shape."""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike

from kickdrift.core.rotations import turn_to
from kickdrift.core.signatures import shows_parameters_of
from kickdrift.world.arguments import direction
from kickdrift.world.bodies.adding import AddsBodies
from kickdrift.world.bodies.handle import Body
from kickdrift.world.shapes.box import Box
from kickdrift.world.shapes.capsule import Capsule
from kickdrift.world.shapes.cone import Cone
from kickdrift.world.shapes.cylinder import Cylinder
from kickdrift.world.shapes.heightfield import HeightField
from kickdrift.world.shapes.hull import Hull
from kickdrift.world.shapes.mesh import Mesh
from kickdrift.world.shapes.plane import Plane
from kickdrift.world.shapes.sphere import Sphere

_OF_MOVABLE = (
    "velocity", "angular_velocity", "density", "mass", "inertia", "centre", "static", "kinematic", "damping", "angular_damping",
    "locked_rotation",
)  # fmt: skip


class AddsShapes(AddsBodies):
    """The methods of a world that add a body of one shape."""

    @shows_parameters_of(AddsBodies.add_body)
    def add_sphere(self, radius: float, **options: Any) -> Body:
        """Add a ball with a radius in m; options as in `add_body`.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> ball = world.add_sphere(radius=0.1, position=(0, 0, 1), density=1000.0, restitution=0.8)
        >>> round(ball.mass, 3)
        4.189
        """
        return self.add_body(Sphere(radius), **options)

    @shows_parameters_of(AddsBodies.add_body)
    def add_capsule(self, radius: float, length: float, **options: Any) -> Body:
        """Add a cylinder along z with hemispherical caps; options as in `add_body`.

        Parameters
        ----------
        radius, length : float
            In m; the length is that of the cylinder between the caps.

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
        """Add a cylinder about z, centred at its origin, with a radius and a length in m; options as in `add_body`.

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
        """Add a cone about z with a radius and a length in m; options as in `add_body`.

        The position passed in is halfway between base and tip; the position of the body is its centre of mass.

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
        """Add a box with three full edge lengths in m; options as in `add_body`.

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
        """Add the convex hull of (N, 3) points in m; options as in `add_body`.

        The position passed in is that of the origin of the points; the position of the body is its centre of mass.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> wedge = world.add_hull([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], density=600.0)
        >>> round(wedge.mass, 6)
        100.0
        """
        return self.add_body(Hull(points), **options)

    @shows_parameters_of(AddsBodies.add_body, ("position", "orientation", *_OF_MOVABLE))
    def add_plane(
        self, normal: ArrayLike = (0.0, 0.0, 1.0), point: ArrayLike = (0.0, 0.0, 0.0), **options: Any
    ) -> Body:
        """Add the half-space below a plane, which never moves.

        Parameters
        ----------
        normal : (3,) array_like
            Its outward normal; any length but zero.
        point : (3,) array_like
            Any point of the plane, m.
        **options
            As in `add_body`.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> floor = world.add_plane(normal=(0, 0, 1), friction=0.6)
        >>> ball = world.add_sphere(radius=0.1, position=(0, 0, 0.1), mass=1.0)
        >>> world.advance(1 / 60, 60)
        >>> bool(abs(ball.position[2] - 0.1) < 1e-3)
        True
        """
        return self.add_body(
            Plane(), position=point, orientation=turn_to(direction("normal", normal)), static=True, **options
        )

    @shows_parameters_of(AddsBodies.add_body, _OF_MOVABLE)
    def add_mesh(self, vertices: ArrayLike, faces: ArrayLike, **options: Any) -> Body:
        """Add an immovable triangle mesh.

        Parameters
        ----------
        vertices : (N, 3) array_like
            m.
        faces : (M, 3) array_like of int
            Indices of vertices, counter-clockwise as seen from outside.
        **options
            As in `add_body`.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> slab = world.add_mesh([(-9, -9, 0), (9, -9, 0), (0, 9, 0)], [(0, 1, 2)])
        >>> world.ray_cast(origin=(0, 0, 5), direction=(0, 0, -1)).distance
        5.0
        """
        return self.add_body(Mesh(vertices, faces), static=True, **options)

    @shows_parameters_of(AddsBodies.add_body, _OF_MOVABLE)
    def add_height_field(self, heights: ArrayLike, spacing: float, **options: Any) -> Body:
        """Add an immovable height field.

        Parameters
        ----------
        heights : (K, L) array_like
            z in m, along x and y.
        spacing : float
            Distance between neighbouring heights, m.
        **options
            As in `add_body`.

        Examples
        --------
        >>> import numpy as np, kickdrift as kd
        >>> world = kd.World()
        >>> hills = world.add_height_field(np.full((5, 5), 0.5), spacing=1.0)
        >>> round(world.ray_cast(origin=(0.2, 0.1, 5), direction=(0, 0, -1)).distance, 6)
        4.5
        """
        return self.add_body(HeightField(heights, spacing), static=True, **options)
