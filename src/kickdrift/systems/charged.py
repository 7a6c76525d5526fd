"""x'' = (q/m) (E(t, x) + v x B(t, x)), by Python functions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.core.arguments import reals
from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.elementwise import multiply
from kickdrift.core.errors import ArgumentError
from kickdrift.core.kinds import Kind
from kickdrift.systems.problem import Adapter, Floats, Function, Problem, name_of
from kickdrift.systems.system import System

field_strength: Function = unbound
electric: Function = unbound
magnetic: Function = unbound


@dataclass(frozen=True)
class ChargedParticle(Problem):
    """x'' = (q/m) (E(t, x) + v x B(t, x)): charges in electric and magnetic fields given by Python functions.

    States have the shape (3,), or (N, 3) for N particles. For planar motion set the third component of position and velocity
    to 0 and B to [0, 0, B_z]: the particles then stay in the plane exactly.

    Parameters
    ----------
    charge_to_mass : array_like
        q/m, of any sign: a number, or N of them.
    magnetic_field : callable
        B, a function of any of ``x``, ``t``, ``params``, and ``out`` (written in place instead of returned). It returns the
        field at each particle, or one vector for all.
    electric_field : callable, optional
        E, likewise; zero by default.
    energy, invariants
        As for `kickdrift.SecondOrder`.

    Raises
    ------
    ArgumentError
        For states of other shapes, or charges that do not fit them.

    Notes
    -----
    ``method="boris"`` is the standard: it kicks with E and rotates v about B. In uniform fields its gyroradius and its drift
    velocity E x B / B^2 are exact, and the phase lags: v turns by 2 atan(h q B / 2 m) per step instead of h q B / m.
    ``"he-sun-liu-qin-2"`` turns by the exact angle, with errors in the radius and the drift instead.
    ``"blanes-moan-gyration-4"`` has order 4. All three preserve the volume of phase space and are symmetric. Their energy
    errors stay bounded in many fields, but not in all: they are not symplectic, and where neither B is constant nor the
    potential quadratic the energy can drift slowly [1]_.

    References
    ----------
    .. [1] E. Hairer, C. Lubich, Energy behaviour of the Boris method for charged-particle dynamics, BIT 58 (2018) 969.

    Examples
    --------
    Half a turn in a uniform field:

    >>> import numpy as np, kickdrift as kd
    >>> ion = kd.ChargedParticle(1.0, lambda x: np.array([0.0, 0.0, 2.0]))
    >>> start = {"x0": [0.0, 0.5, 0.0], "v0": [1.0, 0.0, 0.0]}
    >>> sol = kd.solve(
    ...     ion, (0.0, np.pi / 2), **start, step=0.001, method="boris", compile=False
    ... )
    >>> bool(np.allclose(sol.x[-1], [0.0, -0.5, 0.0], atol=1e-5))
    True
    """

    charge_to_mass: ArrayLike
    magnetic_field: Function
    electric_field: Function | None = None
    energy: Function | None = None
    invariants: Mapping[str, Function] = field(default_factory=dict)

    def system(self, adapter: Adapter) -> System:
        """Make the system. Its last params are the charges to masses, one per number of the state."""
        names = ("t", "x", "params", "out")
        charges = _charges_of(self.charge_to_mass, adapter.x0.shape)
        for role, function in (("magnetic_field", self.magnetic_field), ("electric_field", self.electric_field)):
            if function is not None:
                _check_vectors(adapter, role, function, names)
        b_field = adapter.adapt(self.magnetic_field, "magnetic_field", names)
        native, kick = b_field.native, _nothing
        if self.electric_field is not None:
            e_field = adapter.adapt(self.electric_field, "electric_field", names)
            native, kick = native and e_field.native, adapter.bind(_times_charge, field_strength=e_field.function)
        turn = adapter.bind(_times_charge, field_strength=b_field.function)
        return System(
            name=name_of(self.magnetic_field),
            acceleration=adapter.bind(_lorentz, electric=kick, magnetic=turn),
            x0=adapter.x0,
            v0=adapter.v0,
            params=np.concatenate([adapter.args, charges]),
            quantities=adapter.quantities(self.energy, self.invariants),
            kind=Kind.CHARGED,
            parts={"remainder": kick, "magnetic_field": turn},
            native=native,
        )


def _check_vectors(adapter: Adapter, role: str, function: Function, names: tuple[str, ...]) -> None:
    """Refuse values that would broadcast to vectors but are not vectors: a number, or the strength at each particle."""
    if "out" in adapter.names_of(function, role, names):
        return
    shape = adapter.shape_of(function, role, names)
    if shape not in ((3,), adapter.x0.shape):
        raise ArgumentError(
            f"{role} returns an array of shape {shape}; a field has three components, for each particle or for all:"
            f" return shape (3,) or {adapter.x0.shape}."
        )


def _times_charge(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    field_strength(t, x, v, params, out)
    multiply(out, params[params.size - x.size :])


@compiled
def _nothing(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    out[:] = 0.0


def _lorentz(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    b = np.empty(x.size)
    magnetic(t, x, v, params, b)
    electric(t, x, v, params, out)
    for i in range(0, x.size, 3):
        out[i] += v[i + 1] * b[i + 2] - v[i + 2] * b[i + 1]
        out[i + 1] += v[i + 2] * b[i] - v[i] * b[i + 2]
        out[i + 2] += v[i] * b[i + 1] - v[i + 1] * b[i]


def _charges_of(charge_to_mass: ArrayLike, shape: tuple[int, ...]) -> Floats:
    if shape != (3,) and (len(shape) != 2 or shape[1] != 3):
        raise ArgumentError(
            f"x0 has shape {shape}, but charged particles need (3,) or (N, 3); for planar motion set the third"
            " component of position and velocity to 0."
        )
    try:
        charges = np.broadcast_to(reals(charge_to_mass), shape[:-1])
    except (TypeError, ValueError) as error:
        raise ArgumentError(
            f"charge_to_mass={charge_to_mass!r} does not fit states of shape {shape}: {error}; give a number, or for"
            " states (N, 3) N of them."
        ) from None
    if not np.isfinite(charges).all():
        raise ArgumentError(f"charge_to_mass={charge_to_mass!r} must be finite.")
    return np.repeat(charges.reshape(-1), 3)
