"""The methods of McLachlan: symmetric words with small errors, Nystroem words, and compositions of Verlet steps."""

from decimal import Decimal, localcontext
from fractions import Fraction

from kickdrift.core.kinds import Kind
from kickdrift.methods.record import D, K, Method
from kickdrift.methods.words import palindrome
from kickdrift.methods.yoshida import verlet_steps

MCLACHLAN = "McLachlan, SIAM J. Sci. Comput. 16, 151 (1995)"

with localcontext() as _context:
    _context.prec = 60

    _cube_root = (2 * Decimal(326).sqrt() - 36) ** (1 / Decimal(3))
    _s2 = (_cube_root**2 + 6 * _cube_root - 2) / (12 * _cube_root)

    _root = Decimal(471).sqrt()
    _s4 = (642 + _root) / 3924, 121 * (12 - _root) / 3924

    _root = Decimal(19).sqrt()
    _s5 = (14 - _root) / 108, (20 - 7 * _root) / 108

    # SB3A with four kicks 1, -1/2, -1/2, 1: sum b (c - 1/2)^2 = 1/12 at the nodes a1 and 1/6.
    _sb3a4 = (1 - Decimal(14).sqrt() / 6) / 2

    # SB3A with five kicks b1, b2, b3, b2, b1. The conditions of order 3 for Nystroem methods, with x = 1/2 - a1 and
    # y = a3 (the distances of the nodes from the middle) and B = b1 + b2:
    #   b1 x^2 + b2 y^2 = 1/24    and    b1 (1 - b1) (x - y) + B (1 - B) y = 1/12,
    # so x = p + q y, and y solves (b1 q^2 + b2) y^2 + 2 b1 p q y + b1 p^2 - 1/24 = 0.
    _b1, _b2 = -3 / Decimal(73), 17 / Decimal(59)
    _p = 1 / (12 * _b1 * (1 - _b1))
    _q = 1 - (_b1 + _b2) * (1 - _b1 - _b2) / (_b1 * (1 - _b1))
    _square, _half_linear = _b1 * _q**2 + _b2, _b1 * _p * _q
    _y = (-_half_linear + (_half_linear**2 - _square * (_b1 * _p**2 - 1 / Decimal(24))).sqrt()) / _square
    _x = _p + _q * _y

METHODS = (
    Method(
        name="mclachlan-s2-2",
        order=2,
        word=palindrome(K, [_s2]),
        symmetric=True,
        kind=Kind.SEPARABLE,
        source=f"{MCLACHLAN}, S, m = 2",
    ),
    Method(
        name="mclachlan-s4-4",
        order=4,
        word=palindrome(K, [_s4[0], "6/11", _s4[1]]),
        symmetric=True,
        kind=Kind.SEPARABLE,
        source=f"{MCLACHLAN}, S, m = 4",
    ),
    Method(
        name="mclachlan-s5-4",
        order=4,
        word=palindrome(K, [_s5[0], "2/5", _s5[1], "-1/10"]),
        symmetric=True,
        kind=Kind.SEPARABLE,
        source=f"{MCLACHLAN}, S, m = 5",
    ),
    Method(
        name="mclachlan-sb3a4-4",
        order=4,
        word=palindrome(D, [_sb3a4, 1, 1 / Fraction(6) - Fraction(_sb3a4)]),
        symmetric=True,
        kind=Kind.NEWTONIAN,
        source=f"{MCLACHLAN}, SB3A, m = 4",
    ),
    Method(
        name="mclachlan-sb3a5-4",
        order=4,
        word=palindrome(D, [1 / Fraction(2) - Fraction(_x), "-3/73", Fraction(_x) - Fraction(_y), "17/59"]),
        symmetric=True,
        kind=Kind.NEWTONIAN,
        source=f"{MCLACHLAN}, SB3A, m = 5",
    ),
    # In the three compositions the first weight is the author's choice, and the others are the root of the order
    # conditions at 60 digits; they agree with the 20 digits in the paper.
    Method(
        name="mclachlan-ss5-4",
        order=4,
        word=verlet_steps(["0.28", "0.6254664284676700450123389054926490129182"]),
        symmetric=True,
        kind=Kind.SEPARABLE,
        source=f"{MCLACHLAN}, SS, m = 5",
    ),
    Method(
        name="mclachlan-ss9-6",
        order=6,
        word=verlet_steps(
            [
                "0.1867",
                "0.5554970237124783991569135436283912009641",
                "0.1294669489134753580560452092102047808168",
                "-0.8432656233877346085491427813848149898690",
            ]
        ),
        symmetric=True,
        kind=Kind.SEPARABLE,
        source=f"{MCLACHLAN}, SS, m = 9",
    ),
    Method(
        name="mclachlan-ss17-8",
        order=8,
        word=verlet_steps(
            [
                "25/194",
                "0.5815140871052509624302422782038136910044",
                "-0.4101753714698501375324061500890486599642",
                "0.1851469357165877326532719498634894574402",
                "-0.4095523434208514193398451736889092696187",
                "0.1444059410800120410600751871569277490622",
                "0.2783355003936796513091070628124172294800",
                "0.3149566839162948578902813119729508819232",
            ]
        ),
        symmetric=True,
        kind=Kind.SEPARABLE,
        source=f"{MCLACHLAN}, SS, m = 17",
    ),
)
