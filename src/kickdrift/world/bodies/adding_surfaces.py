"""Adding planes, meshes and height fields to a world, which never move."""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike

from kickdrift.core.rotations import turn_to
from kickdrift.core.signatures import shows_parameters_of
from kickdrift.world.argument_checks import direction
from kickdrift.world.bodies.adding import AddsBodies
from kickdrift.world.bodies.handle import Body
from kickdrift.world.shapes.heightfield import HeightField
from kickdrift.world.shapes.mesh import Mesh
from kickdrift.world.shapes.plane import Plane

_OF_MOVABLE = (
    "velocity", "angular_velocity", "density", "mass", "inertia", "centre", "static", "kinematic", "damping", "angular_damping",
    "locked_rotation",
)  # fmt: skip


class AddsSurfaces(AddsBodies):
    """The methods of a world that add surfaces for bodies to stand on."""

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

        Returns
        -------
        Body

        Raises
        ------
        ArgumentError
            For a normal of length zero; and as `add_body`.

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

        Returns
        -------
        Body

        Raises
        ------
        ArgumentError
            For vertices that are not finite, triangles without area, neighbours that face opposite sides; and as `add_body`.

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
        spacing : float or (2,) array_like
            Distance between neighbouring heights, m; or those along x and y.
        **options
            As in `add_body`.

        Returns
        -------
        Body

        Raises
        ------
        ArgumentError
            For heights that are not finite, fewer than two along x or y, or a spacing that is not positive; and as `add_body`.

        Examples
        --------
        >>> import numpy as np, kickdrift as kd
        >>> world = kd.World()
        >>> hills = world.add_height_field(np.full((5, 5), 0.5), spacing=1.0)
        >>> round(world.ray_cast(origin=(0.2, 0.1, 5), direction=(0, 0, -1)).distance, 6)
        4.5
        """
        return self.add_body(HeightField(heights, spacing), static=True, **options)
