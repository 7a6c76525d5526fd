"""Adding cloths, ropes and soft bodies to a world, finding them by name, and removing them."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.core.errors import ArgumentError
from kickdrift.core.signatures import shows_parameters_of
from kickdrift.world.arguments import choice, direction, unit_quaternion, vector
from kickdrift.world.cloth.building import Built, built_cloth, built_rope, built_soft_body
from kickdrift.world.cloth.deformable import Deformable
from kickdrift.world.cloth.fabric import Fabric
from kickdrift.world.cloth.handle import Cloth
from kickdrift.world.cloth.material import material_of
from kickdrift.world.cloth.mesh import cloth_mesh, grid
from kickdrift.world.cloth.registry import Cloths
from kickdrift.world.cloth.rope import Rope
from kickdrift.world.cloth.rope_material import RopeMaterial
from kickdrift.world.cloth.rope_mesh import rope_mesh
from kickdrift.world.cloth.soft_body import SoftBody
from kickdrift.world.cloth.soft_material import SoftMaterial
from kickdrift.world.cloth.tetrahedra import box_mesh, tetrahedral_mesh
from kickdrift.world.shape_rows import ShapeRows
from kickdrift.world.shapes.kinds import CAPSULE, SPHERE
from kickdrift.world.shapes.mass import rotation_matrix
from kickdrift.world.tables import Tables

D = TypeVar("D", bound=Deformable)

_MOST_VERTICES = 10_000_000


class AddsCloths:
    """The methods of a world that add cloths, ropes and soft bodies, find them by name, and remove them."""

    tables: Tables
    cloths: Cloths
    shape_rows: ShapeRows

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
            `friction`, `drag`, `lift`, `air_density` and `tear_strain`, as in `kickdrift.world.cloth.fabric.Fabric`.

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
        >>> corners, triangles = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2), (0, 2, 3)]
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
            How many along each, two or more. Vertex ``i * ny + j`` is the i-th along the warp and the j-th along the weft.
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
            raise ArgumentError(f"size={size!r} has to be positive, in m.")
        if counts.shape != (2,) or counts.dtype.kind not in "iu" or (counts < 2).any():
            raise ArgumentError(f"vertices={vertices!r} have to be two whole numbers, each two or more.")
        count = int(counts[0]) * int(counts[1])
        if count > _MOST_VERTICES:
            raise ArgumentError(f"vertices={vertices!r} are {count}, more than {_MOST_VERTICES}; give fewer.")
        turn = rotation_matrix(unit_quaternion("orientation", orientation))
        points, triangles = grid(int(counts[0]), int(counts[1]), (float(sides[0]), float(sides[1])))
        centred = points - [0.5 * sides[0], 0.5 * sides[1], 0.0]
        at, warp = centred @ turn.T + vector("position", position, 3), turn[:, 0]
        return self.add_cloth(at, triangles, warp=warp, self_collision=self_collision, name=name, **fabric)

    @shows_parameters_of(RopeMaterial)
    def add_rope(
        self, points: ArrayLike, *, self_collision: bool = False, name: str | None = None, **material: float
    ) -> Rope:
        """Add a rope through points, free of tension, on layer 0.

        Its vertices are the points; what is between two of them is a segment, a straight capsule. It is straight at rest: one
        that is curved at first straightens, if it can and has a bending stiffness.

        Parameters
        ----------
        points : (N, 3) array_like
            Two or more, m. Where it runs round something, segments should be shorter than its radius of curvature.
        self_collision : bool
            Whether it collides with itself; it always collides with other ropes, and with cloths.
        name : str, optional
        **material
            `radius`, `density` (kg/m), `stretch_stiffness` (N), `bending_stiffness` (N m^2), `damping`, `linear_damping` and
            `friction`, as in `kickdrift.world.cloth.rope_material.RopeMaterial`.

        Returns
        -------
        Rope
            Its handle: positions and velocities of the vertices, and the tension; `pin` holds some of them.

        Raises
        ------
        ArgumentError
            For invalid points, of which the message names one, and for invalid numbers.

        Examples
        --------
        >>> import numpy as np
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> points = np.linspace((0, 0, 2), (0, 0, 1), 21)
        >>> rope = world.add_rope(points, radius=0.01, density=0.1, stretch_stiffness=1000.0, damping=0.01, linear_damping=3.0)
        >>> rope.pin([0])
        >>> world.advance(1 / 60, 300)
        >>> round(float(rope.tension[0]), 3)  # the weight below the middle of the first segment
        0.956
        """
        made_of, mesh = material_of(RopeMaterial, "a rope", material), rope_mesh(points)
        rope = self._add(built_rope(mesh, made_of), Rope, name, self_collision)
        self.shape_rows.kinds |= {CAPSULE}  # which segments are to other shapes
        return rope

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

        It is elastic (stable Neo-Hookean), also where it is stretched to several times its length or turned inside out. Its
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
            as in `kickdrift.world.cloth.soft_material.SoftMaterial`.

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
        >>> body = world.add_soft_body(corners, [(0, 1, 2, 3)], density=1000.0, young_modulus=1e5)
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
            How many along each side. Vertex ``(i * (ny + 1) + j) * (nz + 1) + k`` is the i-th, j-th and k-th along them.
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
        ...     (0.2, 0.2, 0.2), (4, 4, 4), position=(0, 0, 0.2), density=1000.0, young_modulus=2e4, damping=0.01
        ... )
        >>> world.advance(1 / 60, 60)
        >>> bool(0.0 < jelly.position[:, 2].min() < 0.004)
        True
        """
        sides, counts = vector("size", size, 3), np.asarray(cells)
        if not (sides > 0.0).all():
            raise ArgumentError(f"size={size!r} has to be positive, in m.")
        if counts.shape != (3,) or counts.dtype.kind not in "iu" or (counts < 1).any():
            raise ArgumentError(f"cells={cells!r} have to be three whole numbers, each one or more.")
        nx, ny, nz = counts.tolist()
        if (nx + 1) * (ny + 1) * (nz + 1) > _MOST_VERTICES:
            raise ArgumentError(f"cells={cells!r} have more than {_MOST_VERTICES} vertices; give fewer.")
        turn = rotation_matrix(unit_quaternion("orientation", orientation))
        points, tetrahedra = box_mesh(sides, (nx, ny, nz))
        at = points @ turn.T + vector("position", position, 3)
        return self.add_soft_body(at, tetrahedra, self_collision=self_collision, name=name, **material)

    def _add(self, built: Built, kind: type[D], name: str | None, self_collision: bool) -> D:
        added = self.cloths.add(built, kind, name, choice("self_collision", self_collision))
        self.shape_rows.kinds |= {SPHERE}  # which particles are to other shapes
        self.tables.altered = True
        return added

    def cloth(self, name: str) -> Cloth:
        """Return the cloth with a name.

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

    def rope(self, name: str) -> Rope:
        """Return the rope with a name.

        Raises
        ------
        UnknownNameError
            If there is none; the message lists the names.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> line = world.add_rope([(0, 0, 0), (1, 0, 0)], name="line")
        >>> world.rope("line") == line
        True
        """
        return self.cloths.named(name, Rope)

    def soft_body(self, name: str) -> SoftBody:
        """Return the soft body with a name.

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

    def remove_cloth(self, cloth: Deformable) -> None:
        """Remove a cloth, a rope or a soft body, and wake everything. Indices of those that were added later decrease by one.

        Raises
        ------
        ArgumentError
            If it has been removed before.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> sheet, towel = (world.add_cloth_grid(vertices=(3, 3), name=name) for name in ("sheet", "towel"))
        >>> world.remove_cloth(sheet)
        >>> towel.index, sheet
        (0, Cloth(index=0, generation=0, name='sheet'))
        """
        self.cloths.remove(cloth)
