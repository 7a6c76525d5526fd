"""Cloths: one that falls over a ball, a flag, a trampoline, a net, and one that tears."""

import math

import numpy as np

from kickdrift.world.deformables.gusts import gusts
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
        linear_damping=1.0, self_collision=True, name="cloth",
    )  # fmt: skip
    return world


def flag(*, vertices: tuple[int, int] = (40, 24), wind: float = 6.0, gustiness: float = 0.0) -> World:
    """Let a flag flutter on a pole.

    Parameters
    ----------
    vertices : tuple of int
        Along the wind and along the pole.
    wind : float
        m/s.
    gustiness : float
        Intensity of its turbulence; see `kickdrift.gusts`.
    """
    world = World()
    world.add_capsule(radius=0.02, length=2.0, position=(-0.03, 0, 1.0), static=True)
    cloth = world.add_cloth_grid(
        (1.2, 0.7), vertices, position=(0.6, 0, 1.6), orientation=_UPRIGHT, density=0.12, bending_stiffness=1e-5, damping=1e-3,
        drag=1.0, lift=1.0, self_collision=True, name="flag",
    )  # fmt: skip
    cloth.pin(np.arange(vertices[1]))
    if gustiness > 0.0:
        world.add_wind(gusts((wind, 0.15 * wind, 0.0), intensity=gustiness, length=3.0))
    else:
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


def net(*, vertices: int = 25) -> World:
    """Let boxes fall into a net that hangs between four posts.

    Parameters
    ----------
    vertices : int
        Along each side.
    """
    world = World(substeps=8)
    world.add_plane()
    size, height = 2.0, 1.3
    cloth = world.add_cloth_grid(
        (size, size), (vertices, vertices), position=(0, 0, height), density=0.4, thickness=0.02, stretch_stiffness=400.0,
        shear_stiffness=20.0, bending_stiffness=1e-4, damping=2e-3, linear_damping=0.3, friction=0.8, name="net",
    )  # fmt: skip
    for x in (-1.0, 1.0):
        for y in (-1.0, 1.0):
            world.add_capsule(0.04, height, position=(1.04 * x, 1.04 * y, 0.5 * height), static=True, collides_with=())
    index = np.arange(vertices * vertices).reshape(vertices, vertices)
    cloth.pin(index[[0, 0, -1, -1], [0, -1, 0, -1]])
    places = ((0, 0, 0.36), (0.3, 0.2, 0.28), (-0.25, 0.3, 0.3), (-0.2, -0.3, 0.26), (0.25, -0.2, 0.3))
    for k, (x, y, side) in enumerate(places):
        world.add_box(
            (side, side, side), position=(x, y, height + 0.4 + 0.45 * k), orientation=(1.0, 0.3 * x, 0.4 * y + 0.1, 0.2 * k),
            density=100.0, friction=0.6,
        )  # fmt: skip
    return world


def tear(*, vertices: tuple[int, int] = (31, 26), speed: float = 8.0) -> World:
    """Throw a ball through a sheet of paper.

    Parameters
    ----------
    vertices : tuple of int
        From side to side, and from top to bottom.
    speed : float
        Of the ball, m/s.
    """
    world = World()
    world.add_plane()
    sheet = world.add_cloth_grid(
        (1.2, 1.0), vertices, position=(0, 0, 1.2), orientation=_UPRIGHT, density=0.3, stretch_stiffness=300.0,
        shear_stiffness=60.0, damping=2e-3, tear_strain=0.25, name="sheet",
    )  # fmt: skip
    z = sheet.position[:, 2]
    sheet.pin(np.flatnonzero((z > z.max() - 1e-9) | (z < z.min() + 1e-9)))
    world.add_sphere(0.12, position=(0.02, -1.2, 1.25), velocity=(0, speed, 1.0), mass=2.0)
    return world
