"""Laws of axes as rows of numbers."""

from typing import Literal

import numpy as np

from kickdrift.core.errors import ArgumentError
from kickdrift.world.joints.axis import Axis
from kickdrift.world.joints.effective import effective_mass
from kickdrift.world.joints.layout import (
    ANGULAR,
    DRIVE_DAMPING,
    DRIVE_MAXIMUM,
    DRIVE_STIFFNESS,
    DRIVEN_MASS,
    JOINT_FRICTION,
    LAWS,
    LINE,
    LINEAR,
    LOCKED,
    LOOSE,
    LOWER_LIMIT,
    MOTOR_MAXIMUM,
    MOTOR_SPEED,
    SWING_TWIST,
    TARGET,
    TARGET_SPEED,
    UPPER_LIMIT,
    VECTOR,
)
from kickdrift.world.tables import JOINT, JOINT_AXES, Tables

LawPart = Literal["limits", "motor", "drive", "friction"]
LAW_PARTS: tuple[LawPart, ...] = ("limits", "motor", "drive", "friction")


def clear_laws(tables: Tables, joint: int) -> None:
    """Let nothing happen along the axes of a joint."""
    laws = tables.array(JOINT_AXES)[6 * joint : 6 * joint + 6]
    laws[:] = 0.0
    laws[:, [LOWER_LIMIT, UPPER_LIMIT, DRIVE_MAXIMUM]] = -np.inf, np.inf, np.inf


def write_law(tables: Tables, joint: int, k: int, axis: Axis, part: LawPart) -> None:
    """Write one part of what happens along an axis of a joint, which is measured."""
    row, law = tables.row(JOINT, joint), tables.row(JOINT_AXES, 6 * joint + k)
    numbers: list[float] = law.tolist()
    if part == "limits":
        numbers[LOWER_LIMIT], numbers[UPPER_LIMIT] = axis.limits or (-np.inf, np.inf)
    elif part == "friction":
        numbers[JOINT_FRICTION] = axis.friction
    elif part == "motor":
        numbers[MOTOR_SPEED], numbers[MOTOR_MAXIMUM] = (
            (axis.motor.speed, axis.motor.maximum) if axis.motor else (0.0, 0.0)
        )
    else:
        mass = numbers[DRIVEN_MASS]  # of the drive that there was: another target makes no drive stiffer
        stiffness, damping, target, speed, maximum = 0.0, 0.0, 0.0, 0.0, 0.0
        if axis.drive is None:
            mass = 0.0
        else:
            mass = mass or effective_mass(tables, joint, k)
            stiffness, damping = axis.drive.coefficients(mass)
            target, speed, maximum = axis.drive.target, axis.drive.speed, axis.drive.maximum
        numbers[DRIVE_STIFFNESS], numbers[DRIVE_DAMPING], numbers[DRIVEN_MASS] = stiffness, damping, mass
        numbers[TARGET], numbers[TARGET_SPEED], numbers[DRIVE_MAXIMUM] = target, speed, maximum
    does = -np.inf < numbers[LOWER_LIMIT] or numbers[UPPER_LIMIT] < np.inf
    does = does or any(
        numbers[column] != 0.0 for column in (MOTOR_MAXIMUM, DRIVE_STIFFNESS, DRIVE_DAMPING, JOINT_FRICTION)
    )
    laws = row.item(LAWS) | 1 << k if does else row.item(LAWS) & ~(1 << k)
    angular = VECTOR if k >= 3 and does and row.item(ANGULAR) == LOOSE else row.item(ANGULAR)
    law[:], row[LAWS], row[ANGULAR] = numbers, laws, angular  # at once, which Ctrl-C does not divide


def check_changeable(tables: Tables, joint: int, k: int, part: LawPart) -> None:
    """Refuse to change the law of an axis that has none of its own.

    Raises
    ------
    ArgumentError
    """
    row = tables.row(JOINT, joint)
    if row.item(LOCKED) >> k & 1:
        raise ArgumentError(f"axis={k} is locked, so it has no {part}; make a joint in which it is open.")
    if row[LINEAR] == LINE and k != 2:
        raise ArgumentError(f"axis={k} of a joint along a line has no {part} of its own; only axis 2, the line, has.")
    if row[ANGULAR] == SWING_TWIST and k >= 3:
        raise ArgumentError(
            f"axis={k} is one of swing and twist, whose {part} cannot be changed; remove the joint and add another one."
        )
