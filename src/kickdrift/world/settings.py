"""Columns of the one row of `kickdrift.world.tables.SETTINGS`."""

from kickdrift.world.columns import column
from kickdrift.world.tables import SETTINGS

GRAVITY = column(SETTINGS, 3, "m/s^2")
STEP = column(SETTINGS, 1, "s")
SUBSTEPS = column(SETTINGS)
MIDPOINT = column(SETTINGS)  # 1.0: free flight by the midpoint rule
MARGIN = column(SETTINGS, 1, "m")  # distance at which speculative contacts are created
SLOP = column(SETTINGS, 1, "m")  # penetration that is not corrected
CONTACT_HERTZ = column(SETTINGS, 1, "Hz")
CONTACT_DAMPING = column(SETTINGS)  # ratio
PUSH_SPEED = column(SETTINGS, 1, "m/s")  # largest speed at which overlapping bodies are pushed apart
BOUNCE_SPEED = column(SETTINGS, 1, "m/s")  # below which nothing bounces
RECYCLE_DISTANCE = column(SETTINGS, 1, "m")  # motion of its bodies up to which a manifold is reused
PLANE_NORMAL = column(SETTINGS, 3)  # normal of the plane that a planar world moves in, or zeros
SLEEP_SPEED = column(SETTINGS, 1, "m/s")  # below which an island may fall asleep; with 0.0 none does
SLEEP_TIME = column(SETTINGS, 1, "s")
HAS_FAST = column(SETTINGS)  # 1.0 once the step has the stage for fast pairs
HAS_DIRECT = column(SETTINGS)  # 1.0 once the step has the stages of the direct solver
# Not settings but results: the residual of the last step, the length of its substeps, and the contents of warnings. Of a body
# that is left unsolved, its row, and since when; of one that turns too fast, its row, the end of the first step in which it
# did, its rate, the fraction of the energy that was lost, since when, and how long substeps should be instead; of one that may
# have missed a contact, or whose impacts had no end, its row, and the time; of one whose joints and contacts have no solution
# together, its row, or -1, and since when.
RESIDUAL = column(SETTINGS, 1, "m/s")
LAST_SUBSTEP = column(SETTINGS, 1, "s")
UNSOLVED_BODY, UNSOLVED_SINCE = column(SETTINGS), column(SETTINGS, 1, "s")
FAST_BODY, FAST_TIME = column(SETTINGS), column(SETTINGS, 1, "s")
FAST_RATE, FAST_LOSS, FAST_SINCE = column(SETTINGS, 1, "rad/s"), column(SETTINGS), column(SETTINGS, 1, "s")
FAST_SUBSTEP = column(SETTINGS, 1, "s")
MISSED_BODY, MISSED_TIME = column(SETTINGS), column(SETTINGS, 1, "s")
BOUNCING_TIME = column(SETTINGS, 1, "s")
JAMMED_BODY, JAMMED_SINCE = column(SETTINGS), column(SETTINGS, 1, "s")
