"""Preparation of the tables of cloths for steps, as far as meshes, pins or the substep have changed."""

from kickdrift.world.deformables.geodesics import Lines
from kickdrift.world.deformables.mesh_tables import mesh_in
from kickdrift.world.deformables.particle_tables import arrange
from kickdrift.world.deformables.substep_choice import tune
from kickdrift.world.deformables.tether_rows import put_tethers
from kickdrift.world.tables import CLOTH, CLOTH_NUMBERS, Tables


class Preparation:
    """The preparation of the tables of the cloths of a world, and what it was made for.

    Parameters
    ----------
    tables : Tables
    """

    def __init__(self, tables: Tables) -> None:
        self._tables = tables
        self.forget()

    def forget(self) -> None:
        """Have everything prepared again, after meshes or tables were replaced."""
        self._lines: dict[int, Lines] = {}
        self._is_arranged = False
        self.forget_pins()

    def forget_pins(self) -> None:
        """Have all that depends on pins prepared again."""
        self._is_tethered, self._substep = False, 0.0

    def prepare(self, substep: float) -> None:
        """Resize the tables that a step fills, and choose tethers, parts and stiffness of all cloths in a substep, s."""
        tables = self._tables
        if tables.count(CLOTH) == 0:
            return
        if not self._is_arranged:
            arrange(tables, [mesh_in(tables, row) for row in range(tables.count(CLOTH))])
        if not self._is_tethered:
            put_tethers(tables, self._lines)
        if substep != self._substep:
            for own, numbers in zip(tables.array(CLOTH), tables.array(CLOTH_NUMBERS), strict=True):
                tune(own, numbers, substep)
        self._is_arranged, self._is_tethered, self._substep = True, True, substep
