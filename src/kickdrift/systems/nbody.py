"""Direct N-body: every body attracts every other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.arguments import real, reals
from kickdrift.core.compilation import Function, compiled
from kickdrift.core.errors import ArgumentError
from kickdrift.core.threads import launch
from kickdrift.systems import gravity
from kickdrift.systems.massless import FEW, add_gravity_of_massive, mostly_massless
from kickdrift.systems.system import Quantity, System
from kickdrift.systems.units import of_bodies

Floats = NDArray[np.float64]

# params is [G, softening^2, Gm_0, ..., Gm_(N-1)]; `gravity` takes it from the softening on.


@compiled
def _kick(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    gravity.add_gravity_pairwise(h, x, params[1:], v)


def _own_kick(compensated: bool) -> Function | None:
    return None if compensated else _kick


@compiled
def _few(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    out[:] = 0.0
    gravity.add_gravity_pairwise(1.0, x, params[1:], out)


@compiled
def _mostly_massless(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    out[:] = 0.0
    add_gravity_of_massive(1.0, x, params[1:], out)


@compiled
def _many(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    out[:] = 0.0
    gravity.add_gravity_tiled(1.0, x, params[1:], out)


@compiled
def _many_threaded(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    out[:] = 0.0
    gravity.add_gravity_threaded(1.0, x, params[1:], out)


@compiled
def _energy(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    out[0] = gravity.energy(x, v, params[1:], params[0])


@compiled
def _momentum(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    gravity.momentum(x, v, params[1:], params[0], out)


@compiled
def _angular_momentum(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    gravity.angular_momentum(x, v, params[1:], params[0], out)


@compiled
def _density(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    # The root of the sum of the squares of the angular velocities that pairs would have on circles.
    squares = 0.0
    for i in range(x.size // 3):
        for j in range(i):
            gm = params[2 + i] + params[2 + j]
            if gm > 0.0:
                r2 = params[1]
                for k in range(3):
                    r2 += (x[3 * i + k] - x[3 * j + k]) ** 2
                squares += gm / (r2 * math.sqrt(r2)) if r2 > 0.0 else 0.0  # of bodies that have merged
    out[0] = math.sqrt(squares)


def _quantities(masses: Floats, x0: Floats, v0: Floats) -> dict[str, Quantity]:
    """Return the conserved quantities; momenta are judged by the sizes of those of the bodies, which may cancel."""
    with np.errstate(all="ignore"):  # the run reports overflow
        momenta = masses[:, None] * v0
        scale = float(np.linalg.norm(momenta, axis=1).sum())
        angular_scale = float(np.linalg.norm(np.cross(x0, momenta), axis=1).sum())
    return {
        "energy": Quantity(_energy),
        "momentum": Quantity(_momentum, 3, scale=scale),
        "angular momentum": Quantity(_angular_momentum, 3, scale=angular_scale),
    }


def nbody(
    masses: ArrayLike,
    x0: ArrayLike,
    v0: ArrayLike,
    G: float = 1.0,
    softening: float = 0.0,
    names: Sequence[str] | None = None,
    threads: bool = False,
) -> System:
    """Create a system of N bodies under Newtonian gravity, summed directly; the state has shape (N, 3).

    Parameters
    ----------
    masses : (N,) array_like
        Masses, at least 0; a massless body is attracted and does not attract.
    x0, v0 : (N, 3) array_like
        Positions and velocities.
    G : float
        Gravitational constant, in the units of the other arguments.
    softening : float
        Plummer softening length: distances enter as sqrt(r^2 + softening^2).
    names : sequence of str, optional
        Names of the bodies.
    threads : bool
        Whether the forces are distributed over Numba's threads (``numba.set_num_threads``). The results are the same, bit
        for bit, for any number of threads. Worthwhile from some 500 bodies on, on otherwise idle cores. Processes forked
        from one that has used threads run on one thread.

    Returns
    -------
    System

    Raises
    ------
    ArgumentError
        For shapes that do not match, negative masses, a G that is not positive, or a negative softening.

    Notes
    -----
    Masses, positions, velocities, G and softening may be quantities of astropy or pint, but then all of them: lengths are in
    the unit of x0, velocities in that of v0, and times in the unit that follows from these.

    Examples
    --------
    >>> import numpy as np, kickdrift as kd
    >>> three = kd.systems.nbody(
    ...     [3, 4, 5], x0=[[1, 3, 0], [-2, -1, 0], [1, -1, 0]], v0=np.zeros((3, 3))
    ... )
    >>> sol = kd.solve(three, (0.0, 1.0), step=0.001, method="leapfrog", save_every=100)
    >>> sol.x.shape, round(float(sol.energy[0]), 6)
    ((11, 3, 3), -12.816667)
    """
    (masses, x0, v0, G, softening), units = of_bodies(masses, x0, v0, G, softening)
    gm, positions, velocities = _checked(masses, x0, v0, G, softening)
    n = gm.size
    labels = [str(name) for name in names] if names is not None else [str(i) for i in range(n)]
    if len(labels) != n or len(set(labels)) != n:
        raise ArgumentError(f"names={labels!r} must be {n} different names, one for each body.")
    many = _mostly_massless if mostly_massless(gm, threads) else _many_threaded if threads else _many
    shared = n > FEW and many is _many_threaded
    if shared:
        launch()
    return System(
        name="nbody",
        acceleration=_few if n <= FEW else many,
        kick=_own_kick if n <= FEW else None,
        density=_density,
        unthreaded=_many if shared else None,
        x0=positions,
        v0=velocities,
        params=np.concatenate([[G, softening * softening], gm]),
        quantities=_quantities(gm / float(G) if G else gm, positions, velocities),
        packaged=True,
        dimensions=("body", "space"),
        coordinates={"body": labels, "space": ["x", "y", "z"]},
        source="Aarseth, Gravitational N-Body Simulations (2003)",
        gm=gm,
        units={} if units is None else units.names,
        quantity_units=units,
    )


def _between(value: Any, least: float) -> bool:
    """Whether a value is a finite number, and no smaller than the least."""
    try:
        return least <= real(value) < math.inf
    except TypeError:
        return False


def _checked(
    masses: ArrayLike, x0: ArrayLike, v0: ArrayLike, G: float, softening: float
) -> tuple[Floats, Floats, Floats]:
    try:
        m, x, v = (reals(value) for value in (masses, x0, v0))
    except TypeError as error:
        raise ArgumentError(f"masses, x0 and v0 must be arrays of numbers: {error}.") from None
    if m.ndim != 1 or m.size == 0:
        raise ArgumentError(f"masses has shape {m.shape}; give a list with one mass per body.")
    for name, value in (("x0", x), ("v0", v)):
        if value.shape != (m.size, 3):
            raise ArgumentError(f"{name} has shape {value.shape}, but {m.size} masses need shape ({m.size}, 3).")
        if not np.isfinite(value).all():
            body = int(np.argwhere(~np.isfinite(value))[0][0])
            raise ArgumentError(f"{name}[{body}]={value[body].tolist()} must be finite.")
    if not (np.isfinite(m).all() and (m >= 0).all()):
        body = int(np.argwhere(~(m >= 0) | ~np.isfinite(m))[0][0])
        raise ArgumentError(f"masses[{body}]={m[body]} must be finite and at least 0.")
    if not _between(G, 5e-324):
        raise ArgumentError(f"G={G!r} must be positive and finite.")
    if not _between(softening, 0.0):
        raise ArgumentError(f"softening={softening!r} must be finite and at least 0.")
    if softening == 0 and len(np.unique(x, axis=0)) < m.size:
        raise ArgumentError("x0 has two bodies at the same position; move one, or give a softening.")
    return G * m, x, v
