"""Cloths on a page for the browser: a mesh each, whose vertices move."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.colours import colour_of
from kickdrift.viewer.page import rounded
from kickdrift.world.recording import DrawnCloth

Floats = NDArray[np.float64]
_FINE = 1 / 4096  # of the size of a cloth, to which its vertices are rounded


class ClothMesh:
    """A cloth that moves.

    Parameters
    ----------
    scene : viser.SceneApi
    cloth : DrawnCloth
    number : int
        How many there were before.
    particles : (P, 3) array
        Vertices of all cloths at first, m.
    """

    def __init__(self, scene: Any, cloth: DrawnCloth, number: int, particles: Floats) -> None:
        self._rows = slice(cloth.first, cloth.last)
        self._grain = _FINE * float(np.ptp(particles[self._rows], axis=0).max())
        self._shown = rounded(particles[self._rows], self._grain)
        colour = tuple(np.round(255 * colour_of(number + 1)).astype(int).tolist())
        self._handle = scene.add_mesh_simple(
            f"/cloth_{number}",
            self._shown,
            cloth.triangles.astype(np.uint32),
            color=colour,
            flat_shading=False,
            side="double",
        )

    def show(self, particles: Floats) -> None:
        """Move its vertices to where they are, if that can be seen."""
        vertices = rounded(particles[self._rows], self._grain)
        if not np.array_equal(vertices, self._shown):
            self._handle.vertices = self._shown = vertices

    def remove(self) -> None:
        """Take it out of the scene."""
        self._handle.remove()
