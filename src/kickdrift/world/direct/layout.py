"""Columns of the tables of the direct solver.

An *island* is a set of bodies that are connected by joints and contacts and solved directly: links of articulations, free
bodies within some contacts of them, and small heaps that the sweeps have left unsolved (see
`kickdrift.world.direct.unconverged_heaps`). Each of its bodies is a *node*, with a row of `LINK` and of `LINK_NUMBERS` (a
free body has no joint), and a place in the order of elimination. Nodes that are coupled by contacts, closing joints or fill are
*neighbours*: of two neighbours, the one eliminated first has a row of `NEIGHBOUR` and of `BLOCK` for the other. After them come
the articulations whose joints are solved one after the other, as islands without contacts, whose energy is judged as well.
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
LOST = column(ISLAND)  # 1 if Newton's method has not found impulses that satisfy the joints at the end of the substep
RATIO = column(ISLAND)  # of the largest mass to the smallest
HAS_JOINTS = column(ISLAND)  # 1 if any of its nodes has a joint
GIVEN_UP = column(ISLAND)  # substeps of this step in which it was lost
TOUCHES = column(ISLAND)  # 1 if its bodies have contacts with each other, 2 if one has a contact with another body
GROUP = column(ISLAND)  # a lower island of those connected with it by contacts, or itself

# Columns of NODE, one row for each place in the order of elimination
LINK_ROW = column(NODE)
PARENT_NODE = column(NODE)
FIRST_NEIGHBOUR = column(NODE)
NEIGHBOURS = column(NODE)
NODE_ISLAND = column(NODE)

# Columns of BLOCK: 6x6 blocks of the matrix
UPPER_BLOCK = column(BLOCK, 36)  # of the node's row and the neighbour's column
LOWER_BLOCK = column(BLOCK, 36)  # and the other way round
BLOCK_PASSING = column(BLOCK, 36)  # of open axis k, six numbers each: its row
BLOCK_COUPLING = column(BLOCK, 36)  # and its column

# Rows of a contact. The wrench of a row is twelve numbers: impulse and angular impulse on the first body by a unit impulse
# along the row, and the same on the second.
_OF_A_CONTACT = Fields()
_OF_A_CONTACT.field(4)  # points
TANGENT = _OF_A_CONTACT.field(2)
TWIST = _OF_A_CONTACT.field()
ROLL = _OF_A_CONTACT.field(3)
CONTACT_ROWS = _OF_A_CONTACT.close()

# Columns of CONTACT_ROW, most of them with one number per row of the contact
WRENCH = column(CONTACT_ROW, 12 * CONTACT_ROWS)
SPEED = column(CONTACT_ROW, CONTACT_ROWS)  # before the solution
WANTED = column(CONTACT_ROW, CONTACT_ROWS)  # target speed
STIFFNESS = column(CONTACT_ROW, CONTACT_ROWS)  # impulse per error of speed
MOVED = column(CONTACT_ROW, CONTACT_ROWS)  # change of speed in the current solution
GIVEN = column(CONTACT_ROW, CONTACT_ROWS)  # change of impulse in the current solution
STATE = column(CONTACT_ROW, CONTACT_ROWS)  # OPEN, HELD or SLIDING
BOUND = column(CONTACT_ROW, 3)  # largest impulse along the tangents, of twist, of rolling
# Of a bound that is reached: the fraction of the stiffness left perpendicular to the impulse
SLIDING_PART = column(CONTACT_ROW, 3)
# Of the impulse at its bound, for rows from TANGENT on
DIRECTION = column(CONTACT_ROW, CONTACT_ROWS - TANGENT) - TANGENT
CONSTANT = column(CONTACT_ROW, CONTACT_ROWS)  # change of impulse at no change of speed
ACTIVE = column(CONTACT_ROW, CONTACT_ROWS)  # 1.0 if the row takes part
IMPULSE = column(CONTACT_ROW, CONTACT_ROWS)  # before the solution
NODES = column(CONTACT_ROW, 2)  # places of both bodies in the order of elimination; -1 if not in the island
HITS = column(CONTACT_ROW, 4, "m/s")  # target speed of each point after an impact; -1.0 if it does not hit
START = column(CONTACT_ROW, CONTACT_ROWS)  # impulse when the substep began
CUT = column(CONTACT_ROW)  # 1.0 or 2.0: this one of the bodies belongs to another island
ROW_MASS = column(CONTACT_ROW, CONTACT_ROWS)  # effective mass of the row for both bodies, free of joints
ACCEPTED = column(CONTACT_ROW, CONTACT_ROWS)  # MOVED of the solution accepted last
BORNE = column(CONTACT_ROW, CONTACT_ROWS)  # change of impulse of the solution accepted last
BASE = column(CONTACT_ROW, CONTACT_ROWS)  # change of impulse with which held rows begin the next refinement
WEIGHT = column(CONTACT_ROW, TWIST, "kg")  # mass borne, by which the stiffness of points and tangents is scaled
OPEN, HELD, SLIDING = 0.0, 1.0, 2.0

# Solutions that are found once, with the pieces of laws that the joints begin with, and not applied: changes of position, and
# of velocity. They are given in place of the time for which velocities act.
CORRECTION, PREDICTION = -1.0, -2.0
