"""In how many parts a substep of a cloth is done, and how stiff it can be in them."""

import math

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.cloth import layout as c

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

MOST_PARTS = 64  # of a substep; where a cloth is so stiff that it would take more, it is made softer
# With the angle w that a vibration turns by in a part, and damping d, kick and drift are stable for w^2 (1 + 2 d / part) < 4.
# The highest of membrane and bending may be one vibration, so that theirs are added. What is stretched is stiffer against
# shear, so that some is left.
_STABLE, _DAMPED = 1.6**2, 1.8**2
_NAMES = "stretch_stiffness", "shear_stiffness", "bending_stiffness", "damping of the membrane", "damping of bending"
_UNITS = "N/m", "N/m", "N m", "s", "s"


def tune(own: Integers, numbers: Floats, substep: float) -> None:
    """Choose parts of a substep for a cloth, and make it softer where they would be too many."""
    stretch, shear, bending, damping, _ = numbers[c.ASKED : c.ASKED + 5].tolist()
    rates = numbers[[c.MEMBRANE_RATE, c.BENDING_RATE]]
    fastest = substep * math.sqrt(float(rates @ rates) / _STABLE)
    parts = min(max(math.ceil(fastest), 1), MOST_PARTS)
    part = substep / parts
    squares = (rates * part) ** 2
    softer, limber = _granted(squares, _STABLE).tolist()
    squares *= softer, limber
    own[c.PARTS] = parts
    numbers[[c.STRETCH, c.SHEAR, c.BENDING]] = softer * stretch, softer * shear, limber * bending
    spare = _granted(2.0 * squares * damping / part, _DAMPED - float(squares.sum()))
    numbers[[c.MEMBRANE_DAMPING, c.BENDING_DAMPING]] = spare * damping


def _granted(wanted: Floats, limit: float) -> Floats:
    """Return how much two get of what they want, as a part of it: half of the limit at least, and what the other leaves."""
    first = min(wanted[0], max(0.5 * limit, limit - wanted[1]))
    given = np.array([first, min(wanted[1], limit - first)])
    granted: Floats = np.divide(given, wanted, where=wanted > 0.0, out=np.ones(2))
    return granted


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
