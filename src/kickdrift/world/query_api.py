"""Spatial queries: ray casts, and overlaps with boxes and spheres."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.errors import ArgumentError
from kickdrift.world.bodies.handle import Body
from kickdrift.world.bodies.registry import Bodies
from kickdrift.world.collision.queries import world_queries
from kickdrift.world.collision.queries.query_arguments import one_vector
from kickdrift.world.collision.queries.world_queries import RayHit, RayHits
from kickdrift.world.layout import BODY_ROW
from kickdrift.world.tables import SHAPE, Tables
from kickdrift.world.world_lock import alone

_Ignored = Body | Iterable[Body]


class SpatialQueries:
    """The spatial queries of a world; none of them changes it."""

    tables: Tables
    bodies: Bodies

    @alone
    def ray_cast(
        self,
        origin: ArrayLike,
        direction: ArrayLike,
        limit: float = np.inf,
        layers: Iterable[int] | None = None,
        ignore: _Ignored = (),
    ) -> RayHit | None:
        """Return the nearest shape that a ray hits, or None.

        Parameters
        ----------
        origin : (3,) array_like
            m.
        direction : (3,) array_like
            Any length but zero.
        limit : float
            Length of the ray, m.
        layers : iterable of int, optional
            Layers whose shapes it can hit, from 0 to 61; all by default.
        ignore : Body or iterable of Body
            Bodies that it passes through, such as the one that casts it.

        Returns
        -------
        RayHit or None
            With the body, the distance, the point and the normal there.

        Raises
        ------
        ArgumentError
            If the origin is not finite, the direction has no length, or the limit or a layer is invalid; and for bodies to
            ignore that have been removed.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> ball = world.add_sphere(radius=0.5)
        >>> hit = world.ray_cast(origin=(0, 0, 5), direction=(0, 0, -1))
        >>> hit.body == ball, hit.distance
        (True, 4.5)
        """
        ray = one_vector("origin", origin), one_vector("direction", direction)
        found = self._hits(world_queries.ray_cast_many(self.tables, *ray, limit, layers, self._ignored(ignore)))
        return found[0] if found else None

    @alone
    def ray_cast_all(
        self,
        origin: ArrayLike,
        direction: ArrayLike,
        limit: float = np.inf,
        layers: Iterable[int] | None = None,
        ignore: _Ignored = (),
    ) -> list[RayHit]:
        """Return the first hit of a ray on every shape along it, nearest first.

        Parameters
        ----------
        origin, direction, limit, layers, ignore
            As in `ray_cast`.

        Returns
        -------
        list of RayHit

        Raises
        ------
        ArgumentError
            As `ray_cast`.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> balls = [world.add_sphere(radius=0.5, position=(0, 0, z)) for z in (0, 2)]
        >>> [hit.distance for hit in world.ray_cast_all(origin=(0, 0, 5), direction=(0, 0, -1))]
        [2.5, 4.5]
        """
        return self._hits(
            world_queries.ray_cast_all(self.tables, origin, direction, limit, layers, self._ignored(ignore))
        )

    @alone
    def ray_cast_many(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        limit: float = np.inf,
        layers: Iterable[int] | None = None,
        ignore: _Ignored = (),
    ) -> RayHits:
        """Return the nearest shape that each of many rays hits, as arrays.

        Parameters
        ----------
        origins : (N, 3) or (3,) array_like
            m.
        directions : (N, 3) array_like
            Any lengths but zero.
        limit, layers, ignore
            As in `ray_cast`.

        Returns
        -------
        RayHits
            One row per ray; the distance is infinite where it hits nothing.

        Raises
        ------
        ArgumentError
            As `ray_cast`, and for numbers of origins and directions that differ.

        Examples
        --------
        >>> import numpy as np, kickdrift as kd
        >>> world = kd.World()
        >>> ball = world.add_sphere(radius=0.5)
        >>> hits = world.ray_cast_many(
        ...     np.array([[0, 0, 5], [1, 0, 5]]), np.array([[0, 0, -1], [0, 0, -1]])
        ... )
        >>> hits.distance
        array([4.5, inf])
        """
        return world_queries.ray_cast_many(self.tables, origins, directions, limit, layers, self._ignored(ignore))

    @alone
    def overlap_box(
        self,
        size: ArrayLike,
        position: ArrayLike = (0.0, 0.0, 0.0),
        orientation: ArrayLike = (1.0, 0.0, 0.0, 0.0),
        layers: Iterable[int] | None = None,
        ignore: _Ignored = (),
    ) -> list[Body]:
        """Return the bodies that overlap a box.

        Parameters
        ----------
        size : (3,) array_like
            Lengths of its edges, m.
        position : (3,) array_like
            Of its centre, m.
        orientation : (4,) array_like
            Quaternion (w, x, y, z) that turns its axes into the world's.
        layers : iterable of int, optional
            Layers whose shapes count, from 0 to 61; all by default.
        ignore : Body or iterable of Body
            Bodies that do not count.

        Returns
        -------
        list of Body

        Raises
        ------
        ArgumentError
            If the size is not positive, or the pose is not finite; and for bodies to ignore that have been removed.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> ball = world.add_sphere(radius=0.5)
        >>> world.overlap_box(size=(1, 1, 1), position=(0.9, 0, 0)) == [ball]
        True
        """
        ignored = self._ignored(ignore)
        return self._bodies_of(world_queries.overlap_box(self.tables, size, position, orientation, layers, ignored))

    @alone
    def overlap_sphere(
        self,
        radius: float,
        position: ArrayLike = (0.0, 0.0, 0.0),
        layers: Iterable[int] | None = None,
        ignore: _Ignored = (),
    ) -> list[Body]:
        """Return the bodies that overlap a sphere.

        Parameters
        ----------
        radius : float
            m.
        position : (3,) array_like
            Of its centre, m.
        layers, ignore
            As in `overlap_box`.

        Returns
        -------
        list of Body

        Raises
        ------
        ArgumentError
            As `overlap_box`.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> ball = world.add_sphere(radius=0.5)
        >>> world.overlap_sphere(radius=0.2, position=(0.6, 0, 0)) == [ball]
        True
        """
        return self._bodies_of(
            world_queries.overlap_sphere(self.tables, radius, position, layers, self._ignored(ignore))
        )

    def _ignored(self, ignore: Any) -> set[int]:
        if isinstance(ignore, Body):
            return {self.bodies.row(ignore, "ignore")}
        if isinstance(ignore, str | np.ndarray) or not isinstance(ignore, Iterable):
            raise ArgumentError(f"ignore={ignore!r} must be a body, or several of them.")
        return {self.bodies.row(body, "ignore") for body in ignore}

    def _hits(self, hits: RayHits) -> list[RayHit]:
        """Return the hits of many rays one by one, each with the handle of its body."""
        return [
            RayHit(int(shape), self.bodies.handle(int(body)), float(distance), point, normal)
            for shape, body, distance, point, normal in zip(*hits, strict=True)
            if shape >= 0
        ]

    def _bodies_of(self, shapes: NDArray[np.int64]) -> list[Body]:
        return [self.bodies.handle(int(row)) for row in np.unique(self.tables.array(SHAPE)[shapes, BODY_ROW])]
