"""The sixth-order Nystroem method of Okunbor and Skeel."""

from kickdrift.core.kinds import Kind
from kickdrift.methods.record import D, Method
from kickdrift.methods.words import palindrome

METHODS = (
    # The root of the order conditions at 60 digits, of which McLachlan (1995) prints 20.
    Method(
        name="okunbor-skeel-6",
        order=6,
        word=palindrome(
            D,
            [
                "-1.013087978917174729814904578488955908639",
                "0.0001660069265000989421747072427969753415071",
                "1.187429573732542707024293320637402200491",
                "-0.3796242142637736060819469079990920603818",
                "-0.01833585209646059034438748840973060841363",
                "0.6891374118518106367408016646578030366064",
            ],
        ),
        symmetric=True,
        kind=Kind.NEWTONIAN,
        source="Okunbor, Skeel, J. Comput. Appl. Math. 51, 375 (1994), method 13",
    ),
)
