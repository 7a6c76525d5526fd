"""Pictures of a recording: chooses from where it is seen, and paints the poses of its bodies."""

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.rotations import turned
from kickdrift.plots.camera import Camera, axes_of, showing
from kickdrift.plots.lighting import BACKGROUND, FADE, GRID, LAMP, SETTING, light, paint
from kickdrift.plots.rendering import MIDDLE, REACH, cast, clear, ray_addresses
from kickdrift.plots.scenery import Pose, Scenery, Sight, is_plane, outline
from kickdrift.world.layout import DYNAMIC
from kickdrift.world.recordings.appearance import DrawnShape
from kickdrift.world.recordings.recording import Recording

Floats = NDArray[np.float64]
_SAMPLES = 2  # rays for a pixel, along each side of it
AHEAD = (-0.42, 0.82, -0.36)  # where a camera looks that sees depth
_FROM_LAMP, _FROM_FRONT = (0.62, 0.35, -1.0), (0.35, 1.0, -0.45)  # right, ahead on the level, and up
_ASPECTS = (0.75, 4.0)  # of pictures, least and greatest
_MOST_POINTS = 500_000  # that are looked at to see how far bodies come
_MOST, _STRAY = 0.95, 6.0  # farther from the middle than six times what most of all places are: out of the picture
_BEYOND = 0.5  # how far fixed bodies reach out of what moves, of its extent, to be seen whole
_FLAT = 0.01  # out of the plane, of the extent, in a scene that is seen from the side
_LAMP_PIXELS = 900
BACKDROP = (1.0, 1.0, 1.0)


class Painter:
    """Paints the states of one recording from one place.

    Parameters
    ----------
    recording : Recording
    pixels : int
        How many a picture has, about; it is as wide as the scene, and even in both directions.

    Attributes
    ----------
    camera : Camera
    width, height : int
        Of the pictures, in pixels.
    distance : (n height, n width) array
        How far the rays of the last picture go, n x n of them for each pixel.
    """

    def __init__(self, recording: Recording, pixels: int) -> None:
        points, reaches = _places(recording)
        low, high = (points - reaches[:, None]).min(axis=0), (points + reaches[:, None]).max(axis=0)
        extent, centre = float(np.linalg.norm(high - low)), 0.5 * (low + high)
        self._flat = _is_flat(recording, extent)
        ahead = np.array((0.0, 1.0, 0.0) if self._flat else AHEAD)
        aspect = _aspect(points, reaches, ahead)
        self.width, self.height = (2 * round(0.5 * math.sqrt(pixels * shape)) for shape in (aspect, 1.0 / aspect))
        self.camera = showing(points, reaches, ahead, self.width / self.height, perspective=not self._flat)
        planes = [part for part in recording.appearance.parts if _is_seen_plane(part, recording, self.camera)]
        self.scenery = Scenery(recording.appearance, extent, planes, from_side=self._flat)
        self._addresses = ray_addresses(self.scenery.kinds)
        self._lamp = _lamp(self.camera, _FROM_FRONT if self._flat else _FROM_LAMP, centre, 0.55 * extent)
        self._setting = np.zeros(SETTING)
        self._setting[LAMP : LAMP + 3] = -self._lamp.ahead
        self._setting[BACKGROUND : BACKGROUND + 3] = BACKDROP
        self._setting[GRID] = _round_length(extent / 12.0)
        self._setting[FADE : FADE + 4] = (1.6 * extent, *centre)
        self._film, self._empty = (_Film(_SAMPLES * self.height, _SAMPLES * self.width) for _ in range(2))
        self._shade = _Film(_LAMP_PIXELS, _LAMP_PIXELS)
        self._lit = np.ones(self._film.distance.shape, dtype=np.float32)
        # Planes do not move: their rays are cast once.
        sight = self.scenery.at(Pose(recording.x[0], recording.orientation[0], recording.particles[0]))
        clear(*self._empty)
        cast(self.camera.numbers(), np.arange(self.scenery.n_planes), *sight, self._addresses, *self._empty)
        self._picture = np.zeros((self.height, self.width, 3), dtype=np.uint8)

    @property
    def distance(self) -> Floats:
        """How far the rays of the last picture go, m, n x n of them for each pixel."""
        return self._film.distance

    def paint(self, pose: Pose) -> NDArray[np.uint8]:
        """Paint the bodies in a pose.

        Returns
        -------
        (height, width, 3) array of uint8
        """
        sight, camera, film, shade = self.scenery.at(pose), self.camera.numbers(), self._film, self._shade
        for array, empty in zip(film, self._empty, strict=True):
            array[:] = empty
        cast(camera, self._nearest_first(sight, self.camera), *sight, self._addresses, *film)
        if not self._flat:
            lamp = self._lamp.numbers()
            clear(*shade)
            cast(lamp, self._nearest_first(sight, self._lamp), *sight, self._addresses, *shade)
            light(camera, film.distance, film.normal, lamp, shade.distance, self._lit)
        colours = self.scenery.colours
        seen = (film.distance, film.owner, film.normal, self._lit)
        paint(camera, sight.shapes, sight.places, colours, self._setting, *seen, self._picture)
        return self._picture.copy()

    def _nearest_first(self, sight: Sight, camera: Camera) -> NDArray[np.intp]:
        """Sort the shapes that are not planes by how far away they are; those that have been removed are nowhere."""
        middles = sight.places[self.scenery.n_planes :, MIDDLE:REACH]
        far = (middles - camera.eye) @ camera.ahead
        there = np.flatnonzero(np.isfinite(far))
        return self.scenery.n_planes + there[np.argsort(far[there], kind="stable")]


class _Film:
    """What the rays through the pixels of a picture meet."""

    def __init__(self, height: int, width: int) -> None:
        self.distance = np.zeros((height, width))
        self.owner = np.zeros((height, width), dtype=np.int32)
        self.normal = np.zeros((height, width, 3), dtype=np.float32)

    def __iter__(self) -> Iterator[NDArray[Any]]:
        return iter((self.distance, self.owner, self.normal))


def _places(recording: Recording) -> tuple[Floats, Floats]:
    """Find points of the shapes that move, as balls, and the ends of rods, at many times, with fixed bodies among them.

    Strays are left out, which would make everything else small, and so are fixed bodies that reach far beyond.

    Returns
    -------
    (K, 3) and (K,) array
        Centres and radii, m.
    """
    parts = [part for part in recording.appearance.parts if not is_plane(part)]
    moving = [part for part in parts if recording.appearance.kinds[part.body] == DYNAMIC]
    shown = [(part.body, *outline(part)) for part in moving or parts]
    for rod in recording.appearance.rods:
        shown += [(rod.body_a, rod.point_a[None], 0.0), (rod.body_b, rod.point_b[None], 0.0)]
    states = max(2, min(recording.t.size, _MOST_POINTS // max(1, sum(len(points) for _, points, _ in shown))))
    rows = np.unique(np.linspace(0, recording.t.size - 1, states).astype(np.intp))
    places, reaches = [], []
    for body, points, reach in shown:
        at, turn = recording.x[rows, body, None], recording.orientation[rows, body, None]
        places.append((at + turned(turn, points)).reshape(-1, 3))
        reaches.append(np.full(len(places[-1]), reach))
    if recording.appearance.cloths:
        places.append(recording.particles[rows].reshape(-1, 3))
        reaches.append(np.zeros(len(places[-1])))
    if not places:
        return np.zeros((1, 3)), np.ones(1)
    x, r = np.concatenate(places), np.concatenate(reaches)
    there = np.isfinite(x).all(axis=1)  # not what was added later
    x, r = x[there], r[there]
    middle = np.median(x, axis=0)
    away = np.abs(x - middle).max(axis=1)
    near = away <= _STRAY * np.quantile(away, _MOST)
    x, r = x[near], r[near]
    fixed = [part for part in parts if recording.appearance.kinds[part.body] != DYNAMIC] if moving else []
    beyond = _BEYOND * float(np.linalg.norm(np.ptp(x, axis=0)))
    low, high = x.min(axis=0) - beyond, x.max(axis=0) + beyond
    for part in fixed:
        points, reach = outline(part)
        points = recording.x[0, part.body] + turned(recording.orientation[0, part.body], points)
        if ((points > low) & (points < high)).all():
            x, r = np.concatenate((x, points)), np.concatenate((r, np.full(len(points), reach)))
    return x, r


def _aspect(points: Floats, reaches: Floats, ahead: Floats) -> float:
    """Return the ratio of a scene's width to its height, seen from a direction, within what pictures can be."""
    right, up, _ = axes_of(ahead)
    width, height = ((points @ axis + reaches).max() - (points @ axis - reaches).min() for axis in (right, up))
    return float(np.clip(width / height, *_ASPECTS))


def _is_flat(recording: Recording, extent: float) -> bool:
    """Whether everything moves in the x-z plane, and turns in it."""
    rows = recording.moving
    if not rows.size or recording.appearance.cloths:
        return False
    q = recording.orientation[:, rows]
    leans = np.abs(2.0 * (q[..., 2] * q[..., 3] + q[..., 0] * q[..., 1])).max()  # of y axes out of the y direction
    ways = np.ptp(recording.x[:, rows, 1])
    return bool(ways < _FLAT * extent and leans < 10 * _FLAT)


def _is_seen_plane(plane: DrawnShape, recording: Recording, camera: Camera) -> bool:
    """Whether a shape is a plane that a camera sees from outside, or from the side where its rays are parallel."""
    if not is_plane(plane):
        return False
    at, turn = recording.x[0, plane.body], recording.orientation[0, plane.body]
    origin = at + turned(turn, plane.position)
    normal = turned(turn, turned(plane.orientation, np.array([0.0, 0.0, 1.0])))
    if not camera.perspective:
        return bool(abs(normal @ camera.ahead) < _FLAT)
    return bool((camera.eye - origin) @ normal > 0.0)


def _lamp(camera: Camera, shining: Sequence[float], centre: Floats, radius: float) -> Camera:
    """Place a lamp so far away that its rays are parallel; they shine in a direction given in the camera's axes."""
    upwards = np.array([0.0, 0.0, 1.0])
    right, ahead, up = shining
    axes = axes_of(right * camera.right + ahead * np.cross(upwards, camera.right) + up * upwards)
    return Camera(centre - 3.0 * radius * axes[2], *axes, False, radius)


def _round_length(length: float) -> float:
    """Return the nearest of 1, 2 and 5 times a power of ten that is not smaller."""
    power = 10.0 ** math.floor(math.log10(length))
    return next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= length)
