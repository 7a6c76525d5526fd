"""Kernels of the contact solver: loops over the lanes of a group of constraints that the compiler vectorises.

`own` are the fields of a group, `s` its scratch; both are flat, with field k of lane l at k WIDTH + l, so that the compiler
can prove that lanes do not overlap. The number of lanes n is an argument: a loop of eight or fewer iterations, known in
advance, would be unrolled before the vectoriser sees it. All kernels have one signature and are called by address: linked into
the stages that use them, each would be compiled several times.

Between `s` and n are three numbers, whose meanings are those of each kernel:

- `fill`: the substep, s; instead of the scratch it gets `raw`.
- `refresh`: slop, m; the substep, s, or 0.0 to keep the gaps.
- `refresh_friction`: the second is 1.0 if bodies have moved within the step, 0.0 in its preparation.
- `solve_normals`: 1 over the substep, 1/s; 1.0 for the soft sweep with the push, 0.0 for the rigid one; its bound.
- `solve_friction`, `apply_impulses`, `find_stale`, `turn_normals`, `measure_normals`: none.
"""

from typing import Any

from numba import types

from kickdrift.core.calls import caller
from kickdrift.core.compilation import compiled
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.effective_mass_simd import find_stale, refresh, refresh_friction
from kickdrift.world.contacts.friction_and_rolling_simd import solve_friction
from kickdrift.world.contacts.prepare_simd import (
    DELTA_POSE_A,
    DELTA_POSE_B,
    INERTIA_A,
    INERTIA_B,
    MARK,
    VELOCITY_A,
    VELOCITY_B,
    fill,
)
from kickdrift.world.contacts.simd_vectors import NEXT, W, cross, dot, impulses, minus, plus, put, times, turn, vector
from kickdrift.world.contacts.turned_normals_simd import turn_normals

_ARRAY = types.Array(types.float64, 1, "C")
KERNEL = types.none(_ARRAY, _ARRAY, types.float64, types.float64, types.float64, types.int64)

run_kernel = caller(KERNEL)


@compiled(fast=True, inline=True)
def _solve_point(own: Any, s: Any, lane: int, i: int, opened: float, arms: Any, spring: Any, state: Any) -> Any:
    """Solve one point, whose fields begin at i; return the state.

    It is the sum of the changes of impulses, the normal velocity and both angular velocities, and 1.0 if a point has landed.
    """
    rate, soft_mass, soft_impulse, per_h, bound, closed, bounces, lands, sum_mass = spring
    (tilted, between), (total, v, turn_a, turn_b, landed) = arms, state
    arm_a = vector(own, c.ARM, i)
    impulse = own[i + c.IMPULSE * W]
    gap = own[i + c.GAP * W] + opened + dot(arm_a, tilted)
    arm_b = minus(arm_a, between)
    # Without branches, which would prevent vectorisation: separated points are rigid, and their bias is gap / h.
    apart = 1.0 if gap > 0.0 else 0.0
    bias = max(gap, 0.0) * per_h + soft_mass * rate * min(gap, 0.0)
    scale = soft_mass + apart * (1.0 - soft_mass)
    leak = (1.0 - apart) * soft_impulse
    speed = v + dot(arm_b, turn_b) - dot(arm_a, turn_a)
    mass = own[i + c.POINT_MASS * W]
    rounding = 1e-9 * mass * abs(speed)
    # Bounds the speed of separation. A bound on the bias would turn deep overlaps into springs whose force does not depend on
    # depth, between which balls wander for ever.
    change = min(-mass * (scale * speed + bias) - leak * impulse, mass * (bound - speed))
    new = max(impulse + change, 0.0)
    # The relaxing sweep adds nothing to points that do not overlap by more than rounding and carry no impulse, since they may
    # bounce when they meet in the next substep; of loaded points, rounding decides whether they overlap. Neither sweep
    # adds anything to points that approach fast enough to bounce, and have not bounced yet.
    idle = ((gap > closed) | (speed < bounces)) & (impulse <= rounding)
    d = min(new - impulse, 0.0 if idle else 1e300)
    landed = max(landed, 1.0 if (gap > 0.0) & (impulse <= 0.0) & (d > 0.0) & (speed < lands) else 0.0)
    own[i + c.IMPULSE * W] = impulse + d
    turn_a = minus(turn_a, times(d, turn(s, INERTIA_A, lane, arm_a)))
    turn_b = plus(turn_b, times(d, turn(s, INERTIA_B, lane, arm_b)))
    return total + d, v + sum_mass * d, turn_a, turn_b, landed


@compiled(fast=True)
def solve_normals(own: Any, s: Any, per_h: float, soft: float, bound: float, n: int) -> None:
    """Do one sweep over the points: soft, with a push of overlapping ones, if `soft` is 1.0; rigid, without the push, if 0.0.

    With the push, `bound` is the largest speed at which overlapping points separate, m/s. Without, it is the depth from which
    points begin to carry impulses, m, and bounds no speed.
    """
    closed = 1e300 if soft > 0.0 else -bound
    for lane in range(n):
        normal = vector(own, c.N, lane)
        mass_a, mass_b = own[c.MASS_A * W + lane], own[c.MASS_B * W + lane]
        rate = soft * own[c.BIAS_RATE * W + lane]
        soft_mass = 1.0 + soft * (own[c.SOFT_MASS * W + lane] - 1.0)
        soft_impulse = soft * own[c.SOFT_IMPULSE * W + lane]
        velocity_a, turn_a = vector(s, VELOCITY_A, lane), vector(s, VELOCITY_A + 3, lane)
        velocity_b, turn_b = vector(s, VELOCITY_B, lane), vector(s, VELOCITY_B + 3, lane)
        way_a, tilt_a = vector(s, DELTA_POSE_A, lane), vector(s, DELTA_POSE_A + 3, lane)
        way_b, tilt_b = vector(s, DELTA_POSE_B, lane), vector(s, DELTA_POSE_B + 3, lane)
        # The arm of b is that of a less the vector between the bodies, times the normal.
        between = cross(vector(own, c.BETWEEN, lane), normal)
        opened = dot(normal, minus(way_b, way_a)) - dot(between, tilt_b)
        arms = (minus(tilt_b, tilt_a), between)
        landed = 0.0 if soft > 0.0 else own[c.LANDED * W + lane]
        state = (0.0, dot(normal, minus(velocity_b, velocity_a)), turn_a, turn_b, landed)
        bounces, lands = -own[c.BOUNCE_THRESHOLD * W + lane], -own[c.LANDING_SPEED * W + lane]
        spring = (rate, soft_mass, soft_impulse, per_h, bound, closed, bounces, lands, mass_a + mass_b)
        # Indices are sums of constants and the lane: others might be negative to the compiler, and prevent vectorisation.
        i = c.P * W + lane
        state = _solve_point(own, s, lane, i, opened, arms, spring, state)
        state = _solve_point(own, s, lane, i + NEXT, opened, arms, spring, state)
        state = _solve_point(own, s, lane, i + 2 * NEXT, opened, arms, spring, state)
        state = _solve_point(own, s, lane, i + 3 * NEXT, opened, arms, spring, state)
        total, _, turn_a, turn_b, landed = state
        own[c.LANDED * W + lane] = landed
        put(s, VELOCITY_A, lane, minus(velocity_a, times(total * mass_a, normal)))
        put(s, VELOCITY_A + 3, lane, turn_a)
        put(s, VELOCITY_B, lane, plus(velocity_b, times(total * mass_b, normal)))
        put(s, VELOCITY_B + 3, lane, turn_b)


@compiled(fast=True)
def apply_impulses(own: Any, s: Any, unused: float, none: float, nothing: float, n: int) -> None:
    """Apply the accumulated impulses to the velocities (warm start); discard the friction of contacts that have just landed.

    The friction of a blow is no estimate of what follows, and nothing corrects it before the drift: rocks that land would
    gain up to 2 % of their energy.
    """
    for lane in range(n):
        normal, first = vector(own, c.N, lane), vector(own, c.T, lane)
        n0, n1, n2, n3 = impulses(own, lane)
        pressed = n0 + n1 + n2 + n3
        keep = 1.0 - own[c.LANDED * W + lane]
        d1, d2 = keep * own[c.TANGENT_IMPULSE * W + lane], keep * own[(c.TANGENT_IMPULSE + 1) * W + lane]
        own[c.TANGENT_IMPULSE * W + lane], own[(c.TANGENT_IMPULSE + 1) * W + lane] = d1, d2
        push = plus(times(d1, first), times(d2, cross(normal, first)))
        arm_a, between = vector(own, c.CENTRE, lane), vector(own, c.BETWEEN, lane)
        torque = vector(own, c.ROLL_IMPULSE, lane)
        twist = keep * own[c.TWISTING_IMPULSE * W + lane]
        own[c.TWISTING_IMPULSE * W + lane] = twist
        torque = plus(torque, times(twist, normal))
        torque_a = plus(cross(arm_a, push), torque)
        torque_b = plus(cross(minus(arm_a, between), push), torque)
        i = (c.P + c.ARM) * W + lane
        of_points = plus(times(n0, vector(own, 0, i)), times(n1, vector(own, 0, i + NEXT)))
        of_points = plus(of_points, times(n2, vector(own, 0, i + 2 * NEXT)))
        of_points = plus(of_points, times(n3, vector(own, 0, i + 3 * NEXT)))
        torque_a = plus(torque_a, of_points)
        torque_b = minus(plus(torque_b, of_points), cross(times(pressed, between), normal))
        push = plus(push, times(pressed, normal))
        mass_a, mass_b = own[c.MASS_A * W + lane], own[c.MASS_B * W + lane]
        put(s, VELOCITY_A, lane, minus(vector(s, VELOCITY_A, lane), times(mass_a, push)))
        put(s, VELOCITY_B, lane, plus(vector(s, VELOCITY_B, lane), times(mass_b, push)))
        put(s, VELOCITY_A + 3, lane, minus(vector(s, VELOCITY_A + 3, lane), turn(s, INERTIA_A, lane, torque_a)))
        put(s, VELOCITY_B + 3, lane, plus(vector(s, VELOCITY_B + 3, lane), turn(s, INERTIA_B, lane, torque_b)))


@compiled(fast=True, inline=True)
def _point_speed(own: Any, i: int, v: float, turn_a: Any, turn_b: Any, between: Any) -> float:
    """Return the normal speed of a point whose fields begin at i; 0.0 if it carries no impulse."""
    arm = vector(own, c.ARM, i)
    speed = v + dot(minus(arm, between), turn_b) - dot(arm, turn_a)
    return abs(speed) if own[i + c.IMPULSE * W] > 0.0 else 0.0


@compiled(fast=True)
def measure_normals(own: Any, s: Any, unused: float, none: float, nothing: float, n: int) -> None:
    """Write into MARK of each lane the largest normal speed of points that carry an impulse, m/s."""
    for lane in range(n):
        normal = vector(own, c.N, lane)
        v = dot(normal, minus(vector(s, VELOCITY_B, lane), vector(s, VELOCITY_A, lane)))
        turn_a, turn_b = vector(s, VELOCITY_A + 3, lane), vector(s, VELOCITY_B + 3, lane)
        between = cross(vector(own, c.BETWEEN, lane), normal)
        i = c.P * W + lane
        most = _point_speed(own, i, v, turn_a, turn_b, between)
        most = max(most, _point_speed(own, i + NEXT, v, turn_a, turn_b, between))
        most = max(most, _point_speed(own, i + 2 * NEXT, v, turn_a, turn_b, between))
        s[MARK * W + lane] = max(most, _point_speed(own, i + 3 * NEXT, v, turn_a, turn_b, between))


# By columns of the table `KERNEL_ADDRESSES`, which holds their addresses
KERNELS = {
    c.APPLY_IMPULSES: apply_impulses, c.SOLVE_NORMALS: solve_normals, c.SOLVE_FRICTION: solve_friction, c.FILL: fill,
    c.FIND_STALE: find_stale, c.REFRESH: refresh, c.REFRESH_FRICTION: refresh_friction,
    c.TURN_NORMALS: turn_normals, c.MEASURE: measure_normals,
}  # fmt: skip
