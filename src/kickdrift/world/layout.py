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

# INVERSE_MASS; zeros do not move
INVERSE_LINEAR_MASS = column(INVERSE_MASS, 1, "1/kg")
INVERSE_INERTIA_IN_WORLD = column(INVERSE_MASS, 6, "1/(kg m^2)")  # xx, yy, zz, xy, xz, yz

# LOAD, asked for during the next step, and FORCE in this substep
LOAD_FORCE = column(LOAD, 3, "N")
LOAD_TORQUE = column(LOAD, 3, "N m")
SUBSTEP_FORCE = column(FORCE, 3, "N")
SUBSTEP_TORQUE = column(FORCE, 3, "N m")

# SHAPE
SHAPE_KIND = column(SHAPE)  # `GONE` if it was removed
BODY_ROW = column(SHAPE)
BEGIN = column(SHAPE)  # of its numbers in GEOMETRY
SIZE = column(SHAPE)  # how many they are
LAYER = column(SHAPE)  # a bit
MASK = column(SHAPE)  # bits of the layers that it meets
IS_SENSOR = column(SHAPE)
SEARCH_STATE = column(SHAPE)  # see `kickdrift.world.collision.search_state`
GONE = -1

# PLACE of a shape in its body, and its surface
PLACE_POSITION = column(PLACE, 3, "m")
PLACE_ORIENTATION = column(PLACE, 4)
FRICTION = column(PLACE)
RESTITUTION = column(PLACE)
ROLLING = column(PLACE, 1, "m")
SURFACE_VELOCITY = column(PLACE, 3, "m/s")
RADIUS = column(PLACE, 1, "m")  # how far it reaches from its origin; 0.0 of planes and surfaces

# PLACED: its pose in the world when the step began
PLACED_POSITION = column(PLACED, 3, "m")
PLACED_ORIENTATION = column(PLACED, 4)

# BOUNDS
LOWER = column(BOUNDS, 3, "m")  # corners of its fat bounds
UPPER = column(BOUNDS, 3, "m")
FIRST_TREE_NODE = column(BOUNDS)  # of a surface in TRIANGLE_TREE
LAST_TREE_NODE = column(BOUNDS)  # the one after it

# EVENTS: shapes of two bodies that begin or end to touch
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
LEFT_TURN = column(KICKED, 3, "rad/s")  # angular velocity that the drift left
LEFT_POSE = column(KICKED, 4)  # and orientation
FALLS = column(KICKED)  # 1.0 where joints say that the body falls freely
NEXT_IMPACT = column(KICKED, 1, "s")  # in the substep

# Columns of INERTIA
MASS = column(INERTIA, 1, "kg")
BODY_INERTIA = column(INERTIA, 6, "kg m^2")  # in the body's axes: xx, yy, zz, xy, xz, yz
INVERSE_INERTIA = column(INERTIA, 6, "1/(kg m^2)")
DAMPING = column(INERTIA, 1, "1/s")
TURN_DAMPING = column(INERTIA, 1, "1/s")
SPHERICAL = column(INERTIA)  # one of the three below

# Columns and values of BODY
BODY_KIND = column(BODY)
AWAKE = column(BODY)
SLEEP_ISLAND = column(BODY)
GENERATION = column(BODY)
LINK_PLACE = column(BODY)  # of its link + 1, where its joints are solved directly; -1 where one after the other
LINK_COUNT = column(BODY)
UNSOLVED = column(
    BODY
)  # for how many steps sweeps have left its contacts unsolved: see `kickdrift.world.direct.unconverged_heaps`
IN_HEAP = column(BODY)  # 1: of a heap that is solved directly
HEAP = column(BODY)  # first body of its heap
HEAP_SIZE = column(BODY)  # of a first body: how many there are
HEAP_UNSOLVED = column(BODY)  # and the most of their UNSOLVED
LEFT_FOR = column(BODY)  # steps in which it was left unsolved, less those in which it was not
REMOVED, STATIC, KINEMATIC, DYNAMIC = 0, 1, 2, 3

# Values of SPHERICAL: moments differ; they are equal, or infinite; or they differ, but the body turns about one axis alone.
TUMBLES, ISOTROPIC, PLANAR = 0.0, 1.0, 2.0
