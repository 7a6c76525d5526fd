"""The five bodies of the Benchmarks Game: Sun and outer planets, in au and years of 365.24 days."""

import math
from dataclasses import replace

import numpy as np

from kickdrift.systems.nbody import nbody
from kickdrift.systems.system import System

_DAYS = 365.24
# Mass (Sun = 1), position (au), velocity (au/day).
_PLANETS = {
    "Jupiter": (
        9.54791938424326609e-04,
        (4.84143144246472090e00, -1.16032004402742839e00, -1.03622044471123109e-01),
        (1.66007664274403694e-03, 7.69901118419740425e-03, -6.90460016972063023e-05),
    ),
    "Saturn": (
        2.85885980666130812e-04,
        (8.34336671824457987e00, 4.12479856412430479e00, -4.03523417114321381e-01),
        (-2.76742510726411899e-03, 4.99852801234917238e-03, 2.30417297573763929e-05),
    ),
    "Uranus": (
        4.36624404335156298e-05,
        (1.28943695621391310e01, -1.51111514016986312e01, -2.23307578892655734e-01),
        (2.96460137564761618e-03, 2.37847173959480950e-03, -2.96589568540237556e-05),
    ),
    "Neptune": (
        5.15138902046611451e-05,
        (1.53796971148509165e01, -2.59193146099879641e01, 1.79258772950371181e-01),
        (2.68067772490389322e-03, 1.62824170038242295e-03, -9.51592254519715870e-05),
    ),
}


def benchmarks_game() -> System:
    """Create the n-body problem of the Benchmarks Game; the state has shape (5, 3).

    Lengths are in au, times in years of 365.24 days, and masses are multiplied by the gravitational constant, so that the
    Sun's is 4 pi^2 au^3/year^2. The Sun moves so that the total momentum is zero. With the default method and a step of 0.01
    the energy is -0.169075164 at the start and -0.169087605 after 1000 steps.

    Returns
    -------
    System

    Examples
    --------
    >>> import kickdrift as kd
    >>> planets = kd.systems.benchmarks_game()
    >>> sol = kd.solve(
    ...     planets, (0.0, 10.0), step=0.01, method="kick-drift", compensated=False
    ... )
    >>> print(f"{sol.energy[0]:.9f} {sol.energy[-1]:.9f}")
    -0.169075164 -0.169087605
    """
    planets = list(_PLANETS.values())
    masses = np.array([1.0] + [mass for mass, _, _ in planets]) * 4 * math.pi**2
    x = np.array([(0.0, 0.0, 0.0)] + [position for _, position, _ in planets])
    v = np.array([(0.0, 0.0, 0.0)] + [velocity for _, _, velocity in planets]) * _DAYS
    v[0] = -(masses[1:, None] * v[1:]).sum(axis=0) / masses[0]
    system = nbody(masses=masses, x0=x, v0=v, G=1.0, names=["Sun", *_PLANETS])
    year = f"year of {_DAYS} days"
    units = {"energy": f"au^5/({year})^4", "momentum": f"au^4/({year})^3", "angular momentum": f"au^5/({year})^3"}
    return replace(
        system,
        name="benchmarks-game",
        quantities={name: replace(quantity, unit=units[name]) for name, quantity in system.quantities.items()},
        units={"t": year, "x": "au", "v": f"au per {year}"},
        source="The Computer Language Benchmarks Game, n-body",
    )
