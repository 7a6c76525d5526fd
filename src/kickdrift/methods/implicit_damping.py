"""The semi-implicit Euler method, implicit in stiff damping."""

from kickdrift.core.kinds import Kind
from kickdrift.methods.letter import Letter
from kickdrift.methods.record import D, Method
from kickdrift.methods.words import word

METHODS = (
    Method(
        name="implicit-damping",
        order=1,
        word=word((Letter.LINEARLY_IMPLICIT_KICK, 1), (D, 1)),
        symmetric=False,
        kind=Kind.VELOCITY_DEPENDENT,
        source="Todorov, Erez, Tassa, IROS, 5026 (2012); MuJoCo documentation, Computation, Numerical integration",
    ),
)
