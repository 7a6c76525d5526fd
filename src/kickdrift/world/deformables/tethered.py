"""The base class of the handles of cloths and ropes, whose vertices may have tethers."""

from __future__ import annotations

from kickdrift.world.deformables.deformable import Deformable
from kickdrift.world.deformables.material import parameter


class Tethered(Deformable):
    """A cloth or a rope of a world.

    Attributes
    ----------
    index : int
        Its position among the cloths, ropes and soft bodies of the world, from 0; it decreases when an earlier one is removed.
    """

    __slots__ = ()

    @property
    def tether_strain(self) -> float:
        """Strain at which tethers hold vertices back, 0.0 without tethers; can be set."""
        return float(self._cloths.numbers(self, "tether_strain")[0])

    @tether_strain.setter
    def tether_strain(self, tether_strain: float) -> None:
        self._cloths.set_numbers(self, "tether_strain", parameter("tether_strain", tether_strain, "1"))
