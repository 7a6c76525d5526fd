"""Questions to a world: what rays meet, and what overlaps a box or a ball."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.world import queries
from kickdrift.world.bodies import Bodies, Body
from kickdrift.world.queries import RayHit, RayHits
from kickdrift.world.tables import SHAPE, Tables

_BODY = 1  # column of SHAPE


class AnswersQueries:
    """The methods of a world that ask where things are, and leave it as it is."""

    tables: Tables
    bodies: Bodies

    def ray_cast(
        self, origin: ArrayLike, direction: ArrayLike, limit: float = np.inf, layers: Iterable[int] | None = None
    ) -> RayHit | None:
        """Return the nearest shape that a ray meets, or None.

        Parameters
        ----------
        origin : (3,) array_like
            m.
        direction : (3,) array_like
            Any length but zero.
        limit : float
            How far the ray goes, m.
        layers : iterable of int, optional
            Layers whose shapes it meets, from 0 to 61; all by default.

        Returns
        -------
        RayHit or None
            With the body, the distance, the point and the normal there.

        Raises
        ------
        ArgumentError
            If the origin is not finite, the direction has no length, or the limit or a layer cannot be.
        """
        return queries.ray_cast(self.tables, origin, direction, limit, layers)

    def ray_cast_all(
        self, origin: ArrayLike, direction: ArrayLike, limit: float = np.inf, layers: Iterable[int] | None = None
    ) -> list[RayHit]:
        """Return where a ray meets every shape on its way first, the nearest shape first; as `ray_cast`."""
        return queries.ray_cast_all(self.tables, origin, direction, limit, layers)

    def ray_cast_many(
        self, origins: ArrayLike, directions: ArrayLike, limit: float = np.inf, layers: Iterable[int] | None = None
    ) -> RayHits:
        """Return the nearest shape that each of many rays meets, as arrays; (N, 3) directions from (N, 3) or (3,) origins."""
        return queries.ray_cast_many(self.tables, origins, directions, limit, layers)

    def overlap_box(
        self,
        size: ArrayLike,
        position: ArrayLike = (0.0, 0.0, 0.0),
        orientation: ArrayLike = (1.0, 0.0, 0.0, 0.0),
        layers: Iterable[int] | None = None,
    ) -> list[Body]:
        """Return the bodies that overlap a box.

        Parameters
        ----------
        size : (3,) array_like
            Lengths of its edges, m.
        position : (3,) array_like
            Of its middle, m.
        orientation : (4,) array_like
            Quaternion (w, x, y, z) that turns its axes into the world's.
        layers : iterable of int, optional
            Layers whose shapes count, from 0 to 61; all by default.

        Raises
        ------
        ArgumentError
            If the size is not positive, or the pose is not finite.
        """
        return self._bodies_of(queries.overlap_box(self.tables, size, position, orientation, layers))

    def overlap_sphere(
        self, radius: float, position: ArrayLike = (0.0, 0.0, 0.0), layers: Iterable[int] | None = None
    ) -> list[Body]:
        """Return the bodies that overlap a ball of a radius in m; the rest as in `overlap_box`."""
        return self._bodies_of(queries.overlap_sphere(self.tables, radius, position, layers))

    def _bodies_of(self, shapes: NDArray[np.int64]) -> list[Body]:
        return [self.bodies.handle(int(row)) for row in np.unique(self.tables.array(SHAPE)[shapes, _BODY])]
