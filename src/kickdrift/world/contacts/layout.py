"""Columns of the tables of contacts, and fields of the constraints that are made from them for the solver.

A manifold is up to four points with one normal.

Constraints are stored in groups of WIDTH: field k of lane l of group g is number (g FIELDS + k) WIDTH + l of the table `LANES`,
so that the loops over lanes vectorise. Fields that the sweeps read come first; those from ANCHORS on are the data from which
`kickdrift.world.contacts.effective_mass_simd` computes them.
"""

from kickdrift.world.columns import Fields, column
from kickdrift.world.tables import COLOURS, CONTACT, GROUPS, KERNEL_ADDRESSES, MANIFOLD

WIDTH = 8  # lanes: two vectors of AVX2 or one of AVX-512

# Columns of CONTACT
SHAPE_A = column(CONTACT)
SHAPE_B = column(CONTACT)
TRIANGLE_INDEX = column(CONTACT)  # of the first shape, if it is a surface
BODY_A = column(CONTACT)
BODY_B = column(CONTACT)
POINTS = column(CONTACT)
CONTACT_STATE = column(CONTACT)
PLACE_IN_GROUPS = column(CONTACT)  # WIDTH times its group, plus its lane; -1 if it has none

# Bits of CONTACT_STATE
TOUCHING = 1
SENSOR = 2
BOUNCED = 4  # bounced in this step
FAST = 8  # its shapes may pass each other within the step
JUST_FOUND = 64  # its points were found at the start of the present step
MOVING = 16  # its arms were recomputed within the last step, or it is new
JUST_LANDED = 32  # one of its points landed in the last substep

# Columns of COLOURS
COLOUR_CONTACTS = column(COLOURS)  # how many
FIRST_GROUP = column(COLOURS)
AFTER_GROUP = column(COLOURS)

# Columns of GROUPS, one per lane
BODIES_A = column(GROUPS, WIDTH)
BODIES_B = column(GROUPS, WIDTH)
GROUP_CONTACTS = column(GROUPS, WIDTH)  # -1 in lanes that have none

# Columns of KERNEL_ADDRESSES: kernels of `kickdrift.world.contacts.contact_solver_simd`, and the number of lanes
APPLY_IMPULSES = column(KERNEL_ADDRESSES)
SOLVE_NORMALS = column(KERNEL_ADDRESSES)
SOLVE_FRICTION = column(KERNEL_ADDRESSES)
FILL = column(KERNEL_ADDRESSES)
FIND_STALE = column(KERNEL_ADDRESSES)
REFRESH = column(KERNEL_ADDRESSES)
REFRESH_FRICTION = column(KERNEL_ADDRESSES)
TURN_NORMALS = column(KERNEL_ADDRESSES)
MEASURE = column(KERNEL_ADDRESSES)
LANE_COUNT = column(KERNEL_ADDRESSES)
# Functions of the direct solver that `kickdrift.world.direct.island_calls` calls
SOLVE_EQUATIONS = column(KERNEL_ADDRESSES)
AIM_JOINTS = column(KERNEL_ADDRESSES)
REPAIR_POSES = column(KERNEL_ADDRESSES)
# Functions of chunks of a cloth: see `kickdrift.world.deformables.chunks`
MEMBRANE_CHUNK = column(KERNEL_ADDRESSES)
COUPLING_CHUNK = column(KERNEL_ADDRESSES)
TURNING_CHUNK = column(KERNEL_ADDRESSES)
KICK_CHUNK = column(KERNEL_ADDRESSES)
CONTACT_CHUNK = column(KERNEL_ADDRESSES)
DRIFT_CHUNK = column(KERNEL_ADDRESSES)
PAIR_CHUNK = column(KERNEL_ADDRESSES)
TETHER_CHUNK = column(KERNEL_ADDRESSES)
# Of threads, zero without them
THREADED_LOOP = column(KERNEL_ADDRESSES)
THREADED_SEARCH = column(KERNEL_ADDRESSES)

# Numbers of a point of a manifold
_POINT = Fields()
ON_A = _POINT.field(3, "m")  # on the first shape, in its frame
ON_B = _POINT.field(3, "m")  # on the second, in its own
FEATURE = _POINT.field()  # id of the features that touch
_POINT.field()  # makes it eight numbers, one cache line
POINT_SIZE = _POINT.close()

# Columns of MANIFOLD. Every step writes those from NORMAL_IMPULSE to TWIST_IMPULSE, which are one cache line.
NORMAL = column(MANIFOLD, 3)  # in the frame of the first shape
ROLLING_IMPULSE = column(MANIFOLD, 3, "N m s")  # in the world's axes
REACHABLE = column(MANIFOLD, 1, "m")  # gap up to which points may touch before they are found again
LEFT_OUT = column(MANIFOLD, 1, "m")  # smallest gap of those that more than four points left out; inf if none
POINT = column(MANIFOLD, 4 * POINT_SIZE)
FOUND_POSE = column(MANIFOLD, 7)  # of the second shape in the first's frame, when the points were found
RECYCLED = column(MANIFOLD, 1, "m")  # distance by which it may have moved since
NORMAL_IMPULSE = column(MANIFOLD, 4, "N s")  # of the points
FRICTION_IMPULSE = column(MANIFOLD, 3, "N s")  # in the world's axes
TWIST_IMPULSE = column(MANIFOLD, 1, "N m s")
REST_A = column(MANIFOLD, 4)  # orientations of both shapes when the contact came to rest
REST_B = column(MANIFOLD, 4)
REST_APART = column(MANIFOLD, 3, "m")  # and the vector from the first body to the second
WIDTH_OF_FACE = column(MANIFOLD, 1, "m")  # half the smallest width of the face that the points span
# Where gravity acts on the face, through the centre of mass of the body that is carried, in the first shape's frame; or NaN
LOAD = column(MANIFOLD, 3, "m")

# Fields of a point of a constraint
_CONSTRAINT_POINT = Fields()
ARM = _CONSTRAINT_POINT.field(3, "m")  # arm of a x normal
# The present gap less its linear change since the step began: g - n . (d_b - d_a) - (p_b x n) . r_b + (p_a x n) . r_a, with the
# displacements d and rotation vectors r of both bodies since then, and their arms p
GAP = _CONSTRAINT_POINT.field(1, "m")
POINT_MASS = _CONSTRAINT_POINT.field(1, "kg")
IMPULSE = _CONSTRAINT_POINT.field(1, "N s")
LEVER = _CONSTRAINT_POINT.field(1, "m")  # distance from the centre
POINT_FIELDS = _CONSTRAINT_POINT.close()

# Of a point, when the step began; of a round shape its core, see `kickdrift.world.contacts.round_cores`
_ANCHOR = Fields()
ANCHOR_A = _ANCHOR.field(3, "m")  # from the centres of mass of both bodies
ANCHOR_B = _ANCHOR.field(3, "m")
RADII = _ANCHOR.field(2, "m")  # of both shapes about it
ANCHOR_SIZE = _ANCHOR.close()

# Fields of a constraint
_CONSTRAINT = Fields()
N = _CONSTRAINT.field(3)  # normal
T = _CONSTRAINT.field(3)  # first tangent; the second is normal x first
BIAS_RATE = _CONSTRAINT.field(1, "1/s")  # of soft points
SOFT_MASS = _CONSTRAINT.field()  # scales of their effective mass, and of the impulse that they have
SOFT_IMPULSE = _CONSTRAINT.field()
FRICTION = _CONSTRAINT.field()  # coefficient
CENTRE = _CONSTRAINT.field(3, "m")  # of the contact, from body a
BETWEEN = _CONSTRAINT.field(3, "m")  # from body a to body b: the difference of their arms
FRICTION_MASS = _CONSTRAINT.field(1, "kg")  # effective mass in the direction in which it is smallest
SURFACE_SPEED = _CONSTRAINT.field(2, "m/s")  # surface velocity along both tangents
TANGENT_IMPULSE = _CONSTRAINT.field(2, "N s")  # friction impulse along both tangents
TWIST_MASS = _CONSTRAINT.field(1, "kg m^2")
TWISTING_IMPULSE = _CONSTRAINT.field(1, "N m s")
ROLL_RESISTANCE = _CONSTRAINT.field(1, "m")
ROLL_MASS = _CONSTRAINT.field(1, "kg m^2")
ROLL_IMPULSE = _CONSTRAINT.field(3, "N m s")
LANDED = _CONSTRAINT.field()  # 1.0 if one of its points landed in the substep
LANDING_SPEED = _CONSTRAINT.field(1, "m/s")  # speed of approach above which unloaded points that meet have landed
MASS_A = _CONSTRAINT.field(1, "1/kg")  # inverse masses
MASS_B = _CONSTRAINT.field(1, "1/kg")
# Turns of both bodies and their relative displacement when arms were computed
REFERENCE = _CONSTRAINT.field(9, "rad, m")
MOST_TURN = _CONSTRAINT.field(1, "rad")  # changes of these up to which arms are kept
MOST_SLIDE = _CONSTRAINT.field(1, "m")
BOUNCE_THRESHOLD = _CONSTRAINT.field(1, "m/s")  # of approach, above which points bounce; sweeps ignore them until then
P = _CONSTRAINT.field(4 * POINT_FIELDS)
ANCHORS = _CONSTRAINT.field(4 * ANCHOR_SIZE)
# Axes perpendicular to the radii of both shapes, when the step began; zeros of balls and capsules
AXES = _CONSTRAINT.field(6)
SPIN_AXIS = _CONSTRAINT.field(3)  # about which normal impulses have no torque, when the step began; or zeros
TURNS = _CONSTRAINT.field()  # 1.0 if the normal is the direction between two cores, and turns with it
# Middles and half axes of the cores of two balls or capsules whose normal turns, from the centres of mass of both bodies, when
# the step began: over the anchors of a third and a fourth point, which they do not have
CORE_A = ANCHORS + 2 * ANCHOR_SIZE
CORE_B = ANCHORS + 3 * ANCHOR_SIZE
SHARE = _CONSTRAINT.field()  # where both arms end between the point on a, 0, and that on b, 1
COUNT = _CONSTRAINT.field()  # of points
REFRESHED = _CONSTRAINT.field()  # 1.0 if arms were recomputed within the step
FIELDS = _CONSTRAINT.close()
GROUP_SIZE = FIELDS * WIDTH  # numbers of a group

# Values of the first number of REFERENCE after a search for impacts: turns so large that arms are recomputed. The second is
# then the speed, m/s, at which the contact hit, or seemed to hit, last
HIT = 1e10  # rad
MISSED = 2e10  # rad; what seemed to be a hit turned out to be none
