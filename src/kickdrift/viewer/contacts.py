"""Points of contacts in a scene of viser."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.viewer.page import Singles, rounded

_COLOUR = (230, 60, 40)
_SIZE = 0.02  # of the radius of what there is to be seen
_FINE = 1 / 4  # of the size of a point, to which positions are rounded


class ContactPoints:
    """The points at which bodies press on each other.

    Parameters
    ----------
    scene : viser.SceneApi
    radius : float
        Of what there is to be seen, m.
    """

    def __init__(self, scene: Any, radius: float) -> None:
        self._size, self._shown = _SIZE * radius, np.zeros((0, 3), np.float32)
        self._cloud = scene.add_point_cloud(
            "/contacts", np.zeros((1, 3)), _COLOUR, point_size=self._size, point_shape="circle", precision="float32",
            visible=False,
        )  # fmt: skip

    def show(self, points: NDArray[np.float64]) -> None:
        """Send the points, (P, 3), m, if they differ from those shown before."""
        places: Singles = rounded(points, _FINE * self._size)
        if np.array_equal(places, self._shown):
            return
        if len(places):
            self._cloud.points = places
        if self._cloud.visible != bool(len(places)):
            self._cloud.visible = bool(len(places))
        self._shown = places
