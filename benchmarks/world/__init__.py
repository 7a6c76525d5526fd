"""Worlds: kickdrift and other engines of rigid bodies, each at the step that its users take."""

import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np

from benchmarks.table import Missing, Row, measured, skipped
from benchmarks.turns import Costs, in_turns, ratio
from benchmarks.world import judge
from benchmarks.world.cases import CASES, Case
from benchmarks.world.described import Scene
from benchmarks.world.judge import Engine
from benchmarks.world.ours import Kickdrift, described
from kickdrift.world.world import World

_OURS = "kickdrift"


def sections(rounds: int, texts: Sequence[str] = ()) -> list[tuple[str, list[Row]]]:
    """Compare all worlds, or those with one of some texts in their titles."""
    return [
        (f"World: {case.title}; {case.watched:g} s, {case.timed:g} s measured", _compare(case, rounds))
        for case in CASES
        if not texts or any(text in case.title for text in texts)
    ]


def _compare(case: Case, rounds: int) -> list[Row]:
    scene = described(_world(case))
    runs = {name: _Run(case, scene, make, case.step) for name, make in _ours(case).items()}
    rows = []
    for rival in case.rivals:
        run = _Run(case, scene, partial(rival.make, scene), rival.step)
        try:
            run.look()
        except Missing as missing:
            rows.append(skipped(rival.label, str(missing)))
            continue
        runs[rival.label] = run
    for name in _ours(case):
        runs[name].look()
    costs = in_turns({label: run.measure for label, run in runs.items()}, min(rounds, case.most_rounds))
    return [*(_row(label, run, costs) for label, run in runs.items()), *rows]


def _ours(case: Case) -> Mapping[str, Callable[[float], Engine]]:
    """Kickdrift with each number of substeps, the usual one first."""

    def make(step: float, substeps: int) -> Engine:
        world = _world(case)
        world.substeps = substeps
        return Kickdrift(world, step)

    usual, *others = case.substeps
    return {_OURS: partial(make, substeps=usual)} | {
        f"{_OURS}, substeps={number}": partial(make, substeps=number) for number in others
    }


def _world(case: Case) -> World:
    made = case.scene()
    return made if isinstance(made, World) else made.world


class _Run:
    """A world in one engine: what its judges say, and what a second of it costs."""

    def __init__(self, case: Case, scene: Scene, make: Callable[[float], Engine], step: float) -> None:
        self._case, self._scene, self._make, self.step = case, scene, make, step
        self.verdicts = ""

    def look(self) -> None:
        """Watch it once."""
        watched = self._watched(self.step)
        finite = bool(np.isfinite(watched.poses).all())
        said = [one(self._scene, watched) for one in self._case.judges] if finite else ["lost to infinity"]
        if self._case.fine_step is not None and finite:
            said.append(judge.strayed(self._scene, watched, self._watched(self._case.fine_step)))
        self.verdicts = "; ".join(said)

    def _watched(self, step: float) -> judge.Watched:
        engine = self._make(step)
        watched = judge.watch(engine, step, self._case.watched)
        _let_go(engine)
        return watched

    def measure(self) -> float:
        """Seconds that one second of the world takes, from its start, without the first step, in which engines set up."""
        engine = self._make(self.step)
        engine.step()
        steps = round(self._case.timed / self.step)
        started = time.perf_counter()
        for _ in range(steps):
            engine.step()
        seconds = time.perf_counter() - started
        _let_go(engine)
        return seconds / (steps * self.step)


def _row(label: str, run: _Run, costs: Costs) -> Row:
    per_step = np.median(costs[label]) * run.step * 1e3
    note = f"{per_step:.2g} ms a step of {run.step * 1e3:.3g} ms; {run.verdicts}"
    if label == _OURS:
        return measured(f"{label}, times real time", 1 / costs[label], note=note)
    return measured(f"{label} / {_OURS}", ratio(costs, label, _OURS), note=note)


def _let_go(engine: Engine) -> None:
    """Free what an engine keeps outside of Python."""
    close = getattr(engine, "close", None)
    if close is not None:
        close()
