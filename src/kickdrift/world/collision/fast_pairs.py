"""Fast pairs: contacts whose points have to be found at the time of impact, or of closest approach, within the step."""

from kickdrift.core.compilation import compiled
from kickdrift.world.collision.narrow_phase.manifolds import smallest
from kickdrift.world.collision.shape_properties import half_width, is_round, sort_of
from kickdrift.world.contacts.layout import BODY_A, SHAPE_A, SHAPE_B
from kickdrift.world.layout import BODY_KIND, DYNAMIC, RADIUS
from kickdrift.world.material_mixing import mixed_restitution
from kickdrift.world.settings import MARGIN
from kickdrift.world.shapes.record import HALF_SPACE
from kickdrift.world.tables import BODY, CONTACT, PLACE, SETTINGS, floats, integers


@compiled
def needs_time_of_impact(world: int, row: int, way: float) -> bool:
    """Whether shapes may move by so much, m, that the contact points at the start of the step are not accurate enough.

    If round shapes bounce off each other, the error of the normal is the distance that they slide, relative to their size.
    """
    contact, place, margin = integers(world, CONTACT), floats(world, PLACE), floats(world, SETTINGS)[0, MARGIN]
    a, b = contact[row, SHAPE_A], contact[row, SHAPE_B]
    reach = smallest(place[a, RADIUS], place[b, RADIUS])
    if sort_of(world, a) == HALF_SPACE:
        return False
    if mixed_restitution(world, a, b) > 0.0 and is_round(world, a) and is_round(world, b):
        return way > 0.01 * reach
    if way <= margin:
        return False
    # A slender body that moves by its thickness may turn another end to what it touches.
    for side in range(2):
        if integers(world, BODY)[contact[row, BODY_A + side], BODY_KIND] == DYNAMIC:
            reach = min(reach, 2.0 * half_width(world, contact[row, SHAPE_A + side]))
    return way > 0.5 * reach
