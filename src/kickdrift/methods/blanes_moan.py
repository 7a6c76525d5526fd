"""The splittings of Blanes and Moan: S for separable problems, SRKN for accelerations a(t, x).

The paper prints 15 digits, with which the order conditions hold to 2e-16. The letter outside of the Nystroem words is a
kick in those of kind b and a drift in those of kind a.
"""

from kickdrift.core.kinds import Kind
from kickdrift.methods.record import D, K, Method
from kickdrift.methods.words import palindrome

BLANES_MOAN = "Blanes, Moan, J. Comput. Appl. Math. 142, 313 (2002)"

METHODS = (
    Method(
        name="blanes-moan-s6",
        order=4,
        word=palindrome(
            K,
            [
                "0.0792036964311957",
                "0.209515106613362",
                "0.353172906049774",
                "-0.143851773179818",
                "-0.0420650803577195",
            ],
        ),
        symmetric=True,
        kind=Kind.SEPARABLE,
        source=f"{BLANES_MOAN}, S_6",
    ),
    Method(
        name="blanes-moan-s10",
        order=6,
        word=palindrome(
            K,
            [
                "0.0502627644003922",
                "0.148816447901042",
                "0.413514300428344",
                "-0.132385865767784",
                "0.0450798897943977",
                "0.067307604692185",
                "-0.188054853819569",
                "0.432666402578175",
                "0.541960678450780",
            ],
        ),
        symmetric=True,
        kind=Kind.SEPARABLE,
        source=f"{BLANES_MOAN}, S_10",
    ),
    Method(
        name="blanes-moan-srkn6b",
        order=4,
        word=palindrome(
            K,
            [
                "0.0829844064174052",
                "0.245298957184271",
                "0.396309801498368",
                "0.604872665711080",
                "-0.0390563049223486",
            ],
        ),
        symmetric=True,
        kind=Kind.NEWTONIAN,
        source=f"{BLANES_MOAN}, SRKN_6^b",
    ),
    Method(
        name="blanes-moan-srkn11b",
        order=6,
        word=palindrome(
            K,
            [
                "0.0414649985182624",
                "0.123229775946271",
                "0.198128671918067",
                "0.290553797799558",
                "-0.0400061921041533",
                "-0.127049212625417",
                "0.0752539843015807",
                "-0.246331761062075",
                "-0.0115113874206879",
                "0.357208872795928",
            ],
        ),
        symmetric=True,
        kind=Kind.NEWTONIAN,
        source=f"{BLANES_MOAN}, SRKN_11^b",
    ),
    Method(
        name="blanes-moan-srkn14a",
        order=6,
        word=palindrome(
            D,
            [
                "0.0378593198406116",
                "0.09171915262446165",
                "0.102635633102435",
                "0.183983170005006",
                "-0.0258678882665587",
                "-0.05653436583288827",
                "0.314241403071447",
                "0.004914688774712854",
                "-0.130144459517415",
                "0.143761127168358",
                "0.106417700369543",
                "0.328567693746804",
                "-0.00879424312851058",
            ],
        ),
        symmetric=True,
        kind=Kind.NEWTONIAN,
        source=f"{BLANES_MOAN}, SRKN_14^a",
    ),
)
