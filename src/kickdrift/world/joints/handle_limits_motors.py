"""The part of a joint's handle that reads and sets the laws of its axes: limits, motors, drives and friction."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kickdrift.world.handle import Handle
from kickdrift.world.joints.limits_motors_options import Axis, Drive, Motor, check_kind

if TYPE_CHECKING:
    from kickdrift.world.joints.registry import Joints


class HasLaws(Handle):
    """The methods of a joint that read and set limits, motors, drives and friction; setting one wakes its bodies.

    All raise `ArgumentError` where no axis is named and the joint does not have exactly one open axis.
    """

    __slots__ = ()
    _joints: Joints

    def motor(self, axis: int | None = None) -> Motor | None:
        """Return the motor of an axis.

        Parameters
        ----------
        axis : int, optional
            0-2 linear, 3-5 angular; the one open axis by default.

        Returns
        -------
        Motor or None
        """
        found: Motor | None = self._joints.law(self, axis, "motor")
        return found

    def drive(self, axis: int | None = None) -> Drive | None:
        """Return the drive of an axis.

        Parameters
        ----------
        axis : int, optional
            0-2 linear, 3-5 angular; the one open axis by default.

        Returns
        -------
        Drive or None
            With stiffness and damping, even if it was set by its frequency.

        Examples
        --------
        To change a part of it:

        >>> from dataclasses import replace
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> block, spring = world.add_box((1, 1, 1), mass=1.0), kd.Drive(stiffness=100.0)
        >>> slider = world.add_slider(None, block, (0, 0, 0), axis=(1, 0, 0), drive=spring)
        >>> slider.set_drive(replace(slider.drive(), target=0.5))
        >>> slider.drive().target
        0.5
        """
        found: Drive | None = self._joints.law(self, axis, "drive")
        return found

    def limits(self, axis: int | None = None) -> tuple[float, float] | None:
        """Return the limits of an axis.

        Parameters
        ----------
        axis : int, optional
            0-2 linear, 3-5 angular; the one open axis by default.

        Returns
        -------
        (2,) tuple of float, or None
            m or rad.
        """
        found: tuple[float, float] | None = self._joints.law(self, axis, "limits")
        return found

    def friction(self, axis: int | None = None) -> float:
        """Return the dry friction of an axis.

        Parameters
        ----------
        axis : int, optional
            0-2 linear, 3-5 angular; the one open axis by default.

        Returns
        -------
        float
            N or N m.
        """
        found: float = self._joints.law(self, axis, "friction")
        return found

    def set_motor(self, motor: Motor | None, axis: int | None = None) -> None:
        """Set the motor of an axis.

        Parameters
        ----------
        motor : Motor or None
            None removes it.
        axis : int, optional
            0-2 linear, 3-5 angular; the one open axis by default.

        Raises
        ------
        ArgumentError
            For anything else, and for an axis that is locked or cannot have a motor.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> wheel = world.add_cylinder(0.3, 0.1, mass=2.0)
        >>> axle = world.add_hinge(None, wheel, anchor=(0, 0, 0), axis=(0, 0, 1))
        >>> axle.set_motor(kd.Motor(speed=10.0))
        >>> world.step(1 / 60)
        >>> round(axle.speed, 6)
        10.0
        """
        check_kind("motor", motor, Motor)
        self._joints.change_law(self, axis, "motor", motor)

    def set_drive(self, drive: Drive | None, axis: int | None = None) -> None:
        """Set the drive of an axis.

        Parameters
        ----------
        drive : Drive or None
            None removes it.
        axis : int, optional
            0-2 linear, 3-5 angular; the one open axis by default.

        Raises
        ------
        ArgumentError
            For anything else, and for an axis that is locked or cannot have a drive.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World(gravity=(0, 0, 0))
        >>> block = world.add_box((1, 1, 1), mass=1.0)
        >>> slider = world.add_slider(None, block, anchor=(0, 0, 0), axis=(1, 0, 0))
        >>> slider.set_drive(kd.Drive(stiffness=100.0, damping=20.0, target=0.5))
        >>> world.advance(1 / 60, 120)
        >>> round(slider.position, 3)
        0.5
        """
        check_kind("drive", drive, Drive)
        self._joints.change_law(self, axis, "drive", drive)

    def set_limits(self, limits: tuple[float, float] | None, axis: int | None = None) -> None:
        """Set the limits of an axis.

        Parameters
        ----------
        limits : (2,) tuple of float, or None
            Smallest and largest position or angle, m or rad; None removes them.
        axis : int, optional
            0-2 linear, 3-5 angular; the one open axis by default.

        Raises
        ------
        ArgumentError
            For limits in the wrong order or not a number, and for an axis that is locked or cannot have limits.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> block = world.add_box((1, 1, 1), mass=1.0)
        >>> slider = world.add_slider(None, block, anchor=(0, 0, 0), axis=(0, 0, 1))
        >>> slider.set_limits((-0.2, 0.2))
        >>> world.advance(1 / 60, 120)
        >>> round(slider.position, 3)
        -0.2
        """
        self._joints.change_law(self, axis, "limits", Axis(limits=limits).limits)

    def set_friction(self, friction: float, axis: int | None = None) -> None:
        """Set the dry friction of an axis.

        Parameters
        ----------
        friction : float
            The largest force or torque of dry friction, N or N m.
        axis : int, optional
            0-2 linear, 3-5 angular; the one open axis by default.

        Raises
        ------
        ArgumentError
            For a negative number, and for an axis that is locked or cannot have friction.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> block = world.add_box((1, 1, 1), mass=1.0)
        >>> slider = world.add_slider(None, block, anchor=(0, 0, 0), axis=(0, 0, 1))
        >>> slider.set_friction(12.0)
        >>> world.step(1 / 60)
        >>> abs(slider.speed) < 1e-9
        True
        """
        self._joints.change_law(self, axis, "friction", Axis(friction=friction).friction)
