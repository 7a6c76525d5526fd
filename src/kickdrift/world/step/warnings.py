"""Warnings of the solver: each kind once per world, with a remedy."""

import math
import warnings

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import UnsolvedWarning, depth_of_caller
from kickdrift.world.bodies.registry import Bodies
from kickdrift.world.direct.substep_estimate import LONG_TURN
from kickdrift.world.layout import LINK_PLACE
from kickdrift.world.settings import (
    BOUNCING_TIME,
    FAST_BODY,
    FAST_LOSS,
    FAST_RATE,
    FAST_SINCE,
    FAST_SUBSTEP,
    FAST_TIME,
    JAMMED_BODY,
    JAMMED_SINCE,
    MISSED_BODY,
    MISSED_TIME,
    STEP,
    SUBSTEPS,
    UNSOLVED_BODY,
    UNSOLVED_SINCE,
)
from kickdrift.world.step.status import (
    BOUNCING_BODY,
    LEFT_BOUNCING,
    LEFT_JAMMED,
    LEFT_UNSOLVED,
    MISSES_CONTACT,
    SAID,
    TURNS_TOO_FAST,
)
from kickdrift.world.tables import BODY, SETTINGS, STEP_STATUS, Tables


def say(found: int, said: int, tables: Tables, bodies: Bodies) -> None:
    """Issue the warnings that stages have found, unless they were issued before.

    `found` and `said` are sets of bits of `kickdrift.world.step.status.WARNING`. Their union is written to the tables, so that
    compiled code does not return for it again; the world keeps it as well, since restoring a snapshot resets the tables.
    """
    tables.array(STEP_STATUS)[0, SAID] = found | said
    for bit, sentence in _SENTENCES.items():
        if found & ~said & bit:
            warnings.warn(sentence(tables, bodies), UnsolvedWarning, stacklevel=depth_of_caller())


def _finer(row: NDArray[np.float64]) -> str:
    """Return the advice to use more substeps, or a smaller step."""
    return f"Use more substeps, such as world.substeps = {2 * int(row[SUBSTEPS])}, or a smaller step than {row[STEP]:.3g} s"


def _unsolved(tables: Tables, bodies: Bodies) -> str:
    """Return the message of LEFT_UNSOLVED."""
    row = tables.array(SETTINGS)[0]
    return (
        f"{bodies.words(int(row[UNSOLVED_BODY]))} rests on contacts that the solver has left unsolved since"
        f" t={row[UNSOLVED_SINCE]:.3g} s: its heap sinks or creeps, and world.residual measures how fast."
        f" {_finer(row)}."
    )


def _missed(tables: Tables, bodies: Bodies) -> str:
    row = tables.array(SETTINGS)[0]
    return (
        f"{bodies.words(int(row[MISSED_BODY]))} was struck so often in the step to t={row[MISSED_TIME]:.4g} s that it may have"
        f" passed through what it met there. Use a smaller step than {row[STEP]:.3g} s."
    )


def _bouncing(tables: Tables, bodies: Bodies) -> str:
    """Return the message of LEFT_BOUNCING."""
    row, body = tables.array(SETTINGS)[0], int(tables.array(STEP_STATUS)[0, BOUNCING_BODY])
    return (
        f"{bodies.words(body)} and what it touches hit each other so often in the substep from t={row[BOUNCING_TIME]:.4g} s"
        f" that not all of these impacts were resolved. Use a smaller step than {row[STEP]:.3g} s, or masses that differ less."
    )


def _too_fast(tables: Tables, bodies: Bodies) -> str:
    """Return the message of TURNS_TOO_FAST."""
    row = tables.array(SETTINGS)[0]
    substep, body = row[STEP] / row[SUBSTEPS], bodies.words(int(row[FAST_BODY]))
    turn, times = float(row[FAST_RATE] * substep), substep / row[FAST_SUBSTEP]
    why = f"{body} turns by {turn:.2g} rad in a substep, too far for its joints"
    if turn <= LONG_TURN:
        why = (
            f"the joints of {body} and of the bodies joined to it move too far in a substep for impulses that satisfy them at"
            " its end"
        )
    substeps, step = math.ceil(row[SUBSTEPS] * times), _rounded_down(row[STEP] / times)
    advice = f"Set world.substeps = {substeps}, or use a step of {step:.2g} s."
    if tables.array(BODY)[int(row[FAST_BODY]), LINK_PLACE] < 0:
        why = f"the joints of {body} and of the bodies joined to it close too many loops to be solved together"
        advice = "More substeps help little: use fewer joints or bodies, or a cloth."
    part, end = 100 * row[FAST_LOSS], row[FAST_TIME]
    change = f"{'lost' if part > 0.0 else 'gained'} {abs(part):.2g} %"
    when = f"in the step to t={end:.4g} s"
    if end - row[FAST_SINCE] > 1.5 * row[STEP]:
        when = f"from t={row[FAST_SINCE]:.4g} s to {end:.4g} s"
    return f"{why}: they {change} of the energy of their bodies {when}. {advice}"


def _jammed(tables: Tables, bodies: Bodies) -> str:
    """Return the message of LEFT_JAMMED."""
    row = tables.array(SETTINGS)[0]
    return (
        f"the joints and the contacts of {bodies.words(int(row[JAMMED_BODY]))} and of the bodies joined to it have had no"
        f" solution together since t={row[JAMMED_SINCE]:.3g} s, so that bodies may sink into each other."
        f" {_finer(row)}, or masses that differ less."
    )


def _rounded_down(step: float) -> float:
    """Return a step, s, rounded down to two digits."""
    digit = 10.0 ** (math.floor(math.log10(step)) - 1)
    return math.floor(step / digit) * digit


_SENTENCES = {
    LEFT_UNSOLVED: _unsolved, TURNS_TOO_FAST: _too_fast, MISSES_CONTACT: _missed, LEFT_BOUNCING: _bouncing,
    LEFT_JAMMED: _jammed,
}  # fmt: skip
