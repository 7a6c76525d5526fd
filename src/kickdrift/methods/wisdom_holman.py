"""Methods for light bodies around a heavy one: kicks by what the Kepler problems leave over, and their exact flow."""

from kickdrift.core.kinds import Kind
from kickdrift.methods.letter import Letter
from kickdrift.methods.record import K, Method, word

KEPLER = Letter.KEPLER

METHODS = (
    Method(
        name="wisdom-holman",
        order=2,
        word=word((K, "1/2"), (KEPLER, 1), (K, "1/2")),
        symmetric=True,
        kind=Kind.NEARLY_KEPLERIAN,
        source="Wisdom, Holman, Astron. J. 102, 1528 (1991)",
        generalised_order=(2, 2),
    ),
)
