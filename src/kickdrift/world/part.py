"""Parts of bodies: shapes with a place and a surface, and what they weigh together."""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from numpy.typing import ArrayLike

from kickdrift.core.errors import ArgumentError
from kickdrift.world.arguments import number, unit_quaternion, vector
from kickdrift.world.shape_rows import Shape, Surface
from kickdrift.world.shapes.mass import Mass, checked_inertia, combined, placed


class Part:
    """A shape with a place in a compound body.

    Parameters
    ----------
    shape : Shape
        One of `kickdrift.world.shapes`.
    position : (3,) array_like
        Origin of the shape's frame in the body, m.
    orientation : (4,) array_like
        Quaternion (w, x, y, z) that turns the shape's axes into the body's.
    density : float, optional
        kg/m^3; the body's by default.
    **surface
        Those of `friction`, `restitution` and the like in which its surface differs from the body's.
    """

    def __init__(
        self,
        shape: Shape,
        position: ArrayLike = (0.0, 0.0, 0.0),
        orientation: ArrayLike = (1.0, 0.0, 0.0, 0.0),
        density: float | None = None,
        **surface: Any,
    ) -> None:
        if not hasattr(shape, "mass_properties"):
            raise ArgumentError(
                f"shape={shape!r} is no shape; give one of kickdrift.world.shapes, such as Box((1, 1, 1))."
            )
        self.shape = shape
        self.position = vector("position", position, 3)
        self.orientation = unit_quaternion("orientation", orientation)
        self.density = density
        surface_of(surface)
        self.surface = surface


def surface_of(options: Mapping[str, Any]) -> Surface:
    """Return a surface with these options.

    Raises
    ------
    ArgumentError
        For options that there are not, and for values that they cannot have.
    """
    unknown = set(options) - {field.name for field in fields(Surface)}
    if unknown:
        raise ArgumentError(f"{sorted(unknown)[0]}= is not known; see the options of World.add_body.")
    return Surface(**options)


def weigh(
    parts: list[Part], density: float | None, mass: float | None, inertia: ArrayLike | None, centre: ArrayLike | None
) -> Mass:
    """Weigh a body of parts, as `World.add_body` is asked to; ArgumentError for what contradicts itself."""
    if density is not None and mass is not None:
        raise ArgumentError(f"density={density!r} and mass={mass!r} say the same twice; give one of them.")
    common = 1000.0 if density is None else density
    whole = combined(
        [
            placed(
                p.shape.mass_properties(), p.position, p.orientation, density=common if p.density is None else p.density
            )
            for p in parts
        ]
    )
    if mass is not None:
        total = number("mass", mass, "kg; static=True is for what nothing moves", zero=False)
        whole = Mass(total, whole.centre, whole.inertia * (total / whole.mass))
    if centre is not None and inertia is None:
        raise ArgumentError(
            f"centre={centre!r} has no inertia about it; give inertia= as well, (3,) or (3, 3), in kg m^2."
        )
    if inertia is not None:
        middle = whole.centre if centre is None else vector("centre", centre, 3)
        whole = Mass(whole.mass, middle, checked_inertia(inertia))
    return whole
