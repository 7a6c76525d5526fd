"""Laws of axes as rows of `JOINT_AXES`: writing, reading and checking them."""

import math
from typing import Any, Literal

import numpy as np

from kickdrift.core.errors import ArgumentError
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.drive_effective_mass import effective_mass
from kickdrift.world.joints.limits_motors_options import Drive, Motor
from kickdrift.world.tables import JOINT, JOINT_AXES, Tables

LawPart = Literal["limits", "motor", "drive", "friction"]
LAW_PARTS: tuple[LawPart, ...] = ("limits", "motor", "drive", "friction")


def clear_laws(tables: Tables, joint: int) -> None:
    """Clear the laws along the axes of a joint."""
    laws = tables.array(JOINT_AXES)[6 * joint : 6 * joint + 6]
    laws[:] = 0.0
    laws[:, [j.LOWER_LIMIT, j.UPPER_LIMIT, j.DRIVE_MAXIMUM]] = -np.inf, np.inf, np.inf


def write_law(tables: Tables, joint: int, k: int, part: LawPart, what: Any) -> None:
    """Write one part of the law of axis k of a measured joint, with the sign of body b relative to a."""
    row, law = tables.row(JOINT, joint), tables.row(JOINT_AXES, 6 * joint + k)
    numbers: list[float] = law.tolist()
    if part == "motor":
        numbers[j.MOTOR_SPEED], numbers[j.MOTOR_MAXIMUM] = (0.0, 0.0) if what is None else (what.speed, what.maximum)
    elif part == "limits":
        numbers[j.LOWER_LIMIT], numbers[j.UPPER_LIMIT] = what or (-math.inf, math.inf)
    elif part == "friction":
        numbers[j.JOINT_FRICTION] = what
    else:
        mass = numbers[j.DRIVEN_MASS]  # of the previous drive: changes of the target do not change the stiffness
        stiffness, damping, target, speed, maximum = 0.0, 0.0, 0.0, 0.0, 0.0
        if what is None:
            mass = 0.0
        else:
            mass = mass or effective_mass(tables, joint, k)
            stiffness, damping = what.coefficients(mass)
            target, speed, maximum = what.target, what.speed, what.maximum
        numbers[j.DRIVE_STIFFNESS], numbers[j.DRIVE_DAMPING], numbers[j.DRIVEN_MASS] = stiffness, damping, mass
        numbers[j.TARGET], numbers[j.TARGET_SPEED], numbers[j.DRIVE_MAXIMUM] = target, speed, maximum
    does = (
        numbers[j.MOTOR_MAXIMUM] or numbers[j.DRIVE_STIFFNESS] or numbers[j.DRIVE_DAMPING] or numbers[j.JOINT_FRICTION]
    )
    does = does or -math.inf < numbers[j.LOWER_LIMIT] or numbers[j.UPPER_LIMIT] < math.inf
    before, angular = row.item(j.LAWS), row.item(j.ANGULAR)
    laws = before | 1 << k if does else before & ~(1 << k)
    if k >= 3 and does and angular == j.LOOSE:
        angular = j.VECTOR
    law[:], row[j.LAWS], row[j.ANGULAR] = numbers, laws, angular  # in one statement, which Ctrl-C does not interrupt


def read_law(tables: Tables, joint: int, k: int, part: LawPart) -> Any:
    """Return one part of the law of axis k of a joint, with the sign of body b relative to a."""
    numbers: list[float] = tables.row(JOINT_AXES, 6 * joint + k).tolist()
    if part == "motor":
        return Motor(numbers[j.MOTOR_SPEED], numbers[j.MOTOR_MAXIMUM]) if numbers[j.MOTOR_MAXIMUM] > 0.0 else None
    if part == "limits":
        limits = numbers[j.LOWER_LIMIT], numbers[j.UPPER_LIMIT]
        return None if limits == (-math.inf, math.inf) else limits
    if part == "friction":
        return numbers[j.JOINT_FRICTION]
    stiffness, damping = numbers[j.DRIVE_STIFFNESS], numbers[j.DRIVE_DAMPING]
    if stiffness == damping == 0.0:
        return None
    return Drive(
        stiffness, damping, target=numbers[j.TARGET], speed=numbers[j.TARGET_SPEED], maximum=numbers[j.DRIVE_MAXIMUM]
    )


def check_changeable(tables: Tables, joint: int, k: int, part: LawPart) -> None:
    """Check that a part of the law of axis k can be changed.

    Raises
    ------
    ArgumentError
        If the axis is locked, or has no law of its own.
    """
    row = tables.row(JOINT, joint)
    if row.item(j.LOCKED) >> k & 1:
        raise ArgumentError(f"axis={k} is locked, so it has no {part}; add a joint in which it is open.")
    if k != 2 and row.item(j.LINEAR) == j.LINE:
        raise ArgumentError(f"axis={k} of a joint along a line has no {part} of its own; only axis 2, the line, has.")
    if k >= 3 and row.item(j.ANGULAR) == j.SWING_TWIST:
        raise ArgumentError(
            f"axis={k} belongs to swing and twist, whose {part} cannot be changed; remove the joint and add another"
            " one."
        )
