"""How a scene of the lab is written: the verbs of `kickdrift.World`, which fill a description that every engine reads."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import ConvexHull

from benchmarks.world.described import GROUND, Body, Floats, Joint, Load, Scene, rotation, shortest_turn

GRAVITY = 9.81
_UP = np.array([0.0, 0.0, 1.0])
_UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])


class Builder:
    """A scene that is being written; each verb returns the number of the body that it adds.

    Parameters
    ----------
    gravity : float or (3,) array_like
        m/s^2; a number acts downwards.
    planar : bool
        Whether bodies move in the xz plane only.
    at : (3,) array_like
        Where the origin of the scene lies, m.
    friction, restitution : float
        Of all bodies that do not say otherwise.
    """

    def __init__(
        self,
        gravity: ArrayLike = GRAVITY,
        planar: bool = False,
        at: ArrayLike = (0.0, 0.0, 0.0),
        friction: float = 0.6,
        restitution: float = 0.0,
    ) -> None:
        given = np.asarray(gravity, dtype=float)
        self._gravity = given if given.shape else -given * _UP
        self._planar, self._at = planar, np.asarray(at, dtype=float)
        self._surface = {"friction": friction, "restitution": restitution}
        self._bodies: list[Body] = []
        self._joints: list[Joint] = []
        self._loads: list[Load] = []

    def scene(self) -> Scene:
        """Return what was written."""
        return Scene(self._gravity, self._bodies, self._joints, self._planar, tuple(self._loads))

    def plane(self, normal: ArrayLike = _UP, **options: Any) -> int:
        """Add the half-space under a plane."""
        up = np.asarray(normal, dtype=float)
        turn = shortest_turn(_UP, up / np.linalg.norm(up))
        return self._add("plane", (), 0.0, np.zeros(3), orientation=turn, static=True, **options)

    def box(self, size: ArrayLike, **options: Any) -> int:
        """Add a box of three full edge lengths."""
        edges = np.asarray(size, dtype=float)
        squares = edges**2
        return self._add(
            "box", tuple((edges / 2).tolist()), float(edges.prod()), (squares.sum() - squares) / 12, **options
        )

    def sphere(self, radius: float, **options: Any) -> int:
        """Add a ball."""
        return self._add("sphere", (radius,), 4 / 3 * np.pi * radius**3, np.full(3, 0.4 * radius**2), **options)

    def capsule(self, radius: float, length: float, **options: Any) -> int:
        """Add a cylinder along z, of a length, with half balls at its ends."""
        cylinder, ball, half = np.pi * radius**2 * length, 4 / 3 * np.pi * radius**3, length / 2
        along = (0.5 * cylinder + 0.4 * ball) * radius**2
        across = cylinder * (radius**2 / 4 + length**2 / 12)
        across += ball * (83 / 320 * radius**2 + (half + 0.375 * radius) ** 2)
        volume = cylinder + ball
        return self._add("capsule", (radius, half), volume, np.array([across, across, along]) / volume, **options)

    def hull(self, points: ArrayLike, **options: Any) -> int:
        """Add the hull of points that turn with their own axes, which have to be those of its inertia."""
        given = np.asarray(points, dtype=float)
        volume, centre, second = moments_of(given)
        gyration = (np.trace(second) - np.diag(second)) / volume
        return self._add("hull", (), volume, gyration, points=given - centre, shift=centre, **options)

    def mesh(self, points: ArrayLike, faces: ArrayLike, **options: Any) -> int:
        """Add triangles, which never move."""
        shape = {"points": np.asarray(points, dtype=float), "faces": np.asarray(faces)}
        return self._add("mesh", (), 0.0, np.zeros(3), static=True, **shape, **options)

    def _add(
        self,
        kind: str,
        size: tuple[float, ...],
        volume: float,
        inertia: Floats,
        *,
        position: ArrayLike = (0.0, 0.0, 0.0),
        orientation: ArrayLike = _UPRIGHT,
        shift: ArrayLike = (0.0, 0.0, 0.0),
        mass: float | None = None,
        density: float = 1000.0,
        static: bool = False,
        velocity: ArrayLike = (0.0, 0.0, 0.0),
        angular_velocity: ArrayLike = (0.0, 0.0, 0.0),
        **others: Any,
    ) -> int:
        weight = float(0.0 if static else density * volume if mass is None else mass)
        others.setdefault("friction", self._surface["friction"])
        others.setdefault("restitution", self._surface["restitution"])
        turn = np.asarray(orientation, dtype=float) / np.linalg.norm(orientation)
        place = self._at + np.asarray(position, dtype=float) + rotation(turn) @ np.asarray(shift, dtype=float)
        vectors = (np.asarray(given, dtype=float) for given in (velocity, angular_velocity))
        moments = weight * np.asarray(others.pop("gyration", inertia), dtype=float)
        values = (float(others.pop("friction")), float(others.pop("restitution")), *vectors)
        self._bodies.append(Body(kind, size, place, turn, weight, moments, *values, **others))
        return len(self._bodies) - 1

    def join(self, kind: str, a: int, b: int, anchor: ArrayLike, axis: ArrayLike = _UP, **options: Any) -> int:
        """Join body b to body a, which may be `GROUND`; return the number of the joint."""
        along = np.asarray(axis, dtype=float)
        options = {name: float(value) if np.ndim(value) == 0 else value for name, value in options.items()}
        place = self._at + np.asarray(anchor, dtype=float)
        self._joints.append(Joint(kind, a, b, place, along / np.linalg.norm(along), **options))
        return len(self._joints) - 1

    def push(self, body: int, force: ArrayLike, begin: float = 0.0, end: float = np.inf) -> None:
        """Let a force act on the centre of a body for some time."""
        self._loads.append(Load(body, np.asarray(force, dtype=float), begin, end))


def moments_of(points: Floats) -> tuple[float, Floats, Floats]:
    """Return the volume of a hull, its centre, and the integral of the products of coordinates relative to it, (3, 3)."""
    hull = ConvexHull(points)
    middle = points.mean(axis=0)
    corners = points[hull.simplices] - middle
    volumes = np.abs(np.linalg.det(corners)) / 6
    sums, volume = corners.sum(axis=1), volumes.sum()
    centre = volumes @ sums / (4 * volume)
    outer = np.einsum("ni,nj->nij", sums, sums) + np.einsum("nki,nkj->nij", corners, corners)
    second = np.einsum("n,nij->ij", volumes, outer) / 20 - volume * np.outer(centre, centre)
    return float(volume), middle + centre, second


__all__ = ["GRAVITY", "GROUND", "Builder", "moments_of"]
