"""Colours that pictures and the viewer share."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# Okabe, Ito, Color Universal Design (2008), in an order in which neighbours differ in lightness too; without yellow,
# which is too light for a line.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000")
FIXED, RODS = (0.72, 0.74, 0.76), (0.35, 0.37, 0.4)  # bodies that forces do not move, and joints
SUM = "#c9ccd1"  # of energies
_LIGHTER = 0.3  # of white in the colours of bodies


def colour_of(body: int) -> Floats:
    """Choose the colour of a body: red, green and blue from 0 to 1."""
    code = COLOURS[body % (len(COLOURS) - 1)]
    pure = np.array([int(code[k : k + 2], 16) / 255.0 for k in (1, 3, 5)])
    return pure + _LIGHTER * (1.0 - pure)
