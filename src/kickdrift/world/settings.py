"""Columns of the one row of `kickdrift.world.tables.SETTINGS`."""

GRAVITY = 0  # three columns, m/s^2
STEP = 3  # s
SUBSTEPS = 4
MIDPOINT = 5  # 1.0: free flight by the midpoint rule
MARGIN = 6  # m, speculative: contacts are sought this far away
SLOP = 7  # m, by which bodies may sink into each other
CONTACT_HERTZ = 8
CONTACT_DAMPING = 9  # ratio
PUSH_SPEED = 10  # m/s, of bodies that are pushed apart, at most
BOUNCE_SPEED = 11  # m/s, below which nothing bounces
RECYCLE_DISTANCE = 12  # m, by which bodies may move before the shapes of a contact are looked at again
PLANE = 13  # three columns: normal of the plane that a planar world moves in, or zeros
SLEEP_SPEED = 16  # m/s, below which an island may fall asleep; 0.0: none does
SLEEP_TIME = 17  # s
HAS_FAST = 18  # 1.0 once the step has the stage for fast pairs
RESIDUAL = 19  # m/s: no setting, but what the last step has left unsolved
