"""Cloths on a page for the browser: a mesh each, whose vertices move."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.colours import colour_of
from kickdrift.viewer.page import rounded
from kickdrift.world.recording import DrawnCloth, Recording

_FINE = 1 / 4096  # of the size of a cloth, to which its vertices are rounded


class ClothMesh:
    """A cloth that moves.

    Parameters
    ----------
    scene : viser.SceneApi
    recording : Recording
    cloth : DrawnCloth
    number : int
        How many there were before.
    """

    def __init__(self, scene: Any, recording: Recording, cloth: DrawnCloth, number: int) -> None:
        self._vertices = recording.particles[:, cloth.first : cloth.last]
        self._grain = _FINE * float(np.ptp(self._vertices[0], axis=0).max())
        self._shown = self._at(0)
        colour = tuple(np.round(255 * colour_of(number + 1)).astype(int).tolist())
        self._handle = scene.add_mesh_simple(
            f"/cloth_{number}",
            self._shown,
            cloth.triangles.astype(np.uint32),
            color=colour,
            flat_shading=False,
            side="double",
        )

    def show(self, row: int) -> None:
        """Move its vertices to where they are in a row, if that can be seen."""
        vertices = self._at(row)
        if not np.array_equal(vertices, self._shown):
            self._handle.vertices = self._shown = vertices

    def _at(self, row: int) -> NDArray[np.float32]:
        return rounded(self._vertices[row], self._grain)
