"""What moves from state to state in a scene of viser: batches of shapes that look alike, joints and cloths."""

from collections.abc import Callable
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.colours import FIXED, RODS, colour_of
from kickdrift.core.rotations import product, turned
from kickdrift.viewer.page import Singles, linear, rounded
from kickdrift.viewer.surfaces import Surface, halves_of_ball, surface_of
from kickdrift.world.layout import DYNAMIC
from kickdrift.world.recordings.appearance import Appearance, DrawnCloth, DrawnShape, Rod
from kickdrift.world.shapes.record import BALL
from kickdrift.world.shapes.shape_kinds import kind_of

Floats = NDArray[np.float64]
FINE = 1 / 512  # of a shape's size, to which positions are rounded: 0.2 % of a box is a pixel of 500
TURN = 1 / 1024  # to which quaternions are rounded
_FINE_CLOTH = 1 / 4096  # of the size of a cloth, to which its vertices are rounded
_LIGHT = 0.45  # of white in every other octant of a ball


class State(NamedTuple):
    """Where everything is at a time.

    Attributes
    ----------
    position : (N, 3) array
        Of the bodies, m.
    orientation : (N, 4) array
    particles : (P, 3) array
        Vertices of all cloths, m.
    """

    position: Floats
    orientation: Floats
    particles: Floats


class Drawn(Protocol):
    """What each state may move."""

    def show(self, state: State) -> None:
        """Send what differs from the state shown before."""
        ...

    def remove(self) -> None:
        """Take it out of the scene."""
        ...


class Drag(NamedTuple):
    """What the mouse does to a body on a page.

    Attributes
    ----------
    page : int
        Which of the pages that are open.
    body : int
        The row of the body.
    phase : str
        "start", "update" or "end".
    grabbed, pulled_to : (3,) array
        Where the mouse has taken the body, as that point moves with it, and where the mouse is now; m.
    """

    page: int
    body: int
    phase: str
    grabbed: Floats
    pulled_to: Floats


class Batch:
    """Shapes that look alike except for colour and size."""

    def __init__(self, parts: list[DrawnShape], surface: Surface, state: State, moves: bool) -> None:
        self.moves = moves
        self._bodies = np.array([part.body for part in parts])
        self._places = np.array([part.position for part in parts])
        self._turns = np.array([part.orientation for part in parts])
        self._scales = np.array([surface_of(part.shape).scale for part in parts], dtype=np.float32)
        size = np.abs(surface.vertices).max() * float(self._scales.max(axis=1).min())
        self._grain = FINE * size
        self._shown = self._at(state)
        self._handles: list[Any] = []

    def add(self, scene: Any, name: str, surface: Surface, colours: Floats) -> None:
        """Draw the shapes where they are at first."""
        positions, turns = self._shown
        self._handles.append(
            scene.add_batched_meshes_simple(
                name,
                surface.vertices,
                surface.faces,
                turns,
                positions,
                batched_scales=self._scales,
                batched_colors=linear(colours),
                flat_shading=surface.flat,
                side="double" if surface.flat else "front",
                lod="off",
            )
        )

    def show(self, state: State) -> None:
        """Move them to where they are, if that can be seen."""
        positions, turns = self._at(state)
        for handle in self._handles:
            if not np.array_equal(positions, self._shown[0]):
                handle.batched_positions = positions
            if not np.array_equal(turns, self._shown[1]):
                handle.batched_wxyzs = turns
        self._shown = positions, turns

    def on_drag(self, heard: Callable[[Drag], None]) -> None:
        """Call a function when the mouse drags one of them; it may not take long."""

        async def hear(event: Any) -> None:  # viser calls what is not a coroutine out of order
            body = int(self._bodies[event.instance_index or 0])
            ends = np.array(event.start_position), np.array(event.end_position)
            heard(Drag(event.client_id, body, event.phase, *ends))

        for handle in self._handles:
            handle.on_drag("left")(hear)

    def remove(self) -> None:
        """Take them out of the scene."""
        for handle in self._handles:
            handle.remove()

    def _at(self, state: State) -> tuple[Singles, Singles]:
        """Return positions and turns, rounded: what hardly moves stays as it is, and is not sent."""
        turns = state.orientation[self._bodies]
        positions = state.position[self._bodies] + turned(turns, self._places)
        return rounded(positions, self._grain), rounded(product(turns, self._turns), TURN)


class JointLines:
    """Lines from bodies to their joints."""

    def __init__(self, scene: Any, rods: tuple[Rod, ...], state: State) -> None:
        self._bodies = np.array([(rod.body_a, rod.body_b) for rod in rods])
        self._points = np.array([(rod.point_a, rod.point_b) for rod in rods])
        colour = tuple(linear(RODS).tolist())
        self._shown = self._at(state)
        self._handle = scene.add_line_segments("/joints", self._shown, colour, thickness=2.0, thickness_units="screen")

    def show(self, state: State) -> None:
        """Move them to where the bodies are."""
        points = self._at(state)
        if not np.array_equal(points, self._shown):
            self._handle.points = self._shown = points

    def remove(self) -> None:
        """Take it out of the scene."""
        self._handle.remove()

    def _at(self, state: State) -> Singles:
        turns = state.orientation[self._bodies]
        points = state.position[self._bodies] + turned(turns, self._points)
        result: Singles = points.astype(np.float32)
        return result


class ClothMesh:
    """A mesh whose vertices move: a cloth, or the surface of a rope or a soft body."""

    def __init__(self, scene: Any, cloth: DrawnCloth, number: int, state: State) -> None:
        self._cloth, self._rows = cloth, slice(cloth.first, cloth.last)
        extent = float(np.ptp(state.particles[self._rows], axis=0).max())
        self._grain = _FINE_CLOTH * (extent if extent > 0.0 else 1.0)  # NaN of a cloth that is added later
        self._shown, triangles = self._at(state)
        colour = tuple(np.round(255 * colour_of(number + 1)).astype(int).tolist())
        self._handle = scene.add_mesh_simple(
            f"/cloth_{number}",
            self._shown,
            triangles.astype(np.uint32),
            color=colour,
            flat_shading=False,
            side="double",
        )

    def show(self, state: State) -> None:
        """Move its vertices to where they are, if that can be seen."""
        vertices, _ = self._at(state)
        if not np.array_equal(vertices, self._shown):
            self._handle.vertices = self._shown = vertices

    def remove(self) -> None:
        """Take it out of the scene."""
        self._handle.remove()

    def _at(self, state: State) -> tuple[Singles, NDArray[np.int64]]:
        vertices, triangles = self._cloth.surface(np.nan_to_num(state.particles[self._rows]))
        return rounded(vertices, self._grain), triangles


def batches_of(
    scene: Any, appearance: Appearance, parts: list[DrawnShape], state: State, moves: NDArray[np.bool_]
) -> list[Batch]:
    """Draw all shapes, those that look alike and move at once."""
    alike: dict[tuple[int, bytes, bytes, bool], list[DrawnShape]] = {}
    for part in parts:
        surface = surface_of(part.shape)
        key = (part.shape.kind, surface.vertices.tobytes(), surface.faces.tobytes(), bool(moves[part.body]))
        alike.setdefault(key, []).append(part)
    batches = []
    for number, (key, group) in enumerate(alike.items()):
        surface, kind = surface_of(group[0].shape), kind_of(group[0].shape)
        batch = Batch(group, surface, state, key[-1])
        colours = np.array([_colour(appearance, part.body) for part in group])
        name = f"/{kind.name.replace(' ', '_')}_{number}"
        if kind.look & BALL:
            dark, light = halves_of_ball(surface)
            batch.add(scene, name, dark, colours)
            batch.add(scene, f"{name}_light", light, colours + _LIGHT * (1.0 - colours))
        else:
            batch.add(scene, name, surface, colours)
        batches.append(batch)
    return batches


def _colour(appearance: Appearance, body: int) -> Floats:
    return colour_of(body) if appearance.kinds[body] == DYNAMIC else np.array(FIXED)
