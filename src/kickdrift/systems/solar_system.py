"""The solar system: Sun, Moon and planets from JPL's states."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError, unknown_name
from kickdrift.systems.nbody import nbody
from kickdrift.systems.planetary import planetary
from kickdrift.systems.system import System

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Ephemeris:
    """Barycentric states of the bodies at a few epochs.

    Attributes
    ----------
    bodies : tuple of str
        Names.
    gm : (N,) array
        Gravitational parameters, au^3/day^2.
    epochs : (E,) array
        Julian dates (TDB); the first is J2000.
    x, v : (E, N, 3) array
        Positions (au) and velocities (au/day), equatorial axes of the ICRF.
    au_km : float
        Kilometres in the astronomical unit of the ephemeris.
    source : str
        The ephemeris.
    """

    bodies: tuple[str, ...]
    gm: Floats
    epochs: Floats
    x: Floats
    v: Floats
    au_km: float
    source: str


@cache
def ephemeris() -> Ephemeris:
    """Read the packaged states of JPL's DE421: J2000 and six epochs up to ten years later.

    Returns
    -------
    Ephemeris
        Names, gravitational parameters, epochs, positions and velocities.

    Examples
    --------
    >>> import kickdrift as kd
    >>> kd.systems.ephemeris().bodies[:4], kd.systems.ephemeris().x.shape
    (('Sun', 'Mercury', 'Venus', 'Earth'), (7, 11, 3))
    """
    data = json.loads(files("kickdrift.systems").joinpath("data/de421.json").read_text())
    epochs = sorted(data["states"], key=float)
    states = np.array([data["states"][epoch] for epoch in epochs])
    return Ephemeris(
        bodies=tuple(name.removesuffix("_bc") for name in data["names"]),
        gm=np.array(data["GM"]),
        epochs=np.array([float(epoch) for epoch in epochs]),
        x=states[:, :, :3],
        v=states[:, :, 3:],
        au_km=data["AU_km"],
        source="JPL DE421: Folkner, Williams, Boggs, IPN Progress Report 42-178 (2009)",
    )


def solar_system(bodies: Sequence[str] | None = None, splitting: str | None = None) -> System:
    """Create the solar system at J2000 (Julian date 2451545.0 TDB), in au and days; the state has shape (N, 3).

    Point masses under Newtonian gravity, barycentric, on the equatorial axes of the ICRF. Planets from Mars outwards
    represent the barycentre of the planet and its moons.

    Parameters
    ----------
    bodies : sequence of str, optional
        Which bodies: Sun, Mercury, Venus, Earth, Moon, Mars, Jupiter, Saturn, Uranus, Neptune, Pluto; all by default. Case
        does not matter. With the Earth but without the Moon, the Earth represents the barycentre of both.
    splitting : str, optional
        As for `planetary`, which then creates the system: list the Sun first, and leave out the Moon, whose orbit around the
        Sun is strongly perturbed by the Earth.

    Returns
    -------
    System

    Raises
    ------
    ArgumentError
        For an unknown body, one named twice, or an empty list.
    UnknownNameError
        For an unknown splitting.

    Examples
    --------
    >>> import kickdrift as kd
    >>> planets = kd.systems.solar_system(["Sun", "Earth", "Jupiter"])
    >>> sol = kd.solve(planets, (0.0, 365.25), step=1.0, method="blanes-moan-srkn6b")
    >>> bool(abs(sol.energy / sol.energy[0] - 1).max() < 1e-9)
    True
    """
    sky = ephemeris()
    chosen = _choose(bodies, sky.bodies)
    gm, x, v = sky.gm[chosen], sky.x[0, chosen], sky.v[0, chosen]
    names = [sky.bodies[i] for i in chosen]
    if "Earth" in names and "Moon" not in names:
        earth = names.index("Earth")
        pair = [sky.bodies.index("Earth"), sky.bodies.index("Moon")]
        share = sky.gm[pair] / sky.gm[pair].sum()
        gm[earth], x[earth], v[earth] = sky.gm[pair].sum(), share @ sky.x[0, pair], share @ sky.v[0, pair]
    system = (
        nbody(masses=gm, x0=x, v0=v, G=1.0, names=names)
        if splitting is None
        else planetary(masses=gm, x0=x, v0=v, G=1.0, splitting=splitting, names=names)
    )
    units = {"energy": "au^5/day^4", "momentum": "au^4/day^3", "angular momentum": "au^5/day^3"}
    return replace(
        system,
        name="solar-system",
        quantities={name: replace(quantity, unit=units[name]) for name, quantity in system.quantities.items()},
        units={"t": "day", "x": "au", "v": "au/day"},
        source=sky.source,
    )


def _choose(bodies: Sequence[str] | None, known: tuple[str, ...]) -> list[int]:
    if bodies is None:
        return list(range(len(known)))
    if isinstance(bodies, str) or not bodies:
        raise ArgumentError(f"bodies={bodies!r} must be a list of at least one name, such as ['Sun', 'Earth'].")
    indices = []
    for name in bodies:
        capital = str(name).strip().capitalize()
        if capital not in known:
            raise unknown_name("bodies", name, known)
        if known.index(capital) in indices:
            raise ArgumentError(f"bodies contains {capital!r} twice; name each body once.")
        indices.append(known.index(capital))
    return indices
