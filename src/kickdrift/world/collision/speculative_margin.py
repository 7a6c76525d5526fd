"""The speculative margin: contacts are found at distances up to which shapes may approach each other in the step."""

import math

from kickdrift.core.compilation import compiled
from kickdrift.world.collision.body_acceleration import reach
from kickdrift.world.collision.predicted_motion import fastest_turn, has_change, way_on_path
from kickdrift.world.contacts.layout import BODY_A, BODY_B, SHAPE_A, SHAPE_B
from kickdrift.world.layout import ANGULAR_VELOCITY, VELOCITY
from kickdrift.world.settings import MARGIN, STEP
from kickdrift.world.tables import CONTACT, MOTION, PLACE, SETTINGS, floats, integers


@compiled(inline=True)
def approach(world: int, row: int, pushed: float) -> float:
    """Bound the distance by which shapes approach in the step, m, including what forces push them beyond the margin."""
    settings = floats(world, SETTINGS)
    step = settings[0, STEP]
    way: float = step * _closing_speed(world, row) + max(pushed - settings[0, MARGIN], 0.0)
    for side in range(2):
        body = integers(world, CONTACT)[row, BODY_A + side]
        if has_change(world, body):
            far = reach(floats(world, PLACE), integers(world, CONTACT)[row, SHAPE_A + side])
            way += way_on_path(world, body) + step * fastest_turn(world, body) * far
    return way


@compiled(inline=True)
def _closing_speed(world: int, row: int) -> float:
    """Bound the speed at which the shapes of a contact can approach each other, m/s."""
    contact, motion, place = integers(world, CONTACT), floats(world, MOTION), floats(world, PLACE)
    a, b = contact[row, BODY_A], contact[row, BODY_B]
    relative = 0.0
    turn_a = 0.0
    turn_b = 0.0
    for k in range(3):
        relative += (motion[b, VELOCITY + k] - motion[a, VELOCITY + k]) ** 2
        turn_a += motion[a, ANGULAR_VELOCITY + k] ** 2
        turn_b += motion[b, ANGULAR_VELOCITY + k] ** 2
    speed = math.sqrt(relative)
    if turn_a > 0.0:
        speed += math.sqrt(turn_a) * reach(place, contact[row, SHAPE_A])
    if turn_b > 0.0:
        speed += math.sqrt(turn_b) * reach(place, contact[row, SHAPE_B])
    return speed
