"""The tilting of triangles and segments on round shapes, which is too fast for the substep, and is treated implicitly.

A triangle on which a round shape presses with a force N touches it at a point. If it tilts by an angle a, the point moves
by R a, where R is the radius of the shape and half of the thickness together, so that the force turns the triangle back: a
stiffness N R. The points of contacts are found once a substep, too seldom for this pendulum: a sheet of 0.4 kg/m^2 under a
ball of 5 kg trembled with 8 m/s, and a rope around a cylinder, whose segments tilt alike, with 0.5 m/s; friction held a third
of what it should. As in the linearly implicit Euler method, the force at the end of a step is taken: a torque
-h N (R da/dt + u), times a factor, where u is the speed at which the triangle slides past the centre of the shape. A belt,
whose triangles turn around the shape as they slide, gets none.
"""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, dot, length, minus, plus, times
from kickdrift.world.columns import vector_at
from kickdrift.world.deformables.body_contacts.contact_rows import add_shares
from kickdrift.world.deformables.body_contacts.pinned_corners import (
    corner_velocity,
    holder_response,
    point_velocity,
    push_holders,
)
from kickdrift.world.deformables.layout import (
    CLOTH_NORMAL,
    CONTACT_AXIS,
    CONTACT_IMPULSE,
    CONTACT_RADIUS,
    OTHER_PARTICLE,
    PARTICLE_INVERSE_MASS,
    PARTICLE_VELOCITY,
    THIRD_PARTICLE,
    TOUCHED_BODY,
    TOUCHED_POINT,
    TOUCHING_PARTICLE,
)
from kickdrift.world.layout import ANGULAR_VELOCITY, VELOCITY
from kickdrift.world.tables import CLOTH_CONTACT, CLOTH_CONTACT_NUMBERS, MOTION, PARTICLE, floats, integers

# Factor of the stiffness: adjacent triangles tilt together. Of 28 balls, capsules and cylinders on random sheets, two leave it
# trembling with more than 0.1 m/s with 2.0, none with 4.0 or 8.0.
_STIFFER = 4.0


@compiled
def resist_tilting(world: int, row: int, half_thickness: float, h: float, left: float) -> None:
    """Apply the torque of a contact for the substep h, s, after its impulse is known; those of particles alone have none.

    `half_thickness` is that of the cloth, m. Bodies move with their changes of velocity for the time `left` in the substep, s.

    In the plane of the triangle, or along the segment, with the gradients g of the barycentric coordinates, the rate of
    tilting is w = sum g (n . v), and a torque T, impulses g . T of the corners, changes it by A T with A = sum g g / m. So T
    is -c (1 + c A)^-1 (w + u / R), where c is h R times the impulse of the part.
    """
    contact, numbers = integers(world, CLOTH_CONTACT), floats(world, CLOTH_CONTACT_NUMBERS)
    particle = floats(world, PARTICLE)
    radius = numbers[row, CONTACT_RADIUS] + half_thickness
    c = _STIFFER * h * numbers[row, CONTACT_IMPULSE] * radius if radius > half_thickness else 0.0
    corners = (contact[row, TOUCHING_PARTICLE], contact[row, OTHER_PARTICLE], contact[row, THIRD_PARTICLE])
    if c == 0.0 or corners[0] == corners[1]:
        return
    p = vector_at(particle, corners[0], 0)
    u, v = minus(vector_at(particle, corners[1], 0), p), minus(vector_at(particle, corners[2], 0), p)
    across = cross(u, v)
    side, area = length(u), length(across)
    if side == 0.0 or (area == 0.0 and corners[0] != corners[2]):
        return
    n = vector_at(numbers, row, CLOTH_NORMAL)
    x, y, second, third = times(1.0 / side, u), across, times(1.0 / side**2, u), across
    if area > 0.0:  # along a segment, `across` is zero
        y = cross(times(1.0 / area, across), x)
        second, third = times(1.0 / area**2, cross(v, across)), times(1.0 / area**2, cross(across, u))
    slide = _slide_past_centre(world, row, radius, n)
    xx, yy, xy, tilt_x, tilt_y = 1.0, 1.0, 0.0, dot(slide, x) / radius, dot(slide, y) / radius
    for k in range(3):
        gradient = second if k == 1 else third if k == 2 else times(-1.0, plus(second, third))
        g, f = dot(gradient, x), dot(gradient, y)
        speed = dot(n, corner_velocity(world, row, k))
        over_mass = particle[corners[k], PARTICLE_INVERSE_MASS] + holder_response(world, row, k, n)
        xx, yy, xy = xx + c * over_mass * g * g, yy + c * over_mass * f * f, xy + c * over_mass * g * f
        tilt_x, tilt_y = tilt_x + g * speed, tilt_y + f * speed
    scale = -c / (xx * yy - xy * xy)
    torque = plus(times(scale * (yy * tilt_x - xy * tilt_y), x), times(scale * (xx * tilt_y - xy * tilt_x), y))
    to_second, to_third = dot(second, torque), dot(third, torque)
    impulses = (-(to_second + to_third), to_second, to_third)
    by = (
        impulses[0] * particle[corners[0], PARTICLE_INVERSE_MASS],
        impulses[1] * particle[corners[1], PARTICLE_INVERSE_MASS],
        impulses[2] * particle[corners[2], PARTICLE_INVERSE_MASS],
    )
    add_shares(particle, corners, PARTICLE_VELOCITY, by, n)
    push_holders(world, row, impulses, n, left)


@compiled
def _slide_past_centre(world: int, row: int, radius: float, n: Vector) -> Vector:
    """Return the velocity of the point of a contact relative to the centre of the round shape that it touches.

    The part along the axis, along which the shape is straight, is only that of points that turn with it.
    """
    contact, numbers = integers(world, CLOTH_CONTACT), floats(world, CLOTH_CONTACT_NUMBERS)
    body, motion = contact[row, TOUCHED_BODY], floats(world, MOTION)
    centre = minus(vector_at(numbers, row, TOUCHED_POINT), times(numbers[row, CONTACT_RADIUS], n))
    v = plus(vector_at(motion, body, VELOCITY), cross(vector_at(motion, body, ANGULAR_VELOCITY), centre))
    v = minus(point_velocity(world, row), v)
    axis, spin = vector_at(numbers, row, CONTACT_AXIS), vector_at(motion, body, ANGULAR_VELOCITY)
    return plus(v, times(radius * dot(axis, cross(spin, n)) - dot(axis, v), axis))
