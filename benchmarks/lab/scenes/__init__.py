"""The trials of the lab, by what they are about."""

from benchmarks.lab.scenes import (
    crowds,
    friction,
    hinged,
    impacts,
    landing,
    motors,
    planar,
    plates,
    polyhedra,
    rows,
    samples,
    stacks,
    swinging,
    towers,
)
from benchmarks.lab.trial import Trial

TRIALS: tuple[Trial, ...] = (
    *towers.TRIALS,
    *stacks.TRIALS,
    *plates.TRIALS,
    *polyhedra.TRIALS,
    *samples.TRIALS,
    *friction.TRIALS,
    *motors.TRIALS,
    *planar.TRIALS,
    *landing.TRIALS,
    *impacts.TRIALS,
    *rows.TRIALS,
    *hinged.TRIALS,
    *swinging.TRIALS,
    *crowds.TRIALS,
)
