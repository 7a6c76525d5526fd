"""Mass properties of bodies: from their parts, or as the user gives them."""

from __future__ import annotations

from collections.abc import Sequence

from numpy.typing import ArrayLike

from kickdrift.core.errors import ArgumentError
from kickdrift.world.argument_checks import number, vector
from kickdrift.world.bodies.part import Part
from kickdrift.world.shapes.mass_properties import Mass, checked_inertia, combined, placed
from kickdrift.world.shapes.record import SOLID
from kickdrift.world.shapes.shape_kinds import kind_of

_LIGHTEST = 1e-200  # kg


def mass_properties_of(
    parts: Sequence[Part],
    density: float | None,
    mass: float | None,
    inertia: ArrayLike | None,
    centre: ArrayLike | None,
) -> Mass:
    """Return mass, centre of mass and inertia of a body, from its parts and the arguments of `World.add_body`."""
    if density is not None and mass is not None:
        raise ArgumentError(f"density={density!r} and mass={mass!r} both determine the mass; give one of them.")
    for part in parts:
        if kind_of(part.shape).sort != SOLID:
            raise ArgumentError(
                f"{type(part.shape).__name__} cannot move: it has no interior; add it with static=True."
            )
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
        total = number("mass", mass, "kg; use static=True for immovable bodies", zero=False)
        whole = Mass(total, whole.centre, whole.inertia * (total / whole.mass))
    if centre is not None and inertia is None:
        raise ArgumentError(
            f"centre={centre!r} is given without inertia; give inertia= as well, (3,) or (3, 3), in kg m^2."
        )
    if inertia is not None:
        middle = whole.centre if centre is None else vector("centre", centre, 3)
        whole = Mass(whole.mass, middle, checked_inertia(inertia))
    check_mass(whole.mass)
    return whole


def check_mass(mass: float) -> None:
    """Raise an ArgumentError for a mass whose inverse, and that of its inertia, would be infinite."""
    if mass < _LIGHTEST:
        raise ArgumentError(
            f"a mass of {mass:g} kg is too small for its inverse to be finite; give {_LIGHTEST:g} kg or more."
        )
