"""Softness of contacts: the damped spring by which they push bodies apart that overlap."""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector
from kickdrift.world.settings import CONTACT_DAMPING, CONTACT_HERTZ, STEP, SUBSTEPS
from kickdrift.world.tables import SETTINGS, floats

# Default frequency of the contact spring of movable bodies, times the substep. A pyramid of twenty rows sways from 0.2 on, and
# stands with 0.15.
STIFFEST = 0.15


@compiled
def softness(world: int, fixed: bool) -> Vector:
    """Return bias rate, 1/s, mass scale and impulse scale of a damped spring, integrated implicitly, for any masses.

    Against immovable bodies it has twice the frequency, thus four times the stiffness, and half the damping ratio.
    """
    settings = floats(world, SETTINGS)
    h, damping = settings[0, STEP] / settings[0, SUBSTEPS], settings[0, CONTACT_DAMPING]
    hertz = settings[0, CONTACT_HERTZ] if settings[0, CONTACT_HERTZ] > 0.0 else STIFFEST / h
    if fixed:
        hertz, damping = 2.0 * hertz, 0.5 * damping
    rate = 2.0 * math.pi * hertz
    a1 = 2.0 * damping + h * rate
    a2 = h * rate * a1
    a3 = 1.0 / (1.0 + a2)
    return rate / a1, a2 * a3, a3
