"""Steps done in parts: a step too long for its impacts or the rotation of touching bodies is halved as often as necessary.

Parts that turn out too long are tried in vain, and cost the more the longer they are. So the next step begins with parts four
times as long as the shortest ones, unless a linkage was the cause.

A part is a step of its own, with a search at its start. Substeps keep their length where the parts divide their number, or get
shorter; parts shorter than one are one substep each. Forces of joints are means over all parts, the residual is the largest.
"""

from collections.abc import Callable

import numpy as np

from kickdrift.core.errors import KickdriftError
from kickdrift.world.joints.layout import TOTAL
from kickdrift.world.settings import RESIDUAL
from kickdrift.world.snapshot import kept, put_back
from kickdrift.world.step.status import DO_LINKAGE_IN_PARTS, EXPECTED_HALVINGS, HALVINGS, MIDWAY, OK
from kickdrift.world.tables import JOINT_NUMBERS, LOAD, SETTINGS, STEP_STATUS, Tables

# 250 hulls of 2 cm that tumble onto each other need 32 parts, which take 70 ms; longer ones, tried before, took 280 ms. With 1,
# a body that needs many parts now and then takes longer.
_FEWER = 2  # halvings less than in the step before


def do_parts(do_part: Callable[[int, int], int], tables: Tables, cause: int) -> None:
    """Do a step in parts; if one fails, the world is restored to the beginning of the step, to the last bit.

    Parameters
    ----------
    do_part : callable
        Does a part, given its number and the number of parts of its length; returns `OK`, or the status with which a stage
        requested that it is halved.
    tables : Tables
        Of the world, at the beginning of the step.
    cause : int
        The status with which a stage requested parts of the step, or `OK` if they were expected.
    """
    loads, status = (before := kept(tables))["LOAD"], tables.row(STEP_STATUS, 0)
    part, parts = 0, 2 << max(int(status[EXPECTED_HALVINGS]) - 1, 0)
    forces = tables.array(JOINT_NUMBERS)[:, TOTAL : TOTAL + 6]
    causes, mean, settings, residual = {cause}, np.zeros_like(forces), tables.row(SETTINGS, 0), 0.0
    try:
        while part < parts:
            tables.put(LOAD, loads)
            status[HALVINGS] = parts.bit_length() - 1
            causes.add(halved := do_part(part, parts))
            if halved == OK:
                mean += forces / parts
                residual = max(residual, settings[RESIDUAL])
                part += 1
            else:
                part, parts = 2 * part, 2 * parts
        forces[:], settings[RESIDUAL] = mean, residual
        expected = 0 if DO_LINKAGE_IN_PARTS in causes else max(parts.bit_length() - 1 - _FEWER, 0)
        tables.row(STEP_STATUS, 0)[EXPECTED_HALVINGS] = expected
    except BaseException as error:
        put_back(tables, before)
        if isinstance(error, KickdriftError):
            tables.array(LOAD)[:] = 0.0
        tables.row(STEP_STATUS, 0)[MIDWAY] = 0
        raise
    finally:
        tables.row(STEP_STATUS, 0)[HALVINGS] = 0
