"""The bodies of a world in a scene of viser: drawn once, and moved from state to state."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import KickdriftError
from kickdrift.core.rotations import product, turned
from kickdrift.viewer.meshes import ClothMesh, Drag, Drawn, JointLines, State, batches_of
from kickdrift.viewer.surfaces import surface_of
from kickdrift.world.layout import DYNAMIC, REMOVED
from kickdrift.world.recordings.appearance import Appearance, DrawnShape
from kickdrift.world.shapes.record import HALF_SPACE
from kickdrift.world.shapes.shape_kinds import kind_of

Floats = NDArray[np.float64]
_STRAYS = 0.01  # of all positions on either side that the camera need not see
_LINES = (205, 208, 212)  # of planes


class DrawnBodies:
    """Shapes, joints, planes and cloths of a world.

    Parameters
    ----------
    scene : viser.SceneApi
    appearance : Appearance
    state : State
        Where they are at first.
    moves : (N,) array of bool
        Which bodies are expected to move; others lie in meshes of their own, so that they are not sent again.
    radius : float
        Of what there is to be seen, m.
    """

    def __init__(
        self, scene: Any, appearance: Appearance, state: State, moves: NDArray[np.bool_], radius: float
    ) -> None:
        solid, planes = parts_of(appearance)
        self._batches = batches_of(scene, appearance, solid, state, moves)
        self._drawn: list[Drawn] = [*self._batches]
        if appearance.rods:
            self._drawn.append(JointLines(scene, appearance.rods, state))
        self._drawn += [ClothMesh(scene, cloth, k, state) for k, cloth in enumerate(appearance.cloths)]
        self._planes = _lay_planes(scene, planes, state, radius)

    def show(self, state: State) -> None:
        """Send what differs from the state shown before."""
        for drawn in self._drawn:
            drawn.show(state)

    def on_drag(self, heard: Callable[[Drag], None]) -> None:
        """Call a function when the mouse drags a body that is expected to move; it may not take long."""
        for batch in self._batches:
            if batch.moves:
                batch.on_drag(heard)

    def remove(self) -> None:
        """Take everything out of the scene."""
        for drawn in (*self._drawn, *self._planes):
            drawn.remove()


def parts_of(appearance: Appearance) -> tuple[list[DrawnShape], list[DrawnShape]]:
    """Return the shapes of existing bodies: bounded ones, and planes."""
    there = [part for part in appearance.parts if appearance.kinds[part.body] != REMOVED]
    planes = [part for part in there if kind_of(part.shape).sort == HALF_SPACE]
    return [part for part in there if kind_of(part.shape).sort != HALF_SPACE], planes


def check_can_be_seen(appearance: Appearance, what: str) -> None:
    """Refuse what has no shapes.

    Raises
    ------
    KickdriftError
    """
    if not any(parts_of(appearance)) and not appearance.cloths:
        raise KickdriftError(f"{what} has no shapes, and so there is nothing to show; add bodies with shapes.")


def extent(appearance: Appearance, x: Floats, particles: Floats) -> tuple[Floats, float]:
    """Return centre and radius of a ball that holds what moves, or what there is; strays are left out.

    Parameters
    ----------
    appearance : Appearance
    x : (T, N, 3) array
        Positions of bodies at the times that will be seen, m.
    particles : (T, P, 3) array
        Those of vertices of cloths, m.
    """
    solid, _ = parts_of(appearance)
    moving = [part for part in solid if appearance.kinds[part.body] == DYNAMIC] or solid
    if not moving and not appearance.cloths:
        return np.zeros(3), 1.0
    bodies = np.unique([part.body for part in moving]).astype(np.intp)
    positions = np.concatenate((x[:, bodies], particles), axis=1).reshape(-1, 3)
    positions = positions[np.isfinite(positions).all(axis=1)]
    low, high = np.quantile(positions, (_STRAYS, 1.0 - _STRAYS), axis=0)
    sizes = [0.0]
    for part in moving:
        surface = surface_of(part.shape)
        sizes.append(
            float(np.linalg.norm(np.abs(part.position) + np.abs(surface.vertices * surface.scale).max(axis=0)))
        )
    return 0.5 * (low + high), float(0.5 * np.linalg.norm(high - low) + np.quantile(sizes, 1.0 - _STRAYS))


def on_planes(appearance: Appearance, state: State, places: Floats) -> list[Floats]:
    """Return the nearest points on each plane to others, (N, 3) each, m."""
    found = []
    for plane in parts_of(appearance)[1]:
        turn = state.orientation[plane.body]
        point = state.position[plane.body] + turned(turn, plane.position)
        normal = turned(product(turn, plane.orientation), [0.0, 0.0, 1.0])
        found.append(places - ((places - point) @ normal)[:, None] * normal)
    return found


def _lay_planes(scene: Any, planes: list[DrawnShape], state: State, radius: float) -> list[Any]:
    """Show planes as grids that one can look through."""
    section = 10.0 ** np.floor(np.log10(radius))
    drawn = []
    for number, plane in enumerate(planes):
        turn = state.orientation[plane.body]
        drawn.append(
            scene.add_grid(
                f"/plane_{number}",
                infinite_grid=True,
                cell_size=section,
                section_size=section,
                section_color=_LINES,
                fade_distance=20.0 * radius,
                position=state.position[plane.body] + turned(turn, plane.position),
                wxyz=product(turn, plane.orientation),
            )
        )
    return drawn
