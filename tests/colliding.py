"""Contacts of two shapes by the function that worlds call, by its address: the interpreter would have it compiled again."""

from kickdrift.core.calls import address_of
from kickdrift.core.compilation import compiled
from kickdrift.world.collision.narrow_phase.manifolds import COLLIDE, collide
from kickdrift.world.collision.narrow_phase.pair_dispatch import PAIRS
from kickdrift.world.contacts.layout import REACHABLE


@compiled
def _collide(address, a, b, pose, margin, manifold):
    return collide(address, (a, b, pose, margin, manifold))


def count_contacts(pair, a, b, pose, margin, manifold):
    """Write the manifold of two shapes of these kinds, and return the number of its points."""
    manifold[REACHABLE] = margin
    return _collide(address_of(PAIRS[pair], COLLIDE), a, b, pose, float(margin), manifold)
