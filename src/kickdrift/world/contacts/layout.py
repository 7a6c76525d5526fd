"""Columns of the tables that contacts live in, and fields of the constraints that are made of them for the solver.

A manifold is up to four points with one normal. Its row of `MANIFOLD`: normal in the frame of the first shape (3), rolling
impulse in the world's axes (3), two spare; four points of eight numbers each: on the first shape in its frame (3), on the
second in its own (3), id of the features that touch, spare; the pose of the second shape in the first's frame when the points
were found (7), and by how much it may have moved since; then, in a cache line of their own, which every step writes, the
normal impulses of the points (4), friction impulse in the world's axes (3) and twist impulse; and the slide (3).

Constraints stand in groups of WIDTH: field k of lane l of group g is number (g FIELDS + k) WIDTH + l of the table `LANES`,
so that the loops over lanes vectorise.
"""

# Columns of CONTACT
SHAPE_A, SHAPE_B, PART, BODY_A, BODY_B, POINTS, STATE, PLACE_IN_GROUPS = range(8)

# Bits of STATE
TOUCHING = 1
SENSOR = 2
HIT = 4  # bounced in this step
FAST = 8  # its shapes may pass each other within the step

# Columns of MANIFOLD
NORMAL = 0
ROLLING_IMPULSE = 3
POINT = 8
POINT_SIZE = 8
ON_A, ON_B, FEATURE = 0, 3, 6
FOUND_POSE = 40
RECYCLED = 47
NORMAL_IMPULSE, FRICTION_IMPULSE, TWIST_IMPULSE = 48, 52, 55
SLIDE_AHEAD = 56  # of fast shapes: how far the second will slide past the first until they touch, in the world's axes

# Fields of a constraint
WIDTH = 8  # lanes: two vectors of AVX2 or one of AVX-512
N = 0  # normal (3)
T = 3  # first tangent (3); the second is normal x first
SOFTNESS = 6  # rate of the bias, scale of the mass, scale of the impulse
FRICTION = 9  # coefficient
CENTRE = 10  # of the contact, from body a (3)
BETWEEN = 13  # from body a to body b where they touch (3): by so much arms of a are longer than those of b
GRIP = 16  # inverse of the 2x2 response to friction: 11, 22, 12
SLIDE = 19  # velocity of the surfaces wanted along both tangents (2)
SLID = 21  # friction impulse along both tangents (2)
TWIST = 23  # effective mass, impulse
ROLL = 25  # resistance (a length), effective mass, impulse (3)
MASS_A = 30  # inverse masses
MASS_B = 31
# Share of what bodies slide past each other by which the contact has moved away from body a; the rest from b
GLIDE_A = 32
OFFSET = 33  # what they will not have slid yet when they touch (3)
FARTHEST = 36  # by how much the contact may have moved away
P = 37  # first of four points:
ARM = 0  # of a x normal (3)
GAP = 3  # separation at the start of the step
POINT_MASS = 4
IMPULSE = 5
LEVER = 6  # distance from the centre
POINT_FIELDS = 7
FIELDS = P + 4 * POINT_FIELDS
