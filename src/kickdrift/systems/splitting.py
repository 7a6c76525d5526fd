"""The common part of the splittings of planetary systems: the end of the params, and the record of a splitting.

After G, softening^2 = 0 and Gm_0 to Gm_(N-1) come, N numbers each: 0 and Gm_1 to Gm_(N-1), which is what `gravity`
wants for the planets alone; the weights of the bodies in a sum over masses, 0 for the first; and mu of the Kepler
problems, 0 for the first, which is the free motion of the centre of mass.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import Function, compiled
from kickdrift.systems.system import Frame

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Splitting:
    """Coordinates in which N bodies are N - 1 Kepler problems and little else.

    Attributes
    ----------
    weights, mu : callable
        From the array of Gm: the numbers of the params above.
    frame : callable
        From the array of Gm: the change of coordinates.
    remainder : callable
        From the array of Gm: the function that writes what the Kepler problems leave of the acceleration.
    parts : mapping of str to callable
        Other parts of the system.
    """

    weights: Callable[[Floats], Floats]
    mu: Callable[[Floats], Floats]
    frame: Callable[[Floats], Frame]
    remainder: Callable[[Floats], Function]
    parts: Mapping[str, Function]

    def params(self, gm: Floats) -> Floats:
        """Return the end of the params."""
        return np.concatenate([[0.0], gm[1:], self.weights(gm), self.mu(gm)])


@compiled(cached=False, inline=True)
def planets(n: int, params: Floats) -> Floats:
    """Return 0 and Gm of each planet, for n numbers in a state."""
    return params[params.size - n : params.size - n + n // 3]


@compiled(cached=False, inline=True)
def weights(n: int, params: Floats) -> Floats:
    """Return the weights of the bodies, for n numbers in a state."""
    return params[params.size - n + n // 3 : params.size - n // 3]


@compiled(cached=False, inline=True)
def mus(n: int, params: Floats) -> Floats:
    """Return mu of the Kepler problems, for n numbers in a state."""
    return params[params.size - n // 3 :]
