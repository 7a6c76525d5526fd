"""The trials of the lab, by what they are about."""

from benchmarks.lab.scenes import plates, towers
from benchmarks.lab.trial import Trial

TRIALS: tuple[Trial, ...] = (*towers.TRIALS, *plates.TRIALS)
