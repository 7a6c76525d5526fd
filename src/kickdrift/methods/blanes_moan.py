"""The Runge-Kutta-Nystroem splittings of Blanes and Moan."""

from fractions import Fraction

from kickdrift.methods.record import K, Kind, Method, alternating

_kicks = [Fraction(b) for b in ("0.0829844064174052", "0.396309801498368", "-0.0390563049223486")]
_drifts = [Fraction(a) for a in ("0.245298957184271", "0.604872665711080")]
# What the printed digits leave over goes to the middle of the palindrome, so that the clock is exact.
_kicks.append(1 - 2 * sum(_kicks, Fraction(0)))
_drifts.append(Fraction(1, 2) - sum(_drifts, Fraction(0)))
_half = [weight for pair in zip(_kicks, _drifts, strict=False) for weight in pair]

METHODS = (
    Method(
        name="blanes-moan-srkn6b",
        order=4,
        word=alternating(K, [*_half, _kicks[-1], *reversed(_half)]),
        symmetric=True,
        kind=Kind.NYSTROM,
        source="Blanes, Moan, J. Comput. Appl. Math. 142, 313 (2002), SRKN_6^b",
    ),
)
