"""m x'' = F - G^T lambda with holonomic constraints g(x) = 0, by Python functions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.core.compilation import unbound
from kickdrift.core.errors import ArgumentError
from kickdrift.core.kinds import Kind
from kickdrift.systems.consistency import check
from kickdrift.systems.constraints import DIFFERENCE, Constraints
from kickdrift.systems.problem import Adapter, Floats, Function, Problem, name_of
from kickdrift.systems.second_order import divided_by_mass, masses_of
from kickdrift.systems.system import System

_POSITION = ("x", "q", "params")
_WEIGHTS = ((1.0, 8.0), (-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0))  # fourth order: of values beside x, over 12 distances

constraint: Function = unbound
SIZE, COUNT = 0, 0  # of the state, and of constraints: loops over a few are unrolled


@dataclass(frozen=True)
class Constrained(Problem):
    """m x'' = F(t, x) - G(x)^T lambda with constraints g(x) = 0 and G = dg/dx, by Python functions.

    The constraint forces -G^T lambda enforce g(x) = 0; their multipliers lambda are the solution's ``multipliers``. Methods:
    ``rattle``, ``shake``, ``projected-kick-drift``. Each step solves the constraints to rounding error, some 1e-16 of the
    size of x; if that fails, the run ends with a message. ``shake`` has the positions of ``rattle``, but its velocities are not
    tangent to the constraints, and have only order 1.

    Parameters
    ----------
    force : callable
        F: returns the force, of the shape of x0, or writes it into ``out``. Arguments: ``x``, ``t``, ``params``,
        ``out``.
    constraint : callable
        g: returns numbers that are zero where the constraints are satisfied, shape (m,), or one number. Arguments: ``x``,
        ``params``.
    mass : array_like
        Positive: a number, or for states (N, 3) one per body.
    jacobian : callable, optional
        G: returns the derivatives of g with respect to x, shape (m, *shape of x0), or the shape of x0 for one number, or
        writes them into ``out``. It is compared with finite differences of g at x0 and near it. Without it, fourth-order
        differences over 1e-4 of the size of x0 are used: 4 n evaluations of g per step, accurate to some 1e-12 if g is
        smooth over such distances and all components of x have the same unit. The constraints are satisfied as accurately as
        with it; the velocities are tangent, and the energy is free of drift, up to that error.
    energy : callable, optional
        Returns the energy, a number; the constraint forces do no work.
    invariants : mapping of str to callable, optional
        Other conserved numbers by name.

    Raises
    ------
    ArgumentError
        For a force that depends on the velocity; a Jacobian with a wrong entry; a start with g(x0) or G v0 not zero.
        Redundant constraints are accepted, and share the force with the smallest multipliers, each weighted by the length of
        its gradient. Constraints whose gradient vanishes, that are nearly but not exactly dependent, or that are dependent
        only at x0, a singular configuration, are refused with the rank found.

    Notes
    -----
    Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed. (2006), section VII.1.

    Examples
    --------
    A pendulum of length 1 in the plane, in Cartesian coordinates:

    >>> import numpy as np, kickdrift as kd
    >>> pendulum = kd.Constrained(
    ...     force=lambda x: np.array([0.0, -9.81]),
    ...     constraint=lambda x: x[0] ** 2 + x[1] ** 2 - 1,
    ...     energy=lambda x, v: 0.5 * (v[0] ** 2 + v[1] ** 2) + 9.81 * x[1],
    ... )
    >>> sol = kd.solve(
    ...     pendulum, (0.0, 0.5), [1, 0], [0, 0], method="rattle", step=0.01, compile=False
    ... )
    >>> bool(abs(np.hypot(*sol.x.T) - 1).max() < 1e-12), bool(abs(sol.energy).max() < 1e-2)
    (True, True)
    """

    start_in_params: ClassVar[bool] = True

    force: Function
    constraint: Function
    mass: ArrayLike = 1.0
    jacobian: Function | None = None
    energy: Function | None = None
    invariants: Mapping[str, Function] = field(default_factory=dict)

    def system(self, adapter: Adapter) -> System:
        """Make the system."""
        force = adapter.adapt(self.force, "the force")
        if "v" in force.names:
            raise ArgumentError(
                f"force={name_of(self.force)} has an argument v, but methods for constraints keep their order only for"
                " forces of t and x; leave out the dependence on velocity, or use kd.SecondOrder in coordinates"
                " without constraints, such as angles."
            )
        shape = adapter.shape_of(self.constraint, "the constraint", _POSITION)
        if len(shape) > 1 or 0 in shape:
            raise ArgumentError(
                f"constraint={name_of(self.constraint)} returns an array of shape {shape}; give the constraints as one"
                " number or a list of them."
            )
        constraint = adapter.adapt(self.constraint, "the constraint", _POSITION, shape)
        adapted = [force, constraint]
        parts = {"constraints": constraint.function}
        if self.jacobian is not None:
            of_jacobian = (*shape, *adapter.x0.shape)
            jacobian = adapter.adapt(self.jacobian, "the jacobian", (*_POSITION, "out"), of_jacobian)
            adapted.append(jacobian)
            parts["constraint_jacobian"] = jacobian.function
        else:
            sizes = {"SIZE": adapter.x0.size, "COUNT": shape[0] if shape else 1}
            parts["constraint_differences"] = adapter.bind(differentiated, constraint=constraint.function, **sizes)
        made = System(
            name=name_of(self.constraint),
            acceleration=adapter.bind(divided_by_mass, force=force.function),
            x0=adapter.x0,
            v0=adapter.v0,
            params=self._params(adapter, shape),
            quantities=adapter.quantities(self.energy, self.invariants),
            kind=Kind.CONSTRAINED,
            parts=parts,
            native=all(function.native for function in adapted),
        )
        check(Constraints(made), adapter.x0.reshape(-1), adapter.v0.reshape(-1))
        return made

    def _params(self, adapter: Adapter, shape: tuple[int, ...]) -> Floats:
        """Append the number of constraints, a length that differences are measured by, and the inverse masses."""
        length = float(abs(adapter.x0).max()) or 1.0
        inverse_masses = 1 / masses_of(self.mass, adapter.x0.shape)
        return np.concatenate([adapter.args, [shape[0] if shape else 1, length], inverse_masses])


def differentiated(t: float, x: Floats, room: Floats, params: Floats, out: Floats) -> None:
    """Write the Jacobian of constraints at x by differences, with `room` for their values; x is moved and put back.

    Truncation and rounding leave some 1e-12 of it.
    """
    d = params[params.size - SIZE - 1]
    for j in range(SIZE):
        d = max(d, abs(x[j]))
    d *= DIFFERENCE
    share = 1.0 / (12.0 * d)
    for j in range(SIZE):
        kept = x[j]
        for i in range(COUNT):
            out[i * SIZE + j] = 0.0
        for place, weight in _WEIGHTS:  # the constraint is called in one place, where the compiler then puts its code
            x[j] = kept + place * d
            constraint(t, x, room, params, room)
            for i in range(COUNT):
                out[i * SIZE + j] += weight * room[i]
        for i in range(COUNT):
            out[i * SIZE + j] *= share
        x[j] = kept
