"""Cloths: one that falls over a ball, a flag, a trampoline."""

import math

import numpy as np

from kickdrift.world.world import World

_UPRIGHT = (math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)  # weft up, warp along x


def drape(*, vertices: int = 40, size: float = 1.2, radius: float = 0.3) -> World:
    """Let a square cloth fall over a ball that lies on the ground.

    Parameters
    ----------
    vertices : int
        Along each side.
    size : float
        Of a side, m.
    radius : float
        Of the ball, m.
    """
    world = World()
    world.add_plane()
    world.add_sphere(radius=radius, position=(0, 0, radius), density=2000.0)
    world.add_cloth_grid(
        (size, size), (vertices, vertices), position=(0.05, 0.02, 2.2 * radius), bending_stiffness=1e-4, damping=1e-3,
        linear_damping=1.0, name="cloth",
    )  # fmt: skip
    return world


def flag(*, vertices: tuple[int, int] = (40, 24), wind: float = 6.0) -> World:
    """Let a flag flutter at a pole.

    Parameters
    ----------
    vertices : tuple of int
        Along the wind and along the pole.
    wind : float
        m/s.
    """
    world = World()
    world.add_capsule(radius=0.02, length=2.0, position=(-0.03, 0, 1.0), static=True)
    cloth = world.add_cloth_grid(
        (1.2, 0.7), vertices, position=(0.6, 0, 1.6), orientation=_UPRIGHT, density=0.12, bending_stiffness=1e-5, damping=1e-3,
        drag=1.0, lift=1.0, name="flag",
    )  # fmt: skip
    cloth.pin(np.arange(vertices[1]))
    cloth.wind = (wind, 0.15 * wind, 0.0)
    return world


def trampoline(*, vertices: int = 25) -> World:
    """Let two balls jump on a trampoline.

    Parameters
    ----------
    vertices : int
        Along each side of its mat, which is held all around.
    """
    world = World(substeps=8)
    mat = world.add_cloth_grid(
        (2.0, 2.0), (vertices, vertices), position=(0, 0, 1.0), density=0.4, stretch_stiffness=800.0, shear_stiffness=200.0,
        name="mat",
    )  # fmt: skip
    index = np.arange(vertices * vertices).reshape(vertices, vertices)
    mat.pin(np.unique(np.concatenate((index[0], index[-1], index[:, 0], index[:, -1]))))
    world.add_sphere(radius=0.15, position=(-0.3, 0.1, 1.9), mass=4.0)
    world.add_sphere(radius=0.1, position=(0.4, -0.1, 2.2), mass=1.0)
    return world
