"""The third-order method of Ruth."""

from kickdrift.core.kinds import Kind
from kickdrift.methods.record import K, Method
from kickdrift.methods.words import rows

METHODS = (
    Method(
        name="ruth-3",
        order=3,
        word=rows(K, ["7/24", "3/4"], ["2/3", "-2/3"]),
        symmetric=False,
        kind=Kind.SEPARABLE,
        source="Ruth, IEEE Trans. Nucl. Sci. 30, 2669 (1983)",
    ),
)
