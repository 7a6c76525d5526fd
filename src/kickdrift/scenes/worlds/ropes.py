"""Ropes: a bridge that hangs on two of them, and a ball on one that winds round a pole."""

import numpy as np

from kickdrift.world.world import World


def bridge(*, planks: int = 14, span: float = 4.0) -> World:
    """Let crates fall onto a bridge of planks that hangs on two ropes.

    Parameters
    ----------
    planks : int
    span : float
        From side to side, m.
    """
    world = World(substeps=8)
    world.add_plane()
    height, width, pitch, between = 1.0, 0.8, 1.12 * span / (planks + 1), 3
    x = np.linspace(-0.5 * span, 0.5 * span, between * (planks + 1) + 1)
    sag = 0.55 * (1.0 - (2.0 * x / span) ** 2)
    held = np.arange(between, between * planks + 1, between)
    ropes = [
        world.add_rope(
            np.stack((x, np.full_like(x, y), height - sag), axis=1), radius=0.015, density=0.3, stretch_stiffness=2e4,
            bending_stiffness=0.02, linear_damping=0.5, name=name,
        )
        for y, name in ((-0.5 * width, "right"), (0.5 * width, "left"))
    ]  # fmt: skip
    for rope in ropes:
        rope.pin([0, len(x) - 1])
    for k in held.tolist():
        slope = np.arctan2(sag[k - 1] - sag[k + 1], x[k + 1] - x[k - 1])
        plank = world.add_box(
            (0.7 * pitch, width + 0.1, 0.04), position=(x[k], 0, height - sag[k] - 0.035),
            orientation=(np.cos(0.5 * slope), 0.0, -np.sin(0.5 * slope), 0.0), density=500.0, friction=0.6,
        )  # fmt: skip
        for rope in ropes:
            rope.pin([k], plank)
    for side in (-1.0, 1.0):
        for y in (-0.5 * width, 0.5 * width):
            world.add_capsule(0.05, height, position=(side * (0.5 * span + 0.06), y, 0.5 * height), static=True)
    for k, (place, side) in enumerate(((-0.6, 0.3), (0.35, 0.36), (-0.1, 0.26))):
        world.add_box(
            (side, side, side), position=(place * 0.5 * span, 0.05 * (k - 1), 1.2 + 0.35 * k), orientation=(1.0, 0.1, 0.1, 0.3),
            density=200.0, friction=0.8,
        )  # fmt: skip
    return world


def tetherball(*, segments: int = 50, speed: float = 6.0) -> World:
    """Let a ball fly round a pole on a rope, which winds round it.

    Parameters
    ----------
    segments : int
        Of the rope.
    speed : float
        Of the ball, m/s.
    """
    world = World(substeps=8)
    world.add_plane()
    world.add_cylinder(0.1, 2.6, position=(0, 0, 1.3), static=True, friction=0.5)
    rope = world.add_rope(
        np.linspace((0.115, 0, 2.4), (1.3, 0, 1.5), segments + 1), radius=0.015, density=0.08, stretch_stiffness=3000.0,
        bending_stiffness=1e-3, linear_damping=0.1, friction=0.5, self_collision=True, name="rope",
    )  # fmt: skip
    ball = world.add_sphere(0.13, position=(1.41, 0, 1.415), mass=0.5, name="ball")
    rope.pin([0])
    rope.pin([segments], ball)
    ball.velocity = (0.0, speed, 0.0)
    return world
