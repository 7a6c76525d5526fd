"""Sleep of cloths: all cloths of a world sleep together, with the bodies that they touch, until one of these moves."""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import dot
from kickdrift.world.columns import vector_at
from kickdrift.world.deformables.body_contacts.contact_rows import gap_of
from kickdrift.world.deformables.body_contacts.particle_contacts import find_contacts
from kickdrift.world.deformables.layout import (
    CLOTH_RADIUS,
    IS_ASLEEP,
    PARTICLE_INVERSE_MASS,
    PARTICLE_VELOCITY,
    PINNED_BODY,
    REST_TIME,
    STIRRED,
    TOUCHED_BODY,
)
from kickdrift.world.layout import AWAKE, BODY_KIND, DYNAMIC, KINEMATIC, TIME_AT_REST
from kickdrift.world.settings import SLEEP_SPEED, SLEEP_TIME
from kickdrift.world.sleeping import is_awake, mark_island, wake_marked
from kickdrift.world.step.status import OK, STATUS
from kickdrift.world.tables import (
    BODY,
    CLOTH,
    CLOTH_CONTACT,
    CLOTH_NUMBERS,
    PARTICLE,
    PIN,
    RESTED,
    SETTINGS,
    STARTED_PARTICLE,
    STEP_STATUS,
    floats,
    integers,
    rows,
)

_TOUCHES = 0.1  # of half the thickness: gap up to which cloth and body touch


@compiled
def wake_cloths(t: float, h: float, world: int) -> None:
    """Wake cloths if the user has moved one, or a body that is awake touches or carries one; wake bodies that they touch."""
    own, numbers = integers(world, CLOTH), floats(world, CLOTH_NUMBERS)
    if own[0, IS_ASLEEP] == 0:
        return
    find_contacts(world, h)
    if integers(world, STEP_STATUS)[0, STATUS] == OK and (own[0, IS_ASLEEP] == STIRRED or _is_held(world)):
        own[0, IS_ASLEEP], numbers[0, REST_TIME] = 0, 0.0
        _wake_touched(world, 1.0)


@compiled
def rest_cloths(t: float, h: float, world: int) -> None:
    """Put all cloths to sleep if they have rested long enough; bodies that touch moving cloths stay awake.

    A pinned vertex that the user moves keeps them awake, however slow it is.
    """
    particle, own, settings = floats(world, PARTICLE), integers(world, CLOTH), floats(world, SETTINGS)
    if own[0, IS_ASLEEP] != 0:
        return
    fastest, driven, numbers = 0.0, False, floats(world, CLOTH_NUMBERS)
    for i in range(rows(world, PARTICLE)):
        v = vector_at(particle, i, PARTICLE_VELOCITY)
        fastest = max(fastest, dot(v, v))
        driven = driven or (dot(v, v) > 0.0 and particle[i, PARTICLE_INVERSE_MASS] == 0.0)
    rests = fastest < settings[0, SLEEP_SPEED] ** 2
    numbers[0, REST_TIME] = numbers[0, REST_TIME] + h if rests else 0.0
    if not rests:
        _wake_touched(world, _TOUCHES)
    if numbers[0, REST_TIME] < settings[0, SLEEP_TIME] or driven or _is_held(world):
        return
    own[0, IS_ASLEEP] = 1
    for i in range(rows(world, PARTICLE)):
        for k in range(3):
            particle[i, PARTICLE_VELOCITY + k] = 0.0
    _note_place(world)


@compiled
def _note_place(world: int) -> None:
    """Store the state in which cloths sleep, by which later changes by the user are detected."""
    now, then = floats(world, PARTICLE), floats(world, STARTED_PARTICLE)
    for i in range(rows(world, PARTICLE)):
        for k in range(PARTICLE.width):
            then[i, k] = now[i, k]


@compiled
def _is_held(world: int) -> bool:
    """Whether a body that is awake is near a cloth, or carries it."""
    contact, pin, held = integers(world, CLOTH_CONTACT), integers(world, PIN), False
    for row in range(rows(world, CLOTH_CONTACT)):
        held = held or _is_awake(world, contact[row, TOUCHED_BODY])
    for k in range(rows(world, PIN)):
        held = held or _is_awake(world, pin[k, PINNED_BODY])
    return held


@compiled(inline=True)
def _is_awake(world: int, body: int) -> bool:
    """Whether a body can move and is awake."""
    own = integers(world, BODY)
    awake: bool = own[body, BODY_KIND] >= KINEMATIC and own[body, AWAKE] != 0
    return awake


@compiled
def _wake_touched(world: int, within: float) -> None:
    """Wake bodies to which cloths are pinned, or that they touch with a gap below a fraction of half the thickness."""
    contact, pin = integers(world, CLOTH_CONTACT), integers(world, PIN)
    radius, found = floats(world, CLOTH_NUMBERS)[0, CLOTH_RADIUS], False
    for row in range(rows(world, CLOTH_CONTACT)):
        if gap_of(world, row) < within * radius:
            found = _stir(world, contact[row, TOUCHED_BODY]) or found
    for k in range(rows(world, PIN)):
        found = _stir(world, pin[k, PINNED_BODY]) or found
    if found:
        wake_marked(world)


@compiled
def _stir(world: int, body: int) -> bool:
    """Reset the time of rest of a dynamic body, and mark its island if it sleeps; return whether it does."""
    if integers(world, BODY)[body, BODY_KIND] != DYNAMIC:
        return False
    floats(world, RESTED)[body, TIME_AT_REST] = 0.0
    if is_awake(world, body):
        return False
    mark_island(world, body)
    return True
