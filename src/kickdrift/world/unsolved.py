"""Warnings of what the solver could not do: once a world, with what would help."""

import math
import warnings

from kickdrift.core.errors import UnsolvedWarning, depth_of_caller
from kickdrift.world.bodies import Bodies
from kickdrift.world.flight import LEFT_FOR
from kickdrift.world.settings import FAST_BODY, FAST_LOSS, FAST_TURN, RESIDUAL, STEP, SUBSTEPS, UNSOLVED_BODY
from kickdrift.world.step_status import LEFT_UNSOLVED, TURNS_TOO_FAST
from kickdrift.world.tables import BODY, SETTINGS, Tables

_TURN = 0.5  # rad: of a substep that is short enough


def warn(found: int, tables: Tables, bodies: Bodies, time: float) -> None:
    """Say what stages have found by a time: a set of bits of `kickdrift.world.step_status.WARNING`."""
    for bit, sentence in ((LEFT_UNSOLVED, _unsolved), (TURNS_TOO_FAST, _too_fast)):
        if found & bit:
            warnings.warn(sentence(tables, bodies, time), UnsolvedWarning, stacklevel=depth_of_caller())


def _unsolved(tables: Tables, bodies: Bodies, time: float) -> str:
    row = tables.array(SETTINGS)[0]
    body, step, substeps = int(row[UNSOLVED_BODY]), float(row[STEP]), int(row[SUBSTEPS])
    since = max(time - float(tables.array(BODY)[body, LEFT_FOR]) * step, 0.0)
    return (
        f"{bodies.words(body)} rests on contacts that the solver has left unsolved since t={since:.3g} s: world.residual is"
        f" {row[RESIDUAL]:.2g} m/s, so that its heap sinks or creeps. Take more substeps, as world.substeps = {2 * substeps},"
        f" or a smaller step than {step:.3g} s."
    )


def _too_fast(tables: Tables, bodies: Bodies, time: float) -> str:
    row = tables.array(SETTINGS)[0]
    step, substeps, turn = float(row[STEP]), int(row[SUBSTEPS]), float(row[FAST_TURN])
    times = max(turn / _TURN, 2.0)
    return (
        f"{bodies.words(int(row[FAST_BODY]))} turns by {turn:.2g} rad in a substep, too far for its joints, which have lost"
        f" {100 * row[FAST_LOSS]:.2g} % of their bodies' energy in the step that ended by t={time:.3g} s. Take"
        f" world.substeps = {math.ceil(substeps * times)}, or a step of {step / times:.2g} s, so that it turns by less."
    )
