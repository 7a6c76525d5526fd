"""The direct solver: RATTLE for an island. Newton's method before the drift, a projection after it.

A substep is symplectic, as the kick and the drift between are: impulses along the joints' directions at its start, such that
nothing is off at its end, and then the velocities' projection onto what the joints allow there. Hairer, Lubich, Wanner,
Geometric Numerical Integration, 2nd ed. (2006), section VII.1.4. Contacts are rows of the same equations. Which pieces of the
laws of axes and of contacts hold is assumed, and solved again as long as a solution lies on other ones: an active-set, or
semi-smooth Newton, method.

Where the substep is too long for that, as where a chain with a heavy end cracks like a whip, velocities are projected before
the drift too, which never adds to their energy, and bodies are put back to where the joints hold them.
"""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import applied, dot, exponential, length, times, turned, turned_back
from kickdrift.world.columns import quaternion_at, symmetric_at, vector_at
from kickdrift.world.direct.closings import (
    add_closings,
    begin_closings,
    load_closings,
    predict_closings,
    refine_closings,
    stay_closings,
)
from kickdrift.world.direct.contact_impulses import give_contacts, left_of_contacts, predict_contacts, refine_contacts
from kickdrift.world.direct.contacts import (
    BOUNCE,
    PRESS,
    REST,
    add_contacts,
    begin_contacts,
    fix_contacts,
    is_cut,
    load_contacts,
    note_impulses,
    review_contacts,
)
from kickdrift.world.direct.factorisation import factor
from kickdrift.world.direct.layout import (
    AFTER_CLOSING,
    AFTER_NODE,
    FIRST_CLOSING,
    FIRST_NODE,
    LINK_ROW,
    LOST,
    RATIO,
)
from kickdrift.world.direct.matrix import clear_blocks, put_inertia
from kickdrift.world.direct.substitution import substitute
from kickdrift.world.flight import BODY_INERTIA, MASS
from kickdrift.world.joints.aim import AHEAD, GENTLY, RELAX, REPAIR, aim
from kickdrift.world.joints.brakes import set_brakes
from kickdrift.world.joints.falling import let_fall
from kickdrift.world.joints.impulses import note_speeds, push_bodies
from kickdrift.world.joints.laws import end_laws, review_laws
from kickdrift.world.joints.layout import (
    ANGULAR_PART,
    AXES,
    BEFORE,
    BODY_B,
    GAIN,
    GIVEN,
    IMPULSE,
    LAWS,
    LINEAR,
    LINK_JOINT,
    LOAD,
    POINT,
    SIGN,
    SOLVED,
    TOTAL,
    WRENCH,
    int64,
)
from kickdrift.world.joints.layout import BODY as LINK_BODY
from kickdrift.world.joints.measure import measure, put_vector
from kickdrift.world.joints.repair import shift_body
from kickdrift.world.settings import RESIDUAL
from kickdrift.world.tables import (
    INERTIA,
    ISLAND,
    ISLAND_CLOSING,
    JOINT,
    JOINT_NUMBERS,
    LINK,
    LINK_NUMBERS,
    MOTION,
    NODE,
    POSE,
    SETTINGS,
    floats,
    integers,
    rows,
)

# Newton's method stops where the parts of their arms that joints are off by, times the ratio of masses, are below CLOSE. The
# usual island takes two steps; one that is not NEAR after QUICK of them begins again from velocities that joints allow.
# Each step squares what trees are off by, so that below SURE no one looks whether the step has done so.
QUICK, ROUNDS, CLOSE, CLOSE_LOOPS, NEAR, SURE = 3, 6, 1e-6, 1e-9, 1e-5, 1e-3

# Given up is what is farther off than that at the end, in parts of the arms, or has more energy than that times what velocities
# have that joints allow: there are solutions far away, which no one wants.
FAR, EXCESS = 1e-3, 1.5

# First guesses that are farther off than that are replaced by velocities that joints allow, from which no step leads astray.
POOR = 0.1

# Solutions with other pieces of laws assumed, and then with axes and points let go only, which comes to an end.
TRIALS, LAST_TRIALS = 3, 3

# Times that a solution is put right by its own matrix, if it leaves more than that of a held row: m/s.
REFINEMENTS, UNNOTICED = 3, 1e-9

REPAIRS = 8


@compiled
def solve_islands(t: float, h: float, world: int) -> None:
    """Find the impulses with which nothing is off at the end of the substep, before the drift."""
    islands = integers(world, ISLAND)
    for island in range(rows(world, ISLAND)):
        note_velocities(island, world)
        note_impulses(island, False, world)
        islands[island, LOST] = 0
        off = islands[island, RATIO] * aim_island(island, h, AHEAD, world)
        if not (off <= POOR and _approach(island, h, off, QUICK, world) <= NEAR):
            _take_care(island, h, world)
    for island in range(rows(world, ISLAND)):
        if is_cut(island, world):
            _hold(island, h, world)
        end_solution(island, h, world)
    let_fall(world)


@compiled
def relax_islands(t: float, h: float, world: int) -> None:
    """Take from the velocities what joints and contacts do not allow where bodies are now, after the drift."""
    islands = integers(world, ISLAND)
    for island in range(rows(world, ISLAND)):
        if islands[island, LOST] != 0:
            repair(island, h, world)
            note_velocities(island, world)
            note_impulses(island, False, world)
            _project(island, h, RELAX, REST, world)
        else:
            solve_at_once(island, h, RELAX, REST, world)
    for island in range(rows(world, ISLAND)):
        if is_cut(island, world):
            aim_island(island, h, RELAX, world)
            stay_closings(island, world)
            hold(island, h, 0.0, REST, world)
        end_relaxation(island, h, world)


@compiled
def measure_islands(t: float, h: float, world: int) -> None:
    """Measure what is left unsolved of the contacts of islands: how fast points that press part or approach, at most."""
    settings = floats(world, SETTINGS)
    for island in range(rows(world, ISLAND)):
        settings[0, RESIDUAL] = max(settings[0, RESIDUAL], left_of_contacts(island, world))


@compiled(cached=False)
def _approach(island: int, h: float, off: float, most: int, world: int) -> float:
    """Take steps of Newton's method, and return how far joints will be off, times the ratio of masses."""
    own = integers(world, ISLAND)[island]
    ratio, closed = own[RATIO], own[AFTER_CLOSING] > own[FIRST_CLOSING]
    for step in range(most):
        begin_closings(island, world)
        begin_contacts(island, h, PRESS, world)
        solve_once(island, h, h, PRESS, step == 0, world)
        off = ratio * aim_island(island, h, AHEAD, world) if closed or off > SURE else off * off
        if off <= (CLOSE_LOOPS if closed else CLOSE):
            break
    return off


@compiled(cached=False)
def _take_care(island: int, h: float, world: int) -> None:
    """Begin with velocities that joints allow, and stay with them if no solution is found near to them."""
    islands = integers(world, ISLAND)
    _project(island, h, GENTLY, PRESS, world)
    energy = kinetic_energy(island, world)
    off = islands[island, RATIO] * aim_island(island, h, AHEAD, world)
    off = _approach(island, h, off, ROUNDS, world)
    if not (
        off <= FAR * islands[island, RATIO] and kinetic_energy(island, world) <= _lawful(island, h, world) * energy
    ):
        islands[island, LOST] = 1
        _project(island, h, GENTLY, PRESS, world)


@compiled(cached=False)
def _lawful(island: int, h: float, world: int) -> float:
    """Part of its energy that an island may have before the drift: what turns by an angle a in the substep has a^2 / 2 more."""
    own, nodes, work = integers(world, ISLAND)[island], integers(world, NODE), floats(world, LINK_NUMBERS)
    fastest = 0.0
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        fastest = max(fastest, h * length(vector_at(work, nodes[node, LINK_ROW], int64(BEFORE + 3))))
    return 1.01 + 0.6 * min(fastest, 1.5) ** 2


@compiled(cached=False)
def _hold(island: int, h: float, world: int) -> None:
    """Let joints take up what contacts with other islands have given: for the end of the substep where that is near."""
    islands = integers(world, ISLAND)
    near = islands[island, RATIO] * aim_island(island, h, AHEAD, world) <= POOR and islands[island, LOST] == 0
    if near:
        begin_closings(island, world)
    else:
        aim_island(island, h, GENTLY, world)
        stay_closings(island, world)
    hold(island, h, h if near else 0.0, PRESS, world)


@compiled(cached=False)
def solve_at_once(island: int, h: float, mode: int, task: int, world: int) -> None:
    """Project velocities onto what joints and contacts allow where bodies are."""
    aim_island(island, h, mode, world)
    stay_closings(island, world)
    begin_contacts(island, h, task, world)
    solve_once(island, h, 0.0, task, True, world)


@compiled(cached=False)
def _project(island: int, h: float, mode: int, task: int, world: int) -> None:
    """Go back to the velocities that were noted, and project them.

    Where that adds energy, a limit that has been passed by far throws what it holds: then without laws of axes, or not at all.
    """
    take_back(island, world)
    energy = kinetic_energy(island, world)
    solve_at_once(island, h, mode, task, world)
    if kinetic_energy(island, world) <= EXCESS * energy:
        return
    take_back(island, world)
    aim_island(island, h, mode, world)
    stay_closings(island, world)
    begin_contacts(island, h, task, world)
    review_contacts(island, task, True, True, world)
    _solve(island, 0.0, world)
    give_joints(island, task, world)
    give_contacts(island, task, world)
    if not kinetic_energy(island, world) <= EXCESS * energy:
        take_back(island, world)


@compiled(cached=False)
def kinetic_energy(island: int, world: int) -> float:
    """Kinetic energy of an island."""
    own, nodes, links = integers(world, ISLAND)[island], integers(world, NODE), integers(world, LINK)
    motion, pose, inertia = floats(world, MOTION), floats(world, POSE), floats(world, INERTIA)
    total = 0.0
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        body = links[nodes[node, LINK_ROW], LINK_BODY]
        v = vector_at(motion, body, int64(0))
        turn = turned_back(quaternion_at(pose, body, ANGULAR_PART), vector_at(motion, body, ANGULAR_PART))
        moments = symmetric_at(inertia, body, int64(BODY_INERTIA))
        total += inertia[body, MASS] * dot(v, v) + dot(turn, applied(moments, turn))
    return 0.5 * total


@compiled(cached=False)
def aim_island(island: int, h: float, mode: int, world: int) -> float:
    """Say what is wanted of each joint of an island, and return how far any of them will be off at most."""
    own, nodes, links = integers(world, ISLAND)[island], integers(world, NODE), integers(world, LINK)
    order, worst = integers(world, ISLAND_CLOSING), 0.0
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        link = nodes[node, LINK_ROW]
        if links[link, LINK_JOINT] >= 0:
            off = aim(links[link, LINK_JOINT], link, h, mode, world)
            worst = worst if off <= worst else off  # which is no number where it is none
    for place in range(own[FIRST_CLOSING], own[AFTER_CLOSING]):
        link = order[place, 0]
        off = aim(links[link, LINK_JOINT], link, h, mode, world)
        worst = worst if off <= worst else off
    return worst


@compiled(cached=False)
def solve_once(island: int, h: float, ahead: float, task: int, first: bool, world: int) -> None:
    """Solve the equations until all pieces of laws fit that were assumed, and give the impulses."""
    settled = False
    for trial in range(TRIALS + LAST_TRIALS):
        settled = review_joints(island, h, task, trial, world)
        settled = review_contacts(island, task, first and trial == 0, trial > TRIALS, world) and settled
        if trial > 0 and settled:
            break
        integers(world, ISLAND)[island, 12 + task] += 1
        _solve(island, ahead, world)
    integers(world, ISLAND)[island, 8 + task] += 1
    if not settled:
        integers(world, ISLAND)[island, 10 + task] += 1
        fix_contacts(island, world)
        _solve(island, ahead, world)
    give_joints(island, task, world)
    give_contacts(island, task, world)


@compiled(cached=False)
def hold(island: int, h: float, ahead: float, task: int, world: int) -> None:
    """Let joints alone take up what contacts with other islands have given since they were solved."""
    own = integers(world, ISLAND)[island]
    for trial in range(TRIALS + LAST_TRIALS):
        settled = review_joints(island, h, task, trial, world)
        if trial > 0 and settled:
            break
        assemble(island, ahead, world)
        factor(own[FIRST_NODE], own[AFTER_NODE], world)
        _predict(island, False, world)
    give_joints(island, task, world)


@compiled(cached=False)
def _solve(island: int, ahead: float, world: int) -> None:
    """Solve the equations with the pieces of laws that are assumed."""
    assemble(island, ahead, world)
    add_contacts(island, world)
    factor(integers(world, ISLAND)[island, FIRST_NODE], integers(world, ISLAND)[island, AFTER_NODE], world)
    _predict(island, True, world)
    for _ in range(REFINEMENTS):
        if max(refine_closings(island, world), 1e-4 * refine_contacts(island, world)) < UNNOTICED:
            break
        _predict(island, True, world)


@compiled(cached=False)
def _predict(island: int, touched: bool, world: int) -> None:
    """Find what the matrix at hand answers to the rows of an island."""
    own, nodes = integers(world, ISLAND)[island], integers(world, NODE)
    work = floats(world, LINK_NUMBERS)
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        for k in range(6):
            work[nodes[node, LINK_ROW], LOAD + k] = 0.0
    load_closings(island, world)
    if touched:
        load_contacts(island, world)
    substitute(own[FIRST_NODE], own[AFTER_NODE], world)
    predict_closings(island, world)
    if touched:
        predict_contacts(island, world)


@compiled(cached=False)
def assemble(island: int, ahead: float, world: int) -> None:
    """Write the matrix of bodies and closing joints, for velocities that act for a time `ahead`."""
    own, nodes = integers(world, ISLAND)[island], integers(world, NODE)
    clear_blocks(own[FIRST_NODE], own[AFTER_NODE], world)
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        put_inertia(nodes[node, LINK_ROW], ahead, world)
    add_closings(island, world)


@compiled(cached=False)
def review_joints(island: int, h: float, task: int, trial: int, world: int) -> bool:
    """Assume the pieces of laws of joints that the solution at hand points to, and say whether it was made with them."""
    own, nodes, links = integers(world, ISLAND)[island], integers(world, NODE), integers(world, LINK)
    joints, order, opened = integers(world, JOINT), integers(world, ISLAND_CLOSING), trial > TRIALS
    settled = True
    if task >= BOUNCE:
        return True  # laws are forces, which do nothing in an instant
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        link = nodes[node, LINK_ROW]
        joint = links[link, LINK_JOINT]
        if joint >= 0 and joints[joint, LAWS] != 0:
            if trial > 0:
                split_impulse(link, joint, world)
            settled = not review_laws(joint, link, h, task != PRESS, opened, world) and settled
    for place in range(own[FIRST_CLOSING], own[AFTER_CLOSING]):
        joint = links[order[place, 0], LINK_JOINT]
        if joints[joint, LAWS] != 0:
            settled = not review_laws(joint, order[place, 0], h, task != PRESS, opened, world) and settled
    return settled


@compiled(cached=False)
def split_impulse(link: int, joint: int, world: int) -> None:
    """Split the impulse at a joint of a tree among its axes."""
    links, work, numbers = integers(world, LINK), floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    force, torque = vector_at(work, link, WRENCH), vector_at(work, link, WRENCH + 3)
    for k in range(6):
        along = dot(vector_at(numbers, joint, AXES + 3 * k), force if k < 3 else torque)
        work[link, GIVEN + k] = links[link, SIGN] * along


@compiled(cached=False)
def give_joints(island: int, task: int, world: int) -> None:
    """Give bodies the impulses of joints that were found."""
    own, nodes, links = integers(world, ISLAND)[island], integers(world, NODE), integers(world, LINK)
    order = integers(world, ISLAND_CLOSING)
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        link = nodes[node, LINK_ROW]
        joint = links[link, LINK_JOINT]
        if joint >= 0:
            split_impulse(link, joint, world)
            give_joint(joint, link, task, world)
    for place in range(own[FIRST_CLOSING], own[AFTER_CLOSING]):
        give_joint(links[order[place, 0], LINK_JOINT], order[place, 0], task, world)


@compiled(cached=False)
def give_joint(joint: int, link: int, task: int, world: int) -> None:
    """Give bodies the impulses at a joint; those of a bounce are no guess for the next substep."""
    work, numbers = floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    column = TOTAL if task >= BOUNCE else IMPULSE
    for k in range(6):
        numbers[joint, column + k] += work[link, GIVEN + k]
    push_bodies(joint, work, link, GIVEN, world)


@compiled(cached=False)
def end_solution(island: int, h: float, world: int) -> None:
    """Keep what was given before the drift."""
    own, nodes, links = integers(world, ISLAND)[island], integers(world, NODE), integers(world, LINK)
    order = integers(world, ISLAND_CLOSING)
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        link = nodes[node, LINK_ROW]
        if links[link, LINK_JOINT] >= 0:
            end_joint(links[link, LINK_JOINT], link, h, world)
    for place in range(own[FIRST_CLOSING], own[AFTER_CLOSING]):
        end_joint(links[order[place, 0], LINK_JOINT], order[place, 0], h, world)


@compiled(cached=False)
def end_joint(joint: int, link: int, h: float, world: int) -> None:
    """Keep what a joint has given before the drift."""
    numbers = floats(world, JOINT_NUMBERS)
    for k in range(6):
        numbers[joint, SOLVED + k] = numbers[joint, IMPULSE + k]
    if integers(world, JOINT)[joint, LAWS] != 0:
        end_laws(joint, link, h, world)


@compiled(cached=False)
def end_relaxation(island: int, h: float, world: int) -> None:
    """Add up the impulses of the substep, and make ready for the next one."""
    own, nodes, links = integers(world, ISLAND)[island], integers(world, NODE), integers(world, LINK)
    order, joints = integers(world, ISLAND_CLOSING), integers(world, JOINT)
    lost = own[LOST] != 0
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        link = nodes[node, LINK_ROW]
        if links[link, LINK_JOINT] >= 0:
            set_brakes(link, links[link, LINK_JOINT], h, world)
            turn_on(links[link, LINK_JOINT], links[link, LINK_BODY], h, lost, world)
    for place in range(own[FIRST_CLOSING], own[AFTER_CLOSING]):
        joint = links[order[place, 0], LINK_JOINT]
        turn_on(joint, joints[joint, BODY_B], h, lost, world)


@compiled(cached=False)
def turn_on(joint: int, body: int, h: float, lost: bool, world: int) -> None:
    """Let the next substep begin as this one did, turned as the body was.

    With the impulse of the relaxation, which bends the paths of what turns, the first guess of Newton's method would be farther
    away. Impulses of no solution are no guess.
    """
    numbers = floats(world, JOINT_NUMBERS)
    note_speeds(joint, world)
    for k in range(6):
        numbers[joint, TOTAL + k] += numbers[joint, IMPULSE + k]
        numbers[joint, IMPULSE + k] = 0.0 if lost else numbers[joint, SOLVED + k]
    if integers(world, JOINT)[joint, LINEAR] == POINT:
        turn = exponential(times(h, vector_at(floats(world, MOTION), body, ANGULAR_PART)))
        put_vector(numbers, joint, IMPULSE, turned(turn, vector_at(numbers, joint, IMPULSE)))
    for k in range(6):
        numbers[joint, SOLVED + k] = numbers[joint, IMPULSE + k]


@compiled(cached=False)
def note_velocities(island: int, world: int) -> None:
    """Keep the velocities of an island."""
    own, nodes, links = integers(world, ISLAND)[island], integers(world, NODE), integers(world, LINK)
    motion, work = floats(world, MOTION), floats(world, LINK_NUMBERS)
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        link = nodes[node, LINK_ROW]
        for k in range(6):
            work[link, BEFORE + k] = motion[links[link, LINK_BODY], k]


@compiled(cached=False)
def take_back_velocities(island: int, world: int) -> None:
    """Go back to the velocities that were noted; taking impulses back would leave their rounding."""
    own, nodes, links = integers(world, ISLAND)[island], integers(world, NODE), integers(world, LINK)
    motion, work = floats(world, MOTION), floats(world, LINK_NUMBERS)
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        link = nodes[node, LINK_ROW]
        for k in range(6):
            motion[links[link, LINK_BODY], k] = work[link, BEFORE + k]


@compiled(cached=False)
def take_back(island: int, world: int) -> None:
    """Go back to the velocities that were noted, and to the impulses that they had."""
    own, nodes, links = integers(world, ISLAND)[island], integers(world, NODE), integers(world, LINK)
    order = integers(world, ISLAND_CLOSING)
    take_back_velocities(island, world)
    note_impulses(island, True, world)
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        if links[nodes[node, LINK_ROW], LINK_JOINT] >= 0:
            begin_anew(links[nodes[node, LINK_ROW], LINK_JOINT], world)
    for place in range(own[FIRST_CLOSING], own[AFTER_CLOSING]):
        begin_anew(links[order[place, 0], LINK_JOINT], world)


@compiled(cached=False)
def begin_anew(joint: int, world: int) -> None:
    """Let a joint have given what it had in the end of the substep before."""
    numbers = floats(world, JOINT_NUMBERS)
    for k in range(6):
        numbers[joint, IMPULSE + k] = numbers[joint, SOLVED + k]


@compiled(cached=False)
def repair(island: int, h: float, world: int) -> None:
    """Put bodies where joints hold them, by changes of position that have no velocity."""
    own, nodes, links = integers(world, ISLAND)[island], integers(world, NODE), integers(world, LINK)
    order, work = integers(world, ISLAND_CLOSING), floats(world, LINK_NUMBERS)
    first, after = own[FIRST_NODE], own[AFTER_NODE]
    for _ in range(REPAIRS):
        aim_island(island, h, REPAIR, world)
        stay_closings(island, world)
        assemble(island, -1.0, world)
        factor(first, after, world)
        _predict(island, False, world)
        for node in range(first, after):
            link = nodes[node, LINK_ROW]
            way, turn = times(h, vector_at(work, link, GAIN)), times(h, vector_at(work, link, GAIN + 3))
            turn = times(1.0 / max(1.0, 2.0 * length(turn)), turn)
            shift_body(links[link, LINK_BODY], way, turn, world)
        for node in range(first, after):
            if links[nodes[node, LINK_ROW], LINK_JOINT] >= 0:
                measure(links[nodes[node, LINK_ROW], LINK_JOINT], world)
        for place in range(own[FIRST_CLOSING], own[AFTER_CLOSING]):
            measure(links[order[place, 0], LINK_JOINT], world)
