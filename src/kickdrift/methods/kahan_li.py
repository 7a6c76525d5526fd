"""The compositions of Kahan and Li, optimal among those with few Verlet steps more than the order needs."""

from kickdrift.core.kinds import Kind
from kickdrift.methods.record import Method
from kickdrift.methods.yoshida import verlet_steps

KAHAN_LI = "Kahan, Li, Math. Comput. 66, 1089 (1997)"

METHODS = (
    Method(
        name="kahan-li-6",
        order=6,
        word=verlet_steps(
            [
                "0.39216144400731413927925056",
                "0.33259913678935943859974864",
                "-0.70624617255763935980996482",
                "0.08221359629355080023149045",
            ]
        ),
        symmetric=True,
        kind=Kind.SEPARABLE,
        source=f"{KAHAN_LI}, s9odr6a",
    ),
    Method(
        name="kahan-li-8",
        order=8,
        word=verlet_steps(
            [
                "0.13020248308889008087881763",
                "0.56116298177510838456196441",
                "-0.38947496264484728640807860",
                "0.15884190655515560089621075",
                "-0.39590389413323757733623154",
                "0.18453964097831570709183254",
                "0.25837438768632204729397911",
                "0.29501172360931029887096624",
            ]
        ),
        symmetric=True,
        kind=Kind.SEPARABLE,
        source=f"{KAHAN_LI}, s17odr8a",
    ),
)
