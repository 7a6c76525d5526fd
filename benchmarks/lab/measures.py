"""Numbers of a run that the trials are judged by: speeds, distances, overlaps, energies."""

from collections.abc import Sequence
from functools import partial

import numpy as np

from benchmarks.lab.trial import Criterion, Measure
from benchmarks.table import Missing
from benchmarks.world.described import Floats, Scene, Unsupported
from benchmarks.world.judge import Watched, energies, gaps
from benchmarks.world.mujoco import Depths

_SLOW = 0.05  # m/s at which Box3D and kickdrift would let a body sleep; the report counts what really rests


def rests(most: float = _SLOW) -> Criterion:
    """Want nothing to move in the last quarter: the largest component of any velocity."""
    return Criterion("speed", "m/s", _speed, most=most)


def speed() -> Criterion:
    """Measure the same, and want nothing of it."""
    return Criterion("speed", "m/s", _speed)


def stays(most: float, bodies: Sequence[int] | None = None) -> Criterion:
    """Want the body that moved most sideways to be near where it began."""
    return Criterion("off", "m", partial(_aside, bodies=bodies), most=most)


def sinks(most: float) -> Criterion:
    """Want the body that went down most not to have gone far."""
    return Criterion("sinks", "m", _down, most=most)


def overlaps(most: float) -> Criterion:
    """Want bodies not to be deep in each other in the end, by MuJoCo's collision; unknown without it."""
    return Criterion("overlap", "m", _overlap, most=most)


def apart(most: float) -> Criterion:
    """Want the ends of all joints together, at worst."""
    return Criterion("joints apart", "m", _apart, most=most)


def gains(most: float = 0.01) -> Criterion:
    """Want no body's energy above the ground to rise over its start, each body on its own."""
    return Criterion("gains", "", _gain, most=most)


def loses(most: float = 0.01) -> Criterion:
    """Want no body's energy above the ground to fall below its start, each body on its own."""
    return Criterion("loses", "", _loss, most=most)


def keeps(within: float = 0.01, spread: float | None = None) -> Criterion:
    """Want the energy of all to stay, within a part of `spread` in J or of the largest kinetic energy."""
    return Criterion("energy off", "", partial(_off, spread=spread), most=within)


def rises(most: float) -> Criterion:
    """Want the energy of all never to rise over its start."""
    return Criterion("energy gained", "J", _rise, most=most)


def comes_to(label: str, unit: str, measure: Measure, exact: float, within: float = 0.01) -> Criterion:
    """Want a number that mechanics gives, within a part of it."""
    margin = within * abs(exact)
    return Criterion(label, unit, measure, exact - margin, exact + margin, exact)


def at_most(label: str, unit: str, measure: Measure, most: float) -> Criterion:
    """Want a number to be no larger."""
    return Criterion(label, unit, measure, most=most)


def _last(watched: Watched) -> slice:
    return slice(-max(len(watched.times) // 4, 1), None)


def _speed(scene: Scene, watched: Watched) -> float:
    return float(np.abs(watched.motions[_last(watched), scene.moving, :3]).max())


def _aside(scene: Scene, watched: Watched, bodies: Sequence[int] | None) -> float:
    moving = scene.moving if bodies is None else list(bodies)
    moved = watched.poses[:, moving, :3] - watched.poses[0, moving, :3]
    up = _up(scene)
    sideways = moved - np.multiply.outer(moved @ up, up)
    return float(np.linalg.norm(sideways[-1], axis=-1).max())


def _down(scene: Scene, watched: Watched) -> float:
    moved = watched.poses[-1, scene.moving, :3] - watched.poses[0, scene.moving, :3]
    return float(max(0.0, -(moved @ _up(scene)).min()))


def _up(scene: Scene) -> Floats:
    size = np.linalg.norm(scene.gravity)
    return -scene.gravity / size if size > 0 else np.zeros(3)


def _overlap(scene: Scene, watched: Watched) -> float:
    try:
        return Depths(scene).deepest(watched.poses[-1])
    except (Missing, Unsupported):
        return np.nan


def _apart(scene: Scene, watched: Watched) -> float:
    return float(max(gaps(scene, poses).max() for poses in watched.poses))


def _gain(scene: Scene, watched: Watched) -> float:
    energy = _above_ground(scene, watched)
    return float((energy.max(axis=0) / energy[0] - 1).max())


def _loss(scene: Scene, watched: Watched) -> float:
    energy = _above_ground(scene, watched)
    return float((1 - energy.min(axis=0) / energy[0]).max())


def _above_ground(scene: Scene, watched: Watched) -> Floats:
    """Energies of what moves, (T, N)."""
    mass = np.array([scene.bodies[i].mass for i in scene.moving])
    inertia = np.array([scene.bodies[i].inertia for i in scene.moving])
    x, q = watched.poses[:, scene.moving, :3], watched.poses[:, scene.moving, 3:]
    v, w = watched.motions[:, scene.moving, :3], watched.motions[:, scene.moving, 3:]
    spin = turned_back(q, w)
    return np.asarray(((mass * (v**2).sum(-1)) + (inertia * spin**2).sum(-1)) / 2 - mass * (x @ scene.gravity))


def turned_back(q: Floats, v: Floats) -> Floats:
    """Turn vectors by the inverses of quaternions (w, x, y, z)."""
    w, u = q[..., :1], -q[..., 1:]
    t = 2 * np.cross(u, v)
    return np.asarray(v + w * t + np.cross(u, t))


def _off(scene: Scene, watched: Watched, spread: float | None) -> float:
    kinetic, whole = np.array([energies(scene, p, m) for p, m in zip(watched.poses, watched.motions, strict=True)]).T
    return float(np.abs(whole - whole[0]).max() / (kinetic.max() if spread is None else spread))


def _rise(scene: Scene, watched: Watched) -> float:
    whole = [energies(scene, p, m)[1] for p, m in zip(watched.poses, watched.motions, strict=True)]
    return float(max(whole) - whole[0])
