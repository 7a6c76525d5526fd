"""The methods that may be the fastest somewhere, of each kind of problem.

Midpoint rule, implicit Euler, implicit Verlet, `tao-4` and `composition-diagonal-6` were tried on the problems that `python -m
benchmarks --only auto` has of their kinds. None came within twice the fastest time to errors from 1e-3 to 1e-9, and most are 10
to 1000 times off.
"""

from kickdrift import methods
from kickdrift.core.kinds import Kind

_RUNGE_KUTTA = ("runge-kutta-4", "dop853", "gauss-4", "gauss-6", "gauss-8", "radau-5", "radau-7")
_WORDS = ("blanes-moan-s6", "blanes-moan-s10", "kahan-li-8", "sofroniou-spaletta-10")
_NYSTROM = (
    *("velocity-verlet", "blanes-moan-srkn6b", "blanes-moan-srkn11b", "blanes-moan-srkn14a"),
    *("kahan-li-8", "teloy-8c", "sofroniou-spaletta-10", "dop853"),
)

_OF = {
    Kind.NEWTONIAN: (*_NYSTROM, "gauss-6"),
    Kind.SEPARABLE: ("velocity-verlet", *_WORDS, "dop853", "gauss-6"),
    Kind.VELOCITY_DEPENDENT: _RUNGE_KUTTA,
    Kind.DAMPED: ("conformal-verlet", "blanes-moan-conformal-4", "blanes-moan-conformal-6", "dop853"),
    Kind.CHARGED: ("boris", "blanes-moan-gyration-4", "blanes-moan-gyration-6", "dop853"),
    Kind.NEARLY_KEPLERIAN: ("wisdom-holman", "wisdom-holman-corrected-3", "blanes-aba-1064", *_NYSTROM),
    Kind.MULTIRATE: ("respa-2", *_NYSTROM),
    Kind.OSCILLATORY: ("deuflhard-2", "mollified-impulse", "garcia-archilla-sanz-serna-skeel-2", *_NYSTROM),
    Kind.HAMILTONIAN: _RUNGE_KUTTA,
    Kind.PARTITIONED: _RUNGE_KUTTA,
    Kind.FIRST_ORDER: ("radau-3", *_RUNGE_KUTTA),
}


def of(kind: Kind) -> tuple[str, ...]:
    """Return the names of the candidates for a kind of problem; none where noise drives it, and for constraints."""
    return tuple(dict.fromkeys(methods.get(name).name for name in _OF.get(kind, ())))
