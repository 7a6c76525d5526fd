"""Adding cloths to a world, and finding them by name."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.core.errors import ArgumentError
from kickdrift.core.signatures import shows_parameters_of
from kickdrift.world.argument_checks import direction, unit_quaternion, vector
from kickdrift.world.deformables.adding_deformables import AddsDeformables
from kickdrift.world.deformables.building import built_cloth
from kickdrift.world.deformables.cloth_handle import Cloth
from kickdrift.world.deformables.fabric import Fabric
from kickdrift.world.deformables.material import material_of
from kickdrift.world.deformables.mesh import MOST_VERTICES, cloth_mesh, grid
from kickdrift.world.shapes.mass_properties import rotation_matrix


class AddsCloths(AddsDeformables):
    """The methods of a world that add cloths, and find them by name."""

    @shows_parameters_of(Fabric)
    def add_cloth(
        self,
        vertices: ArrayLike,
        triangles: ArrayLike,
        *,
        warp: ArrayLike = (1.0, 0.0, 0.0),
        self_collision: bool = False,
        name: str | None = None,
        **fabric: float,
    ) -> Cloth:
        """Add a cloth with the shape of a triangle mesh, free of tension, on layer 0.

        Parameters
        ----------
        vertices : (N, 3) array_like
            m.
        triangles : (M, 3) array_like of int
            Vertices of each, all counter-clockwise as seen from the same side.
        warp : (3,) array_like
            Direction of the warp threads; the weft is perpendicular to it.
        self_collision : bool
            Whether it collides with itself, which takes several times as long; it always collides with other cloths.
        name : str, optional
        **fabric
            `density`, `thickness`, `stretch_stiffness`, `shear_stiffness`, `bending_stiffness`, `damping`, `linear_damping`,
            `friction`, `drag`, `lift`, `air_density`, `tear_strain` and `tether_strain`, as in
            `kickdrift.world.deformables.fabric.Fabric`.

        Returns
        -------
        Cloth
            Its handle: positions and velocities of the vertices; `pin` holds some of them.

        Raises
        ------
        ArgumentError
            For an invalid mesh, whose vertex or triangle the message names, and for invalid numbers.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
        >>> triangles = [(0, 1, 2), (0, 2, 3)]
        >>> sheet = world.add_cloth(corners, triangles, density=0.2)
        >>> round(float(sheet.mass.sum()), 6)
        0.2
        """
        made_of, mesh = material_of(Fabric, "a cloth", fabric), cloth_mesh(vertices, triangles)
        return self._add(built_cloth(mesh, made_of, direction("warp", warp)), Cloth, name, self_collision)

    @shows_parameters_of(Fabric)
    def add_cloth_grid(
        self,
        size: ArrayLike = (1.0, 1.0),
        vertices: ArrayLike = (20, 20),
        *,
        position: ArrayLike = (0.0, 0.0, 0.0),
        orientation: ArrayLike = (1.0, 0.0, 0.0, 0.0),
        self_collision: bool = False,
        name: str | None = None,
        **fabric: float,
    ) -> Cloth:
        """Add a rectangular cloth; other parameters as in `add_cloth`.

        Parameters
        ----------
        size : (2,) array_like
            Along warp and weft, m: its x and y axes.
        vertices : (2,) array_like of int
            How many along each, (nx, ny), two or more. Vertex ``i * ny + j`` is the i-th along the warp and the j-th along the
            weft.
        position : (3,) array_like
            Of its centre, m.
        orientation : (4,) array_like
            Quaternion (w, x, y, z) that turns its axes into the world's.

        Returns
        -------
        Cloth

        Raises
        ------
        ArgumentError
            For invalid numbers.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> sheet = world.add_cloth_grid(size=(1.0, 1.0), vertices=(5, 5), position=(0, 0, 1))
        >>> sheet.pin([0, 4])
        >>> sheet.position.shape
        (25, 3)
        """
        sides, counts = vector("size", size, 2), np.asarray(vertices)
        if not (sides > 0.0).all():
            raise ArgumentError(f"size={size!r} must be positive, in m.")
        if counts.shape != (2,) or counts.dtype.kind not in "iu" or (counts < 2).any():
            raise ArgumentError(f"vertices={vertices!r} must be two whole numbers of at least 2.")
        count = int(counts[0]) * int(counts[1])
        if count > MOST_VERTICES:
            raise ArgumentError(f"vertices={vertices!r} make {count}, more than {MOST_VERTICES}; give fewer.")
        turn = rotation_matrix(unit_quaternion("orientation", orientation))
        points, triangles = grid(int(counts[0]), int(counts[1]), (float(sides[0]), float(sides[1])))
        centred = points - [0.5 * sides[0], 0.5 * sides[1], 0.0]
        at, warp = centred @ turn.T + vector("position", position, 3), turn[:, 0]
        return self.add_cloth(at, triangles, warp=warp, self_collision=self_collision, name=name, **fabric)

    def cloth(self, name: str) -> Cloth:
        """Return the cloth with a name.

        Parameters
        ----------
        name : str

        Returns
        -------
        Cloth

        Raises
        ------
        UnknownNameError
            If there is none; the message lists the names.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> sheet = world.add_cloth_grid(vertices=(3, 3), name="sheet")
        >>> world.cloth("sheet") == sheet
        True
        """
        return self.cloths.named(name, Cloth)
