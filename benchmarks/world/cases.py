"""Which worlds are compared, with whom, and what of."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from benchmarks.world import judge
from benchmarks.world.box3d import Box3d
from benchmarks.world.bullet import Bullet
from benchmarks.world.described import Scene
from benchmarks.world.judge import Engine, Judge
from benchmarks.world.mujoco import Mujoco
from benchmarks.world.rapier import Rapier
from kickdrift.scenes import worlds

Make = Callable[[Scene, float], Engine]


@dataclass(frozen=True)
class Rival:
    """An engine as its users take it.

    Attributes
    ----------
    label : str
    make : callable
        Of a scene and a step.
    step : float
        s.
    """

    label: str
    make: Make
    step: float


@dataclass(frozen=True)
class Case:
    """A world, who runs it, and what it is judged by.

    Attributes
    ----------
    title : str
    scene : callable
        Makes the world, or what has it as its `world`.
    watched, timed : float
        Seconds of the world: for the judges, from its start, and then for each measurement.
    judges : tuple of callable
    rivals : tuple of Rival
    step : float
        kickdrift's, s.
    most_rounds : int
        Of measurements.
    substeps : tuple of int
        Of kickdrift's steps: the usual number, and others to be compared.
    fine_step : float, optional
        s; what each engine does with it is what its usual step is judged by.
    """

    title: str
    scene: Callable[[], Any]
    watched: float
    timed: float
    judges: tuple[Judge, ...]
    rivals: tuple[Rival, ...]
    step: float = 1 / 60
    most_rounds: int = 5
    substeps: tuple[int, ...] = (4,)
    fine_step: float | None = None


BOX3D = Rival("Box3D", Box3d, 1 / 60)
RAPIER = Rival("rapier3d", Rapier, 1 / 60)
THREADS = Rival("rapier3d, 2 threads", partial(Rapier, threads=2), 1 / 60)
REDUCED = Rival("rapier3d, multibody", partial(Rapier, reduced=True), 1 / 60)
BULLET = Rival("PyBullet", Bullet, 1 / 60)
SLOW_BULLET = Rival("PyBullet, 1/240 s", Bullet, 1 / 240)
MUJOCO = Rival("MuJoCo, 5 ms", Mujoco, 0.005)
FINE = Rival("MuJoCo, 2 ms", Mujoco, 0.002)
GRADIENTS = Rival("MuJoCo, 5 ms, CG", partial(Mujoco, solver="CG"), 0.005)
FINE_GRADIENTS = Rival("MuJoCo, 2 ms, CG", partial(Mujoco, solver="CG"), 0.002)
RUNGE_KUTTA = Rival("MuJoCo, 5 ms, RK4", partial(Mujoco, integrator="RK4"), 0.005)
FINE_RUNGE_KUTTA = Rival("MuJoCo, 2 ms, RK4", partial(Mujoco, integrator="RK4"), 0.002)

_STACK = (judge.drift, judge.depth)
_MACHINE = (judge.stretch, judge.energy)
CASES = (
    Case("Pyramid of 55 boxes", worlds.pyramid, 5.0, 1.0, _STACK, (BOX3D, RAPIER, THREADS, MUJOCO, FINE, BULLET)),
    Case(
        "Pyramid of 210 boxes", partial(worlds.pyramid, base=20), 5.0, 0.5, _STACK,
        (BOX3D, RAPIER, THREADS, MUJOCO, FINE, BULLET),
    ),
    Case("Pyramid of 5050 boxes", partial(worlds.pyramid, base=100), 5.0, 0.5, _STACK, (BOX3D, RAPIER, THREADS)),
    Case(
        "Pile of 1000 boxes", worlds.pile, 5.0, 5.0, (judge.depth, judge.rest),
        (BOX3D, RAPIER, THREADS, MUJOCO, BULLET), most_rounds=3,
    ),
    Case("Grid of 30 x 30 balls on joints", worlds.joint_grid, 3.0, 1.0, _MACHINE, (RAPIER, MUJOCO, BULLET)),
    Case(
        "Sixteen ragdolls", worlds.ragdolls, 5.0, 5.0, (judge.stretch, judge.depth, judge.rest),
        (RAPIER, GRADIENTS, FINE_GRADIENTS, SLOW_BULLET), most_rounds=3,
    ),
    Case(
        "Chain of 20 links, 10 : 1", partial(worlds.chain, ratio=10.0), 5.0, 5.0, _MACHINE,
        (RAPIER, REDUCED, MUJOCO, FINE, RUNGE_KUTTA, FINE_RUNGE_KUTTA, BULLET, SLOW_BULLET),
    ),
    Case(
        "Chain of 20 links, 1000 : 1", worlds.chain, 5.0, 5.0, _MACHINE,
        (RAPIER, REDUCED, MUJOCO, FINE, RUNGE_KUTTA, FINE_RUNGE_KUTTA, BULLET, SLOW_BULLET),
    ),
    Case(
        "Quadruped on springs", worlds.quadruped, 5.0, 5.0, (judge.drift, judge.stretch, judge.depth),
        (RAPIER, MUJOCO, FINE, SLOW_BULLET), step=0.02, substeps=(4, 2, 1), fine_step=0.0005,
    ),
)  # fmt: skip
