"""The laws of a joint along or about one of its axes."""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from kickdrift.core.arguments import choice
from kickdrift.core.errors import ArgumentError

_LARGEST = 2**1023  # integers below this can be converted to floats


def is_number(value: Any) -> bool:
    """Whether a value is a real number that a float can hold, and not a bool."""
    if isinstance(value, int):
        return not isinstance(value, bool) and -_LARGEST < value < _LARGEST
    return isinstance(value, float | np.integer | np.floating)


def finite(argument: str, value: float) -> None:
    """Check that a value is a finite number.

    Raises
    ------
    ArgumentError
        If it is not.
    """
    if not ((type(value) is float or is_number(value)) and math.isfinite(value)):
        raise ArgumentError(f"{argument}={value!r} must be a finite number.")


def not_negative(argument: str, value: float, unit: str, *, infinite: bool = False) -> None:
    """Check that a value is a number, zero or positive, and finite unless `infinite`.

    Raises
    ------
    ArgumentError
        If it is not.
    """
    if type(value) is float and 0.0 <= value < math.inf:
        return
    if not (is_number(value) and value >= 0.0 and (infinite or value < math.inf)):
        rest = "zero or positive" if infinite else "zero or positive, and finite"
        raise ArgumentError(f"{argument}={value!r} must be {rest}, in {unit}.")


def pair(argument: str, value: Any) -> tuple[float, float]:
    """Return a pair of numbers, which may be infinite.

    Raises
    ------
    ArgumentError
        For anything else.
    """
    ends = list(value) if isinstance(value, tuple | list) or (isinstance(value, np.ndarray) and value.ndim == 1) else []
    if len(ends) != 2 or not all(is_number(end) for end in ends):
        raise ArgumentError(f"{argument}={value!r} must be two numbers, the smallest and the largest, or None.")
    return value[0], value[1]


def check_kind(argument: str, value: Any, kind: type) -> None:
    """Check that a value is None or an instance of a type.

    Raises
    ------
    ArgumentError
        If it is neither.
    """
    if not (value is None or isinstance(value, kind)):
        raise ArgumentError(f"{argument}={value!r} must be a kickdrift.{kind.__name__}, or None.")


@dataclass(frozen=True)
class Motor:
    """A motor that maintains a speed, with as much torque or force as that takes, up to a maximum.

    Parameters
    ----------
    speed : float
        Rate of the joint's angle or position; rad/s about an axis, m/s along one.
    maximum : float
        N m about an axis, N along one.

    Raises
    ------
    ArgumentError
        For a speed that is not finite or a negative maximum.

    Examples
    --------
    >>> import kickdrift as kd
    >>> world = kd.World()
    >>> wheel = world.add_cylinder(0.3, 0.1, mass=2.0)
    >>> motor = kd.Motor(speed=10.0, maximum=0.9)
    >>> axle = world.add_hinge(None, wheel, anchor=(0, 0, 0), axis=(0, 0, 1), motor=motor)
    >>> world.advance(1 / 60, 30)
    >>> round(axle.speed, 6), round(axle.effort, 6)
    (5.0, 0.9)
    """

    speed: float = 0.0
    maximum: float = math.inf

    def __post_init__(self) -> None:
        finite("speed", self.speed)
        not_negative("maximum", self.maximum, "N m about an axis, N along one", infinite=True)


@dataclass(frozen=True)
class Drive:
    """A spring and damper that pulls towards a position: passive, or as the controller of an actuator.

    Give either stiffness and damping, or frequency and damping ratio. The latter refer to the effective mass of the two bodies
    alone, with the joint's locked axes held, in the pose in which the joint is created.

    Parameters
    ----------
    stiffness : float
        N m/rad about an axis, N/m along one.
    damping : float
        N m s/rad about an axis, N s/m along one.
    hertz, damping_ratio : float, optional
        Natural frequency, Hz, and damping divided by critical damping.
    target : float
        Position or angle at which the spring force is zero, m or rad.
    speed : float
        Speed at which the damping force is zero, m/s or rad/s.
    maximum : float
        Largest force or torque, N or N m.

    Raises
    ------
    ArgumentError
        For negative numbers, ones that are not finite, and a stiffness that is given twice.

    Notes
    -----
    Spring and damper are integrated implicitly, so that any stiffness and damping is stable. Springs that are slow compared
    to the substep conserve their energy.

    Examples
    --------
    >>> import kickdrift as kd
    >>> world = kd.World()
    >>> rod = world.add_capsule(0.05, 0.9, position=(0, 0, -0.5), mass=1.0)
    >>> spring = kd.Drive(stiffness=500.0, damping=50.0, target=0.5)
    >>> hinge = world.add_hinge(None, rod, anchor=(0, 0, 0), axis=(0, 1, 0), drive=spring)
    >>> world.advance(1 / 60, 300)
    >>> round(hinge.angle, 2)
    0.5
    """

    stiffness: float = 0.0
    damping: float = 0.0
    hertz: float | None = None
    damping_ratio: float = 0.0
    target: float = 0.0
    speed: float = 0.0
    maximum: float = math.inf

    def __post_init__(self) -> None:
        not_negative("stiffness", self.stiffness, "N m/rad about an axis, N/m along one")
        not_negative("damping", self.damping, "N m s/rad about an axis, N s/m along one")
        not_negative("damping_ratio", self.damping_ratio, "ratio to critical damping")
        not_negative("maximum", self.maximum, "N m about an axis, N along one", infinite=True)
        finite("target", self.target)
        finite("speed", self.speed)
        if self.hertz is None:
            if self.damping_ratio > 0.0:
                raise ArgumentError(
                    f"damping_ratio={self.damping_ratio!r} refers to a frequency; give hertz too, or damping instead."
                )
            return
        if not (is_number(self.hertz) and 0.0 < self.hertz < math.inf):
            raise ArgumentError(f"hertz={self.hertz!r} must be positive and finite, in Hz.")
        if self.stiffness > 0.0 or self.damping > 0.0:
            raise ArgumentError(
                f"hertz={self.hertz!r} and stiffness={self.stiffness!r}, damping={self.damping!r} define the stiffness"
                " twice; give hertz and damping_ratio, or stiffness and damping."
            )

    def coefficients(self, mass: float) -> tuple[float, float]:
        """Return stiffness and damping for an effective mass, kg, or moment of inertia, kg m^2."""
        if self.hertz is None:
            return self.stiffness, self.damping
        rate = 2.0 * math.pi * self.hertz
        return mass * rate * rate, 2.0 * mass * self.damping_ratio * rate


@dataclass(frozen=True)
class Axis:
    """Limits, motor, drive and friction of a joint along or about one of its axes.

    Parameters
    ----------
    locked : bool
        Whether no motion is possible. All other parameters are for open axes.
    limits : (2,) tuple of float, optional
        Smallest and largest position or angle, in m or rad; infinite for none.
    motor : Motor, optional
    drive : Drive, optional
    friction : float
        The largest force or torque of dry friction, at rest and in motion, N or N m.

    Raises
    ------
    ArgumentError
        For limits in the wrong order or not a number, negative friction, and a locked axis with anything else.

    Examples
    --------
    >>> import kickdrift as kd
    >>> world = kd.World()
    >>> block = world.add_box((1, 1, 1), mass=1.0)
    >>> free, held = kd.Axis(), kd.Axis(locked=True)
    >>> axes = {"linear": (free, held, held), "angular": (held, held, held)}
    >>> joint = world.add_six_dof_joint(None, block, anchor=(0, 0, 0), **axes)
    >>> world.apply_force(block, (6.0, 0, 0))
    >>> world.step(1 / 60)
    >>> world.velocity[block.index].round(6)
    array([0.1, 0. , 0. ])
    """

    locked: bool = False
    limits: tuple[float, float] | None = None
    motor: Motor | None = None
    drive: Drive | None = None
    friction: float = 0.0

    def __post_init__(self) -> None:
        choice("locked", self.locked)
        not_negative("friction", self.friction, "N m about an axis, N along one")
        check_kind("motor", self.motor, Motor)
        check_kind("drive", self.drive, Drive)
        if self.limits is not None:
            lower, upper = pair("limits", self.limits)
            if not lower <= upper:
                raise ArgumentError(
                    f"limits={self.limits!r} must be the smallest and the largest position, in this order."
                )
            if lower == math.inf or upper == -math.inf:
                raise ArgumentError(f"limits={self.limits!r} allow no finite position; give finite limits.")
        if self.locked and self.has_law:
            raise ArgumentError("locked=True leaves no motion to limit, drive or brake; leave the axis open.")

    def reversed(self) -> "Axis":
        """Return the same laws with the opposite sign of positions, speeds and efforts."""
        return Axis(
            self.locked,
            None if self.limits is None else (-self.limits[1], -self.limits[0]),
            None if self.motor is None else replace(self.motor, speed=-self.motor.speed),
            None if self.drive is None else replace(self.drive, target=-self.drive.target, speed=-self.drive.speed),
            self.friction,
        )

    @property
    def has_law(self) -> bool:
        """Whether there are limits, a motor, a drive or friction."""
        return bool(self.limits or self.motor or self.drive or self.friction > 0.0)


LOCKED = Axis(locked=True)
FREE = Axis()
