"""Columns of the tables that the direct solver works in.

An *island* is what joints and contacts hold together of the bodies that are solved directly: links of articulations, and free
bodies that touch them. Each of its bodies is a *node*, with a row of `LINK` and of `LINK_NUMBERS` (a free body has no joint),
and a place in the order in which nodes are eliminated. Nodes that contacts, closing joints or fill couple are *neighbours*: of
two of them, the one eliminated first has a row of `NEIGHBOUR` and of `BLOCK` for the other.
"""

from kickdrift.world.joints.layout import int64

# Columns of ISLAND
FIRST_NODE, AFTER_NODE = 0, 1  # places in the order of elimination
FIRST_CONTACT, AFTER_CONTACT = 2, 3  # rows of ISLAND_CONTACT
FIRST_JOINT, FIRST_CLOSING, AFTER_JOINT = 10, 4, 5  # rows of ISLAND_JOINT: of trees first, then those that close loops
LOST = 6  # 1: Newton's method found no impulses with which nothing will be off
RATIO = 7  # of the greatest mass to the least
HAS_JOINTS = 8  # 1 where joints hold any of its nodes
GIVEN_UP = 9  # substeps of this step in which it was lost

# Columns of NODE, a row for each place in the order
LINK_ROW, PARENT_NODE, FIRST_NEIGHBOUR, NEIGHBOURS, NODE_ISLAND = 0, 1, 2, 3, 4

# Columns of BLOCK: 6x6 blocks of the matrix, of the node's row and the neighbour's column, and the other way round
UPPER_BLOCK, LOWER_BLOCK = int64(0), int64(36)
BLOCK_PASSING, BLOCK_COUPLING = int64(72), int64(108)  # of open axis k, six numbers each: its row and its column

# Rows of a contact, and columns of CONTACT_ROW. A row of a contact is a wrench of twelve numbers: impulse and angular impulse
# of its unit on the first body, the same on the second.
TANGENT, TWIST, ROLL = 4, 6, 7  # the first four are the points
WRENCH = 0
SPEED = 120  # before the solution
WANTED = 130  # speed
STIFFNESS = 140  # impulse per speed missing
MOVED, GIVEN = 150, 160  # change of speed and impulse by the solution at hand
STATE = 170  # OPEN, HELD or SLIDING
BOUND = 180  # greatest impulse along the tangents, of twist, of rolling
SLIDE = 183  # of a bound that is reached: the part of the stiffness that is left at right angles to the impulse
DIRECTION = 186 - TANGENT  # of the impulse at its bound, a number a row from the tangents on
CONSTANT = 192  # impulse at no change of speed
ACTIVE = 202  # 1.0 where the row takes part
IMPULSE = 212  # before the solution
NODES = 222  # places in the order of both bodies; -1 where none is moved
START = 228  # impulse when the substep began
ROW_MASS = 239  # that a row moves, of both bodies alone
ACCEPTED = 250  # MOVED of the solution that was accepted last
BASE = 270  # impulse, less the one before the solution, that rows begin with which hold
BORNE = 260  # impulse that the bodies bear there
WEIGHT = 280  # mass that bears on each row, of points and tangents
CUT = 238  # 1.0 where one of the bodies belongs to another island
HITS = 224  # of each point, the speed wanted after an impact; -1.0 where it has none
OPEN, HELD, SLIDING = 0.0, 1.0, 2.0
