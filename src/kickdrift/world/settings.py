"""Columns of the one row of `kickdrift.world.tables.SETTINGS`."""

from kickdrift.world.columns import column
from kickdrift.world.tables import SETTINGS

GRAVITY = column(SETTINGS, 3, "m/s^2")
STEP = column(SETTINGS, 1, "s")
SUBSTEPS = column(SETTINGS)
MIDPOINT = column(SETTINGS)  # 1.0: free flight by the midpoint rule
MARGIN = column(SETTINGS, 1, "m")  # speculative: contacts are sought this far away
SLOP = column(SETTINGS, 1, "m")  # by which bodies may sink into each other
CONTACT_HERTZ = column(SETTINGS, 1, "Hz")
CONTACT_DAMPING = column(SETTINGS)  # ratio
PUSH_SPEED = column(SETTINGS, 1, "m/s")  # of bodies that are pushed apart, at most
BOUNCE_SPEED = column(SETTINGS, 1, "m/s")  # below which nothing bounces
RECYCLE_DISTANCE = column(SETTINGS, 1, "m")  # by which bodies may move before a contact's shapes are looked at again
PLANE_NORMAL = column(SETTINGS, 3)  # normal of the plane that a planar world moves in, or zeros
SLEEP_SPEED = column(SETTINGS, 1, "m/s")  # below which an island may fall asleep; 0.0: none does
SLEEP_TIME = column(SETTINGS, 1, "s")
HAS_FAST = column(SETTINGS)  # 1.0 once the step has the stage for fast pairs
HAS_DIRECT = column(SETTINGS)  # 1.0 once the step has the stages of the direct solver
# No settings, but what the last step has left unsolved, and what warnings tell of: a body that is left unsolved, and since
# when; one that turns too fast, the end of the first step in which it did, its turn in a substep, and the part of the energy
# that was lost; one that may have passed what it met, and the end of that step.
RESIDUAL = column(SETTINGS, 1, "m/s")
UNSOLVED_BODY, UNSOLVED_SINCE = column(SETTINGS), column(SETTINGS, 1, "s")
FAST_BODY, FAST_TIME = column(SETTINGS), column(SETTINGS, 1, "s")
FAST_TURN, FAST_LOSS = column(SETTINGS, 1, "rad"), column(SETTINGS)
MISSED_BODY, MISSED_TIME = column(SETTINGS), column(SETTINGS, 1, "s")
