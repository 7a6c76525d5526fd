"""The lab: many small scenes in kickdrift, Box3D, rapier3d and MuJoCo, and which engine holds which.

A scene is held where all its criteria are met; they are the same for all engines. What an engine has no means for is a
dash.
"""

import sys
import time
from collections.abc import Sequence

from benchmarks.lab.report import markdown
from benchmarks.lab.running import CONTESTANTS, Contestant, Result, run
from benchmarks.lab.scenes import TRIALS
from benchmarks.lab.trial import Trial
from benchmarks.table import Missing

ENGINES = tuple(contestant.label for contestant in CONTESTANTS)


def report(engines: Sequence[str] = (), scenes: Sequence[str] = ()) -> str:
    """Run the trials whose names have one of some texts in them, in some engines, and write the table; all by default."""
    trials = [trial for trial in TRIALS if not scenes or any(text.lower() in trial.name.lower() for text in scenes)]
    contestants = [one for one in CONTESTANTS if not engines or one.label in engines]
    return markdown([(trial, [_run(trial, one) for one in contestants]) for trial in trials], contestants)


def _run(trial: Trial, contestant: Contestant) -> Result:
    started = time.perf_counter()
    try:
        result = run(trial, contestant)
    except Missing as missing:
        result = Result((), reason=str(missing))
    said = "holds" if result.holds else "-" if not result.runs else "does not hold"
    numbers = result.reason or ", ".join(criterion.said(value) for criterion, value in result.findings)
    took = time.perf_counter() - started
    print(f"{trial.name} | {contestant.label} | {said} | {numbers} | {took:.1f} s", file=sys.stderr, flush=True)
    return result
