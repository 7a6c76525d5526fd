"""What a run and an ensemble of runs have in common: their energy, and other names of their states."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import KickdriftError
from kickdrift.engine.description import Description

Floats = NDArray[np.float64]


class Motion:
    """States and conserved quantities at the times kept."""

    x: Floats
    v: Floats
    invariants: Mapping[str, Floats]
    about: Description

    @property
    def energy(self) -> Floats:
        """Energy at the times kept, shape (T,); of M members (M, T).

        Raises
        ------
        KickdriftError
            If the system has no energy.
        """
        if "energy" not in self.invariants:
            raise KickdriftError(
                f"{self.about.system!r} has no energy; pass energy=... to its description, for an acceleration"
                " kd.SecondOrder(acceleration, energy=...)."
            )
        return self.invariants["energy"]

    @property
    def q(self) -> Floats:
        """Positions under the name that they have in Hamiltonians: x."""
        return self.x

    @property
    def p(self) -> Floats:
        """Momenta of a Hamiltonian: v."""
        return self.v

    @property
    def y(self) -> Floats:
        """States of first-order equations: x."""
        return self.x
