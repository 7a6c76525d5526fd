"""Active-set method: the equations of an island are solved until the solution lies on the assumed pieces of all laws."""

from kickdrift.core.compilation import compiled
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.contact_active_set import (
    BOUNCE,
    BOUNCE_FRICTION,
    REST,
    bounds_hold,
    fix_contacts,
    phase_of,
    update_contact_states,
)
from kickdrift.world.direct.contact_assembly import add_contacts, load_contacts
from kickdrift.world.direct.contact_impulses import give_contacts, predict_contacts, refine_contacts
from kickdrift.world.direct.factorisation import factor
from kickdrift.world.direct.island_velocities import inner_speed
from kickdrift.world.direct.joint_impulses import give_joints
from kickdrift.world.direct.line_search import search_line
from kickdrift.world.direct.loop_closures import add_closings, load_closings, predict_closings, refine_closings
from kickdrift.world.direct.matrix import clear_blocks, put_inertia
from kickdrift.world.direct.substitution import substitute
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.law_pieces import fix_laws, refine_laws, update_law_states
from kickdrift.world.joints.limits_motors import begin_laws
from kickdrift.world.tables import ISLAND, ISLAND_JOINT, JOINT, LINK, LINK_NUMBERS, MOTION, NODE, floats, integers

# Largest number of solutions with different pieces of laws assumed. With 40, sixteen ragdolls in a heap take 1.7 times as long,
# 64 balls that settle in a pen twice, and no more scenes of the lab hold; a ball that strikes a wall of 56 blocks leaves its
# points at 0.18 m/s in the mean, with 40 at 0.05.
TRIALS = 20

# The same for the friction of bounces, which are rare. Of 3600 impacts of one to six balls and boxes on linkages at once, 2.8 %
# need more than 20, 0.4 % more than 40, and 0.2 % more than 60, for which 200 are not enough either.
BOUNCE_FRICTION_TRIALS = 60

# Largest number of iterative refinements with the same matrix, if held rows have a residual above REFINED, m/s: for islands
# with joints, and for heaps, whose mass ratios are the worst, and which come to rest the better the smaller the residual is.
# _NOTICED_POINT, and in bounces _NOTICED_HIT, is the residual allowed to contacts of the former, _NOTICED_HEAP_POINT that to
# contacts of the latter. With 1e-6 for _NOTICED_POINT, sixteen ragdolls take 1.13 times as long, a quadruped 1.06 times. With
# 1e-4 the feet of one whose joints swing by 2 mrad creep at 5e-6 m/s, with 3e-5 and less at 9e-7.
REFINEMENTS, REFINED = 3, 1e-9
_HEAP_REFINEMENTS = 5
_NOTICED_POINT, _NOTICED_HIT, _NOTICED_HEAP_POINT = 3e-5, 1e-6, 1e-7

# Except in bounces, contacts may have a residual of this fraction of `inner_speed`, the root mean square speed of internal
# motion. In heaps of ragdolls that have just fallen, a projection takes 9.1 solutions without, 8.2 with 7e-4, and 6.7 with
# 7e-3, with which feet would slip visibly. And bounds of the friction of heaps may be off by what changes velocities by
# _NOTICED_BOUND of it: 64 polyhedra that fall into a shaft take 0.28 s in their worst step without, 0.15 s with 0.01 to 0.1.
_NOTICED_PART, _NOTICED_BOUND = 1e-3, 1e-2


@compiled
def solve_island(world: int, island: int, h: float, ahead: float, task: int, afresh: bool, touched: bool) -> bool:
    """Solve the equations of an island until all assumed pieces of laws fit, and apply the impulses.

    Friction of contacts is bounded by the normal impulses at the start, and then by those of each solution,
    until these bounds hold: with fixed bounds laws are convex, and a solution is found from any start. Bounds by what is no
    solution yet grow beyond all measure: a ball at 15 m/s would drive a block out of a wall at 18 m/s, and free ones at 12.6.

    Parameters
    ----------
    world, island : int
    h, ahead : float
        Substep, and the time for which the new velocities act: h, or 0 for a projection, s; or `CORRECTION` or `PREDICTION`.
    task : int
        The laws of contacts: `PRESS`, `REST`, `BOUNCE` or `BOUNCE_FRICTION`.
    afresh : bool
        Whether the pieces of the laws of contacts are assumed afresh; those of joints always are.
    touched : bool
        Whether contacts take part; otherwise their impulses do not change.

    Returns
    -------
    bool
        Whether the laws are satisfied.
    """
    if ahead < 0.0:
        solve_assumed(world, island, ahead, touched)
        return True
    heap = integers(world, ISLAND)[island, d.HAS_JOINTS] == 0
    left, whole, found = _HEAP_REFINEMENTS if heap else REFINEMENTS, True, False
    for trial in range(BOUNCE_FRICTION_TRIALS if task == BOUNCE_FRICTION else TRIALS):
        settled = review(world, island, h, task, trial == 0, afresh, touched, whole) and whole and trial > 0
        if settled:
            moving = _NOTICED_BOUND * inner_speed(world, island, MOTION) if heap and task == REST else 0.0
            found = left == 0 or refine(world, island, task, touched) < REFINED
            left = left if found else left - 1
            found = (not touched or bounds_hold(world, island, task, moving)) and found
            if found:
                break
            settled = review(world, island, h, task, False, False, touched, True)
        if not settled:
            factor_island(world, island, ahead, touched)
        predict(world, island, touched)
        whole = search_line(world, island, trial == 0, touched)
    if not found:
        fix_impulses(world, island, touched)
        solve_assumed(world, island, ahead, touched)
    give_joints(world, island, task)
    if touched:
        give_contacts(world, island, task)
    return found


@compiled(cached=False)
def solve_assumed(world: int, island: int, ahead: float, touched: bool) -> None:
    """Solve the equations once, with the assumed pieces of laws."""
    factor_island(world, island, ahead, touched)
    predict(world, island, touched)


@compiled(cached=False)
def factor_island(world: int, island: int, ahead: float, touched: bool) -> None:
    """Assemble and factor the matrix of an island, with the assumed pieces of laws."""
    assemble(world, island, ahead)
    if touched:
        add_contacts(world, island)
    factor(world, integers(world, ISLAND)[island, d.FIRST_NODE], integers(world, ISLAND)[island, d.AFTER_NODE])


@compiled(cached=False)
def fix_impulses(world: int, island: int, touched: bool) -> None:
    """Fix the impulses of contacts, and of motors and friction of joints, to those of the accepted solution, within bounds."""
    own, order, links = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT), integers(world, LINK)
    if touched:
        fix_contacts(world, island)
    for place in range(own[d.FIRST_JOINT], own[d.AFTER_JOINT]):
        joint = links[order[place, 0], j.LINK_JOINT]
        if integers(world, JOINT)[joint, j.LAWS] != 0:
            fix_laws(world, joint, order[place, 0])


@compiled(cached=False)
def refine(world: int, island: int, task: int, touched: bool) -> float:
    """Begin the next solution with the impulses of the current one, and return the residual of its held rows, m/s.

    Tolerances of contacts and laws other than `REFINED` are expressed by scaling their residuals.
    """
    own, order, links = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT), integers(world, LINK)
    joints, worst = integers(world, JOINT), refine_closings(world, island)
    if touched:
        left, noticed = refine_contacts(world, island), _NOTICED_POINT if task < BOUNCE else _NOTICED_HIT
        noticed = noticed if own[d.HAS_JOINTS] != 0 else _NOTICED_HEAP_POINT
        if left > noticed and task < BOUNCE:
            noticed = max(noticed, _NOTICED_PART * inner_speed(world, island, MOTION))
        worst = max(worst, REFINED / noticed * left)
    for place in range(own[d.FIRST_JOINT], own[d.AFTER_JOINT]):
        link = order[place, 0]
        if joints[links[link, j.LINK_JOINT], j.LAWS] != 0:
            worst = max(worst, 1e-2 * refine_laws(world, links[link, j.LINK_JOINT], link))
    return worst


@compiled(cached=False)
def predict(world: int, island: int, touched: bool) -> None:
    """Find changes of velocity and impulses of an island with the factored matrix."""
    own, nodes = integers(world, ISLAND)[island], integers(world, NODE)
    work = floats(world, LINK_NUMBERS)
    for node in range(own[d.FIRST_NODE], own[d.AFTER_NODE]):
        for k in range(6):
            work[nodes[node, d.LINK_ROW], j.CLOSING_IMPULSE + k] = 0.0
    load_closings(world, island)
    if touched:
        load_contacts(world, island)
    substitute(world, own[d.FIRST_NODE], own[d.AFTER_NODE])
    predict_closings(world, island)
    if touched:
        predict_contacts(world, island)


@compiled(cached=False)
def assemble(world: int, island: int, ahead: float) -> None:
    """Write the matrix of bodies and closing joints, for velocities that act for a time `ahead`."""
    own, nodes = integers(world, ISLAND)[island], integers(world, NODE)
    clear_blocks(world, own[d.FIRST_NODE], own[d.AFTER_NODE])
    for node in range(own[d.FIRST_NODE], own[d.AFTER_NODE]):
        put_inertia(world, nodes[node, d.LINK_ROW], ahead)
    add_closings(world, island)


@compiled(cached=False)
def review(world: int, island: int, h: float, task: int, first: bool, afresh: bool, touched: bool, whole: bool) -> bool:
    """Assume the pieces of laws that the current solution implies, and return whether it was found with them."""
    own, order, links = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT), integers(world, LINK)
    joints, settled = integers(world, JOINT), True
    if touched:
        settled = update_contact_states(world, island, task, first and afresh, whole)
    for place in range(own[d.FIRST_JOINT], own[d.AFTER_JOINT]):
        joint = links[order[place, 0], j.LINK_JOINT]
        if joints[joint, j.LAWS] != 0:
            if first:
                begin_laws(world, joint, order[place, 0], h, phase_of(task))
            settled = update_law_states(world, joint, order[place, 0], first) and settled
    return settled
