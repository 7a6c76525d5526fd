"""The extended Forest-Ruth-like methods of Omelyan, Mryglod and Folk, in the forms for positions and for velocities."""

from kickdrift.core.kinds import Kind
from kickdrift.methods.record import D, K, Method
from kickdrift.methods.words import palindrome

OMELYAN = "Omelyan, Mryglod, Folk, Comput. Phys. Commun. 146, 188 (2002)"

# In the paper's letters both words are xi, 1/2 - lambda, chi, and then what the sums leave: lambda, 1 - 2 (xi + chi).

METHODS = (
    Method(
        name="omelyan-pefrl-4",
        order=4,
        word=palindrome(D, ["0.1786178958448091", "0.7123418310626054", "-0.06626458266981849"]),
        symmetric=True,
        kind=Kind.SEPARABLE,
        source=f"{OMELYAN}, PEFRL",
        aliases=("pefrl",),
    ),
    Method(
        name="omelyan-vefrl-4",
        order=4,
        word=palindrome(K, ["0.1644986515575760", "0.52094333910398989", "1.235692651138917"]),
        symmetric=True,
        kind=Kind.SEPARABLE,
        source=f"{OMELYAN}, VEFRL",
        aliases=("vefrl",),
    ),
)
