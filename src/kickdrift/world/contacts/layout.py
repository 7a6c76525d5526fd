"""Columns of the tables that contacts live in, and fields of the constraints that are made of them for the solver.

A manifold is up to four points with one normal. Its row of `MANIFOLD`: normal in the frame of the first shape (3), rolling
impulse in the world's axes (3), two spare; four points of eight numbers each: on the first shape in its frame (3), on the
second in its own (3), id of the features that touch, spare; the pose of the second shape in the first's frame when the points
were found (7), and by how much it may have moved since; then, in a cache line of their own, which every step writes, the
normal impulses of the points (4), friction impulse in the world's axes (3) and twist impulse; and how the contact lay when it
came to rest: orientations of both shapes (4 and 4), the way from the first body to the second (3), and half the least width of
the face that the points span.

Constraints stand in groups of WIDTH: field k of lane l of group g is number (g FIELDS + k) WIDTH + l of the table `LANES`,
so that the loops over lanes vectorise. Fields that the sweeps read come first; from ANCHORS on stand those of which
`kickdrift.world.contacts.prepare_simd` makes them.
"""

# Columns of CONTACT
SHAPE_A, SHAPE_B, TRIANGLE_INDEX, BODY_A, BODY_B, POINTS, CONTACT_STATE, PLACE_IN_GROUPS = range(8)

# Bits of CONTACT_STATE
TOUCHING = 1
SENSOR = 2
BOUNCED = 4  # bounced in this step
FAST = 8  # its shapes may pass each other within the step
MOVING = 16  # its arms were taken anew within the last step, or it is new

# Columns of MANIFOLD
NORMAL = 0
ROLLING_IMPULSE = 3
POINT = 8
POINT_SIZE = 8
ON_A, ON_B, FEATURE = 0, 3, 6
FOUND_POSE = 40
RECYCLED = 47
NORMAL_IMPULSE, FRICTION_IMPULSE, TWIST_IMPULSE = 48, 52, 55
REST_A, REST_B, REST_APART, WIDTH_OF_FACE = 56, 60, 64, 67

# Fields of a constraint
WIDTH = 8  # lanes: two vectors of AVX2 or one of AVX-512
N = 0  # normal (3)
T = 3  # first tangent (3); the second is normal x first
SOFTNESS = 6  # rate of the bias, scale of the mass, scale of the impulse
FRICTION = 9  # coefficient
CENTRE = 10  # of the contact, from body a (3)
BETWEEN = 13  # from body a to body b (3): by so much arms of a are longer than those of b
GRIP = 16  # inverse of the 2x2 response to friction: 11, 22, 12
SLIDE = 19  # velocity of the surfaces wanted along both tangents (2)
SLID = 21  # friction impulse along both tangents (2)
TWIST = 23  # effective mass, impulse
ROLL = 25  # resistance (a length), effective mass, impulse (3)
MASS_A = 30  # inverse masses
MASS_B = 31
REFERENCE = 32  # turns of both bodies and what they had slid past each other when the arms were taken (9)
STALE = 41  # by how much they may differ from now: turns, slide
P = 43  # first of four points:
ARM = 0  # of a x normal (3)
GAP = 3  # separation at the start of the step, as far as it is linear in what bodies have moved since
POINT_MASS = 4
IMPULSE = 5
LEVER = 6  # distance from the centre
POINT_FIELDS = 7
# Of the four points, when the step began: from both bodies (3 and 3), and the radii of both shapes about them (2). What is
# round has its core there, see `kickdrift.world.contacts.rolling_core`.
ANCHORS = P + 4 * POINT_FIELDS
ANCHOR_SIZE, ANCHOR_B, RADII = 8, 3, 6
AXES = (
    ANCHORS + 4 * ANCHOR_SIZE
)  # that radii are at right angles to, when the step began (3 and 3); zeros of balls and capsules
SHARE = AXES + 6  # of the way from the point on a to that on b, at which both arms end
COUNT = SHARE + 1  # of points
REFRESHED = SHARE + 2  # 1.0 where arms were taken anew within the step
FIELDS = REFRESHED + 1
