"""In how many parts a substep of a cloth is done, and how stiff it can be in them."""

import math

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.cloth import layout as c

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

MOST_PARTS = 64  # of a substep; where a cloth is so stiff that it would take more, it is made softer
# Kick and drift are stable up to 2 for the angle that a vibration turns by in a part, a = (rate part)^2 its square; damped ones
# for sqrt(a (1 + 2 damping / part)). What is stretched is stiffer against shear, so that some is left.
_STABLE, _DAMPED = 1.6, 1.8
_NAMES = "stretch_stiffness", "shear_stiffness", "bending_stiffness", "damping of the membrane", "damping of bending"
_UNITS = "N/m", "N/m", "N m", "s", "s"


def tune(own: Integers, numbers: Floats, substep: float) -> None:
    """Choose parts of a substep for a cloth, and make it softer where they would be too many."""
    stretch, shear, bending, damping, _ = numbers[c.ASKED : c.ASKED + 5].tolist()
    membrane, rate = numbers[[c.MEMBRANE_RATE, c.BENDING_RATE]].tolist()
    parts = min(max(math.ceil(substep * max(membrane, rate) / _STABLE), 1), MOST_PARTS)
    part = substep / parts
    softer, limber = (
        min(1.0, _STABLE / (part * fastest)) ** 2 if fastest > 0.0 else 1.0 for fastest in (membrane, rate)
    )
    rate *= math.sqrt(limber)
    own[c.PARTS] = parts
    numbers[[c.STRETCH, c.SHEAR, c.BENDING]] = softer * stretch, softer * shear, limber * bending
    numbers[c.MEMBRANE_DAMPING] = min(damping, _most_damping(math.sqrt(softer) * membrane, part))
    numbers[c.BENDING_DAMPING] = min(damping, _most_damping(rate, part))


def _most_damping(rate: float, part: float) -> float:
    """Return the largest damping, s, for which sqrt(a (1 + 2 damping / part)) is `_DAMPED`, with a = (rate part)^2."""
    return max(0.5 * ((_DAMPED / rate) ** 2 / part - part), 0.0) if rate > 0.0 else math.inf


def softness(words: str, numbers: Floats) -> str:
    """Say of a cloth, if it is softer or less damped than was asked, what it is, and what would help."""
    asked, used = numbers[c.ASKED : c.ASKED + 5].tolist(), numbers[c.STRETCH : c.STRETCH + 5].tolist()
    found = [
        f"{name} {now:.3g} of {wanted:.3g} {unit}"
        for name, unit, wanted, now in zip(_NAMES, _UNITS, asked, used, strict=True)
        if now < wanted
    ]
    if not found:
        return ""
    return f" Of {words}, as much as the step allows: {', '.join(found)}; more substeps or larger triangles allow more."
