"""Columns of the tables that the direct solver works in.

An *island* is what joints and contacts hold together of the bodies that are solved directly: links of articulations, free
bodies that touch them, up to some contacts away, and small heaps that the sweeps have left unsolved (see
`kickdrift.world.direct.unconverged_heaps`). Each of its bodies is a *node*, with a row of `LINK` and of `LINK_NUMBERS` (a
free body has no joint), and a place in the order in which nodes are eliminated. Nodes that contacts, closing joints or fill
couple are *neighbours*: of two of them, the one eliminated first has a row of `NEIGHBOUR` and of `BLOCK` for the other.
"""

from kickdrift.world.columns import Fields, column
from kickdrift.world.tables import BLOCK, CONTACT_ROW, ISLAND, NODE

# Columns of ISLAND
FIRST_NODE = column(ISLAND)  # places in the order of elimination
AFTER_NODE = column(ISLAND)
FIRST_CONTACT = column(ISLAND)  # rows of ISLAND_CONTACT
AFTER_CONTACT = column(ISLAND)
FIRST_JOINT = column(ISLAND)  # rows of ISLAND_JOINT: of trees first, then those that close loops
FIRST_CLOSING = column(ISLAND)
AFTER_JOINT = column(ISLAND)
LOST = column(ISLAND)  # 1: Newton's method found no impulses with which nothing will be off
RATIO = column(ISLAND)  # of the greatest mass to the least
HAS_JOINTS = column(ISLAND)  # 1 where joints hold any of its nodes
GIVEN_UP = column(ISLAND)  # substeps of this step in which it was lost

# Columns of NODE, a row for each place in the order
LINK_ROW = column(NODE)
PARENT_NODE = column(NODE)
FIRST_NEIGHBOUR = column(NODE)
NEIGHBOURS = column(NODE)
NODE_ISLAND = column(NODE)

# Columns of BLOCK: 6x6 blocks of the matrix
UPPER_BLOCK = column(BLOCK, 36)  # of the node's row and the neighbour's column
LOWER_BLOCK = column(BLOCK, 36)  # and the other way round
BLOCK_PASSING = column(BLOCK, 36)  # of open axis k, six numbers: its row
BLOCK_COUPLING = column(BLOCK, 36)  # and its column

# Rows of a contact: a wrench of twelve numbers each, impulse and angular impulse of its unit on the first body, the same on the
# second
_OF_A_CONTACT = Fields()
_OF_A_CONTACT.field(4)  # points
TANGENT = _OF_A_CONTACT.field(2)
TWIST = _OF_A_CONTACT.field()
ROLL = _OF_A_CONTACT.field(3)
CONTACT_ROWS = _OF_A_CONTACT.close()

# Columns of CONTACT_ROW, a number a row of the contact
WRENCH = column(CONTACT_ROW, 12 * CONTACT_ROWS)
SPEED = column(CONTACT_ROW, CONTACT_ROWS)  # before the solution
WANTED = column(CONTACT_ROW, CONTACT_ROWS)  # speed
STIFFNESS = column(CONTACT_ROW, CONTACT_ROWS)  # impulse per speed missing
MOVED = column(CONTACT_ROW, CONTACT_ROWS)  # change of speed by the solution at hand
GIVEN = column(CONTACT_ROW, CONTACT_ROWS)  # impulse by it
STATE = column(CONTACT_ROW, CONTACT_ROWS)  # OPEN, HELD or SLIDING
BOUND = column(CONTACT_ROW, 3)  # greatest impulse along the tangents, of twist, of rolling
# Of a bound that is reached: the part of the stiffness that is left at right angles to the impulse
SLIDE = column(CONTACT_ROW, 3)
DIRECTION = (
    column(CONTACT_ROW, CONTACT_ROWS - TANGENT) - TANGENT
)  # of the impulse at its bound, of rows from TANGENT on
CONSTANT = column(CONTACT_ROW, CONTACT_ROWS)  # impulse at no change of speed
ACTIVE = column(CONTACT_ROW, CONTACT_ROWS)  # 1.0 where the row takes part
IMPULSE = column(CONTACT_ROW, CONTACT_ROWS)  # before the solution
NODES = column(CONTACT_ROW, 2)  # places in the order of both bodies; -1 where none is moved
HITS = column(CONTACT_ROW, 4, "m/s")  # of each point, the speed wanted after an impact; -1.0 where it has none
START = column(CONTACT_ROW, CONTACT_ROWS)  # impulse when the substep began
CUT = column(CONTACT_ROW)  # 1.0 or 2.0: this one of the bodies belongs to another island
ROW_MASS = column(CONTACT_ROW, CONTACT_ROWS)  # that a row moves, of both bodies alone
ACCEPTED = column(CONTACT_ROW, CONTACT_ROWS)  # MOVED of the solution that was accepted last
BORNE = column(CONTACT_ROW, CONTACT_ROWS)  # impulse that the bodies bear there
BASE = column(CONTACT_ROW, CONTACT_ROWS)  # impulse, less the one before the solution, that rows begin with which hold
WEIGHT = column(CONTACT_ROW, TWIST, "kg")  # mass as if moved by which a row is stiff, of points and tangents
OPEN, HELD, SLIDING = 0.0, 1.0, 2.0
