"""Steps done in parts: a step too long for its impacts or the rotation of touching bodies is halved as often as necessary.

Parts that turn out too long are tried in vain, and cost the more the longer they are. So the step after begins with parts that
are halved `_FEWER` times less than the shortest of this one.

A part is a step of its own, with a search at its start. Substeps keep their length where the parts divide their number, or get
shorter; parts shorter than one are one substep each. Forces of joints are means over all parts, the residual is the largest.
"""

from collections.abc import Callable

import numpy as np

from kickdrift.core.errors import KickdriftError
from kickdrift.world.joints.layout import TOTAL
from kickdrift.world.settings import RESIDUAL
from kickdrift.world.snapshot import kept, put_back
from kickdrift.world.step.status import EXPECTED_HALVINGS, HALVINGS, MIDWAY, NONE_EXPECTED
from kickdrift.world.tables import JOINT_NUMBERS, LOAD, SETTINGS, STEP_STATUS, Tables

# 250 hulls of 2 cm that tumble onto each other need 32 parts: 70 of the 350 ms of a step that tried the whole first. With 1, a
# body that needs many parts now and then takes longer.
_FEWER = 2  # halvings less than in the step before


def do_parts(do_part: Callable[[int, int], bool], tables: Tables) -> None:
    """Do a step in parts; if one fails, the world is restored to the beginning of the step, to the last bit.

    Parameters
    ----------
    do_part : callable
        Does a part, given its number and the number of parts of its length; returns False if it must be halved.
    tables : Tables
        Of the world, at the beginning of the step.
    """
    loads, status = (before := kept(tables))["LOAD"], tables.row(STEP_STATUS, 0)
    part, parts = 0, 2 << max(int(status[EXPECTED_HALVINGS]) - 1, 0)
    forces = tables.array(JOINT_NUMBERS)[:, TOTAL : TOTAL + 6]
    shortest, mean, settings, residual = parts, np.zeros_like(forces), tables.row(SETTINGS, 0), 0.0
    try:
        while part < parts:
            tables.put(LOAD, loads)
            status[HALVINGS] = parts.bit_length() - 1
            if do_part(part, parts):
                mean += forces / parts
                residual = max(residual, settings[RESIDUAL])
                part += 1
            else:
                part, parts = 2 * part, 2 * parts
                shortest = parts
        forces[:], settings[RESIDUAL] = mean, residual
        status = tables.row(STEP_STATUS, 0)
        halvings = 0 if status[EXPECTED_HALVINGS] == NONE_EXPECTED else shortest.bit_length() - 1
        status[EXPECTED_HALVINGS] = max(halvings - _FEWER, 0)
    except BaseException as error:
        put_back(tables, before)
        if isinstance(error, KickdriftError):
            tables.array(LOAD)[:] = 0.0
        tables.row(STEP_STATUS, 0)[MIDWAY] = 0
        raise
    finally:
        tables.row(STEP_STATUS, 0)[HALVINGS] = 0
