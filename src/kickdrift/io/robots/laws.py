"""What acts along the axis of a joint: limits, springs, dampers, friction and actuators."""

import math
from dataclasses import dataclass
from typing import Any

from kickdrift.core.errors import ArgumentError
from kickdrift.io.robots.parsing import Model
from kickdrift.world.joints.limits_motors_options import Axis, Drive

_ANY = (-math.inf, math.inf)


@dataclass(frozen=True)
class Actuator:
    """An actuator of a joint: force = gear (gain control + bias[0] + bias[1] length + bias[2] rate), length = gear position.

    Attributes
    ----------
    joint : str
        Name of the joint.
    gear, gain : float
    bias : (3,) tuple of float
        Zeros for a motor, whose force is proportional to its control.
    control_range : (2,) tuple of float
        Least and greatest control; values beyond are clamped, as in MuJoCo.
    force_range : (2,) tuple of float
        Least and greatest force, in N or N m at the joint.
    zero : float
        The file's position of the joint, where `Joint.angle` or `Joint.position` is zero.
    passive : Drive
        Spring and damper of the joint itself.
    """

    joint: str
    gear: float
    gain: float
    bias: tuple[float, float, float]
    control_range: tuple[float, float]
    force_range: tuple[float, float]
    zero: float
    passive: Drive

    @property
    def servo(self) -> bool:
        """Whether its force depends on the position or speed of its joint, as in position and velocity servos."""
        return self.gear != 0.0 and (self.bias[1] < 0.0 or self.bias[2] < 0.0)

    @property
    def maximum(self) -> float:
        """Greatest force in either direction, in N or N m at the joint."""
        return max(abs(end) for end in self.force_range)

    def drive(self, control: float) -> Drive:
        """Return the drive of the joint at a control, including its own spring and damper, for ``Joint.set_drive``.

        Parameters
        ----------
        control : float
            Clamped to `control_range`.

        Returns
        -------
        Drive

        Raises
        ------
        ArgumentError
            For a motor, which is not a drive; `effort` returns its force.
        """
        if not self.servo:
            raise ArgumentError(
                f"control={control!r} of a motor is a force, not a drive; in each step, pass effort(control) to"
                " Joint.apply_effort."
            )
        stiffness, damping = -self.bias[1] * self.gear**2, -self.bias[2] * self.gear**2
        constant = self._force(control)  # at position and speed zero of the file
        passive = self.passive
        total, rate = stiffness + passive.stiffness, damping + passive.damping
        if total == 0.0:
            return Drive(damping=rate, speed=constant / rate, maximum=self.maximum)
        pull = constant - stiffness * self.zero + passive.stiffness * passive.target
        return Drive(stiffness=total, damping=rate, target=pull / total, maximum=self.maximum)

    def effort(self, control: float) -> float:
        """Return the force or torque of a motor at a control, for ``Joint.apply_effort``.

        Parameters
        ----------
        control : float
            Clamped to `control_range`.

        Returns
        -------
        float
            N or N m, clamped to `force_range`.

        Raises
        ------
        ArgumentError
            For a servo, whose force depends on the position of its joint; see `drive`.
        """
        if self.servo:
            raise ArgumentError(
                f"control={control!r} of a servo is not a force; pass drive(control) to Joint.set_drive."
            )
        return _clipped(self._force(control), self.force_range)

    def _force(self, control: float) -> float:
        return self.gear * (self.gain * _clipped(control, self.control_range) + self.bias[0])


def _clipped(value: float, ends: tuple[float, float]) -> float:
    return min(max(value, ends[0]), ends[1])


def axis_of(model: Model, joint: int, actuators: dict[str, Actuator], notes: list[str]) -> Axis:
    """Return the laws along or about the axis of a hinge or slide, and collect its actuators."""
    m = model.compiled
    at, dof = int(m.jnt_qposadr[joint]), int(m.jnt_dofadr[joint])
    zero, name = float(m.qpos0[at]), model.name("joint", joint)
    if zero != 0.0:
        notes.append(
            f"joint {name!r} is at zero here where it is at {zero:g} in the file; its limits are shifted accordingly"
        )
    limits = None
    if m.jnt_limited[joint]:
        lower, upper = (float(end) - zero for end in m.jnt_range[joint])
        limits = (lower, upper)
    passive = Drive(
        stiffness=float(m.jnt_stiffness[joint]),
        damping=float(m.dof_damping[dof]),
        target=float(m.qpos_spring[at]) - zero,
    )
    drive = passive if passive.stiffness > 0.0 or passive.damping > 0.0 else None
    kinds = (model.mujoco.mjtTrn.mjTRN_JOINT, model.mujoco.mjtTrn.mjTRN_JOINTINPARENT)
    for row in range(m.nu):
        if not model.is_one_of(m.actuator_trntype[row], *kinds) or m.actuator_trnid[row, 0] != joint:
            continue
        actuator = _actuator(model, row, zero, passive, notes)
        if actuator is None:
            continue
        actuators[model.name("actuator", row)] = actuator
        if actuator.servo and drive is not None and drive is not passive:
            raise ArgumentError(f"joint {name!r} has two servos, but a joint here has at most one; remove the other.")
        if actuator.servo:
            drive = actuator.drive(0.0)
            if -actuator.force_range[0] != actuator.force_range[1]:
                notes.append(
                    f"the force of servo {model.name('actuator', row)!r} has the larger of its two limits in both"
                    " directions"
                )
            if drive.maximum < math.inf and (passive.stiffness > 0.0 or passive.damping > 0.0):
                notes.append(
                    f"the maximum force of the servo of joint {name!r} applies to the sum of the servo and the joint's"
                    " own spring and damper"
                )
    return Axis(limits=limits, drive=drive, friction=float(m.dof_frictionloss[dof]))


def _actuator(model: Model, row: int, zero: float, passive: Drive, notes: list[str]) -> Actuator | None:
    m, mj = model.compiled, model.mujoco
    name, joint = model.name("actuator", row), int(m.actuator_trnid[row, 0])
    biases = {int(mj.mjtBias.mjBIAS_NONE): (0.0, 0.0, 0.0)}
    biases[int(mj.mjtBias.mjBIAS_AFFINE)] = tuple(m.actuator_biasprm[row, :3].tolist())
    bias = biases.get(int(m.actuator_biastype[row]))
    plain = model.is_one_of(m.actuator_gaintype[row], mj.mjtGain.mjGAIN_FIXED)
    plain = plain and model.is_one_of(m.actuator_dyntype[row], mj.mjtDyn.mjDYN_NONE)
    if not plain or bias is None or bias[1] > 0.0 or bias[2] > 0.0:
        notes.append(f"actuator {name!r} is left out: it is neither a motor nor a servo without internal dynamics")
        return None
    gear = float(m.actuator_gear[row, 0])
    clamped = m.actuator_ctrllimited[row] and not m.opt.disableflags & mj.mjtDisableBit.mjDSBL_CLAMPCTRL
    return Actuator(
        joint=model.name("joint", joint),
        gear=gear,
        gain=float(m.actuator_gainprm[row, 0]),
        bias=bias,
        control_range=_ends(m.actuator_ctrlrange[row]) if clamped else _ANY,
        force_range=_force_range(m, row, gear, joint),
        zero=zero,
        passive=passive,
    )


def _force_range(m: Any, row: int, gear: float, joint: int) -> tuple[float, float]:
    """Return the least and the greatest force of an actuator at its joint, which may have a range of its own."""
    least, greatest = _ANY
    if m.actuator_forcelimited[row]:
        least, greatest = sorted(gear * end for end in _ends(m.actuator_forcerange[row]))
    if m.jnt_actfrclimited[joint]:
        lower, upper = _ends(m.jnt_actfrcrange[joint])
        least, greatest = max(least, lower), min(greatest, upper)
    return least, greatest


def _ends(pair: Any) -> tuple[float, float]:
    return float(pair[0]), float(pair[1])
