"""How a trial is run in an engine, and what comes of it."""

import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Protocol

import numpy as np

from benchmarks.lab.ours import Kickdrift
from benchmarks.lab.trial import Criterion, Trial
from benchmarks.world.box3d import Box3d
from benchmarks.world.described import Floats, Scene, Unsupported
from benchmarks.world.judge import Watched
from benchmarks.world.mujoco import Mujoco
from benchmarks.world.rapier import Rapier
from kickdrift import KickdriftError, LostBodyError


class Engine(Protocol):
    """A scene in an engine that takes forces."""

    def advance(self, count: int) -> None:
        """Take so many steps."""
        ...

    def push(self, body: int, force: Floats) -> None:
        """Let a force act until `advance` returns."""
        ...

    def poses(self) -> Floats:
        """Positions and orientations, (N, 7)."""
        ...

    def motions(self) -> Floats:
        """Velocities and angular velocities, (N, 6)."""
        ...


@dataclass(frozen=True)
class Contestant:
    """An engine with its defaults, at the step that its users take."""

    label: str
    make: Callable[[Scene, float], Engine]
    step: float


CONTESTANTS = (
    Contestant("kickdrift", Kickdrift, 1 / 60),
    Contestant("Box3D", Box3d, 1 / 60),
    Contestant("rapier3d", Rapier, 1 / 60),
    Contestant("MuJoCo", partial(Mujoco, integrator="Euler"), 0.005),
)


@dataclass(frozen=True)
class Result:
    """What came of a trial.

    Attributes
    ----------
    findings : tuple of (Criterion, float)
        Of the scene that is worst at each; empty where the engine cannot run it.
    cost, slow : float
        Time of a step, s: the median, and that below which nine in ten are.
    reason : str
        Why there is nothing, or the error that ended it.
    refused : bool
        Whether the engine said that it cannot, and the trial accepts that.
    """

    findings: tuple[tuple[Criterion, float], ...]
    cost: float = np.nan
    slow: float = np.nan
    reason: str = ""
    refused: bool = False

    @property
    def runs(self) -> bool:
        """Whether the engine could express the trial."""
        return self.refused or bool(self.findings)

    @property
    def holds(self) -> bool:
        """Whether all is as wanted."""
        return self.refused or (
            bool(self.findings) and all(criterion.holds(value) for criterion, value in self.findings)
        )


def run(trial: Trial, contestant: Contestant) -> Result:
    """Run all scenes of a trial."""
    found, costs = [], []
    for scene in trial.scenes:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # what a run comes to is measured
                watched, cost = _watch(trial, scene, contestant)
        except Unsupported as reason:
            return Result((), reason=str(reason))
        except KickdriftError as reason:
            if trial.refusable and not isinstance(reason, LostBodyError):
                return Result((), reason=str(reason), refused=True)
            return Result(tuple((criterion, np.inf) for criterion in trial.criteria), reason=str(reason))
        found.append([_measured(criterion, scene, watched) for criterion in trial.criteria])
        costs.append(cost)
    worst = tuple(
        (criterion, max(values, key=partial(_badness, criterion)))
        for criterion, values in zip(trial.criteria, zip(*found, strict=True), strict=True)
    )
    return Result(worst, *np.median(costs, axis=0).tolist())


def _measured(criterion: Criterion, scene: Scene, watched: Watched) -> float:
    if not (np.isfinite(watched.poses).all() and np.isfinite(watched.motions).all()):
        return np.inf
    return criterion.measure(scene, watched)


def _badness(criterion: Criterion, value: float) -> float:
    """How far beyond its bounds a value is."""
    return max(value - criterion.most, criterion.least - value)


def _watch(trial: Trial, scene: Scene, contestant: Contestant) -> tuple[Watched, Floats]:
    """Run a scene and look now and then; return that, and the median and the ninth decile of the time of a step."""
    step = contestant.step
    engine = contestant.make(scene, step)
    try:
        times, poses, motions, costs = [0.0], [engine.poses()], [engine.motions()], []
        done = 0
        for look in range(1, trial.looks + 1):
            wanted = round(look * trial.duration / trial.looks / step)
            if wanted == done:
                continue
            started = time.perf_counter()
            _advance(engine, scene, done, wanted, step)
            costs.append((time.perf_counter() - started) / (wanted - done))
            done = wanted
            times.append(done * step)
            poses.append(engine.poses())
            motions.append(engine.motions())
            if not np.isfinite(poses[-1]).all():
                break  # what is lost stays so, and MuJoCo takes minutes over it
    finally:
        close = getattr(engine, "close", None)
        if close is not None:
            close()
    return Watched(np.array(times), np.array(poses), np.array(motions)), np.quantile(costs, (0.5, 0.9))


def _advance(engine: Engine, scene: Scene, done: int, wanted: int, step: float) -> None:
    if not scene.loads:
        engine.advance(wanted - done)
        return
    for number in range(done, wanted):
        for load in scene.loads:
            if load.begin <= (number + 1e-9) * step < load.end:
                engine.push(load.body, load.force)
        engine.advance(1)
