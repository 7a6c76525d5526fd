"""How cloths come into a world."""

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.core.errors import ArgumentError
from kickdrift.world.arguments import direction, number, unit_quaternion, vector
from kickdrift.world.cloth.handle import Cloth
from kickdrift.world.cloth.mesh import cloth_mesh, grid
from kickdrift.world.cloth.registry import Cloths, Fabric
from kickdrift.world.shape_rows import ShapeRows
from kickdrift.world.shapes.kinds import SPHERE
from kickdrift.world.shapes.mass import rotation_matrix
from kickdrift.world.tables import Tables

_MOST_VERTICES = 10_000_000


class AddsCloths:
    """The methods of a world that add cloths."""

    tables: Tables
    cloths: Cloths
    shape_rows: ShapeRows

    def add_cloth(
        self,
        vertices: ArrayLike,
        triangles: ArrayLike,
        *,
        density: float = 0.2,
        thickness: float = 0.005,
        stretch_stiffness: float = 200.0,
        shear_stiffness: float = 40.0,
        bending_stiffness: float = 1e-5,
        damping: float = 0.0,
        linear_damping: float = 0.0,
        friction: float = 0.6,
        drag: float = 0.0,
        lift: float = 0.0,
        air_density: float = 1.2,
        warp: ArrayLike = (1.0, 0.0, 0.0),
        name: str | None = None,
    ) -> Cloth:
        """Add a cloth that lies as a mesh of triangles does, without tension. It is of layer 0, and meets all shapes that do.

        Parameters
        ----------
        vertices : (N, 3) array_like
            m.
        triangles : (M, 3) array_like of int
            Vertices of each, all of them counter-clockwise seen from the same side.
        density : float
            kg/m^2.
        thickness : float
            m: vertices keep half of it away from shapes. Bodies that are narrower than its triangles pass between them.
        stretch_stiffness, shear_stiffness : float
            Tension over strain along warp and weft, and shear force over the shear angle, both of a metre's width, N/m.
        bending_stiffness : float
            Moment over curvature of a metre's width, N m.
        damping : float
            Of its strains, s: they count as they would be so much later. What is more than the step allows is left out.
        linear_damping : float
            Of its velocities, 1/s.
        friction : float
            Coefficient; of a cloth and a shape the geometric mean counts.
        drag, lift : float
            Coefficients; see `kickdrift.world.cloth.wind.add_wind`. About 1.2 is that of a plate across the wind.
        air_density : float
            kg/m^3.
        warp : (3,) array_like
            Direction of the threads along which it is stretched; the weft lies across.
        name : str, optional

        Returns
        -------
        Cloth
            Its handle: positions and velocities of the vertices; `pin` holds some of them.

        Raises
        ------
        ArgumentError
            For a mesh that a cloth cannot be made of, and numbers that cannot be; the sentence names the vertex or triangle.
        """
        mesh = cloth_mesh(vertices, triangles)
        fabric = Fabric(
            number("density", density, "kg/m^2", zero=False),
            number("thickness", thickness, "m", zero=False),
            number("stretch_stiffness", stretch_stiffness, "N/m", zero=False),
            number("shear_stiffness", shear_stiffness, "N/m"),
            number("bending_stiffness", bending_stiffness, "N m"),
            number("damping", damping, "s"),
            number("linear_damping", linear_damping, "1/s"),
            number("friction", friction, "1"),
            number("drag", drag, "1"),
            number("lift", lift, "1"),
            number("air_density", air_density, "kg/m^3"),
        )
        cloth = self.cloths.add(mesh, fabric, direction("warp", warp), name)
        self.shape_rows.kinds |= {SPHERE}  # which particles are to other shapes
        self.tables.altered = True
        return cloth

    def add_cloth_grid(
        self,
        size: ArrayLike = (1.0, 1.0),
        vertices: ArrayLike = (20, 20),
        *,
        position: ArrayLike = (0.0, 0.0, 0.0),
        orientation: ArrayLike = (1.0, 0.0, 0.0, 0.0),
        density: float = 0.2,
        thickness: float = 0.005,
        stretch_stiffness: float = 200.0,
        shear_stiffness: float = 40.0,
        bending_stiffness: float = 1e-5,
        damping: float = 0.0,
        linear_damping: float = 0.0,
        friction: float = 0.6,
        drag: float = 0.0,
        lift: float = 0.0,
        air_density: float = 1.2,
        name: str | None = None,
    ) -> Cloth:
        """Add a rectangular cloth; see `add_cloth` for what is not said here.

        Parameters
        ----------
        size : (2,) array_like
            Along warp and weft, m: the x and the y axis before it is turned.
        vertices : (2,) array_like of int
            How many along each, two or more. Vertex ``i * ny + j`` is the i-th along the warp and the j-th along the weft.
        position : (3,) array_like
            Of its middle, m.
        orientation : (4,) array_like
            Quaternion (w, x, y, z).

        Returns
        -------
        Cloth

        Raises
        ------
        ArgumentError
            For numbers that cannot be.
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
        return self.add_cloth(
            centred @ turn.T + vector("position", position, 3),
            triangles,
            density=density,
            thickness=thickness,
            stretch_stiffness=stretch_stiffness,
            shear_stiffness=shear_stiffness,
            bending_stiffness=bending_stiffness,
            damping=damping,
            linear_damping=linear_damping,
            friction=friction,
            drag=drag,
            lift=lift,
            air_density=air_density,
            warp=turn[:, 0],
            name=name,
        )

    def cloth(self, name: str) -> Cloth:
        """Return the cloth of a name.

        Raises
        ------
        UnknownNameError
            If none has it; the sentence says which there are.
        """
        return self.cloths.handle(self.cloths.names.row(name))
