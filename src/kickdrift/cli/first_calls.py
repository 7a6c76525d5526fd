"""Short runs of everything that users call, for `kickdrift compile`: entry points are compiled at their first call."""

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import kickdrift as kd
from kickdrift.scenes import DEFAULTS, FIRST_METHODS, Defaults


def worlds() -> None:
    """Step a world with a cloth, ask it for what is where, place its arm, and draw it."""
    world = kd.World()
    world.add_plane()
    ball = world.add_sphere(1.0, position=(0.0, 0.0, 2.0))
    hinge = world.add_hinge(world.ground, ball, anchor=(0.0, 0.0, 4.0), axis=(0.0, 1.0, 0.0))
    world.add_box((1.0, 1.0, 1.0), position=(3.0, 0.0, 0.5))
    world.add_cylinder(1.0, 1.0, position=(6.0, 0.0, 0.5))
    # Beside the plane of the other bodies, so that pictures are not flat
    world.add_cloth_grid(vertices=(3, 3), position=(0.0, 3.0, 0.1))
    recording = world.run(duration=0.02, step=0.01)
    world.ray_cast((0.0, 0.0, 9.0), (0.0, 0.0, -1.0))
    world.overlap_sphere(radius=0.5, position=(0.0, 0.0, 2.0))
    hinge.angle, hinge.speed = 0.1, 0.0
    with tempfile.TemporaryDirectory() as folder:
        world.save(Path(folder) / "world.npz")
        kd.load_world(Path(folder) / "world.npz")
        recording.plot(Path(folder) / "picture.png")
        recording.animate(Path(folder) / "film.gif", progress=False)


def systems() -> None:
    """Solve those of the catalogue by the methods that every course begins with."""
    for name, make in kd.systems.catalogue().items():
        own = DEFAULTS.get(name, Defaults())
        for method in (own.method, *FIRST_METHODS):
            kd.solve(make(), (0.0, own.step), step=own.step, method=method, progress=False).report()


def interpreted() -> None:
    """Solve what is not compiled, whose flows call compiled functions."""
    brief: dict[str, Any] = {"step": 0.01, "compile": False, "progress": False}
    curved = kd.Hamiltonian(dHdq=lambda q, p: q * (1 + p * p), dHdp=lambda q, p: p * (1 + q * q))
    for method in ("semi-implicit-euler", "gauss-4", "tao-4"):
        kd.solve(curved, (0.0, 0.02), 0.5, 0.0, method=method, **brief)
    kd.solve(kd.FirstOrder(lambda y: -y), (0.0, 0.02), [1.0], method="radau-5", **brief)


def runs() -> None:
    """Solve with steps that vary, events, impacts, constraints and decays, and several members at once."""
    brief: dict[str, Any] = {"t_span": (0.0, 0.02), "step": 0.01, "progress": False}
    kepler = kd.systems.kepler(eccentricity=0.5)
    for control in ("distance", kd.LogarithmicHamiltonian()):
        kd.solve(kepler, step_control=control, **brief)
    kd.solve(kepler, (0.0, 0.02), rtol=1e-6, method="dop853", progress=False)
    kd.solve(kepler, events=lambda x: x[0] - 0.4999, **brief)
    kd.solve_ensemble(kepler, x0=kepler.x0 + 1e-3 * np.arange(16).reshape(8, 2), **brief)
    falling = kd.SecondOrder(lambda x: np.array([0.0, -9.81]))
    kd.solve(falling, x0=[0.0, 1e-4], v0=[1.0, 0.0], impacts=kd.Impacts(lambda x: x[1], restitution=0.5), **brief)
    rod = kd.Constrained(lambda x: np.array([0.0, -9.81]), lambda x: np.array([x @ x - 1]))
    kd.solve(rod, x0=[1.0, 0.0], v0=[0.0, 0.0], method="rattle", **brief).report()
    kd.solve(kd.FirstOrder(lambda y: -y), x0=[1.0], method="radau-5", **brief).report()


ALL: tuple[Callable[[], None], ...] = (worlds, systems, runs, interpreted)
