"""Restitution in islands: bounces of points, solved simultaneously with the joints.

At the start of a substep, when joints are satisfied, in rounds: all points that will hit within the substep faster than the
bounce speed get -e times their speed, together with points of the same manifold that would hit in the next substep, so that
bodies that land flat do not turn; then the points that these push onto others, until none hits. A round is solved without
friction first. Then friction acts on the part of the motion that restitution leaves alone, by the law of
`kickdrift.world.contacts.impacts.simultaneous_impact`, and adds no energy; solved together with Newton's rule, it would throw a
ball of 26 mg between bodies of 600 kg at 500 m/s. Joints at their limits are stopped in both. Points that hit even after
`_ROUNDS` rounds, as of a body that is thrown to and fro between others, are left to the solution of the substep, which stops
them, as with e = 0. Points without restitution also hit in islands struck by a contact so fast that its shapes move by more
than half of the smaller one in a substep: at its end they might have turned through each other, since the solution of a substep
assumes constant arms. Smith, Kaufman, Vouga, Tamstorf, Grinspun, Reflections on Simultaneous Impact, ACM Trans. Graph. 31
(2012) 106.
"""

import math

from kickdrift.core.compilation import compiled
from kickdrift.world.collision.body_acceleration import closing_acceleration
from kickdrift.world.collision.continuous.missed_contacts import drop_paths
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.bounce_speed import restitution_of, slowest_bounce
from kickdrift.world.contacts.impacts.struck_bodies import strikes
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.contact_active_set import BOUNCE, BOUNCE_FRICTION, read_both, twelve
from kickdrift.world.direct.contact_lookup import contact_row, linked_bodies, linked_constraint, row_of
from kickdrift.world.direct.contact_rows import impulse_field
from kickdrift.world.direct.contact_wrenches import along, write_wrench
from kickdrift.world.direct.energy_bounds import energy_driven
from kickdrift.world.direct.energy_guard import NO_MORE, has_more
from kickdrift.world.direct.island_accelerations import find_accelerations, read_accelerations
from kickdrift.world.direct.island_solver import solve_at_once
from kickdrift.world.direct.island_velocities import (
    fastest,
    kinetic_energy,
    note_velocities,
    restore_impulses,
    take_back_velocities,
)
from kickdrift.world.direct.islands import direct_islands
from kickdrift.world.direct.joint_impulses import clear_impulses
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.right_hand_side import RELAX
from kickdrift.world.step.status import DO_LINKAGE_IN_PARTS, HALVINGS, MOST_HALVINGS, OK, STATUS
from kickdrift.world.tables import CONTACT, DELTA_POSE, ISLAND, ISLAND_CONTACT, MOTION, STEP_STATUS, integers

_ROUNDS = 30

# Turn of a body of a linkage in a substep, rad, above which a step with a bounce is done in parts. Halved four times at most,
# one of six planar linkages that strike a wall gains 2 % of its energy.
_WHIRL = 0.07


@compiled
def bounce_islands(t: float, h: float, world: int) -> None:
    """Resolve the bounces of all impacts in islands within the substep."""
    status = integers(world, STEP_STATUS)
    for island in range(direct_islands(world)):
        if not _resolve_impacts(world, island, h):
            _leave_impacts(world, island)
        elif status[0, HALVINGS] < MOST_HALVINGS and _whirls(world, island, h):
            drop_paths(t, h, world)
            if status[0, STATUS] == OK:
                status[0, STATUS] = DO_LINKAGE_IN_PARTS
            return


@compiled(cached=False)
def _whirls(world: int, island: int, h: float) -> bool:
    """Whether the bodies of a linkage that has bounced in the step turn too far in a substep to keep its energy."""
    own, order, bounced = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT), False
    if own[d.HAS_JOINTS] == 0:  # free bodies rotate exactly
        return False
    for k in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
        row = row_of(world, order[k, 0])
        hit = integers(world, CONTACT)[row, c.CONTACT_STATE] & c.BOUNCED != 0
        bounced = bounced or (hit and restitution_of(world, row) > 0.0)
    return bounced and h * fastest(world, island, MOTION, j.ANGULAR_PART) > _WHIRL


@compiled(cached=False)
def _resolve_impacts(world: int, island: int, h: float) -> bool:
    """Resolve the impacts of an island in rounds; return whether no point hits any more."""
    for n in range(_ROUNDS):
        if not _find_hits(world, island, h):
            return True
        if n == 0:
            find_accelerations(world, island, h)
        _find_speeds(world, island)
        note_velocities(world, island)
        clear_impulses(world, island)
        most = NO_MORE * energy_driven(world, island, kinetic_energy(world, island, MOTION))
        solve_at_once(world, island, h, RELAX, BOUNCE)
        if has_more(world, island, most):  # no solution: nothing bounces
            take_back_velocities(world, island)
            restore_impulses(world, island)
            break
        note_velocities(world, island)  # friction without a solution is left out
        if not solve_at_once(world, island, h, RELAX, BOUNCE_FRICTION) or has_more(world, island, most):
            take_back_velocities(world, island)
        restore_impulses(world, island)
    return False


@compiled(cached=False)
def _leave_impacts(world: int, island: int) -> None:
    """Let the solution of the substep stop all points of an island, and not only those too slow to bounce in the next one."""
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT)
    for k in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
        linked_constraint(world, order[k, 0])[c.BOUNCE_THRESHOLD * c.WIDTH] = 1e300


@compiled(cached=False)
def _find_hits(world: int, island: int, h: float) -> bool:
    """Mark the points of an island that hit; return whether any does."""
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT)
    contact, found, struck = integers(world, CONTACT), False, False
    for k in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
        struck = struck or strikes(world, row_of(world, order[k, 0]))
    for k in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
        row = row_of(world, order[k, 0])
        if _hits(world, order[k, 0], restitution_of(world, row) > 0.0 or struck, h):
            contact[row, c.CONTACT_STATE] |= c.BOUNCED
            found = True
    return found


@compiled(cached=False)
def _hits(world: int, index: int, may_hit: bool, h: float) -> bool:
    """Mark the points of a contact that hit (HITS); return whether any hits within the substep."""
    a, b = linked_bodies(world, index)
    own, numbers = linked_constraint(world, index), contact_row(world, index)
    row = row_of(world, index)
    slowest, closing = slowest_bounce(world, h, row), closing_acceleration(world, row)
    velocity, change, wrench = twelve(), twelve(), twelve()
    read_both(world, MOTION, a, b, velocity)
    read_both(world, DELTA_POSE, a, b, change)
    hit = False
    for k in range(d.TANGENT):
        numbers[d.HITS + k] = -1.0
        i = (c.P + c.POINT_FIELDS * k) * c.WIDTH
        if not may_hit or own[i + c.POINT_MASS * c.WIDTH] == 0.0:
            continue
        write_wrench(own, k, wrench)
        gap = own[i + c.GAP * c.WIDTH] + along(wrench, change)
        speed = along(wrench, velocity)
        if speed < -slowest and gap + 2.0 * h * speed <= 0.0:
            numbers[d.HITS + k] = 0.0
            # The solution of the substep would stop a point that forces bring to the surface within it.
            hit = hit or gap + h * (speed - h * closing) <= 0.0
    for k in range(d.TANGENT):
        numbers[d.HITS + k] = numbers[d.HITS + k] if hit else -1.0
    if hit:
        for k in range(d.CONTACT_ROWS):
            own[impulse_field(k) * c.WIDTH] = 0.0
    return hit


@compiled(cached=False)
def _find_speeds(world: int, island: int) -> None:
    """Find the speeds after the impact of the points of an island that hit.

    On the rest of the way forces and joints make a point faster, and slower on the way back to the start of the substep.
    """
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT)
    velocity, change, forced, wrench = twelve(), twelve(), twelve(), twelve()
    for place in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
        index = order[place, 0]
        a, b = linked_bodies(world, index)
        fields, numbers, e = (
            linked_constraint(world, index),
            contact_row(world, index),
            restitution_of(world, row_of(world, index)),
        )
        read_both(world, MOTION, a, b, velocity)
        read_both(world, DELTA_POSE, a, b, change)
        read_accelerations(world, island, a, b, forced)
        for k in range(d.TANGENT):
            if numbers[d.HITS + k] < 0.0:
                continue
            write_wrench(fields, k, wrench)
            gap = fields[(c.P + c.POINT_FIELDS * k + c.GAP) * c.WIDTH] + along(wrench, change)
            speed, gained = along(wrench, velocity), -2.0 * along(wrench, forced) * max(gap, 0.0)
            numbers[d.HITS + k] = math.sqrt(max(e * e * (speed * speed + gained) - gained, 0.0))
