"""The compositions of Suzuki: the fractal of five Verlet steps and, with Umeno, fifteen steps of order 8."""

from decimal import Decimal, localcontext
from fractions import Fraction

from kickdrift.core.kinds import Kind
from kickdrift.methods.record import Method
from kickdrift.methods.yoshida import verlet_steps

with localcontext() as _context:
    _context.prec = 60
    _outer = Fraction(1 / (4 - Decimal(4) ** (Decimal(1) / Decimal(3))))

METHODS = (
    Method(
        name="suzuki-4",
        order=4,
        word=verlet_steps([_outer, _outer]),
        symmetric=True,
        kind=Kind.SEPARABLE,
        source="Suzuki, Phys. Lett. A 146, 319 (1990)",
    ),
    Method(
        name="suzuki-umeno-8",
        order=8,
        word=verlet_steps(
            [
                "0.7416703643506129534482278017838063156035",
                "-0.4091008258000315939973000958935634173099",
                "0.1907547102962383799538762564503716627355",
                "-0.5738624711160822666563877266355357421595",
                "0.2990641813036559238444635406886029882258",
                "0.3346249182452981837849579798821822886337",
                "0.3152930923967665966320566638110024309941",
            ]
        ),
        symmetric=True,
        kind=Kind.SEPARABLE,
        source=(
            "Suzuki, Umeno, in Computer Simulation Studies in Condensed-Matter Physics VI, 74 (1993);"
            " McLachlan, SIAM J. Sci. Comput. 16, 151 (1995), SS, m = 15"
        ),
        aliases=("mclachlan-ss15-8",),
    ),
)
