"""The fourth-order Nystroem method of Calvo and Sanz-Serna."""

from kickdrift.core.kinds import Kind
from kickdrift.methods.record import K, Method
from kickdrift.methods.words import rows

METHODS = (
    Method(
        name="calvo-sanz-4",
        order=4,
        word=rows(
            K,
            ["0.0617588581356263250", "0.3389780265536433551", "0.6147913071755775662", "-0.1405480146593733802"],
            ["0.2051776615422863869", "0.4030212816042145870", "-0.1209208763389140082"],
        ),
        symmetric=False,
        kind=Kind.NEWTONIAN,
        source="Calvo, Sanz-Serna, SIAM J. Sci. Comput. 14, 936 (1993)",
        aliases=("calvo-sanz-serna-4",),
    ),
)
