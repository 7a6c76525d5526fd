"""The residual of the sweeps: the normal speed of loaded points after a step."""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import length
from kickdrift.world.collision.body_acceleration import weight_per_mass
from kickdrift.world.columns import vector_at
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.body_gather_simd import gather
from kickdrift.world.contacts.constraint_groups import group_of, lane_count, new_scratch, run
from kickdrift.world.contacts.graph_colouring import LINKED
from kickdrift.world.contacts.prepare_simd import MARK, VELOCITY_A
from kickdrift.world.layout import RESIDUAL_SIZE
from kickdrift.world.settings import GRAVITY, RESIDUAL, SLOP
from kickdrift.world.tables import BODY, COLOURS, GROUPS, MOTION, SETTINGS, floats, integers

_W = c.WIDTH

# Residuals above _NOTED times the velocity that gravity and forces add in a step are noted, and count as far too large above
# _FAR times that. Without gravity and forces, the velocity that lets bodies sink by _SUNK of the slop in a step takes its
# place: about that of gravity at 1/60 s.
_NOTED, _FAR, _SUNK = 0.01, 30.0, 0.5

# Bits of RESIDUAL_SIZE: in this step the residual of a body was noted; was far too large; or the body has contacts that are
# solved directly.
NOTED_RESIDUAL, FAR_RESIDUAL, TOUCHES = 1, 2, 4


@compiled
def measure_residual(t: float, h: float, world: int) -> None:
    """Measure the residual, and mark bodies with a large one, and those with contacts that are solved directly."""
    groups, colours, body = integers(world, GROUPS), integers(world, COLOURS), integers(world, BODY)
    scratch, motion, most = new_scratch(), floats(world, MOTION), floats(world, SETTINGS)[0, RESIDUAL]
    least = _NOTED * h * length(vector_at(floats(world, SETTINGS), 0, GRAVITY))
    weightless = _NOTED * _SUNK * floats(world, SETTINGS)[0, SLOP] / h
    for g in range(colours[0, c.FIRST_GROUP], colours[LINKED, c.FIRST_GROUP]):
        gather(world, g, motion, VELOCITY_A, scratch)
        run(world, c.MEASURE, group_of(world, g), scratch, 0.0, 0.0, 0.0)
        for lane in range(lane_count(world)):
            left = scratch[MARK * _W + lane]
            most = max(most, left)
            if left > least:
                a, b = groups[g, c.BODIES_A + lane], groups[g, c.BODIES_B + lane]
                weight = max(weight_per_mass(world, a), weight_per_mass(world, b))
                noted = _NOTED * h * weight if weight > 0.0 else weightless
                if left > noted:
                    for row in (a, b):
                        body[row, RESIDUAL_SIZE] |= (
                            NOTED_RESIDUAL | FAR_RESIDUAL if left > _FAR * noted else NOTED_RESIDUAL
                        )
    for g in range(colours[LINKED, c.FIRST_GROUP], colours[LINKED, c.AFTER_GROUP]):
        for lane in range(_W):
            if groups[g, c.GROUP_CONTACTS + lane] >= 0:
                body[groups[g, c.BODIES_A + lane], RESIDUAL_SIZE] |= TOUCHES
                body[groups[g, c.BODIES_B + lane], RESIDUAL_SIZE] |= TOUCHES
    floats(world, SETTINGS)[0, RESIDUAL] = most
