"""Adding ropes to a world, and finding them by name."""

from __future__ import annotations

from numpy.typing import ArrayLike

from kickdrift.core.signatures import shows_parameters_of
from kickdrift.world.deformables.adding_deformables import AddsDeformables
from kickdrift.world.deformables.building import built_rope
from kickdrift.world.deformables.material import material_of
from kickdrift.world.deformables.rope_handle import Rope
from kickdrift.world.deformables.rope_material import RopeMaterial
from kickdrift.world.deformables.rope_mesh import rope_mesh


class AddsRopes(AddsDeformables):
    """The methods of a world that add ropes, and find them by name."""

    @shows_parameters_of(RopeMaterial)
    def add_rope(
        self, points: ArrayLike, *, self_collision: bool = False, name: str | None = None, **material: float
    ) -> Rope:
        """Add a rope through points, free of tension, on layer 0.

        Its vertices are the points; between two of them lies a segment, a straight capsule. Its rest shape is straight: a rope
        that is curved at first straightens if it is free to and has a bending stiffness.

        Parameters
        ----------
        points : (N, 3) array_like
            Two or more, m. Where it runs round something, segments should be shorter than its radius of curvature.
        self_collision : bool
            Whether it collides with itself; it always collides with other ropes, and with cloths.
        name : str, optional
        **material
            `radius`, `density` (kg/m), `stretch_stiffness` (N), `bending_stiffness` (N m^2), `damping`, `linear_damping`,
            `friction` and `tether_strain`, as in `kickdrift.world.deformables.rope_material.RopeMaterial`.

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
        >>> rope = world.add_rope(
        ...     points,
        ...     radius=0.01,
        ...     density=0.1,
        ...     stretch_stiffness=1000.0,
        ...     damping=0.01,
        ...     linear_damping=3.0,
        ... )
        >>> rope.pin([0])
        >>> world.advance(1 / 60, 300)
        >>> round(float(rope.tension[0]), 3)  # the weight below the middle of the first segment
        0.956
        """
        made_of, mesh = material_of(RopeMaterial, "a rope", material), rope_mesh(points)
        return self._add(built_rope(mesh, made_of), Rope, name, self_collision)

    def rope(self, name: str) -> Rope:
        """Return the rope with a name.

        Parameters
        ----------
        name : str

        Returns
        -------
        Rope

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
