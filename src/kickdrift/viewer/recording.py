"""Recordings of worlds as pages for the browser."""

from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.colours import COLOURS, FIXED, RODS, SUM, colour_of
from kickdrift.core.errors import KickdriftError
from kickdrift.core.rotations import product, turned
from kickdrift.viewer.cloth import ClothMesh
from kickdrift.viewer.curves import Curve, panel
from kickdrift.viewer.page import Mover, Singles, Stage, check_in_memory, rounded, write_page
from kickdrift.viewer.surfaces import Surface, halves_of_ball, surface_of
from kickdrift.world.integration import DYNAMIC, REMOVED
from kickdrift.world.recording import DrawnShape, Recording
from kickdrift.world.shapes.catalogue import kind_of
from kickdrift.world.shapes.record import BALL, HALF_SPACE

Floats = NDArray[np.float64]
_RATE = 30.0  # states a second, at least, where so many were kept
_MOST_POSES = 900_000  # that differ from those before: 18.5 MB; a thousand bodies that never rest have as many in 30 s
_FINE = 1 / 512  # of a shape's size, to which places are rounded: 0.2 % of a box is a pixel of 500
_TURN = 1 / 1024  # to which quaternions are rounded
_STRAYS = 0.01  # of all places on either side that the camera need not see
_LINES = (205, 208, 212)  # of planes
_LIGHT = 0.45  # of white in every other octant of a ball


def recording_to_html(recording: Recording, path: str | Path) -> Path:
    """Write a recording as a page that plays in the browser, in real time, and can be turned with the mouse.

    Parameters
    ----------
    recording : Recording
        The states kept are shown, 30 a second or a few more; there is nothing between them. Where so much moves for so long
        that the file would have more than 20 MB, 15 or 10 a second are.
    path : path
        Ends in ``.html``.

    Returns
    -------
    Path
        The file written. It needs no server and no network.

    Raises
    ------
    KickdriftError
        If there is nothing to be seen, or the states are on disk.
    FileFormatError
        If the file cannot be written.
    MissingExtraError
        If viser is not installed.
    """
    parts = [part for part in recording.appearance.parts if recording.appearance.kinds[part.body] != REMOVED]
    if not parts and not recording.appearance.cloths:
        raise KickdriftError("the recording has no shapes, and so there is nothing to be seen; add bodies with shapes.")
    check_in_memory(recording)
    return write_page(path, recording.about.system, lambda stage: _play(stage, recording, parts))


def _play(stage: Stage, recording: Recording, parts: list[DrawnShape]) -> str:
    solid = [part for part in parts if kind_of(part.shape).sort != HALF_SPACE]
    rows = rows_shown(recording.t)
    poses = _moved(recording, rows, solid)
    if poses > _MOST_POSES:
        rows = rows_shown(recording.t, _RATE / -(-poses // _MOST_POSES))
    centre, radius = _extent(recording, solid, rows)
    stage.look(centre, radius)
    _lay_planes(stage.scene, recording, [part for part in parts if kind_of(part.shape).sort == HALF_SPACE], radius)
    cloths = enumerate(recording.appearance.cloths)
    movers: list[Mover] = [
        *_batches(stage.scene, recording, solid, rows),
        *_joints(stage.scene, recording),
        *(ClothMesh(stage.scene, recording, cloth, number) for number, cloth in cloths),
    ]
    for before, row in zip([rows[0], *rows], rows, strict=False):
        stage.wait(float(recording.t[row] - recording.t[before]))
        for mover in movers:
            mover.show(row)
    stage.wait(1.0 / _RATE)  # the last state is seen, too
    t = recording.t
    return panel(recording.about.system, t, _energies(recording.derived), float(t[-1] - t[0]), "s")


def _energies(derived: Mapping[str, Floats]) -> list[Curve]:
    kinetic, potential = derived["kinetic energy"], derived["potential energy"]
    potential = potential - potential.min()
    return [
        Curve("kinetic + potential energy", kinetic + potential, SUM),
        Curve("kinetic", kinetic, COLOURS[1]),
        Curve("potential, J", potential, COLOURS[0]),
    ]


def rows_shown(t: Floats, rate: float = _RATE) -> list[int]:
    """Choose rows so that no two of them are farther apart than a rate asks for, where the states kept allow that."""
    rows, longest = [0], (1.0 + 1e-9) / rate
    while rows[-1] < t.size - 1:
        last = int(np.searchsorted(t, t[rows[-1]] + longest, side="right")) - 1
        rows.append(max(last, rows[-1] + 1))
    return rows


def _moved(recording: Recording, rows: list[int], parts: list[DrawnShape]) -> int:
    """Count poses of shapes that can be told from those in the row before."""
    sizes = {part.body: part.shape.reach for part in parts if recording.appearance.kinds[part.body] == DYNAMIC}
    bodies, grains = list(sizes), _FINE * np.array(list(sizes.values()))
    count = int(recording.particles.shape[1]) * len(rows) // 2  # a vertex takes less than half of the room of a pose
    for before, row in pairwise(rows):
        way = np.abs(recording.x[row, bodies] - recording.x[before, bodies]).max(axis=1, initial=0.0)
        turn = np.abs(recording.orientation[row, bodies] - recording.orientation[before, bodies]).max(
            axis=1, initial=0.0
        )
        count += int(np.count_nonzero((way > grains) | (turn > _TURN)))
    return count


class _Batch:
    """Shapes that look alike but for colour and size, and move."""

    def __init__(self, recording: Recording, parts: list[DrawnShape], surface: Surface) -> None:
        self._recording = recording
        self._bodies = np.array([part.body for part in parts])
        self._places = np.array([part.position for part in parts])
        self._turns = np.array([part.orientation for part in parts])
        self.scales = np.array([surface_of(part.shape).scale for part in parts], dtype=np.float32)
        size = np.abs(surface.vertices).max() * float(self.scales.max(axis=1).min())
        self._grain = _FINE * size
        self._handles: list[Any] = []

    def add(self, scene: Any, name: str, surface: Surface, colours: Floats) -> None:
        """Put the shapes where they are at first."""
        positions, turns = self._at(0)
        self._shown = positions, turns
        self._handles.append(
            scene.add_batched_meshes_simple(
                name,
                surface.vertices,
                surface.faces,
                turns,
                positions,
                batched_scales=self.scales,
                batched_colors=np.round(255 * colours).astype(np.uint8),
                flat_shading=surface.flat,
                side="double" if surface.flat else "front",
                lod="off",
            )
        )

    def show(self, row: int) -> None:
        """Move them to where they are in a row, if that can be seen."""
        positions, turns = self._at(row)
        for handle in self._handles:
            if not np.array_equal(positions, self._shown[0]):
                handle.batched_positions = positions
            if not np.array_equal(turns, self._shown[1]):
                handle.batched_wxyzs = turns
        self._shown = positions, turns

    def _at(self, row: int) -> tuple[Singles, Singles]:
        """Return places and turns, rounded: what hardly moves stays as it is, and takes no room in the file."""
        turns = self._recording.orientation[row, self._bodies]
        positions = self._recording.x[row, self._bodies] + turned(turns, self._places)
        return rounded(positions, self._grain), rounded(product(turns, self._turns), _TURN)


class _Joints:
    """Lines from bodies to their joints."""

    def __init__(self, scene: Any, recording: Recording) -> None:
        self._recording, rods = recording, recording.appearance.rods
        self._bodies = np.array([(rod.body_a, rod.body_b) for rod in rods])
        self._points = np.array([(rod.point_a, rod.point_b) for rod in rods])
        colour = tuple(round(255 * part) for part in RODS)
        self._shown = self._at(0)
        self._handle = scene.add_line_segments("/joints", self._shown, colour, thickness=2.0, thickness_units="screen")

    def show(self, row: int) -> None:
        points = self._at(row)
        if not np.array_equal(points, self._shown):
            self._handle.points = self._shown = points

    def _at(self, row: int) -> Singles:
        turns = self._recording.orientation[row, self._bodies]
        points = self._recording.x[row, self._bodies] + turned(turns, self._points)
        result: Singles = points.astype(np.float32)
        return result


def _joints(scene: Any, recording: Recording) -> list[_Joints]:
    return [_Joints(scene, recording)] if recording.appearance.rods else []


def _batches(scene: Any, recording: Recording, parts: list[DrawnShape], rows: list[int]) -> list[_Batch]:
    """Add all shapes, those that look alike and move at once; return what moves."""
    x, q = recording.x[rows], recording.orientation[rows]
    moves = (x != x[0]).any(axis=(0, 2)) | (q != q[0]).any(axis=(0, 2))
    alike: dict[tuple[int, bytes, bytes, bool], list[DrawnShape]] = {}
    for part in parts:
        surface = surface_of(part.shape)
        key = (part.shape.kind, surface.vertices.tobytes(), surface.faces.tobytes(), bool(moves[part.body]))
        alike.setdefault(key, []).append(part)
    moving = []
    for number, (key, group) in enumerate(alike.items()):
        surface, kind = surface_of(group[0].shape), kind_of(group[0].shape)
        batch = _Batch(recording, group, surface)
        colours = np.array([_colour(recording, part.body) for part in group])
        name = f"/{kind.name.replace(' ', '_')}_{number}"
        if kind.look & BALL:
            dark, light = halves_of_ball(surface)
            batch.add(scene, name, dark, colours)
            batch.add(scene, f"{name}_light", light, colours + _LIGHT * (1.0 - colours))
        else:
            batch.add(scene, name, surface, colours)
        if key[-1]:
            moving.append(batch)
    return moving


def _colour(recording: Recording, body: int) -> Floats:
    return colour_of(body) if recording.appearance.kinds[body] == DYNAMIC else np.array(FIXED)


def _lay_planes(scene: Any, recording: Recording, planes: list[DrawnShape], radius: float) -> None:
    """Show planes as grids that one can look through."""
    section = 10.0 ** np.floor(np.log10(radius))
    for number, plane in enumerate(planes):
        turn = recording.orientation[0, plane.body]
        scene.add_grid(
            f"/plane_{number}",
            infinite_grid=True,
            cell_size=section,
            section_size=section,
            section_color=_LINES,
            fade_distance=20.0 * radius,
            position=recording.x[0, plane.body] + turned(turn, plane.position),
            wxyz=product(turn, plane.orientation),
        )


def _extent(recording: Recording, parts: list[DrawnShape], rows: list[int]) -> tuple[Floats, float]:
    """Return centre and radius of a ball that holds what moves, or what there is; strays are left out."""
    moving = [part for part in parts if recording.appearance.kinds[part.body] == DYNAMIC] or parts
    if not moving and not recording.appearance.cloths:
        return np.zeros(3), 1.0
    bodies = np.unique([part.body for part in moving]).astype(np.intp)
    places = np.concatenate((recording.x[rows][:, bodies], recording.particles[rows]), axis=1).reshape(-1, 3)
    places = places[np.isfinite(places).all(axis=1)]
    low, high = np.quantile(places, (_STRAYS, 1.0 - _STRAYS), axis=0)
    sizes = [0.0]
    for part in moving:
        surface = surface_of(part.shape)
        sizes.append(
            float(np.linalg.norm(np.abs(part.position) + np.abs(surface.vertices * surface.scale).max(axis=0)))
        )
    return 0.5 * (low + high), float(0.5 * np.linalg.norm(high - low) + np.quantile(sizes, 1.0 - _STRAYS))
