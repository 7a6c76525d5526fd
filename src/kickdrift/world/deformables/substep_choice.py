"""Choice of the number of parts of a substep of a cloth, and of the stiffness that is stable in them."""

import math

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.deformables import layout as c

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

MOST_PARTS = 64  # of a substep; a cloth that would need more is made softer
# With the phase w of a vibration per part, and damping d, kick and drift are stable for w^2 (1 + 2 d / part) < 4. The highest
# modes of membrane and bending may coincide, so their squares are added. A margin is left, since stretched cloth is stiffer in
# shear.
_STABLE, _DAMPED = 1.6**2, 1.8**2
_FAR_SOFTER = 0.5  # of the stiffness asked for: below, a warning says so
_DAMPINGS = ("damping of the membrane", "s"), ("damping of bending", "s")
_NAMES = {
    c.ROPE: (
        ("stretch_stiffness", "N"),
        ("", ""),
        ("bending_stiffness", "N m^2"),
        ("damping of strain", "s"),
        _DAMPINGS[1],
    ),
    c.SHEET: (("stretch_stiffness", "N/m"), ("shear_stiffness", "N/m"), ("bending_stiffness", "N m"), *_DAMPINGS),
    c.VOLUME: (("young_modulus", "Pa"), ("", ""), ("", ""), ("damping", "s"), ("", "")),
}  # with units, in the order of `ASKED`
WORDS = {c.ROPE: "rope", c.SHEET: "cloth", c.VOLUME: "soft body"}
_LARGER = {c.ROPE: "longer segments", c.SHEET: "larger triangles", c.VOLUME: "larger tetrahedra"}


def tune(own: Integers, numbers: Floats, substep: float) -> None:
    """Choose the number of parts of a substep, s, for a cloth, and soften it if they would be too many."""
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
    """Divide a limit between two demands: return the fraction of each that is granted, (2,).

    Each gets at least half of the limit, if it needs as much, and whatever the other leaves.
    """
    first = min(wanted[0], max(0.5 * limit, limit - wanted[1]))
    given = np.array([first, min(wanted[1], limit - first)])
    granted: Floats = np.divide(given, wanted, where=wanted > 0.0, out=np.ones(2))
    return granted


def is_far_softer(numbers: Floats) -> bool:
    """Whether a stiffness in use is less than half of that of the material."""
    asked, used = numbers[c.ASKED : c.ASKED + 3], numbers[c.STRETCH : c.STRETCH + 3]
    return bool(np.any(used < _FAR_SOFTER * asked))


def softness(words: str, dimension: int, numbers: Floats) -> str:
    """Return a note on what is softer or less damped than its material, with what would help, or an empty string."""
    asked, used = numbers[c.ASKED : c.ASKED + 5].tolist(), numbers[c.STRETCH : c.STRETCH + 5].tolist()
    found = [
        f"{name} {now:.3g} of {wanted:.3g} {unit}"
        for (name, unit), wanted, now in zip(_NAMES[dimension], asked, used, strict=True)
        if f"{now:.3g}" != f"{wanted:.3g}"
    ]
    if not found:
        return ""
    stretches = used[0] < asked[0] and dimension != c.VOLUME and not numbers[c.TETHER_STRAIN]
    tethers = ", and tether_strain bounds the stretch" if stretches else ""
    more = f"more substeps or {_LARGER[dimension]} allow more{tethers}"
    return f" Of {words}, as much as the step allows: {', '.join(found)}; {more}."
