"""Adding soft bodies to a world, and finding them by name."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.core.errors import ArgumentError
from kickdrift.core.signatures import shows_parameters_of
from kickdrift.world.argument_checks import unit_quaternion, vector
from kickdrift.world.deformables.adding_deformables import AddsDeformables
from kickdrift.world.deformables.building import built_soft_body
from kickdrift.world.deformables.material import material_of
from kickdrift.world.deformables.mesh import MOST_VERTICES
from kickdrift.world.deformables.soft_body_handle import SoftBody
from kickdrift.world.deformables.soft_material import SoftMaterial
from kickdrift.world.deformables.tetrahedra import box_mesh, tetrahedral_mesh
from kickdrift.world.shapes.mass_properties import rotation_matrix


class AddsSoftBodies(AddsDeformables):
    """The methods of a world that add soft bodies, and find them by name."""

    @shows_parameters_of(SoftMaterial)
    def add_soft_body(
        self,
        vertices: ArrayLike,
        tetrahedra: ArrayLike,
        *,
        self_collision: bool = False,
        name: str | None = None,
        **material: float,
    ) -> SoftBody:
        """Add a soft body with the shape of a tetrahedral mesh, free of stress, on layer 0.

        It is elastic (stable Neo-Hookean), even when stretched to several times its length or turned inside out. Its
        surface collides as a cloth does: its vertices with shapes, its triangles with cloths, ropes and other soft bodies.

        Parameters
        ----------
        vertices : (N, 3) array_like
            m.
        tetrahedra : (M, 4) array_like of int
            Vertices of each; seen from the last one the first three are counter-clockwise.
        self_collision : bool
            Whether its surface collides with itself.
        name : str, optional
        **material
            `density` (kg/m^3), `young_modulus` (Pa), `poisson_ratio`, `damping`, `linear_damping`, `friction` and `thickness`,
            as in `kickdrift.world.deformables.soft_material.SoftMaterial`.

        Returns
        -------
        SoftBody
            Its handle: positions and velocities of the vertices, and the volume; `pin` holds some of them.

        Raises
        ------
        ArgumentError
            For an invalid mesh, whose vertex or tetrahedron the message names, and for invalid numbers.

        Notes
        -----
        Strain is constant in each tetrahedron. Such meshes are too stiff in bending, the more so for a Poisson ratio near 0.5
        ("locking"): a beam needs several cells across its height, and `poisson_ratio` up to 0.4 or so.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
        >>> body = world.add_soft_body(
        ...     corners, [(0, 1, 2, 3)], density=1000.0, young_modulus=1e5
        ... )
        >>> round(body.volume, 6), round(float(body.mass.sum()), 3)
        (0.166667, 166.667)
        """
        made_of, mesh = material_of(SoftMaterial, "a soft body", material), tetrahedral_mesh(vertices, tetrahedra)
        return self._add(built_soft_body(mesh, made_of), SoftBody, name, self_collision)

    @shows_parameters_of(SoftMaterial)
    def add_soft_box(
        self,
        size: ArrayLike = (1.0, 1.0, 1.0),
        cells: ArrayLike = (6, 6, 6),
        *,
        position: ArrayLike = (0.0, 0.0, 0.0),
        orientation: ArrayLike = (1.0, 0.0, 0.0, 0.0),
        self_collision: bool = False,
        name: str | None = None,
        **material: float,
    ) -> SoftBody:
        """Add a soft box, cut into cells of six tetrahedra each; other parameters as in `add_soft_body`.

        Parameters
        ----------
        size : (3,) array_like
            m.
        cells : (3,) array_like of int
            How many along each side, (nx, ny, nz). Vertex ``(i * (ny + 1) + j) * (nz + 1) + k`` is the i-th, j-th and k-th
            along them.
        position : (3,) array_like
            Of its centre, m.
        orientation : (4,) array_like
            Quaternion (w, x, y, z) that turns its axes into the world's.

        Returns
        -------
        SoftBody

        Raises
        ------
        ArgumentError
            For invalid numbers.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> floor = world.add_plane()
        >>> jelly = world.add_soft_box(
        ...     (0.2, 0.2, 0.2),
        ...     (4, 4, 4),
        ...     position=(0, 0, 0.2),
        ...     density=1000.0,
        ...     young_modulus=2e4,
        ...     damping=0.01,
        ... )
        >>> world.advance(1 / 60, 60)
        >>> bool(0.0 < jelly.position[:, 2].min() < 0.004)
        True
        """
        sides, counts = vector("size", size, 3), np.asarray(cells)
        if not (sides > 0.0).all():
            raise ArgumentError(f"size={size!r} must be positive, in m.")
        if counts.shape != (3,) or counts.dtype.kind not in "iu" or (counts < 1).any():
            raise ArgumentError(f"cells={cells!r} must be three whole numbers of at least 1.")
        nx, ny, nz = counts.tolist()
        if (nx + 1) * (ny + 1) * (nz + 1) > MOST_VERTICES:
            raise ArgumentError(f"cells={cells!r} have more than {MOST_VERTICES} vertices; give fewer.")
        turn = rotation_matrix(unit_quaternion("orientation", orientation))
        points, tetrahedra = box_mesh(sides, (nx, ny, nz))
        at = points @ turn.T + vector("position", position, 3)
        return self.add_soft_body(at, tetrahedra, self_collision=self_collision, name=name, **material)

    def soft_body(self, name: str) -> SoftBody:
        """Return the soft body with a name.

        Parameters
        ----------
        name : str

        Returns
        -------
        SoftBody

        Raises
        ------
        UnknownNameError
            If there is none; the message lists the names.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> jelly = world.add_soft_box(cells=(1, 1, 1), name="jelly")
        >>> world.soft_body("jelly") == jelly
        True
        """
        return self.cloths.named(name, SoftBody)
