"""Scaling of the impulses for warm starting, where the mass of a body changes."""

import numpy as np

from kickdrift.world.contacts.layout import (
    BODY_A,
    BODY_B,
    FRICTION_IMPULSE,
    NORMAL_IMPULSE,
    ROLLING_IMPULSE,
    TWIST_IMPULSE,
)
from kickdrift.world.tables import CONTACT, MANIFOLD, Tables

_COLUMNS = (
    *range(NORMAL_IMPULSE, NORMAL_IMPULSE + 4),
    *range(FRICTION_IMPULSE, FRICTION_IMPULSE + 3),
    *range(ROLLING_IMPULSE, ROLLING_IMPULSE + 3),
    TWIST_IMPULSE,
)


def scale_impulses(tables: Tables, body: int, factor: float) -> None:
    """Scale the impulses of all contacts of a body."""
    contacts = tables.array(CONTACT)
    rows = np.flatnonzero((contacts[:, BODY_A] == body) | (contacts[:, BODY_B] == body))
    tables.array(MANIFOLD)[np.ix_(rows, _COLUMNS)] *= factor
