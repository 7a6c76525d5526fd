"""Gusts: a turbulent wind, the same for the same seed."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.arguments import is_whole
from kickdrift.core.compilation import Function, compiled
from kickdrift.core.errors import ArgumentError
from kickdrift.core.random import fill_normal
from kickdrift.world.argument_checks import number
from kickdrift.world.deformables.wind_functions import air_velocity

Floats = NDArray[np.float64]

_SHELLS, _FINE = 12, 20  # of wave numbers, with three waves each; parts of a shell, over which its energy is summed
_LEAST, _MOST = 0.1, 400.0  # wave numbers times the length: beyond them are 3 % of the energy
_SCALE = math.gamma(1 / 3) / (
    math.sqrt(math.pi) * math.gamma(5 / 6)
)  # 1.339: integral of the correlation is the length
_C = tuple(
    (-1) ** k * math.tau ** (2 * k) / math.factorial(2 * k) for k in range(11)
)  # of the cosine of turns, to 1e-10


def gusts(mean: ArrayLike, intensity: float = 0.2, length: float = 5.0, seed: int = 0) -> Function:
    """Create a gusty wind for `World.add_wind`: a mean wind that carries turbulence along.

    The turbulence is a sum of transverse waves, so that the velocity field has no divergence (Kraichnan, Diffusion by a random
    velocity field, Phys. Fluids 13 (1970) 22), with von Karman's spectrum, which falls as the wave number to the power of
    -5/3. The waves move with the mean wind and evolve in time (Fung et al., Kinematic simulation of homogeneous turbulence by
    unsteady random Fourier modes, J. Fluid Mech. 236 (1992) 281).

    Parameters
    ----------
    mean : (3,) array_like
        Velocity of the mean wind, m/s.
    intensity : float
        Root mean square of the fluctuation of each component, divided by the mean speed: 0.1 over the sea, 0.3 among houses.
    length : float
        Integral length scale of the turbulence along the wind, m.
    seed : int
        At least 0; each seed yields another wind.

    Returns
    -------
    callable
        A function of `t`, `position` and `wind`.

    Raises
    ------
    ArgumentError
        For numbers that are not finite, a negative intensity or seed, or a length that is not positive.

    Examples
    --------
    >>> import kickdrift as kd
    >>> world = kd.World()
    >>> flag = world.add_cloth_grid(
    ...     size=(1.2, 0.7), vertices=(12, 8), position=(0.6, 0, 2), drag=1.0, lift=1.0
    ... )
    >>> flag.pin(range(8))
    >>> world.add_wind(kd.gusts(mean=(8, 0, 0), intensity=0.3, seed=1))
    >>> world.advance(1 / 60, 60)
    >>> bool(abs(flag.velocity).max() < 30.0)
    True
    """
    flow = air_velocity("mean", mean)
    strength = number("intensity", intensity, "1") * float(np.linalg.norm(flow))
    waves = _waves(flow, strength, number("length", length, "m", zero=False), _checked_seed(seed))

    def blow(t, position, wind):  # type: ignore[no-untyped-def]
        for i in range(len(wind)):
            for k in range(3):
                wind[i, k] += flow[k]
        add_waves(t, waves, position, wind)

    return blow


@compiled(fast=True)
def add_waves(t: float, waves: Floats, position: Floats, wind: Floats) -> None:
    """Add the velocities of waves, one a column; with a cosine of its own, which the compiler vectorises, ten times as fast."""
    for i in range(len(wind)):
        x, y, z = position[i, 0], position[i, 1], position[i, 2]
        u, v, w = 0.0, 0.0, 0.0
        for k in range(waves.shape[1]):
            turn = waves[0, k] * x + waves[1, k] * y + waves[2, k] * z + waves[3, k] * t + waves[4, k]
            turn -= np.floor(turn + 0.5)
            s = turn * turn
            value = _C[6] + s * (_C[7] + s * (_C[8] + s * (_C[9] + s * _C[10])))
            value = _C[0] + s * (_C[1] + s * (_C[2] + s * (_C[3] + s * (_C[4] + s * (_C[5] + s * value)))))
            u += waves[5, k] * value
            v += waves[6, k] * value
            w += waves[7, k] * value
        wind[i, 0] += u
        wind[i, 1] += v
        wind[i, 2] += w


def _waves(flow: Floats, strength: float, length: float, seed: int) -> Floats:
    """Return a column for each wave: its vector, 1/m, rate, 1/s, and phase, in turns, and its amplitude, (3,), m/s.

    The three of a shell have a wave number that is drawn from it, and run along the axes of a frame that is turned at random.
    Each of them moves the air along the next axis, so that all components have the same strength.
    """
    edges = np.geomspace(_LEAST, _MOST, _SHELLS * _FINE + 1)
    spectrum = edges**5 / (1.0 + edges**2) ** (17.0 / 6.0)  # over the logarithm of the wave number
    energy = (0.5 * (spectrum[1:] + spectrum[:-1])).reshape(_SHELLS, _FINE).sum(axis=1)
    sizes = strength * np.sqrt(2.0 * energy / energy.sum())
    rows = np.empty((3 * _SHELLS, 8))
    for shell in range(_SHELLS):
        drawn = np.empty(20)
        fill_normal(np.uint64(seed), np.uint64(shell), drawn)
        axes, _ = np.linalg.qr(drawn[:9].reshape(3, 3))
        place = shell + 0.5 + np.arctan2(drawn[18], drawn[19]) / math.tau
        vectors = axes.T * _LEAST * (_MOST / _LEAST) ** (place / _SHELLS) / (_SCALE * length * math.tau)
        own = rows[3 * shell : 3 * shell + 3]
        own[:, :3], own[:, 5:] = vectors, sizes[shell] * np.roll(axes.T, -1, axis=0)
        own[:, 3] = -vectors @ flow + strength * np.linalg.norm(vectors, axis=1) * drawn[9:12]
        own[:, 4] = np.arctan2(drawn[12:15], drawn[15:18]) / math.tau
    return np.ascontiguousarray(rows.T)


def _checked_seed(seed: int) -> int:
    if not is_whole(seed, 0, 2**64 - 1):
        raise ArgumentError(f"seed={seed!r} must be a whole number from 0 to 2**64 - 1.")
    return int(seed)
