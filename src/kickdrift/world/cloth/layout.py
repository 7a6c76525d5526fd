"""Columns of the tables of cloths."""

from kickdrift.world.columns import Fields, column
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_CONTACT,
    CLOTH_CONTACT_NUMBERS,
    CLOTH_NUMBERS,
    CLOTH_PAIR,
    CLOTH_PAIR_NUMBERS,
    CLOTH_SEARCH,
    CLOTH_TREE_NODE,
    COUPLING,
    COUPLING_NUMBERS,
    CURVED_FACE,
    CURVED_FACE_NUMBERS,
    FACE,
    FACE_BOUNDS,
    FACE_GROUP,
    FACE_NORMALS,
    FACE_NUMBERS,
    FACE_TURN,
    GROUP_REST,
    GROUP_STRAIN,
    INTERVAL_START,
    PARTICLE,
    PARTICLE_BOUNDS,
    PARTICLE_COUPLINGS,
    PARTICLE_PATH,
    PARTICLE_REST,
    PARTICLE_SHIFT,
    PARTICLE_WIND,
    PIN,
    PIN_NUMBERS,
    TREE_NEIGHBOUR,
    ZONE,
    ZONE_NUMBERS,
)

# CLOTH
FIRST_PARTICLE, LAST_PARTICLE = column(CLOTH), column(CLOTH)  # the one after the last, as below
FIRST_FACE, LAST_FACE = column(CLOTH), column(CLOTH)
FIRST_COUPLING, LAST_COUPLING = column(CLOTH), column(CLOTH)
FIRST_CURVED, LAST_CURVED = column(CLOTH), column(CLOTH)
FIRST_PIN, LAST_PIN = column(CLOTH), column(CLOTH)
PARTS = column(CLOTH)  # of a substep
FIRST_CONTACT, LAST_CONTACT = column(CLOTH), column(CLOTH)
CLOTH_GENERATION = column(CLOTH)
FIRST_NODE, LAST_NODE = column(CLOTH), column(CLOTH)
MEETS_ITSELF = column(CLOTH)
FIRST_GROUP, LAST_GROUP = column(CLOTH), column(CLOTH)
IS_ASLEEP = column(CLOTH)  # of the first cloth, for all of them
STIRRED = 2  # value of it: they sleep, and were moved

# CLOTH_NUMBERS
STRETCH = column(CLOTH_NUMBERS, 1, "N/m")  # stiffness, as it is in use
SHEAR = column(CLOTH_NUMBERS, 1, "N/m")
BENDING = column(CLOTH_NUMBERS, 1, "N m")
MEMBRANE_DAMPING = column(CLOTH_NUMBERS, 1, "s")  # as it is in use
BENDING_DAMPING = column(CLOTH_NUMBERS, 1, "s")
CLOTH_RADIUS = column(CLOTH_NUMBERS, 1, "m")  # half the thickness
AREA_DENSITY = column(CLOTH_NUMBERS, 1, "kg/m^2")
LINEAR_DAMPING = column(CLOTH_NUMBERS, 1, "1/s")
CLOTH_FRICTION = column(CLOTH_NUMBERS)
DRAG = column(CLOTH_NUMBERS, 1, "kg/m^3")  # coefficient times density of the air
LIFT = column(CLOTH_NUMBERS, 1, "kg/m^3")
WIND = column(CLOTH_NUMBERS, 3, "m/s")
ASKED = column(CLOTH_NUMBERS, 5, "N/m, N/m, N m, s, s")  # the first five as they were asked for
MEMBRANE_RATE = column(CLOTH_NUMBERS, 1, "1/s")  # highest angular frequency, with what was asked for
BENDING_RATE = column(CLOTH_NUMBERS, 1, "1/s")
REST_TIME = column(CLOTH_NUMBERS, 1, "s")  # for how long all cloths have rested, of the first
SKIN = column(CLOTH_NUMBERS, 1, "m")  # by which particles may move otherwise than foreseen until pairs are sought anew

TEAR_STRAIN = column(CLOTH_NUMBERS)  # 0.0: it does not tear

# PARTICLE
column(PARTICLE, 3, "m")  # position
PARTICLE_INVERSE_MASS = column(PARTICLE, 1, "1/kg")  # 0.0 of those that are pinned
PARTICLE_VELOCITY = column(PARTICLE, 3, "m/s")
PARTICLE_MASS = column(PARTICLE, 1, "kg")

# PARTICLE_REST
column(PARTICLE_REST, 3, "m")  # where it is in the cloth without tension
SPLIT_FROM = column(PARTICLE_REST)  # vertex of the cloth that it was one with; of those from the start, nothing

# Fields of PARTICLE_LANES
_LANES = Fields()
PLACES = _LANES.field(3, "m")
FORCES = _LANES.field(3, "N")
CURVES = _LANES.field(3, "1/m")  # force of bending over the stiffness; where a part begins, as it was before
LANE_FIELDS = _LANES.close()

# PARTICLE_COUPLINGS
COUPLINGS = column(PARTICLE_COUPLINGS, 2)  # the first and one after the last, of those of the cloth

# COUPLING: particles that are bent alike have the same ones
OFFSET = column(COUPLING)  # by how many rows of PARTICLE the other one comes later

# COUPLING_NUMBERS
WEIGHT = column(COUPLING_NUMBERS, 1, "1/m^2")

# FACE
CORNERS = column(FACE, 3)  # particles
OWNED = column(FACE)  # set of its corners, then of the sides from them to the next, which no triangle before has

# FACE_NUMBERS
TO_REST = column(FACE_NUMBERS, 4, "1/m")  # inverse of the two edges from the first corner, in the axes of warp and weft
FACE_AREA = column(FACE_NUMBERS, 1, "m^2")

# FACE_GROUP, GROUP_REST and GROUP_STRAIN, eight numbers of each
GROUP_CORNERS = column(FACE_GROUP, 24)  # particles: the first corners, the second and the third ones
RESTS = column(FACE_GROUP)  # row of GROUP_REST
IN_ROWS = column(FACE_GROUP)  # 1: corners follow each other
column(GROUP_REST, 40, "1/m, m^2")  # TO_REST and FACE_AREA
column(GROUP_STRAIN, 24)  # along warp and weft, and shear, at the last kick

# CURVED_FACE
STENCIL = column(CURVED_FACE, 6)  # particles: its corners and those across its sides

# CURVED_FACE_NUMBERS
PULLS = column(CURVED_FACE_NUMBERS, 6, "1/m")  # of the particles along its normal, over the bending stiffness
REST_ENERGY = column(CURVED_FACE_NUMBERS)  # that it would take to flatten it, over the bending stiffness

# PIN: by cloths, and of each by bodies
PINNED_PARTICLE = column(PIN)
PINNED_BODY = column(PIN)

# PIN_NUMBERS
PIN_POSITION = column(PIN_NUMBERS, 3, "m")  # in the body

# CLOTH_CONTACT
TOUCHING_PARTICLE = column(CLOTH_CONTACT)
TOUCHED_BODY = column(CLOTH_CONTACT)
MOVES_BODY = column(CLOTH_CONTACT)  # 1: the body takes the reaction
IN_LANES = column(CLOTH_CONTACT)  # 1: it and the next seven are of different particles, and move no body

# CLOTH_CONTACT_NUMBERS
CLOTH_NORMAL = column(CLOTH_CONTACT_NUMBERS, 3)  # from the shape to the particle
CLOTH_GAP = column(CLOTH_CONTACT_NUMBERS, 1, "m")
CONTACT_FRICTION = column(CLOTH_CONTACT_NUMBERS)
TOUCHED_POINT = column(CLOTH_CONTACT_NUMBERS, 3, "m")  # from the centre of the body
GROUND_VELOCITY = column(
    CLOTH_CONTACT_NUMBERS, 3, "m/s"
)  # of the shape there; of a body that it moves, besides its own

# PARTICLE_SHIFT
column(PARTICLE_SHIFT, 3, "m")  # what it is moved by in the drift, without a velocity

# INTERVAL_START
column(INTERVAL_START, 3, "m")  # where particles were when it began

# PARTICLE_WIND
column(PARTICLE_WIND, 3, "m/s")

# PARTICLE_BOUNDS, in a frame that moves with the cloths
column(PARTICLE_BOUNDS, 6, "m")  # corners of a box that it is in for as long as pairs are not sought anew

# PARTICLE_PATH
column(PARTICLE_PATH, 3, "m")  # where it was when pairs were sought
FORESEEN = column(PARTICLE_PATH, 3, "m/s")  # how it was going to move

# FACE_BOUNDS
column(FACE_BOUNDS, 6, "m")  # around those of the corners

# FACE_NORMALS
column(FACE_NORMALS, 6)  # corners of a box around its normal, of length one

# FACE_TURN
column(FACE_TURN, 6)  # its normal as it is, and as it is foreseen; zeros where it is not known

# CLOTH_TREE_NODE
IS_CONNECTED = column(CLOTH_TREE_NODE)
NEIGHBOURS = column(CLOTH_TREE_NODE, 2)  # the first and one after the last, of those in TREE_NEIGHBOUR

# TREE_NEIGHBOUR, of a node
NEIGHBOUR = column(TREE_NEIGHBOUR)  # a later node of its level that is near it at rest
BETWEEN = column(TREE_NEIGHBOUR)  # one that joins both to one piece; the neighbour itself where they share a side

# CLOTH_SEARCH
SEARCH_VALID = column(CLOTH_SEARCH)  # 0: pairs are to be sought anew
SEARCH_AGE = column(CLOTH_SEARCH, 1, "s")
SEARCH_HORIZON = column(CLOTH_SEARCH, 1, "s")  # age that the search was made for
FRAME_VELOCITY = column(CLOTH_SEARCH, 3, "m/s")
TURN = column(CLOTH_SEARCH)  # how far the substep is done
SHARED_PARTS = column(CLOTH_SEARCH)
INTERVAL = column(CLOTH_SEARCH)  # parts, after which cloths meet
TRAVELLED = column(
    CLOTH_SEARCH, 1, "m"
)  # how far particles have moved against each other at most, since pairs were sought
CROSSINGS = column(CLOTH_SEARCH)  # pairs of triangles that cross

# CLOTH_PAIR
PAIR_PARTICLES = column(CLOTH_PAIR, 4)  # the vertex and the corners, or the ends of one edge and of the other
PAIR_KIND = column(CLOTH_PAIR)

# CLOTH_PAIR_NUMBERS
PAIR_DISTANCE = column(CLOTH_PAIR_NUMBERS, 1, "m")  # that is kept
PAIR_FRICTION = column(CLOTH_PAIR_NUMBERS)
PAIR_APART = column(CLOTH_PAIR_NUMBERS, 1, "m")  # when it was last looked at
PAIR_SEEN = column(CLOTH_PAIR_NUMBERS, 1, "m")  # TRAVELLED then
PAIR_LAID = column(CLOTH_PAIR_NUMBERS, 1, "m")  # TRAVELLED when what follows was found; `NOT_LAID`
PAIR_GIVES = column(CLOTH_PAIR_NUMBERS, 1, "1/kg")  # velocity over impulse; zero where it takes none
PAIR_WEIGHTS = column(CLOTH_PAIR_NUMBERS, 4)
PAIR_NORMAL = column(CLOTH_PAIR_NUMBERS, 3)  # from the second to the first
NOT_LAID = -1.0

# ZONE
IN_ZONE = column(ZONE)  # leads to the first particle of its zone
IS_TANGLED = column(ZONE)  # 1: a triangle of it crosses another one

# ZONE_NUMBERS, of the first particle
ZONE_MASS = column(ZONE_NUMBERS, 1, "kg")
ZONE_CENTRE = column(ZONE_NUMBERS, 3, "kg m")
ZONE_MOMENTUM = column(ZONE_NUMBERS, 3, "kg m/s")
ZONE_SPIN = column(ZONE_NUMBERS, 3, "kg m^2/s")
ZONE_INERTIA = column(ZONE_NUMBERS, 6, "kg m^2")
