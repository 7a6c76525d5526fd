"""Orbital elements of bodies around a heavy one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError, KickdriftError
from kickdrift.engine.solution import Solution

Floats = NDArray[np.float64]

_COORDINATES = ("jacobi", "heliocentric")


@dataclass(frozen=True, eq=False)
class OrbitalElements:
    """Osculating elements of the orbits of bodies; angles are in radians, lengths in the unit of the positions.

    Attributes
    ----------
    t : (T,) array
        Times.
    a : (T, N) array
        Semi-major axes; negative for hyperbolas.
    e : (T, N) array
        Eccentricities.
    i : (T, N) array
        Inclinations to the x-y plane, from 0 to pi.
    Omega : (T, N) array
        Longitudes of the ascending node, from 0 to 2 pi; 0 if there is no node.
    omega : (T, N) array
        Arguments of the pericentre, from 0 to 2 pi; for circular orbits the origin of M.
    M : (T, N) array
        Mean anomalies, from 0 to 2 pi; unbounded for hyperbolas.
    bodies : tuple of str
        Names of the N bodies: all but the first.
    """

    t: Floats
    a: Floats
    e: Floats
    i: Floats
    Omega: Floats
    omega: Floats
    M: Floats
    bodies: tuple[str, ...]


def orbital_elements(solution: Solution, coordinates: str = "jacobi") -> OrbitalElements:
    """Return the orbital elements of all bodies but the first, at the times kept.

    Parameters
    ----------
    solution : Solution
        Of `kickdrift.systems.kepler`, `nbody`, `planetary`, or one of the solar systems, whose first body is the heavy one.
    coordinates : str
        ``"jacobi"``: around the centre of mass of the preceding bodies, with the mass of these and the body; or
        ``"heliocentric"``: around the first body, with the mass of the two.

    Returns
    -------
    OrbitalElements

    Raises
    ------
    ArgumentError
        For other coordinates, or a single body.
    KickdriftError
        For systems without gravitational parameters.

    Notes
    -----
    Murray, Dermott, Solar System Dynamics (1999), section 2.8.

    Examples
    --------
    >>> import numpy as np, kickdrift as kd
    >>> orbit = kd.systems.kepler(eccentricity=0.6)
    >>> sol = kd.solve(orbit, (0.0, 6.0), step=0.01, method="wisdom-holman")
    >>> elements = kd.analysis.orbital_elements(sol)
    >>> bool(np.allclose(elements.e, 0.6)), bool(np.allclose(elements.M[:, 0], sol.t))
    (True, True)
    """
    if coordinates not in _COORDINATES:
        raise ArgumentError(f"coordinates={coordinates!r} must be one of {', '.join(map(repr, _COORDINATES))}.")
    if not isinstance(solution, Solution):
        raise ArgumentError(f"solution={solution!r} is not a solution; give the result of kd.solve(...).")
    solution = solution.plain
    gm = np.array(solution.about.gm)
    if not gm.size:
        raise KickdriftError(
            f"{solution.about.system!r} has no gravitational parameters; use kd.systems.kepler, nbody, planetary or"
            " another system of gravitating bodies."
        )
    x, v = (_in_space(half) for half in (solution.x, solution.v))
    if gm.size == 1 and x.shape[1] == 1 and solution.x.ndim == 2:  # one body around a centre
        return _elements(solution.t, x, v, gm, ("0",))
    if gm.size < 2:
        raise ArgumentError(f"{solution.about.system!r} has only one body, and so no orbit.")
    relative = _relative if coordinates == "jacobi" else _heliocentric
    mu = np.cumsum(gm)[1:] if coordinates == "jacobi" else gm[0] + gm[1:]
    names = tuple(map(str, solution.about.coordinates.get("body", range(gm.size))))[1:]
    return _elements(solution.t, relative(gm, x), relative(gm, v), mu, names)


def _in_space(states: Floats) -> Floats:
    """Return states as (T, N, 3)."""
    bodies = states.reshape(states.shape[0], -1, states.shape[-1])
    return np.pad(bodies, ((0, 0), (0, 0), (0, 3 - bodies.shape[2])))


def _heliocentric(gm: Floats, states: Floats) -> Floats:
    return states[:, 1:] - states[:, :1]


def _relative(gm: Floats, states: Floats) -> Floats:
    """Return positions or velocities relative to the centre of mass of the bodies before."""
    centres = np.cumsum(gm[:, None] * states, axis=1) / np.cumsum(gm)[:, None]
    difference: Floats = states[:, 1:] - centres[:, :-1]
    return difference


def _elements(t: Floats, x: Floats, v: Floats, mu: Floats, bodies: tuple[str, ...]) -> OrbitalElements:
    r, spin = np.linalg.norm(x, axis=2), np.cross(x, v)
    h, outwards = np.linalg.norm(spin, axis=2), (x * v).sum(axis=2)
    with np.errstate(divide="ignore", invalid="ignore"):
        a = 1 / (2 / r - (v * v).sum(axis=2) / mu)
        e_cosine, e_sine = h * h / (mu * r) - 1, h * outwards / (mu * r)
        e, anomaly = np.hypot(e_cosine, e_sine), np.arctan2(e_sine, e_cosine)
        flat = np.hypot(spin[..., 0], spin[..., 1])
        node = np.where(flat > 0.0, np.arctan2(spin[..., 0], -spin[..., 1]), 0.0)
        ascending = np.stack([np.cos(node), np.sin(node), np.zeros_like(node)], axis=-1)
        across = np.cross(spin, ascending) / h[..., None]
        latitude = np.arctan2((x * across).sum(axis=2), (x * ascending).sum(axis=2))
        mean = np.where(a > 0, _of_ellipse(r, a, outwards, mu), _of_hyperbola(r, a, outwards, mu))
    turn = 2 * np.pi
    inclination = np.arctan2(flat, spin[..., 2])
    return OrbitalElements(t, a, e, inclination, node % turn, (latitude - anomaly) % turn, mean, bodies)


def _of_ellipse(r: Floats, a: Floats, outwards: Floats, mu: Floats) -> Floats:
    sine = outwards / np.sqrt(mu * a)
    mean: Floats = (np.arctan2(sine, 1 - r / a) - sine) % (2 * np.pi)
    return mean


def _of_hyperbola(r: Floats, a: Floats, outwards: Floats, mu: Floats) -> Floats:
    sine = outwards / np.sqrt(-mu * a)
    mean: Floats = sine - np.arctanh(sine / (1 - r / a))
    return mean
