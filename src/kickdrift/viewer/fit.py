"""Cameras of live pages, which see all of a world whatever the shape of the page."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.viewer.page import place_for

Floats = NDArray[np.float64]
_SAME = 1e-3  # of the distance, by which the place differs that a page sends back


class Fit:
    """The camera of one page, which stands back as far as a narrow page needs, until its user moves it.

    A page changes its shape when it is turned or resized, and when the panel of its controls is docked, which happens after
    it has connected.

    Parameters
    ----------
    camera : viser.CameraHandle
        At the place for a page at least as wide as high, or where the page itself first had it.
    centre : (3,) array
        Of the ball that it sees.
    radius : float
    """

    def __init__(self, camera: Any, centre: Floats, radius: float) -> None:
        self._camera, self._centre, self._radius = camera, centre, radius
        self._aspect, self._places = 1.0, [np.array(camera.position), place_for(centre, radius)]
        self._fit()
        camera.on_update(lambda _: self._fit())

    def _fit(self) -> None:
        aspect = min(self._camera.aspect, 1.0)
        if aspect != self._aspect and not self._moved():
            self._aspect = aspect
            self._places.append(place_for(self._centre, self._radius, aspect))
            self._camera.position, self._camera.look_at = self._places[-1], self._centre

    def _moved(self) -> bool:
        """Whether the user has moved the camera; a page may still send one of the earlier places that it was given."""
        away = np.linalg.norm(np.array(self._camera.position) - self._places, axis=1).min()
        return bool(away > _SAME * np.linalg.norm(self._places[1] - self._centre))
