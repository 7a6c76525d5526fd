"""Columns of the tables of bodies, shapes and events."""

from kickdrift.world.columns import column
from kickdrift.world.tables import (
    BODY,
    BOUNDS,
    DELTA_POSE,
    EVENTS,
    FORCE,
    INERTIA,
    INVERSE_MASS,
    KICKED,
    LOAD,
    MOTION,
    PLACE,
    PLACED,
    POSE,
    RESTED,
    SHAPE,
)

# POSE of a body
POSITION = column(POSE, 3, "m")  # of its centre of mass
ORIENTATION = column(POSE, 4)  # w, x, y, z

# MOTION
VELOCITY = column(MOTION, 3, "m/s")
ANGULAR_VELOCITY = column(MOTION, 3, "rad/s")  # in the world's axes

# DELTA_POSE since the start of the step
DISPLACEMENT = column(DELTA_POSE, 3, "m")
ROTATION = column(DELTA_POSE, 3, "rad")

# INVERSE_MASS; zeros for bodies that forces do not move
INVERSE_LINEAR_MASS = column(INVERSE_MASS, 1, "1/kg")
INVERSE_INERTIA_IN_WORLD = column(INVERSE_MASS, 6, "1/(kg m^2)")  # xx, yy, zz, xy, xz, yz

# LOAD, applied by users during the next step, and FORCE in this substep
LOAD_FORCE = column(LOAD, 3, "N")
LOAD_TORQUE = column(LOAD, 3, "N m")
SUBSTEP_FORCE = column(FORCE, 3, "N")
SUBSTEP_TORQUE = column(FORCE, 3, "N m")
FORCE_BEFORE = column(FORCE, 3, "N")  # the first one, once that of the end of the substep is known

# SHAPE
SHAPE_KIND = column(SHAPE)  # `GONE` if it was removed
BODY_ROW = column(SHAPE)
BEGIN = column(SHAPE)  # first row of its numbers in GEOMETRY
SIZE = column(SHAPE)  # how many they are
LAYER = column(SHAPE)  # one bit
MASK = column(SHAPE)  # bits of the layers that it collides with
IS_SENSOR = column(SHAPE)
SEARCH_STATE = column(SHAPE)  # see `kickdrift.world.collision.broad_phase.search_state`
GONE = -1

# PLACE of a shape in its body, and its surface
PLACE_POSITION = column(PLACE, 3, "m")
PLACE_ORIENTATION = column(PLACE, 4)
FRICTION = column(PLACE)
RESTITUTION = column(PLACE)
ROLLING = column(PLACE, 1, "m")
SURFACE_VELOCITY = column(PLACE, 3, "m/s")
RADIUS = column(PLACE, 1, "m")  # of its bounding sphere about its origin; 0.0 for planes and surfaces

# PLACED: its pose in the world when the step began
PLACED_POSITION = column(PLACED, 3, "m")
PLACED_ORIENTATION = column(PLACED, 4)
LAST_LOST = column(PLACED)  # row of LOST_POINT, plus 1: the last point that it has lost on a surface in this step

# BOUNDS
LOWER = column(BOUNDS, 3, "m")  # corners of its fat bounds
UPPER = column(BOUNDS, 3, "m")
FIRST_TREE_NODE = column(BOUNDS)  # of the tree of a surface in TRIANGLE_TREE
LAST_TREE_NODE = column(BOUNDS)  # one after the last

# EVENTS: shapes of two bodies that begin or stop touching
BEGINS = column(EVENTS)
FIRST_BODY = column(EVENTS)
SECOND_BODY = column(EVENTS)
FROM_SENSOR = column(EVENTS)

# Columns of KICKED
KICKED_VELOCITY = column(KICKED, 3, "m/s")  # after the kick
KICKED_ANGULAR_VELOCITY = column(KICKED, 3, "rad/s")
ADDED = column(KICKED, 3, "m/s")  # by the kick
SPIN = column(KICKED, 3, "kg m^2/s")  # L
IMPACT_TIME = column(KICKED, 1, "s")  # of the last impact in the substep
LEFT_TURN = column(KICKED, 3, "rad/s")  # angular velocity after the last drift
LEFT_POSE = column(KICKED, 4)  # orientation after the last drift
KICK = column(KICKED)  # WHOLE_KICK, before the drift; HALF_KICK before and half after it; or FREE_KICK, in free flight
NEXT_IMPACT = column(KICKED, 1, "s")  # in the substep
# Of impacts in the substep: the last round in which the body was hit, and the last sweep over it that changed its velocity
LAST_ROUND = column(KICKED)
LAST_SWEEP = column(KICKED)
# Within a round, before that is noted: the first hit of the body, or of those connected with it
GROUP = column(KICKED, over=LAST_ROUND)

WHOLE_KICK, HALF_KICK, FREE_KICK = 0.0, 1.0, 2.0

# Columns of RESTED
TIME_AT_REST = column(RESTED, 1, "s")  # of a body
ISLAND_TIME_AT_REST = column(RESTED, 1, "s")
BOUNDING_RADIUS = column(RESTED, 1, "m")  # of its sphere about its centre of mass
SLEPT_POSE = column(RESTED, 7)  # pose in which it sleeps
WAKES = column(RESTED, 1)  # 1.0 in the row of an island that is about to be woken

# Columns of INERTIA
MASS = column(INERTIA, 1, "kg")
BODY_INERTIA = column(INERTIA, 6, "kg m^2")  # in the body's axes: xx, yy, zz, xy, xz, yz
INVERSE_INERTIA = column(INERTIA, 6, "1/(kg m^2)")
DAMPING = column(INERTIA, 1, "1/s")
TURN_DAMPING = column(INERTIA, 1, "1/s")
INERTIA_KIND = column(INERTIA)  # TUMBLES, ISOTROPIC or PLANAR

# Columns and values of BODY
BODY_KIND = column(BODY)
AWAKE = column(BODY)
SLEEP_ISLAND = column(BODY)
GENERATION = column(BODY)
LINK_PLACE = column(BODY)  # row of its link + 1; minus that if joints are solved one after the other
LINK_COUNT = column(BODY)
# Heaps: see `kickdrift.world.direct.unconverged_heaps`
RESIDUAL_SIZE = column(BODY)  # bits for this step: see `kickdrift.world.contacts.residual`
UNSOLVED = column(BODY)  # number of steps for which the sweeps have left it unsolved; large if solved directly
IN_HEAP = column(BODY)  # 1 in a heap that is solved directly
HEAP = column(BODY)  # first body of its heap
HEAP_SIZE = column(BODY)  # for the first body of a heap: its number of bodies, or bits of `struck_bodies`
HEAP_UNSOLVED = column(BODY)  # and the largest of their UNSOLVED
LEFT_FOR = column(BODY)  # number of steps in which it was left unsolved, less those in which it was not
REMOVED, STATIC, KINEMATIC, DYNAMIC = 0, 1, 2, 3

# Values of INERTIA_KIND: moments of inertia differ; are equal, or infinite; or differ, but the world is planar.
TUMBLES, ISOTROPIC, PLANAR = 0.0, 1.0, 2.0
