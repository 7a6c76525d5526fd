"""A world of kickdrift among the engines, and in the words that all understand."""

import numpy as np

from benchmarks.world.described import Body, Floats, Joint, Scene, rotation
from kickdrift.world.joints.ball import Ball
from kickdrift.world.joints.hinge import Hinge
from kickdrift.world.joints.joint_kinds import KINDS
from kickdrift.world.joints.layout import (
    ANCHOR_B,
    BODY_A,
    BODY_B,
    DRIVE_DAMPING,
    DRIVE_STIFFNESS,
    FRAME_B,
    JOINT_KIND,
    LOWER_LIMIT,
    TARGET,
    UPPER_LIMIT,
)
from kickdrift.world.layout import BODY_INERTIA, BODY_ROW, LAYER, MASK, MASS
from kickdrift.world.settings import GRAVITY
from kickdrift.world.shapes.kind_numbers import BOX, CAPSULE, PLANE, SPHERE
from kickdrift.world.tables import INERTIA, JOINT, JOINT_AXES, JOINT_NUMBERS, SETTINGS, SHAPE
from kickdrift.world.world import World

_NAMES = {PLANE: "plane", SPHERE: "sphere", CAPSULE: "capsule", BOX: "box"}


class Kickdrift:
    """A world, a step at a time.

    Parameters
    ----------
    world : World
    step : float
        Seconds.
    """

    def __init__(self, world: World, step: float) -> None:
        self._world, self._step = world, step

    def step(self) -> None:
        """Take a step."""
        self._world.step(self._step)

    def poses(self) -> Floats:
        """Positions and orientations, (N, 7), without the ground."""
        return np.hstack([self._world.position, self._world.orientation])[1:]

    def motions(self) -> Floats:
        """Velocities and angular velocities, (N, 6)."""
        return np.hstack([self._world.velocity, self._world.angular_velocity])[1:]


def described(world: World) -> Scene:
    """Describe a world at its start, in which every body has one shape, around its centre of mass."""
    table = world.tables.array(SHAPE)
    gravity = world.tables.array(SETTINGS)[0, GRAVITY : GRAVITY + 3].copy()
    bodies: dict[int, Body] = {}
    for row, placed in world.shape_rows.shapes.items():
        body, shape = int(table[row, BODY_ROW]), placed.shape
        inertia = world.tables.array(INERTIA)[body]
        bodies[body] = Body(
            _NAMES[shape.kind],
            tuple(float(number) for number in shape.numbers),
            world.position[body].copy(),
            world.orientation[body].copy(),
            float(inertia[MASS]),
            inertia[BODY_INERTIA : BODY_INERTIA + 3].copy(),
            placed.surface.friction,
            placed.surface.restitution,
            world.velocity[body].copy(),
            world.angular_velocity[body].copy(),
            int(table[row, LAYER]) & 0xFFFF,
            int(table[row, MASK]) & 0xFFFF,
        )
    rows = sorted(bodies)
    if rows != list(range(1, len(world.position))):
        raise ValueError("A world to be compared has one shape a body.")
    return Scene(
        gravity, [bodies[row] for row in rows], [_joint(world, row) for row in range(len(world.tables.array(JOINT)))]
    )


def _joint(world: World, row: int) -> Joint:
    """Describe a ball or a hinge whose bodies are where they were when it was made."""
    joint, numbers = world.tables.array(JOINT)[row], world.tables.array(JOINT_NUMBERS)[row]
    law = world.tables.array(JOINT_AXES)[6 * row + 5]
    b = int(joint[BODY_B])
    turn = rotation(world.orientation[b])
    limits = (float(law[LOWER_LIMIT]), float(law[UPPER_LIMIT]))
    return Joint(
        {Ball: "ball", Hinge: "hinge"}[KINDS[joint[JOINT_KIND]]],
        int(joint[BODY_A]) - 1,
        b - 1,
        world.position[b] + turn @ numbers[ANCHOR_B : ANCHOR_B + 3],
        turn @ rotation(numbers[FRAME_B : FRAME_B + 4])[:, 2],
        limits if np.isfinite(limits).all() else None,
        float(law[TARGET]),
        float(law[DRIVE_STIFFNESS]),
        float(law[DRIVE_DAMPING]),
    )
