"""From the solution of the equations to impulses: which pieces of laws it fits, and what bodies are given."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import dot
from kickdrift.world.columns import vector_at
from kickdrift.world.joints.brakes import set_brakes
from kickdrift.world.joints.impulses import note_speeds, push_bodies
from kickdrift.world.joints.laws import end_laws, review_laws
from kickdrift.world.joints.layout import (
    AXES,
    END,
    FIRST,
    GIVEN,
    IMPULSE,
    LAWS,
    LINK_JOINT,
    LINKS,
    LOST,
    RELAXING,
    SEQUENTIAL,
    SIGN,
    SOLVED,
    TOTAL,
    WRENCH,
)
from kickdrift.world.tables import ARTICULATION, JOINT, JOINT_NUMBERS, LINK, LINK_NUMBERS, floats, integers

# Solutions with other pieces of laws assumed, and then with axes let go only, which comes to an end. A few axes that change
# their minds take two or three.
TRIALS = 12
LAST_TRIALS = 12


@compiled(cached=False)
def settle(row: int, h: float, trial: int, world: int) -> bool:
    """Assume the pieces of laws that the solution so far points to, and say whether it was made with them."""
    articulation: Any = integers(world, ARTICULATION)[row]
    links, joints = integers(world, LINK), integers(world, JOINT)
    settled = True
    for link in range(articulation[FIRST], articulation[END]):
        joint = links[link, LINK_JOINT]
        if joint >= 0 and joints[joint, LAWS] != 0:
            if trial > 0 and link < articulation[FIRST] + articulation[LINKS]:
                split_impulse(link, joint, world)
            opened = trial > TRIALS
            settled = not review_laws(joint, link, h, articulation[RELAXING] != 0, opened, world) and settled
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
def give_impulses(row: int, world: int) -> None:
    """Give bodies the impulses that were found."""
    articulation: Any = integers(world, ARTICULATION)[row]
    links, work = integers(world, LINK), floats(world, LINK_NUMBERS)
    numbers = floats(world, JOINT_NUMBERS)
    for link in range(articulation[FIRST], articulation[END]):
        joint = links[link, LINK_JOINT]
        if joint < 0:
            continue
        if link < articulation[FIRST] + articulation[LINKS]:
            split_impulse(link, joint, world)
        for k in range(6):
            numbers[joint, IMPULSE + k] += work[link, GIVEN + k]
        push_bodies(joint, work, link, GIVEN, world)


@compiled(cached=False)
def end_solution(row: int, h: float, world: int) -> None:
    """Keep what was given before the drift."""
    articulation: Any = integers(world, ARTICULATION)[row]
    links, joints, numbers = integers(world, LINK), integers(world, JOINT), floats(world, JOINT_NUMBERS)
    for link in range(articulation[FIRST], articulation[END]):
        joint = links[link, LINK_JOINT]
        if joint >= 0:
            for k in range(6):
                numbers[joint, SOLVED + k] = numbers[joint, IMPULSE + k]
            if joints[joint, LAWS] != 0:
                end_laws(joint, link, h, world)


@compiled(cached=False)
def end_relaxation(row: int, h: float, world: int) -> None:
    """Add up the impulses of the substep, and make ready for the next one."""
    articulation: Any = integers(world, ARTICULATION)[row]
    links, numbers = integers(world, LINK), floats(world, JOINT_NUMBERS)
    for link in range(articulation[FIRST], articulation[END]):
        joint = links[link, LINK_JOINT]
        if joint >= 0:
            note_speeds(joint, world)
            if link < articulation[FIRST] + articulation[LINKS] and articulation[SEQUENTIAL] == 0:
                set_brakes(link, joint, h, world)
            for k in range(6):
                numbers[joint, TOTAL + k] += numbers[joint, IMPULSE + k]
                # The next substep begins as this one did. With the impulse of the relaxation, which bends the paths of what
                # turns, the first guess of Newton's method would be farther away. Impulses of no solution are no guess.
                numbers[joint, IMPULSE + k] = numbers[joint, SOLVED + k] if articulation[LOST] == 0 else 0.0
    articulation[RELAXING] = 0
