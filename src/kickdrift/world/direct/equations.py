"""The equations of an island, solved until the pieces of laws fit that were assumed: an active-set method."""

from kickdrift.core.compilation import compiled
from kickdrift.world.direct.closings import (
    add_closings,
    load_closings,
    predict_closings,
    refine_closings,
)
from kickdrift.world.direct.contact_impulses import give_contacts, predict_contacts, refine_contacts
from kickdrift.world.direct.contacts import (
    BOUNCE,
    PRESS,
    add_contacts,
    fix_contacts,
    load_contacts,
    update_contact_states,
)
from kickdrift.world.direct.factorisation import factor
from kickdrift.world.direct.joint_impulses import give_joints, split_impulse
from kickdrift.world.direct.layout import (
    AFTER_CLOSING,
    AFTER_NODE,
    FIRST_CLOSING,
    FIRST_NODE,
    LINK_ROW,
)
from kickdrift.world.direct.matrix import clear_blocks, put_inertia
from kickdrift.world.direct.substitution import substitute
from kickdrift.world.joints.laws import update_law_states
from kickdrift.world.joints.layout import (
    CLOSING_IMPULSE,
    LAWS,
    LINK_JOINT,
)
from kickdrift.world.joints.right_hand_side import write_right_hand_side
from kickdrift.world.tables import (
    ISLAND,
    ISLAND_CLOSING,
    JOINT,
    LINK,
    LINK_NUMBERS,
    NODE,
    floats,
    integers,
)

# Solutions with other pieces of laws assumed, and then with axes and points let go only, which comes to an end.
TRIALS, LAST_TRIALS = 3, 3

# Times that a solution is put right by its own matrix, if it leaves more than that of a held row: m/s.
REFINEMENTS, UNNOTICED = 3, 1e-9


@compiled(cached=False)
def aim_island(island: int, h: float, mode: int, world: int) -> float:
    """Say what is wanted of each joint of an island, and return how far any of them will be off at most."""
    own, nodes, links = integers(world, ISLAND)[island], integers(world, NODE), integers(world, LINK)
    order, worst = integers(world, ISLAND_CLOSING), 0.0
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        link = nodes[node, LINK_ROW]
        if links[link, LINK_JOINT] >= 0:
            off = write_right_hand_side(links[link, LINK_JOINT], link, h, mode, world)
            worst = worst if off <= worst else off  # which is no number where it is none
    for place in range(own[FIRST_CLOSING], own[AFTER_CLOSING]):
        link = order[place, 0]
        off = write_right_hand_side(links[link, LINK_JOINT], link, h, mode, world)
        worst = worst if off <= worst else off
    return worst


@compiled(cached=False)
def solve_once(island: int, h: float, ahead: float, task: int, first: bool, world: int) -> None:
    """Solve the equations until all pieces of laws fit that were assumed, and give the impulses."""
    settled = False
    for trial in range(TRIALS + LAST_TRIALS):
        settled = update_joint_states(island, h, task, trial, world)
        settled = update_contact_states(island, task, first and trial == 0, trial > TRIALS, world) and settled
        if trial > 0 and settled:
            break
        solve_assumed(island, ahead, world)
    if not settled:
        fix_contacts(island, world)
        solve_assumed(island, ahead, world)
    give_joints(island, task, world)
    give_contacts(island, task, world)


@compiled(cached=False)
def hold(island: int, h: float, ahead: float, task: int, world: int) -> None:
    """Let joints alone take up what contacts with other islands have given since they were solved."""
    own = integers(world, ISLAND)[island]
    for trial in range(TRIALS + LAST_TRIALS):
        settled = update_joint_states(island, h, task, trial, world)
        if trial > 0 and settled:
            break
        assemble(island, ahead, world)
        factor(own[FIRST_NODE], own[AFTER_NODE], world)
        predict(island, False, world)
    give_joints(island, task, world)


@compiled(cached=False)
def solve_assumed(island: int, ahead: float, world: int) -> None:
    """Solve the equations with the pieces of laws that are assumed."""
    assemble(island, ahead, world)
    add_contacts(island, world)
    factor(integers(world, ISLAND)[island, FIRST_NODE], integers(world, ISLAND)[island, AFTER_NODE], world)
    predict(island, True, world)
    for _ in range(REFINEMENTS):
        if max(refine_closings(island, world), 1e-4 * refine_contacts(island, world)) < UNNOTICED:
            break
        predict(island, True, world)


@compiled(cached=False)
def predict(island: int, touched: bool, world: int) -> None:
    """Find what the matrix at hand answers to the rows of an island."""
    own, nodes = integers(world, ISLAND)[island], integers(world, NODE)
    work = floats(world, LINK_NUMBERS)
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        for k in range(6):
            work[nodes[node, LINK_ROW], CLOSING_IMPULSE + k] = 0.0
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
def update_joint_states(island: int, h: float, task: int, trial: int, world: int) -> bool:
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
            settled = not update_law_states(joint, link, h, task != PRESS, opened, world) and settled
    for place in range(own[FIRST_CLOSING], own[AFTER_CLOSING]):
        joint = links[order[place, 0], LINK_JOINT]
        if joints[joint, LAWS] != 0:
            settled = not update_law_states(joint, order[place, 0], h, task != PRESS, opened, world) and settled
    return settled
