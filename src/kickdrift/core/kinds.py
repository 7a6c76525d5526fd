"""The kinds of problem, and which includes which."""

from enum import Enum
from functools import cache


class Kind(Enum):
    """Kinds of problems, by the form of the equations; ``kind.value`` is a phrase that describes it.

    A kind includes the more specific ones below it, and a method that has its order on a kind has it on those, too. ::

        FIRST_ORDER                   y' = f(t, y)
          PARTITIONED                 x' = f(t, x, v), v' = g(t, x, v)
            HAMILTONIAN               H(q, p), separable or not
              SEPARABLE               T(p) + V(q)
                NEWTONIAN             accelerations a(t, x)
                  NEARLY_KEPLERIAN    light bodies around a heavy one
                  MULTIRATE           a fast and a slow part
                    OSCILLATORY       -omega^2 x + g(t, x)
            VELOCITY_DEPENDENT        accelerations a(t, x, v)
              NEWTONIAN ...
              DAMPED                  a(t, x) - c v
              CHARGED                 charges in electric and magnetic fields
        CONSTRAINED                   a(t, x) with constraints g(x) = 0
        LANGEVIN                      forces, friction and noise

    Examples
    --------
    >>> from kickdrift.methods import Kind
    >>> Kind.HAMILTONIAN.includes(Kind.NEWTONIAN), Kind.NEWTONIAN.includes(Kind.HAMILTONIAN)
    (True, False)
    """

    FIRST_ORDER = "first-order equations y' = f(t, y)"
    PARTITIONED = "partitioned equations x' = f(t, x, v), v' = g(t, x, v)"
    HAMILTONIAN = "Hamiltonians H(q, p), separable or not"
    SEPARABLE = "separable Hamiltonians T(p) + V(q)"
    VELOCITY_DEPENDENT = "accelerations a(t, x, v)"
    NEWTONIAN = "accelerations a(t, x)"
    DAMPED = "accelerations a(t, x) - c v with linear damping"
    CHARGED = "charges in electric and magnetic fields"
    NEARLY_KEPLERIAN = "light bodies around a heavy one"
    MULTIRATE = "accelerations a(t, x) with a fast and a slow part"
    OSCILLATORY = "accelerations -omega^2 x + g(t, x)"
    CONSTRAINED = "accelerations a(t, x) with constraints g(x) = 0"
    LANGEVIN = "Langevin dynamics: forces, friction and noise"

    __hash__ = object.__hash__  # a member is one object; that of Enum takes ten times as long

    @cache
    def includes(self, other: "Kind") -> bool:
        """Whether a problem of the other kind is one of this kind, too."""
        return self is other or any(self.includes(parent) for parent in _PARENTS.get(other, ()))


_PARENTS = {
    Kind.PARTITIONED: (Kind.FIRST_ORDER,),
    Kind.HAMILTONIAN: (Kind.PARTITIONED,),
    Kind.SEPARABLE: (Kind.HAMILTONIAN,),
    Kind.VELOCITY_DEPENDENT: (Kind.PARTITIONED,),
    Kind.NEWTONIAN: (Kind.SEPARABLE, Kind.VELOCITY_DEPENDENT),
    Kind.DAMPED: (Kind.VELOCITY_DEPENDENT,),
    Kind.CHARGED: (Kind.VELOCITY_DEPENDENT,),
    Kind.NEARLY_KEPLERIAN: (Kind.NEWTONIAN,),
    Kind.MULTIRATE: (Kind.NEWTONIAN,),
    Kind.OSCILLATORY: (Kind.MULTIRATE,),
}
