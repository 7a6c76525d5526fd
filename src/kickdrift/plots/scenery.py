"""What there is to be seen of a recording: its shapes as numbers for the rays of a camera, and where they are."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.calls import address_of, caller
from kickdrift.core.colours import FIXED, RODS, colour_of
from kickdrift.core.compilation import compiled
from kickdrift.core.rotations import product, turn_to, turned
from kickdrift.plots.rendering import MIDDLE, REACH
from kickdrift.world.layout import DYNAMIC, REMOVED
from kickdrift.world.recordings.appearance import Appearance, DrawnShape
from kickdrift.world.shapes.kind_numbers import BOX, CAPSULE, PLANE, TRIANGLE
from kickdrift.world.shapes.record import BALL, EXTENT, HALF_SPACE, PLAIN
from kickdrift.world.shapes.shape_kinds import KINDS, kind_of, met_as
from kickdrift.world.shapes.triangle import FIRST_TRIANGLE, TRIANGLE_SIZE

Floats = NDArray[np.float64]
_enclose = caller(EXTENT)
_ROD = 0.002  # thickness of a rod, of the extent of the scene
_GROUND = (0.93, 0.94, 0.95)
_CORNERS = np.array([[k >> axis & 1 for axis in range(3)] for k in range(8)], dtype=np.bool_)
_SLAB = 20.0  # half the width of what stands for a plane that is seen from the side, of the extent of the scene


class Pose(NamedTuple):
    """Where all bodies are: positions (N, 3) and orientations (N, 4); and the vertices of cloths, (P, 3)."""

    position: Floats
    orientation: Floats
    particles: Floats


class Sight(NamedTuple):
    """Shapes as a camera takes them; see `kickdrift.plots.rendering.cast`.

    Attributes
    ----------
    shapes : (S, 4) array of int
    places : (S, 11) array
    numbers : (K,) array
    """

    shapes: NDArray[np.int64]
    places: Floats
    numbers: Floats


class _Piece(NamedTuple):
    """A shape as rays see it: its kind and numbers, and a ball around it in its own frame."""

    kind: int
    numbers: Floats
    middle: Floats
    reach: float


class Scenery:
    """The shapes of a world, wherever its bodies are.

    Parameters
    ----------
    appearance : Appearance
    extent : float
        Of the scene, m.
    planes : sequence of Part
        Those planes of it that are to be seen.
    from_side : bool
        Whether planes are seen from the side, as slabs.

    Attributes
    ----------
    colours : (S, 3) array
    n_planes : int
        They are the first of the shapes.
    """

    def __init__(self, appearance: Appearance, extent: float, planes: list[DrawnShape], *, from_side: bool) -> None:
        self._rods = appearance.rods
        self._segments = [
            (cloth.first + i, cloth.radius, colour_of(k + 1))
            for k, cloth in enumerate(appearance.cloths)
            if cloth.radius > 0.0
            for i in range(cloth.last - cloth.first - 1)
        ]
        radii = [_ROD * extent] * len(self._rods) + [radius for _, radius, _ in self._segments]
        pieces: list[_Piece] = []
        bodies, places, colours = [], [], []
        self.n_planes = len(planes)
        for part in (*planes, *(part for part in appearance.parts if not is_plane(part))):
            if appearance.kinds[part.body] == REMOVED:
                continue
            made, origin, colour = _seen(
                part, appearance.kinds[part.body] == DYNAMIC, _SLAB * extent if from_side else None
            )
            pieces += made
            bodies += [part.body] * len(made)
            places += [[*origin, *part.orientation]] * len(made)
            colours += [colour] * len(made)
        sheets = [(k, cloth) for k, cloth in enumerate(appearance.cloths) if cloth.radius == 0.0]
        corners = [cloth.first + cloth.triangles for _, cloth in sheets]
        self._corners = np.concatenate([np.zeros((0, 3), dtype=np.int64), *corners])
        self._cloth = slice(len(pieces), len(pieces) + len(self._corners))
        pieces += [_Piece(TRIANGLE, np.zeros(TRIANGLE_SIZE), np.zeros(3), 0.0)] * len(self._corners)
        bodies += [0] * len(self._corners)
        places += [[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]] * len(self._corners)
        colours += [colour_of(k + 1) for k, cloth in sheets for _ in cloth.triangles]
        self._bodies = np.array(bodies, dtype=np.intp)
        self._in_body = np.array(places, dtype=np.float64).reshape(-1, 7)
        self._middles = np.array([p.middle for p in pieces]).reshape(-1, 3)
        self._reaches = np.array([p.reach for p in pieces] + [0.0] * len(radii))
        pieces += [_Piece(CAPSULE, np.array([radius, 0.0]), np.zeros(3), 0.0) for radius in radii]
        ends = np.cumsum([p.numbers.size for p in pieces], dtype=np.int64)
        sizes = np.array([p.numbers.size for p in pieces], dtype=np.int64)
        kinds, looks = [p.kind for p in pieces], [KINDS[p.kind].look for p in pieces]
        looks[self._cloth] = [PLAIN] * len(self._corners)
        looks[len(pieces) - len(self._segments) :] = [PLAIN] * len(self._segments)
        self._shapes = np.column_stack((kinds, ends - sizes, ends, looks)).astype(np.int64).reshape(-1, 4)
        self._numbers = np.concatenate([np.zeros(0), *(p.numbers for p in pieces)])
        ropes = [colour for _, _, colour in self._segments]
        self.colours = np.array([*colours, *[RODS] * len(self._rods), *ropes]).reshape(-1, 3)

    @property
    def kinds(self) -> set[int]:
        """Kinds of shapes that rays will have to meet."""
        return {int(kind) for kind in self._shapes[:, 0]}

    def at(self, pose: Pose) -> Sight:
        """Return the scenery for a pose of the bodies."""
        turns, at = pose.orientation[self._bodies], pose.position[self._bodies]
        places = np.zeros((len(self._shapes), 11))
        count = len(self._bodies)
        places[:count, :3] = at + turned(turns, self._in_body[:, :3])
        places[:count, 3:7] = product(turns, self._in_body[:, 3:])
        places[:count, MIDDLE:REACH] = places[:count, :3] + turned(places[:count, 3:7], self._middles)
        places[:, REACH] = self._reaches
        numbers = self._numbers.copy()
        self._lay_cloths(pose.particles, places, numbers)
        for i, (first, last) in enumerate(self._lines(pose), start=count):
            along = last - first
            length = float(np.linalg.norm(along))
            places[i, :3] = places[i, MIDDLE:REACH] = first + 0.5 * along
            places[i, 3:7] = turn_to(along / length) if length > 0.0 else (1.0, 0.0, 0.0, 0.0)
            places[i, REACH] = 0.5 * length + numbers[self._shapes[i, 1]]
            numbers[self._shapes[i, 1] + 1] = 0.5 * length
        return Sight(self._shapes, places, numbers)

    def _lines(self, pose: Pose) -> Iterator[tuple[Floats, Floats]]:
        """Yield the ends of rods, then those of segments of ropes."""
        for rod in self._rods:
            first = pose.position[rod.body_a] + turned(pose.orientation[rod.body_a], rod.point_a)
            yield first, pose.position[rod.body_b] + turned(pose.orientation[rod.body_b], rod.point_b)
        for i, _, _ in self._segments:
            yield pose.particles[i], pose.particles[i + 1]

    def _lay_cloths(self, particles: Floats, places: Floats, numbers: Floats) -> None:
        """Write where the triangles of cloths are."""
        corners, own = particles[self._corners], self._cloth
        middles = corners.mean(axis=1)
        places[own, :7] = (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
        places[own, MIDDLE:REACH] = middles
        places[own, REACH] = np.linalg.norm(corners - middles[:, None], axis=2).max(axis=1, initial=0.0)
        at = self._shapes[own, 1, None] + np.arange(9)
        numbers[at] = corners.reshape(-1, 9)


def is_plane(part: DrawnShape) -> bool:
    """Whether a shape fills half of space."""
    return kind_of(part.shape).sort == HALF_SPACE


def outline(part: DrawnShape) -> tuple[Floats, float]:
    """Return points of a shape that is not a plane, in the axes of its body, and how far it reaches beyond them.

    They are the corners of the box around it; of a ball its centre.
    """
    low, high = _box(part)
    if kind_of(part.shape).look & BALL:
        return part.position[None] + turned(part.orientation, 0.5 * (low + high)[None]), 0.5 * float((high - low).max())
    corners = np.where(_CORNERS, high, low)
    return part.position + turned(part.orientation, corners), 0.0


def _seen(part: DrawnShape, moves: bool, slab: float | None) -> tuple[list[_Piece], Floats, Any]:
    """Return a shape as rays see it, the origin of its frame in the axes of its body, and its colour.

    A plane is a cube with edges of 2 `slab`, m, if that is given.
    """
    if not is_plane(part):
        return _pieces(part), part.position, colour_of(part.body) if moves else FIXED
    if slab is None:
        return [_Piece(PLANE, np.zeros(0), np.zeros(3), np.inf)], part.position, _GROUND
    middle = part.position - turned(part.orientation, np.array([0.0, 0.0, slab]))
    return [_Piece(BOX, np.full(3, slab), np.zeros(3), 2.0 * slab)], middle, _GROUND


def _pieces(part: DrawnShape) -> list[_Piece]:
    """Cut a shape into what rays meet: meshes into triangles."""
    shape = part.shape
    if met_as(shape.kind) == TRIANGLE:
        triangles = shape.numbers[FIRST_TRIANGLE:].reshape(-1, TRIANGLE_SIZE)
        corners = triangles[:, :9].reshape(-1, 3, 3)
        middles = corners.mean(axis=1)
        reaches = np.linalg.norm(corners - middles[:, None], axis=2).max(axis=1)
        return [_Piece(TRIANGLE, *row) for row in zip(triangles, middles, reaches.tolist(), strict=True)]
    middle, reach = _ball(part)
    return [_Piece(shape.kind, shape.numbers, middle, reach)]


def _ball(part: DrawnShape) -> tuple[Floats, float]:
    """Return a ball around a shape in its own frame: around its origin, or around its box if that is smaller."""
    low, high = _box(part)
    around_box = 0.5 * float(np.linalg.norm(high - low))
    reach = part.shape.reach
    return (np.zeros(3), reach) if 0.0 < reach <= around_box else (0.5 * (low + high), around_box)


def _box(part: DrawnShape) -> tuple[Floats, Floats]:
    """Return the lower and the upper corner of the box around a shape in its own frame."""
    extent = kind_of(part.shape).extent
    assert extent is not None, "planes have none"
    box = np.array(_extent(address_of(extent, EXTENT), part.shape.numbers))
    return box[:3], box[3:]


@compiled
def _extent(address: Any, numbers: Any) -> Any:
    return _enclose(address, (numbers, (1.0, 0.0, 0.0, 0.0)))
