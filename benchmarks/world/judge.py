"""What a run of a world is judged by, the same for every engine: positions and velocities at some times."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from benchmarks.world.described import GROUND, Floats, Scene, inverse, rotation
from benchmarks.world.mujoco import Depths


class Engine(Protocol):
    """A scene in an engine."""

    def step(self) -> object:
        """Take a step."""
        ...

    def poses(self) -> Floats:
        """Positions and orientations, (N, 7)."""
        ...

    def motions(self) -> Floats:
        """Velocities and angular velocities, (N, 6)."""
        ...


@dataclass(frozen=True)
class Watched:
    """Where bodies were at some times, the start among them.

    Attributes
    ----------
    times : (T,) array
        s.
    poses, motions : (T, N, 7) and (T, N, 6) arrays
    """

    times: Floats
    poses: Floats
    motions: Floats


Judge = Callable[[Scene, Watched], str]


def watch(engine: Engine, step: float, duration: float, looks: int = 50) -> Watched:
    """Run for a time and look now and then, at times that do not depend on the step."""
    times, poses, motions = [0.0], [engine.poses()], [engine.motions()]
    done = 0
    for look in range(1, looks + 1):
        wanted = round(look * duration / looks / step)
        for _ in range(wanted - done):
            engine.step()
        done = wanted
        times.append(done * step)
        poses.append(engine.poses())
        motions.append(engine.motions())
    return Watched(np.array(times), np.array(poses), np.array(motions))


def drift(scene: Scene, watched: Watched) -> str:
    """How far a body is from where it began, in the end."""
    moved = watched.poses[-1, :, :3] - watched.poses[0, :, :3]
    return f"drift {100 * np.linalg.norm(moved[scene.moving], axis=1).max():.2g} cm"


def strayed(scene: Scene, watched: Watched, fine: Watched) -> str:
    """How far a body was from where the same engine takes it with short steps, at worst."""
    apart = watched.poses[:, scene.moving, :3] - fine.poses[:, scene.moving, :3]
    return f"off its own limit by {1e3 * np.linalg.norm(apart, axis=2).max():.2g} mm"


def depth(scene: Scene, watched: Watched) -> str:
    """How deep bodies were in each other at worst, by MuJoCo's collision."""
    depths = Depths(scene)
    deep = [depths.deepest(poses) for poses in watched.poses]
    return f"overlap {1e3 * max(deep):.2g} mm, in the end {1e3 * deep[-1]:.2g} mm"


def rest(scene: Scene, watched: Watched) -> str:
    """How fast the fastest body is in the end."""
    return f"fastest {np.linalg.norm(watched.motions[-1, scene.moving, :3], axis=1).max():.2g} m/s in the end"


def stretch(scene: Scene, watched: Watched) -> str:
    """How far the ends of a joint were apart at worst, over all times and at half of them."""
    widest = 1e3 * np.array([gaps(scene, poses).max() for poses in watched.poses])
    return (
        f"joints apart by {np.nanmax(widest):.2g} mm, at half of the times by less than {np.nanmedian(widest):.1g} mm"
    )


def energy(scene: Scene, watched: Watched) -> str:
    """Largest error of the energy, over the largest kinetic energy."""
    kinetic, whole = np.array([energies(scene, p, m) for p, m in zip(watched.poses, watched.motions, strict=True)]).T
    with np.errstate(invalid="ignore"):
        return f"energy off by {100 * np.max(np.abs(whole - whole[0])) / np.max(kinetic):.2g} %"


def gaps(scene: Scene, poses: Floats) -> Floats:
    """How far the two ends of each joint are apart."""

    def end(body: int, anchor: Floats) -> Floats:
        if body == GROUND:
            return anchor
        made = scene.bodies[body]
        local = rotation(inverse(made.orientation)) @ (anchor - made.position)
        return poses[body, :3] + rotation(poses[body, 3:]) @ local

    return np.array([np.linalg.norm(end(j.a, j.anchor) - end(j.b, j.anchor)) for j in scene.joints])


def energies(scene: Scene, poses: Floats, motions: Floats) -> tuple[float, float]:
    """Kinetic energy, and with that of gravity."""
    kinetic = potential = 0.0
    for i in scene.moving:
        body = scene.bodies[i]
        spin = rotation(poses[i, 3:]).T @ motions[i, 3:]
        kinetic += (body.mass * motions[i, :3] @ motions[i, :3] + body.inertia @ (spin * spin)) / 2
        potential -= body.mass * scene.gravity @ poses[i, :3]
    return kinetic, kinetic + potential
