"""The outer solar system of Hairer, Lubich and Wanner: Sun, four giant planets and Pluto, in au and days."""

from dataclasses import replace

import numpy as np

from kickdrift.systems.planetary import planetary
from kickdrift.systems.system import System

GRAVITY = 2.95912208286e-4  # au^3 / day^2, of the mass of the Sun
# Mass (Sun = 1), position (au), velocity (au/day) on 5 September 1994; the inner planets are in the mass of the Sun.
BODIES = {
    "Sun": (1.00000597682, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
    "Jupiter": (0.000954786104043, (-3.5023653, -3.8169847, -1.5507963), (0.00565429, -0.00412490, -0.00190589)),
    "Saturn": (0.000285583733151, (9.0755314, -3.0458353, -1.6483708), (0.00168318, 0.00483525, 0.00192462)),
    "Uranus": (0.0000437273164546, (8.3101420, -16.2901086, -7.2521278), (0.00354178, 0.00137102, 0.00055029)),
    "Neptune": (0.0000517759138449, (11.4707666, -25.7294829, -10.8169456), (0.00288930, 0.00114527, 0.00039677)),
    "Pluto": (1 / 1.3e8, (-15.5387357, -25.2225594, -3.1902382), (0.00276725, -0.00170702, -0.00136504)),
}


def outer_solar_system(splitting: str = "jacobi") -> System:
    """Create the outer solar system of Hairer, Lubich and Wanner; the state has shape (6, 3).

    Lengths are in au, times in days, masses in solar masses. The energy is -3.215453183208163e-8 solar masses au^2/day^2 at
    the start. Jupiter's period is 4332.6 days.

    Parameters
    ----------
    splitting : str
        As for `planetary`.

    Returns
    -------
    System

    Examples
    --------
    >>> import kickdrift as kd
    >>> planets = kd.systems.outer_solar_system()
    >>> sol = kd.solve(planets, (0.0, 20_000.0), step=200.0, method="wisdom-holman")
    >>> sol.x.shape
    (101, 6, 3)
    """
    masses, x, v = (np.array([body[i] for body in BODIES.values()]) for i in range(3))
    system = planetary(masses, x, v, G=GRAVITY, splitting=splitting, names=list(BODIES))
    units = {
        "energy": "solar mass au^2/day^2",
        "momentum": "solar mass au/day",
        "angular momentum": "solar mass au^2/day",
    }
    return replace(
        system,
        name="outer-solar-system",
        quantities={name: replace(quantity, unit=units[name]) for name, quantity in system.quantities.items()},
        units={"t": "day", "x": "au", "v": "au/day"},
        source="Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed. (2006), section I.2.4",
    )
