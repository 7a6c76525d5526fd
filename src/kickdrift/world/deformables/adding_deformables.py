"""What adding cloths, ropes and soft bodies has in common, and removing them."""

from __future__ import annotations

from typing import TypeVar

from kickdrift.world.argument_checks import choice
from kickdrift.world.bodies.shape_rows import ShapeRows
from kickdrift.world.deformables.building import MET_AS, Built
from kickdrift.world.deformables.deformable import Deformable
from kickdrift.world.deformables.registry import Cloths
from kickdrift.world.tables import Tables

D = TypeVar("D", bound=Deformable)


class AddsDeformables:
    """The methods of a world that adding cloths, ropes and soft bodies is made of."""

    tables: Tables
    cloths: Cloths
    shape_rows: ShapeRows

    def _add(self, built: Built, kind: type[D], name: str | None, self_collision: bool) -> D:
        added = self.cloths.add(built, kind, name, choice("self_collision", self_collision))
        self.shape_rows.kinds |= MET_AS[built.dimension]
        self.tables.altered = True
        return added

    def remove_cloth(self, cloth: Deformable) -> None:
        """Remove a cloth, a rope or a soft body, and wake everything. Indices of those that were added later decrease by one.

        Parameters
        ----------
        cloth : Cloth, Rope or SoftBody

        Raises
        ------
        ArgumentError
            If it has been removed before.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> sheet, towel = (
        ...     world.add_cloth_grid(vertices=(3, 3), name=name) for name in ("sheet", "towel")
        ... )
        >>> world.remove_cloth(sheet)
        >>> towel.index, sheet
        (0, Cloth(index=0, generation=0, name='sheet'))
        """
        self.cloths.remove(cloth)
