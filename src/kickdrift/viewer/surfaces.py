"""Triangles of shapes for the browser: of one size for all shapes of a kind, where possible."""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.shapes import kind_numbers

Floats = NDArray[np.float64]
Faces = NDArray[np.int64]
_AROUND = 24  # corners of what is round; a multiple of four, so that octants of balls end at edges
_UNIT = np.ones(3)


class Surface(NamedTuple):
    """Triangles of a shape in its own frame.

    Attributes
    ----------
    vertices : (V, 3) array
        Before they are scaled: alike for all boxes, balls, cylinders and cones.
    faces : (F, 3) array of int
        Counter-clockwise seen from outside.
    scale : (3,) array
        Along the axes.
    flat : bool
        Whether faces are lit one by one.
    """

    vertices: Floats
    faces: Faces
    scale: Floats
    flat: bool = False


def surface_of(shape: Any) -> Surface:
    """Return the triangles of a shape that is not a plane."""
    return SURFACES[shape.kind](shape)


def halves_of_ball(surface: Surface) -> tuple[Surface, Surface]:
    """Cut a ball into octants, every other one of which has another colour: they show how it turns."""
    middles = surface.vertices[surface.faces].mean(axis=1)
    dark = np.prod(middles, axis=1) > 0.0
    return surface._replace(faces=surface.faces[dark]), surface._replace(faces=surface.faces[~dark])


def _box(shape: Any) -> Surface:
    corners = np.array([[k & 1, k >> 1 & 1, k >> 2 & 1] for k in range(8)]) * 2.0 - 1.0
    loops = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
    return Surface(corners, _fans(loops), 0.5 * np.array(shape.size), flat=True)


def _sphere(shape: Any) -> Surface:
    height = np.linspace(-0.5 * np.pi, 0.5 * np.pi, _AROUND // 2 + 1)
    arc = np.column_stack((np.cos(height), np.sin(height)))
    return _revolved([arc], np.full(3, shape.radius))


def _capsule(shape: Any) -> Surface:
    height = np.linspace(-0.5 * np.pi, 0.5 * np.pi, _AROUND // 2 + 2)
    half = 0.5 * shape.length / shape.radius
    arc = np.column_stack((np.cos(height), np.sin(height) + half * np.sign(height)))
    return _revolved([arc], np.full(3, shape.radius))


def _cylinder(shape: Any) -> Surface:
    corners = np.array([(0.0, -1.0), (1.0, -1.0), (1.0, 1.0), (0.0, 1.0)])
    return _revolved([corners[k : k + 2] for k in range(3)], np.array([shape.radius, shape.radius, 0.5 * shape.length]))


def _cone(shape: Any) -> Surface:
    corners = np.array([(0.0, -1.0), (1.0, -1.0), (0.0, 1.0)])
    return _revolved([corners[k : k + 2] for k in range(2)], np.array([shape.radius, shape.radius, 0.5 * shape.length]))


def _hull(shape: Any) -> Surface:
    return Surface(shape.vertices, _fans(shape.faces), _UNIT, flat=True)


def _mesh(shape: Any) -> Surface:
    return Surface(shape.vertices, shape.faces, _UNIT, flat=True)


def _fans(loops: Any) -> Faces:
    """Cut convex polygons into triangles about their first corners."""
    return np.array([(loop[0], loop[k], loop[k + 1]) for loop in loops for k in range(1, len(loop) - 1)])


def _revolved(profiles: list[Floats], scale: Floats) -> Surface:
    """Turn lines of radii and heights, from below upwards, about the z axis; where two of them meet is an edge."""
    angle = 2.0 * np.pi * np.arange(_AROUND) / _AROUND
    vertices, faces, first = [], [], 0
    for profile in profiles:
        radius, height = profile[:, :1], np.broadcast_to(profile[:, 1:], (len(profile), _AROUND))
        vertices.append(np.stack((radius * np.cos(angle), radius * np.sin(angle), height), axis=2).reshape(-1, 3))
        number = first + np.arange(len(profile) * _AROUND).reshape(-1, _AROUND)
        beside = np.roll(number, -1, axis=1)
        for triangles, pole in (
            ((number[:-1], beside[:-1], beside[1:]), radius[:-1]),
            ((number[:-1], beside[1:], number[1:]), radius[1:]),
        ):
            wide = pole[:, 0] > 1e-9  # at a pole one of the two triangles is a line
            faces.append(np.stack(triangles, axis=2)[wide].reshape(-1, 3))
        first += number.size
    return Surface(np.concatenate(vertices), np.concatenate(faces), scale)


SURFACES: Mapping[int, Callable[[Any], Surface]] = MappingProxyType(
    {
        kind_numbers.SPHERE: _sphere,
        kind_numbers.CAPSULE: _capsule,
        kind_numbers.BOX: _box,
        kind_numbers.HULL: _hull,
        kind_numbers.MESH: _mesh,
        kind_numbers.HEIGHT_FIELD: lambda shape: _mesh(shape.mesh),
        kind_numbers.CYLINDER: _cylinder,
        kind_numbers.CONE: _cone,
    }
)
