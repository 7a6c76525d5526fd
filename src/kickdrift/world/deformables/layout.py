"""Columns of the tables of cloths."""

from kickdrift.world import tables as t
from kickdrift.world.columns import Fields, column

# CLOTH
FIRST_PARTICLE, LAST_PARTICLE = column(t.CLOTH), column(t.CLOTH)  # LAST is one after the last, here and below
FIRST_FACE, LAST_FACE = column(t.CLOTH), column(t.CLOTH)
FIRST_COUPLING, LAST_COUPLING = column(t.CLOTH), column(t.CLOTH)
FIRST_CURVED, LAST_CURVED = column(t.CLOTH), column(t.CLOTH)
FIRST_PIN, LAST_PIN = column(t.CLOTH), column(t.CLOTH)
PARTS = column(t.CLOTH)  # number of parts of a substep
FIRST_CONTACT, LAST_CONTACT = column(t.CLOTH), column(t.CLOTH)
CLOTH_GENERATION = column(t.CLOTH)
FIRST_NODE, LAST_NODE = column(t.CLOTH), column(t.CLOTH)
MEETS_ITSELF = column(t.CLOTH)
FIRST_GROUP, LAST_GROUP = column(t.CLOTH), column(t.CLOTH)
IS_ASLEEP = column(t.CLOTH)  # of the first cloth, for all of them
STIRRED = 2  # value of IS_ASLEEP: they sleep, but the user has moved them
DIMENSION = column(t.CLOTH)
FIRST_TETRAHEDRON, LAST_TETRAHEDRON = column(t.CLOTH), column(t.CLOTH)
FIRST_TETHER, LAST_TETHER = column(t.CLOTH), column(t.CLOTH)
LAST_FREE_TETHER = column(t.CLOTH)  # one after the last of a particle that is not pinned
ROPE, SHEET, VOLUME = 1, 2, 3  # values of DIMENSION

# CLOTH_NUMBERS
STRETCH = column(t.CLOTH_NUMBERS, 1, "N/m")  # stiffness in use; of a rope in N, of a soft body its Young's modulus, Pa
SHEAR = column(t.CLOTH_NUMBERS, 1, "N/m")
BENDING = column(t.CLOTH_NUMBERS, 1, "N m")  # of a rope in N m^2
MEMBRANE_DAMPING = column(t.CLOTH_NUMBERS, 1, "s")  # in use
BENDING_DAMPING = column(t.CLOTH_NUMBERS, 1, "s")
CLOTH_RADIUS = column(t.CLOTH_NUMBERS, 1, "m")  # half the thickness
AREA_DENSITY = column(t.CLOTH_NUMBERS, 1, "kg/m^2")  # of a sheet
LINEAR_DAMPING = column(t.CLOTH_NUMBERS, 1, "1/s")
CLOTH_FRICTION = column(t.CLOTH_NUMBERS)
DRAG = column(t.CLOTH_NUMBERS, 1, "kg/m^3")  # coefficient times density of the air
LIFT = column(t.CLOTH_NUMBERS, 1, "kg/m^3")
WIND = column(t.CLOTH_NUMBERS, 3, "m/s")
ASKED = column(t.CLOTH_NUMBERS, 5, "N/m, N/m, N m, s, s")  # the first five columns as the fabric has them
MEMBRANE_RATE = column(t.CLOTH_NUMBERS, 1, "1/s")  # highest angular frequency, with the stiffness of the fabric
BENDING_RATE = column(t.CLOTH_NUMBERS, 1, "1/s")
REST_TIME = column(t.CLOTH_NUMBERS, 1, "s")  # of the first cloth: for how long all cloths have been at rest
SKIN = column(t.CLOTH_NUMBERS, 1, "m")  # deviation of particles from predicted paths up to which pairs remain valid

TEAR_STRAIN = column(t.CLOTH_NUMBERS)  # 0.0 if it does not tear
POISSON_RATIO = column(t.CLOTH_NUMBERS)  # of a soft body
TETHER_STRAIN = column(t.CLOTH_NUMBERS)  # of a way along the cloth to a pin; 0.0 without tethers

# PARTICLE
column(t.PARTICLE, 3, "m")  # position
PARTICLE_INVERSE_MASS = column(t.PARTICLE, 1, "1/kg")  # 0.0 if pinned
PARTICLE_VELOCITY = column(t.PARTICLE, 3, "m/s")
PARTICLE_MASS = column(t.PARTICLE, 1, "kg")

# PARTICLE_REST
column(t.PARTICLE_REST, 3, "m")  # position in the mesh at rest
SPLIT_FROM = column(t.PARTICLE_REST)  # vertex of the cloth from which it was split; unused for original vertices

# Fields of PARTICLE_LANES
_LANES = Fields()
PLACES = _LANES.field(3, "m")
FORCES = _LANES.field(3, "N")
FORCES_APART = _LANES.field(3, "N")  # the other addends of the forces; see `kickdrift.world.deformables.face_groups`
CURVES = _LANES.field(3, "1/m")  # force of bending over the stiffness; where a part begins, as it was before
LANE_FIELDS = _LANES.close()

# PARTICLE_COUPLINGS
COUPLINGS = column(t.PARTICLE_COUPLINGS, 2)  # the first and one after the last, among those of the cloth

# COUPLING: particles with equal couplings share them
OFFSET = column(t.COUPLING)  # row of the other particle less that of the particle

# COUPLING_NUMBERS
WEIGHT = column(t.COUPLING_NUMBERS, 1, "1/m^2")

# FACE
CORNERS = column(t.FACE, 3)  # particles
OWNED = column(t.FACE)  # bits of its corners, then of the sides that begin there, that no earlier triangle has

# FACE_NUMBERS
TO_REST = column(t.FACE_NUMBERS, 4, "1/m")  # inverse matrix of the two edges from the first corner, in warp and weft
FACE_AREA = column(t.FACE_NUMBERS, 1, "m^2")
REST_LENGTH = column(t.FACE_NUMBERS, 1, "m")  # of a segment of a rope, a triangle whose second corner is the third, too

# FACE_GROUP, GROUP_REST and GROUP_STRAIN, eight numbers of each
RESTS = column(t.FACE_GROUP)  # row of GROUP_REST
IN_ROWS = column(t.FACE_GROUP)  # 1 if the corners are consecutive rows; then the first triangle is all that is read
# field to which the forces on the first corners are added, on the second and the third ones
ADDED_TO = column(t.FACE_GROUP, 3)
# One after the last row of its colour: see `kickdrift.world.deformables.face_groups`
AFTER_COLOUR = column(t.FACE_GROUP)
GROUP_CORNERS = column(t.FACE_GROUP, 24)  # particles: three of each triangle
column(t.GROUP_REST, 40, "1/m, m^2")  # TO_REST and FACE_AREA
column(t.GROUP_STRAIN, 24)  # strains along warp and weft, and shear, at the last kick

# TETRAHEDRON
TETRAHEDRON_CORNERS = column(t.TETRAHEDRON, 4)  # particles

# TETRAHEDRON_NUMBERS
TO_REST_CELL = column(t.TETRAHEDRON_NUMBERS, 9, "1/m")  # inverse matrix of the three edges from the first corner
REST_VOLUME = column(t.TETRAHEDRON_NUMBERS, 1, "m^3")

# CURVED_FACE
STENCIL = column(t.CURVED_FACE, 6)  # particles: its corners and those across its sides

# CURVED_FACE_NUMBERS
PULLS = column(t.CURVED_FACE_NUMBERS, 6, "1/m")  # forces on the particles along its normal, over the bending stiffness
REST_ENERGY = column(t.CURVED_FACE_NUMBERS)  # energy that flattens it, over the bending stiffness

# PIN: sorted by cloth, then by body
PINNED_PARTICLE = column(t.PIN)
PINNED_BODY = column(t.PIN)

# PIN_NUMBERS
PIN_POSITION = column(t.PIN_NUMBERS, 3, "m")  # in the body

# TETHER
TETHERED = column(t.TETHER)  # particle
TETHER_PIN = column(t.TETHER)  # of it to a dynamic body, or FREE
TETHER_ANCHOR = column(t.TETHER)  # particle, pinned in the world or to a body that is not dynamic

# TETHER_NUMBERS
TETHER_LENGTH = column(t.TETHER_NUMBERS, 1, "m")

# CLOTH_CONTACT
TOUCHING_PARTICLE = column(t.CLOTH_CONTACT)
TOUCHED_BODY = column(t.CLOTH_CONTACT)
MOVES_BODY = column(t.CLOTH_CONTACT)  # 1 if the body receives the reaction
IN_LANES = column(t.CLOTH_CONTACT)  # number of contacts from this one on that are resolved eight at a time
# The other end of a segment that touches, the other corners of a triangle; otherwise the particle itself
OTHER_PARTICLE = column(t.CLOTH_CONTACT)
THIRD_PARTICLE = column(t.CLOTH_CONTACT)
# The pins of the corners to bodies: see `kickdrift.world.deformables.body_contacts.pinned_corners`
HELD_BY = column(t.CLOTH_CONTACT, 3)
CARRIED_BY = column(t.CLOTH_CONTACT, 3)  # rows of the contacts that carry the corners, or NOTHING
# CARRIES or IS_CARRIED of `kickdrift.world.deformables.body_contacts.load_path`, or 0
ON_LOAD_PATH = column(t.CLOTH_CONTACT)

# CLOTH_CONTACT_NUMBERS: the first eight columns are those of CONTACT_LANES
CLOTH_NORMAL = column(t.CLOTH_CONTACT_NUMBERS, 3)  # from the shape to the particle
# The normal times the position at which the point touches; of contacts in lanes, when they were found
CLOTH_OFFSET = column(t.CLOTH_CONTACT_NUMBERS, 1, "m")
CONTACT_FRICTION = column(t.CLOTH_CONTACT_NUMBERS)
# Surface velocity of the shape; relative to its body if MOVES_BODY
GROUND_VELOCITY = column(t.CLOTH_CONTACT_NUMBERS, 3, "m/s")
TOUCHED_POINT = column(t.CLOTH_CONTACT_NUMBERS, 3, "m")  # from the centre of the body
SHARES = column(t.CLOTH_CONTACT_NUMBERS, 3)  # barycentric coordinates of the point that touches
CONTACT_IMPULSE = column(t.CLOTH_CONTACT_NUMBERS, 4, "kg m/s")  # in this part: along the normal, and of friction
PASSED_FRICTION = column(t.CLOTH_CONTACT_NUMBERS, 3, "kg m/s")  # on the bodies on both sides of the cloth alone
CONTACT_RADIUS = column(t.CLOTH_CONTACT_NUMBERS, 1, "m")  # of curvature at the point, otherwise zero
CONTACT_AXIS = column(t.CLOTH_CONTACT_NUMBERS, 3)  # along which a round shape is straight; zero for a ball

# CONTACT_LANES and CONTACT_LANE_PARTICLES, of the eight contacts from row `row` on in their row `row // 8`
column(t.CONTACT_LANES, 64)  # the first eight columns of CLOTH_CONTACT_NUMBERS, eight numbers each
column(t.CONTACT_LANE_PARTICLES, 8)

# PARTICLE_SHIFT
column(t.PARTICLE_SHIFT, 3, "m")  # displacement in the drift besides that of its velocity
CARRIER = column(t.PARTICLE_SHIFT)  # while contacts are found: the row of the contact that carries it, plus 1, or 0

# INTERVAL_START
column(t.INTERVAL_START, 3, "m")  # positions when the interval began
GIVES = column(t.INTERVAL_START, 1, "1/kg")  # inverse mass of a particle pinned to a dynamic body, otherwise zero

# PARTICLE_WIND
column(t.PARTICLE_WIND, 3, "m/s")

# PARTICLE_BOUNDS, in a frame that moves with the cloths
column(t.PARTICLE_BOUNDS, 6, "m")  # corners of a box that contains it as long as pairs remain valid

# PARTICLE_PATH
column(t.PARTICLE_PATH, 3, "m")  # position when its motion was predicted
PREDICTED_VELOCITY = column(t.PARTICLE_PATH, 3, "m/s")  # predicted velocity
PREDICTED_AT = column(t.PARTICLE_PATH, 1, "s")  # SEARCH_AGE when it was predicted

# FACE_BOUNDS
column(t.FACE_BOUNDS, 6, "m")  # bounds of those of its corners

# FACE_NORMALS
column(t.FACE_NORMALS, 6)  # corners of a box around its unit normal

# FACE_TURN
column(t.FACE_TURN, 6)  # its unit normal, at present and predicted; zeros if it is undetermined

# FACE_STARS
# of each corner, three times a triangle plus its corner: the next one at this particle
NEXT_AROUND = column(t.FACE_STARS, 3)

# CLOTH_LOAD, of a body: see `kickdrift.world.deformables.body_contacts.predicted_loads`
WITHHELD_IMPULSE = column(t.CLOTH_LOAD, 6, "N s, N m s")  # and angular impulse, which act in the next substep
STEADY_FORCE = column(t.CLOTH_LOAD, 3, "N")  # which acts in it as well, and is taken back
STEADY_TORQUE = column(t.CLOTH_LOAD, 3, "N m")
GIVEN_FORCE = column(t.CLOTH_LOAD, 6, "N, N m")  # and torque that have moved the body in the last substep
STARTED_LOAD = column(t.CLOTH_LOAD, 18)  # these when the step began
NOTED_VELOCITY = column(t.CLOTH_LOAD, 3, "m/s")  # before the kick
NOTED_SPIN = column(t.CLOTH_LOAD, 3, "kg m^2/s")
NOTED_DELTA = column(t.CLOTH_LOAD, 6)  # DELTA_POSE when the substep began
HELD = column(t.CLOTH_LOAD, 6)  # part of a change of motion that contacts hold
MOST_WITHHELD = column(t.CLOTH_LOAD, 1, "m/s")  # in a substep
WITHHELD_CHANGE = column(t.CLOTH_LOAD, 6)  # of MOTION, which they hold in this substep
GIVEN_CHANGE = column(t.CLOTH_LOAD, 6)  # of MOTION, which cloths have made in it

# CLOTH_TREE_NODE
IS_CONNECTED = column(t.CLOTH_TREE_NODE)
NEAR_NODES = column(t.CLOTH_TREE_NODE, 2)  # the first and one after the last, of those in TREE_NEIGHBOUR
HAS_STRAYED = column(t.CLOTH_TREE_NODE)  # 1 if a particle of it has

# TREE_NEIGHBOUR, of a node
NEAR_NODE = column(t.TREE_NEIGHBOUR)  # a later node of its level that is near it at rest
BETWEEN = column(t.TREE_NEIGHBOUR)  # one that joins both to one piece; the neighbour itself where they share a side

# CLOTH_SEARCH
SEARCH_STATE = column(t.CLOTH_SEARCH)
SEARCH_AGE = column(t.CLOTH_SEARCH, 1, "s")  # since the last search of all pairs
SEARCH_HORIZON = column(t.CLOTH_SEARCH, 1, "s")  # age up to which pairs remain valid
FRAME_VELOCITY = column(t.CLOTH_SEARCH, 3, "m/s")
BOXES_VELOCITY = column(t.CLOTH_SEARCH, 3, "m/s")  # of the frame of PARTICLE_BOUNDS
TURN = column(t.CLOTH_SEARCH)  # progress in the substep, from which the stage resumes
SHARED_PARTS = column(t.CLOTH_SEARCH)  # number of parts of the substep
INTERVAL = column(t.CLOTH_SEARCH)  # number of parts after which cloth-cloth contact is resolved
# how far particles have moved against each other at most, since pairs were sought
TRAVELLED = column(t.CLOTH_SEARCH, 1, "m")
FIRST_HELD = column(t.CLOTH_SEARCH)  # pair, or `NONE_HELD`
CROSSINGS = column(t.CLOTH_SEARCH)  # number of pairs of triangles that cross
# relative displacement of particles for which NEAR_PAIR lists the near pairs
NEAR_AHEAD = column(t.CLOTH_SEARCH, 1, "m")

# Values of SEARCH_STATE
INVALID = 0.0  # nothing is known
SOUGHT = 1.0  # motion is predicted, and there are boxes for it
VALID = 2.0  # pairs are known, too
KEPT = 3.0  # motion is predicted and pairs are known, but boxes must be made again

# SEARCH_TASK
TASK_NODES = column(t.SEARCH_TASK, 2)  # of the trees of both cloths
FIRST_FOUND, LAST_FOUND = column(t.SEARCH_TASK), column(t.SEARCH_TASK)  # of FOUND_PAIR, one after the last
PLACE_OF_FOUND = column(t.SEARCH_TASK)  # row of CLOTH_PAIR

# CLOTH_PAIR
PAIR_PARTICLES = column(t.CLOTH_PAIR, 4)  # vertex and corners, or ends of one edge and of the other
PAIR_FACES = column(t.CLOTH_PAIR, 2)  # triangles that own them
PAIR_KIND = column(t.CLOTH_PAIR)
NEXT_HELD = column(t.CLOTH_PAIR)  # the next pair that is held during the interval, or `NONE_HELD`
NONE_HELD = -1

# CLOTH_PAIR_NUMBERS
PAIR_DISTANCE = column(t.CLOTH_PAIR_NUMBERS, 1, "m")  # distance to be kept
PAIR_FRICTION = column(t.CLOTH_PAIR_NUMBERS)
PAIR_APART = column(t.CLOTH_PAIR_NUMBERS, 1, "m")  # distance when it was last computed
PAIR_SEEN = column(t.CLOTH_PAIR_NUMBERS, 1, "m")  # TRAVELLED then
PAIR_LAID = column(t.CLOTH_PAIR_NUMBERS, 1, "m")  # TRAVELLED when what follows was found; `NOT_LAID`
PAIR_GIVES = column(t.CLOTH_PAIR_NUMBERS, 1, "1/kg")  # velocity over impulse; zero where it takes none
PAIR_WEIGHTS = column(t.CLOTH_PAIR_NUMBERS, 4)
PAIR_NORMAL = column(t.CLOTH_PAIR_NUMBERS, 3)  # from the second to the first
NOT_LAID = -1.0

# ZONE
IN_ZONE = column(t.ZONE)  # parent in the disjoint sets of particles
CROSSING_COUNT = column(t.ZONE)  # number of pairs of triangles that cross, one of which is of it
IS_STRAY = column(t.ZONE)  # 1 if it has left its predicted path, so that its pairs are sought again
STAR = column(t.ZONE)  # whether the triangles around it are flat
NOT_KNOWN, FLAT, FOLDED = 0, 1, 2  # values of STAR

# ZONE_NUMBERS, of the first particle
ZONE_MASS = column(t.ZONE_NUMBERS, 1, "kg")
ZONE_CENTRE = column(t.ZONE_NUMBERS, 3, "kg m")
ZONE_MOMENTUM = column(t.ZONE_NUMBERS, 3, "kg m/s")
ZONE_SPIN = column(t.ZONE_NUMBERS, 3, "kg m^2/s")
ZONE_INERTIA = column(t.ZONE_NUMBERS, 6, "kg m^2")
