"""Solutions as pages for the browser: bodies that move on their orbits."""

from pathlib import Path
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from kickdrift.analysis.energy import energy_error
from kickdrift.core.colours import COLOURS, colour_of
from kickdrift.core.errors import ArgumentError
from kickdrift.engine.solution import Solution
from kickdrift.viewer.curves import Curve, panel
from kickdrift.viewer.page import Singles, Stage, check_in_memory, linear, rounded, write_page
from kickdrift.viewer.surfaces import surface_of
from kickdrift.world.shapes.sphere import Sphere

Floats = NDArray[np.float64]
_RATE, _SECONDS, _SLOWEST = 30.0, 20.0, 10.0  # states a second; of the page; states a second where few were kept
_RADIUS = 10.0  # of the scene in the browser's units, whatever the orbits are measured in
_SIZES = (2e-4, 1e-2)  # of the balls that stand for bodies, of the radius of the scene: least and greatest
_APART = 0.1  # of the way to the nearest body, which a ball may fill
_FINE = 1 / 32  # of the smallest ball, to which places are rounded
_ROWS_MEASURED = 20
_MOST_POINTS = 50_000  # of all orbits: more of them are slow on a machine without a graphics card
_MOST_ORBITS = 200  # bodies that have one: those of thousands are a sheet that hides all bodies
_DOT = 5e-3  # size of dots that stand for so many bodies, of the radius of the scene: four pixels
_MOST_TAILS, _TAIL = 50, 24  # bodies that have one, and its states
_MOST_NAMES = 30
_NAME_SIZES = (1e-4, 0.04)  # heights, of the radius of the scene: least and greatest
_NAME_APART = 0.25  # of the way to the nearest body, for the height: about a name's width away from it
_FAINT = 0.6  # of white in the colours of orbits
_LOST_TURN = 1.0  # radians between two states: farther apart, they no longer make a curve


class _Orbits(NamedTuple):
    """Where bodies are in the browser's units, (T, N, 3), and their colours, (N, 3) from 0 to 1."""

    paths: Floats
    colours: Floats


def solution_to_html(solution: Solution, path: str | Path) -> Path:
    """Write a solution as a page that plays in the browser: bodies, their orbits, and their names.

    Parameters
    ----------
    solution : Solution
        Of bodies in the plane or in space: x0 of shape (2,), (3,), (N, 2) or (N, 3). It plays in at most 20 s, in 30 states
        a second of those kept. Orbits are drawn through the states; where these are so far apart that no curve can be seen
        in them, as points, and a body whose states shown are that far apart has no tail. Names of bodies that are close to
        each other are small: they can be read from nearby. More than 30 bodies have no names, more than 50 no tails,
        and more than 200 no orbits, which the page says; these are dots of one size.
    path : path
        Ends in ``.html``.

    Returns
    -------
    Path
        The file written. It needs no server and no network.

    Raises
    ------
    ArgumentError
        If the states are not positions in the plane or in space.
    KickdriftError
        If the states are on disk.
    FileFormatError
        If the file cannot be written.
    MissingExtraError
        If viser is not installed.
    """
    solution = solution.plain
    shape = solution.x.shape[1:]
    if not 1 <= len(shape) <= 2 or shape[-1] not in (2, 3):
        raise ArgumentError(
            f"x has the shape {shape} at each time, and the viewer shows bodies in the plane or in space, (2,), (3,), (N, 2)"
            " or (N, 3); sol.plot() draws it over time."
        )
    check_in_memory(solution)
    return write_page(path, f"{solution.about.system} by {solution.about.method}", lambda stage: _play(stage, solution))


def _play(stage: Stage, solution: Solution) -> str:
    orbits = _orbits(solution)
    rows, waits = _rows_shown(solution.t)
    stage.look(np.zeros(3), _RADIUS)
    title, bodies = f"{solution.about.system} by {solution.about.method}", len(orbits.colours)
    movers: list[_Mover] = []
    if bodies <= _MOST_ORBITS:
        _draw_paths(stage.scene, orbits)
        movers.append(_Balls(stage.scene, orbits))
    else:
        movers.append(_Dots(stage.scene, orbits))
        title += f", {bodies} bodies without their orbits"
    smooth = _smooth(orbits.paths[rows])  # tails of others would be chords that cross the orbit
    if bodies <= _MOST_TAILS and smooth.any():
        movers.append(_Tails(stage.scene, _Orbits(orbits.paths[:, smooth], orbits.colours[smooth]), rows))
    names = tuple(solution.about.coordinates.get("body", ()))
    if 1 < len(names) <= _MOST_NAMES:
        movers.append(_Names(stage.scene, orbits, names))
    for wait, row in zip(waits, rows, strict=True):
        stage.wait(wait)
        for mover in movers:
            mover.show(row)
    stage.wait(1.0 / _RATE)
    about = solution.about
    curves = [Curve("energy error", energy_error(solution), COLOURS[0])] if "energy" in solution.invariants else []
    return panel(title, solution.t, curves, "", sum(waits), about.units.get("t", ""))


def _orbits(solution: Solution) -> _Orbits:
    """Put the middle of all bodies at the origin, and let the farthest of them fill the scene."""
    x = solution.x.reshape(solution.t.size, -1, solution.x.shape[-1])
    x = np.pad(x, ((0, 0), (0, 0), (0, 3 - x.shape[-1])))
    # The median of the bodies, so that a few far ones on part of an orbit do not move it.
    x = x - np.median(x.mean(axis=0), axis=0)
    x *= _RADIUS / (np.linalg.norm(x, axis=2).max() or 1.0)
    return _Orbits(x, np.array([colour_of(body) for body in range(x.shape[1])]))


def _bytes(colours: Floats) -> NDArray[np.uint8]:
    result: NDArray[np.uint8] = np.round(255.0 * colours).astype(np.uint8)
    return result


def _rows_shown(t: Floats) -> tuple[list[int], list[float]]:
    """Choose rows at equal times, and say how long to wait before each."""
    if t.size == 1:
        return [0], [0.0]
    seconds = min(_SECONDS, t.size / _SLOWEST)
    wanted = np.linspace(t[0], t[-1], min(t.size, int(seconds * _RATE)))
    order = np.argsort(t, kind="stable")  # t may run backwards
    rows = np.unique(order[np.searchsorted(t[order], wanted).clip(0, t.size - 1)])
    waits = np.abs(np.diff(t[rows], prepend=t[rows[0]])) * seconds / abs(t[-1] - t[0])
    return rows.tolist(), waits.tolist()


def _draw_paths(scene: Any, orbits: _Orbits) -> None:
    """Draw the orbits as lines, or as points where the states are too far apart."""
    count, bodies, _ = orbits.paths.shape
    stride = -(-count * bodies // _MOST_POINTS)
    paths, colours = orbits.paths[::stride], orbits.colours
    if len(paths) < 2:
        return
    faint = colours + _FAINT * (1.0 - colours)
    smooth = _smooth(paths)
    if smooth.any():
        segments = np.stack((paths[:-1, smooth], paths[1:, smooth]), axis=2).reshape(-1, 2, 3)
        each = np.broadcast_to(linear(faint[smooth])[None, :, None], (len(paths) - 1, smooth.sum(), 2, 3)).reshape(
            -1, 2, 3
        )
        scene.add_line_segments("/orbits", segments, each, thickness=1.0, thickness_units="screen")
    if not smooth.all():
        points = paths[:, ~smooth].reshape(-1, 3)
        each_point = np.broadcast_to(_bytes(faint[~smooth]), (len(paths), (~smooth).sum(), 3)).reshape(-1, 3)
        scene.add_point_cloud("/states", points, each_point, point_size=2e-3 * _RADIUS, precision="float32")


def _smooth(paths: Floats) -> NDArray[np.bool_]:
    """Return which bodies turn so little from state to state that these are a curve."""
    way = np.diff(paths, axis=0)
    if len(way) < 2:
        return np.ones(paths.shape[1], dtype=np.bool_)
    lengths = np.linalg.norm(way, axis=2)
    cosines = (way[1:] * way[:-1]).sum(axis=2) / np.maximum(lengths[1:] * lengths[:-1], 1e-300)
    turns = np.median(np.arccos(np.clip(cosines, -1.0, 1.0)), axis=0)
    result: NDArray[np.bool_] = turns < _LOST_TURN
    return result


class _Mover(Protocol):
    """What changes from state to state."""

    def show(self, row: int) -> None:
        """Send what differs from the row shown before."""
        ...


class _Balls:
    """Bodies as balls that leave room between them."""

    def __init__(self, scene: Any, orbits: _Orbits) -> None:
        self._paths, radii = orbits.paths, _radii(orbits.paths)
        self._grain = _FINE * float(radii.min())
        surface, bodies = surface_of(Sphere(1.0)), len(orbits.colours)
        self._handle = scene.add_batched_meshes_simple(
            "/bodies",
            surface.vertices,
            surface.faces,
            np.broadcast_to((1.0, 0.0, 0.0, 0.0), (bodies, 4)),
            self._at(0),
            batched_scales=radii,
            batched_colors=linear(orbits.colours),
            lod="off",
        )

    def show(self, row: int) -> None:
        self._handle.batched_positions = self._at(row)

    def _at(self, row: int) -> Singles:
        return rounded(self._paths[row], self._grain)


class _Dots:
    """Thousands of bodies: balls, of 500 triangles each, would take the time of a graphics card."""

    def __init__(self, scene: Any, orbits: _Orbits) -> None:
        self._paths = orbits.paths
        self._handle = scene.add_point_cloud(
            "/bodies",
            self._at(0),
            _bytes(orbits.colours),
            point_size=_DOT * _RADIUS,
            point_shape="circle",
            precision="float32",
        )

    def show(self, row: int) -> None:
        self._handle.points = self._at(row)

    def _at(self, row: int) -> Singles:
        return rounded(self._paths[row], _FINE * _DOT * _RADIUS)


def _radii(paths: Floats) -> Singles:
    """Choose radii of balls, so that those that are near to each other can be told apart."""
    least, greatest = (size * _RADIUS for size in _SIZES)
    if paths.shape[1] == 1:
        return np.array([greatest], dtype=np.float32)
    radii: Singles = np.clip(_APART * _nearest(paths), least, greatest).astype(np.float32)
    return radii


def _nearest(paths: Floats) -> Floats:
    """Return the median distance of each of several bodies to the one that is nearest to it."""
    rows = np.unique(np.linspace(0, len(paths) - 1, _ROWS_MEASURED).astype(np.intp))
    result: Floats = np.median([cKDTree(paths[row]).query(paths[row], k=2)[0][:, 1] for row in rows], axis=0)
    return result


class _Tails:
    """The last states of each body before the one that is shown."""

    def __init__(self, scene: Any, orbits: _Orbits, rows: list[int]) -> None:
        self._paths, self._rows = orbits.paths, rows
        self._place = {row: place for place, row in enumerate(rows)}
        tail = np.broadcast_to(linear(orbits.colours)[None, :, None], (_TAIL, len(orbits.colours), 2, 3)).reshape(
            -1, 2, 3
        )
        self._handle = scene.add_line_segments(
            "/tails", self._at(rows[0]), tail, thickness=2.5, thickness_units="screen"
        )

    def show(self, row: int) -> None:
        self._handle.points = self._at(row)

    def _at(self, row: int) -> Singles:
        place = self._place[row]
        last = self._paths[[self._rows[max(0, place - k)] for k in range(_TAIL + 1)]]
        result: Singles = np.stack((last[:-1], last[1:]), axis=2).reshape(-1, 2, 3).astype(np.float32)
        return result


class _Names:
    """Names that go with their bodies; those of bodies close to each other are small, and readable from nearby."""

    def __init__(self, scene: Any, orbits: _Orbits, names: tuple[str, ...]) -> None:
        self._paths = orbits.paths
        least, greatest = (size * _RADIUS for size in _NAME_SIZES)
        heights = np.clip(_NAME_APART * _nearest(orbits.paths), least, greatest)
        self._labels = [
            scene.add_label(
                f"/names/{body}",
                name,
                position=self._paths[0, body],
                font_size_mode="scene",
                font_scene_height=float(heights[body]),
            )
            for body, name in enumerate(names)
        ]

    def show(self, row: int) -> None:
        for label, place in zip(self._labels, self._paths[row], strict=True):
            label.position = place
