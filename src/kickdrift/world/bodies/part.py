"""A part of a compound body."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from numpy.typing import ArrayLike

from kickdrift.core.errors import ArgumentError
from kickdrift.world.argument_checks import number, unit_quaternion, vector
from kickdrift.world.bodies.shape_rows import Surface
from kickdrift.world.shapes.record import Shape
from kickdrift.world.shapes.shape_kinds import kind_of


class Part:
    """A shape with its pose in a compound body.

    Parameters
    ----------
    shape : Shape
        Such as `kickdrift.Sphere`, `kickdrift.Box` or `kickdrift.Hull`.
    position : (3,) array_like
        Origin of the shape's frame in the body, m.
    orientation : (4,) array_like
        Quaternion (w, x, y, z) that turns the shape's axes into the body's.
    density : float, optional
        kg/m^3; the body's by default.
    **surface
        The surface options of `World.add_body` in which it differs from the body, such as `friction`.

    Raises
    ------
    ArgumentError
        For anything but a shape, and for an invalid pose, density or surface.

    Examples
    --------
    >>> import kickdrift as kd
    >>> world = kd.World()
    >>> handle = kd.Part(kd.Box((0.04, 0.04, 0.4)))
    >>> head = kd.Part(kd.Box((0.2, 0.06, 0.06)), position=(0, 0, 0.2), density=7800.0)
    >>> hammer = world.add_body([handle, head])
    >>> round(hammer.mass, 3)
    6.256
    """

    def __init__(
        self,
        shape: Shape,
        position: ArrayLike = (0.0, 0.0, 0.0),
        orientation: ArrayLike = (1.0, 0.0, 0.0, 0.0),
        density: float | None = None,
        **surface: Any,
    ) -> None:
        kind_of(shape)
        self.shape = shape
        self.position = vector("position", position, 3)
        self.orientation = unit_quaternion("orientation", orientation)
        self.position.flags.writeable = self.orientation.flags.writeable = False  # worlds share them
        self.density = None if density is None else number("density", density, "kg/m^3", zero=False)
        surface_of(surface)
        self.surface = surface


def surface_of(options: Mapping[str, Any]) -> Surface:
    """Return a surface with these options.

    Raises
    ------
    ArgumentError
        For unknown options, and for invalid values.
    """
    unknown = set(options) - {field.name for field in fields(Surface)}
    if unknown:
        raise ArgumentError(
            f"{sorted(unknown)[0]}= is not an option of a body; help(kickdrift.World.add_body) lists them."
        )
    return Surface(**options)
